"""Sheet of one friction test that was recorded in several files."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.measurement.friction.loops import friction_work
from sonolube.measurement.friction_analysis import channel_values
from sonolube.measurement.recordings.joined_recording import join_recordings
from sonolube.measurement.recordings.reader import read_recording
from sonolube.report.measured import sheet
from sonolube.report.measured.friction import FrictionSettings, friction_channel, recording_sheet

_COLUMNS = (sheet.Column("file", "File"), sheet.Column("start_time", "From", "s"), sheet.Column("end_time", "To", "s"))


def joined_friction_sheet(paths: Sequence[Path], *, settings: FrictionSettings) -> sheet.Sheet:
    """Friction in all files of one test, as of one recording, with a table of the files.

    The analyses of `friction_sheet` over all files, so that cycles of a reciprocating motion may extend over several of
    them; and per file its time, mean friction and scatter, and work and distance where the velocity was recorded.
    """
    parts = [read_recording(path, mapping=settings.mapping) for path in paths]
    joined = join_recordings(parts)
    whole = recording_sheet(joined, title=f"{len(paths)} files as one test", settings=settings)
    name = friction_channel(joined)
    unit = str(joined[name].attrs.get("units", ""))
    moving = "relative_velocity" in joined.variables and name == "friction_force"
    columns = [
        *_COLUMNS,
        *sheet.quantity_columns({name: "Friction"}),
        sheet.Column(f"{name}_deviation", "Deviation", unit),
    ]
    if moving:
        columns += sheet.quantity_columns({"frictional_work": "Work", "sliding_distance": "Distance"})
    rows = []
    for path, part, start in zip(paths, parts, joined.attrs["part_starts"], strict=True):
        time, friction = channel_values(part, "time"), channel_values(part, name)
        known = friction[np.isfinite(friction)]
        row: list[sheet.Cell] = [path.name, start, start + float(time[-1] - time[0])]
        row += [float(known.mean()), float(known.std(ddof=1)) if known.size > 1 else None]
        rows.append((*row, *(_work(time, friction, channel_values(part, "relative_velocity")) if moving else ())))
    table = sheet.Table(name="files", title="Friction in each file", columns=tuple(columns), rows=tuple(rows))
    return sheet.joined([whole, sheet.Sheet(tables=(table,))], title=whole.title, source=whole.source)


def _work(time: np.ndarray, friction: np.ndarray, velocity: np.ndarray) -> tuple[sheet.Cell, sheet.Cell]:
    """Work and distance in one file; nothing where it has no sliding."""
    try:
        work = friction_work(time=time, friction_force=friction, relative_velocity=velocity)
    except InvalidInput:
        return None, None
    return float(work.frictional_work[-1]), work.sliding_distance
