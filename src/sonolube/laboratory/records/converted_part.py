"""Raw blocks that were converted: removed once the recording holds every sample, and read back from it."""

import json
from collections.abc import Mapping
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.laboratory.records.documents import read_documents
from sonolube.laboratory.records.part_clock import PartClock, part_clock
from sonolube.laboratory.records.recorded_part import ROWS, PartOfRecording, Pieces, recorded_part
from sonolube.laboratory.records.run_folder import (
    PURPOSE,
    RunFacts,
    changed_recordings,
    raw_parts,
    raw_path,
    read_run_facts,
    recording_path,
)
from sonolube.laboratory.records.set_point_steps import SET_POINT_CHANNELS
from sonolube.operating_system import remove_file
from sonolube.storage.files import locked_folder
from sonolube.vocabulary import quantities


def converted_part(path: Path) -> PartOfRecording:
    """Part of a recording by its netCDF file."""
    import h5netcdf

    try:
        with h5netcdf.File(path, "r") as file:
            attributes: dict[str, Any] = dict(file.attrs)
            time = file["time"]
            rate, samples = float(attributes["sample_rate"]), int(time.shape[0])
            spanned = round(float(time[-1]) * rate) + 1 if samples else 0
            measured = {name: str(variable.attrs.get("quantity", name)) for name, variable in file.variables.items()}
            units = {name: str(file[name].attrs["units"]) for name, of in measured.items() if of not in quantities()}
            clock = _clock(attributes)
    except (OSError, KeyError, ValueError) as failure:
        raise InvalidInput(f"{path}: is no recording of a run: {failure}") from None
    measured.pop("time")
    begun = datetime.strptime(str(attributes["begun"]), "%Y-%m-%d %H:%M:%S.%f").replace(tzinfo=UTC)
    return PartOfRecording(
        path=path,
        samples=samples,
        missing=spanned - samples,
        sample_rate=rate,
        begun=begun.timestamp(),
        variables=measured,
        units={name: "" if unit == "1" else unit for name, unit in units.items()},
        clock=clock,
        set_points=tuple(name for name in measured if name in SET_POINT_CHANNELS),
        lubricants=tuple(json.loads(str(attributes.get("lubricants", "[]")))),
        caveats=str(attributes.get("caveats", "")).splitlines(),
        pieces=partial(_pieces_of_file, path, samples, list(measured)),
    )


def _pieces_of_file(path: Path, samples: int, names: list[str]) -> Pieces:
    """Pieces of the netCDF file of a part."""
    import h5netcdf

    with h5netcdf.File(path, "r") as file:
        for first in range(0, samples, ROWS):
            rows = slice(first, first + ROWS)
            yield file["time"][rows], [file[name][rows] for name in names]


def _clock(attributes: Mapping[str, Any]) -> PartClock | None:
    """Clock of a part by the attributes of its file; None for that of the run."""
    if "clock_name" not in attributes:
        return None
    return part_clock({name: attributes[f"clock_{name}"] for name in PartClock.__slots__})


def drop_raw_blocks(folder: Path) -> tuple[str, ...]:
    """Remove the raw blocks of a run that has ended, each part once its recording was found to hold every sample.

    Parameters
    ----------
    folder : Path

    Returns
    -------
    tuple of str
        What was removed, a line a part.

    Raises
    ------
    InvalidInput
        If the run is at work or was not recovered, or a recording is missing, was changed or differs from its blocks.
    """
    known, documents = read_run_facts(folder), read_documents(folder)
    with locked_folder(folder, purpose=PURPOSE):
        if not documents.of("stop"):
            raise InvalidInput(f"{folder}: has not ended in order; run sonolube lab recover first")
        parts = {number: recorded_part(folder, number, documents, facts=known.facts) for number in raw_parts(folder)}
        for number, part in parts.items():
            _require_converted(folder, number, part, known)
        done = []
        for number in parts:
            size = raw_path(folder, number).stat().st_size
            remove_file(raw_path(folder, number))
            done.append(f"{raw_path(folder, number).name} removed, {size / 1e6:.3g} MB")
    return tuple(done)


def _require_converted(folder: Path, number: int, part: PartOfRecording, known: RunFacts) -> None:
    """Raise unless the recording of a part holds every sample of its raw blocks, bit for bit, and none is damaged."""
    path = recording_path(folder, number, part.clock_name)
    if not part.samples:
        return
    if not path.is_file() or path.name not in known.recordings:
        raise InvalidInput(f"{folder}: {path.name} is missing or has no SHA-256; run sonolube lab recover first")
    if path.name in changed_recordings(folder, known):
        raise InvalidInput(f"{path}: was changed after the run wrote it; its raw blocks are kept")
    if part.damaged:
        raise InvalidInput(f"{part.path}: is damaged at {part.damaged} places, and is kept")
    import h5netcdf

    first = 0
    with h5netcdf.File(path, "r") as file:
        for time, columns in part.pieces():
            rows = slice(first, first + time.size)
            for name, values in zip(("time", *part.variables), (time, *columns), strict=True):
                if name not in file.variables or not np.array_equal(file[name][rows], values, equal_nan=True):
                    raise InvalidInput(f"{path}: {name} differs from the raw blocks, which are kept")
            first = rows.stop
        if file["time"].shape[0] != first:
            raise InvalidInput(f"{path}: has other samples than the raw blocks, which are kept")
