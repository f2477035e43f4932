"""Command that measures what a run has recorded."""

from collections.abc import Sequence
from pathlib import Path

from sonolube.laboratory.records import Run
from sonolube.operating_system import quoted
from sonolube.text.units import format_si


def next_command(run: Run) -> str:
    """Command for what was recorded: decay length, calibration, friction, impedance, rotation, or to show it.

    Names the folder of the run where the command takes all parts of the recording.
    """
    parts = run.part_channels
    friction = _having(parts, "friction_force")
    gauges = [path for path in friction if "displacement" in parts[path]]
    lifts = any(note.facts.get("normal_load") == 0 for note in run.notes if note.kind == "conditions")
    if lifts and any("normal_load" in parts[path] for path in friction):
        return f"sonolube identify decay-length {quoted(str(run.folder))}"
    if gauges:
        applied = "".join(f" --apply {quoted(str(path))}" for path in gauges[1:])
        return f"sonolube measure calibration {quoted(str(gauges[0]))}{applied}"
    if friction:
        return f"sonolube measure friction {_files(run, friction)}"
    driven = [path for path in _having(parts, "voltage") if "current" in parts[path]]
    if driven:
        return f"sonolube measure impedance {_files(run, driven)}"
    turning = _having(parts, "gaussmeter")
    diameter = run.facts.get("groove_diameter")
    if turning and isinstance(diameter, int | float):
        groove = format_si(float(diameter), "m").replace(" ", "")
        return f"sonolube measure rotation {_files(run, turning)} --groove-diameter {groove}"
    return f"sonolube lab show {quoted(str(run.folder))}"


def _having(parts: dict[Path, tuple[str, ...]], channel: str) -> list[Path]:
    """Files of the parts with a channel."""
    return [path for path, channels in parts.items() if channel in channels]


def _files(run: Run, chosen: Sequence[Path]) -> str:
    """Folder of a run where all of its parts are chosen, else their files."""
    is_whole = len(chosen) == len(run.recordings)
    return quoted(str(run.folder)) if is_whole else " ".join(quoted(str(path)) for path in chosen)
