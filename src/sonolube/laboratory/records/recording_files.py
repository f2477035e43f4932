"""Recordings as files, streamed part by part: netCDF, TDMS, CSV; exports of runs.

The netCDF follows the CF conventions, and those for attributes of the whole file (ACDD), so that others find quantity,
unit, sensor and time in UTC of every sample; `sonolube measure` reads it.
"""

import io
import json
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

import numpy as np

from sonolube.errors import InvalidInput, UnknownName
from sonolube.laboratory.records.documents import numbered_parts, part_clocks, read_documents
from sonolube.laboratory.records.recorded_part import WAVES, PartOfRecording, converted_part, recorded_part
from sonolube.laboratory.records.run_folder import (
    UNRESOLVED,
    RunFacts,
    raw_parts,
    read_run_facts,
    recording_path,
    utc_text,
)
from sonolube.storage.files import unfinished_file
from sonolube.vocabulary import quantities, unit_of

_PACKED: Final[Mapping[str, Any]] = {"compression": "gzip", "compression_opts": 1, "shuffle": True}
_ROWS: Final = 1 << 16  # of a chunk of set points
_STANDARD_NAMES: Final[Mapping[str, str]] = {  # by the table of CF, which has none for tribology
    **{name: name for name in ("time", "air_temperature", "relative_humidity")},
    "ambient_temperature": "air_temperature",
}
_CALENDAR: Final = {"calendar": "standard", "units_metadata": "leap_seconds: none"}  # as clocks of computers count
_CONVENTIONS: Final = "CF-1.11, ACDD-1.3"
_STATED: Final = {"creator_name": ("creator", "operator"), "institution": ("institution",), "license": ("licence",)}
_CSV_DIGITS: Final = "%.17g"  # what 64-bit floats hold


def write_netcdf_recording(part: PartOfRecording, known: RunFacts, path: Path) -> Path:
    """Write a part of a recording as netCDF, whole or not at all."""
    import h5netcdf

    with unfinished_file(path) as unfinished:
        try:
            with h5netcdf.File(unfinished, "w") as file:
                _define(file, part, known)
                first = 0
                for time, columns in part.pieces():
                    rows = slice(first, first + time.size)
                    for name, values in zip(("time", *part.variables), (time, *columns), strict=True):
                        file[name][rows] = values
                    unfinished.check()
                    first = rows.stop
        finally:
            unfinished.check()  # tells more than what HDF5 makes of it
        unfinished.complete()
    return path


def write_tdms_recording(part: PartOfRecording, known: RunFacts, path: Path) -> Path:
    """Write a part of a recording as TDMS, as `write_netcdf_recording`; with a channel `time` where samples lack."""
    from nptdms import ChannelObject, GroupObject, RootObject, TdmsWriter

    root = RootObject(properties={"name": known.title, "DateTime": _start(part)})
    with unfinished_file(path) as file, TdmsWriter(file) as writer:
        for time, columns in part.pieces():
            named = dict(zip(part.variables, columns, strict=True)) | ({"time": time} if part.missing else {})
            channels = [
                ChannelObject("recording", name, values, properties=_waveform(part, name))
                for name, values in named.items()
            ]
            writer.write_segment([root, GroupObject("recording"), *channels])
            file.check()
        file.complete()
    return path


def write_csv_recording(part: PartOfRecording, known: RunFacts, path: Path) -> Path:
    """Write a part of a recording as CSV with the units in its first line, as `write_netcdf_recording`."""
    heads = ["time [s]", *(f"{name} [{_unit(part, name) or '1'}]" for name in part.variables)]
    with unfinished_file(path) as file:
        file.write((",".join(heads) + "\n").encode())
        for time, columns in part.pieces():
            np.savetxt(text := io.BytesIO(), np.stack([time, *columns], 1), fmt=_CSV_DIGITS, delimiter=",")
            file.write(text.getvalue())
            file.check()
        file.complete()
    return path


def _define(file: Any, part: PartOfRecording, known: RunFacts) -> None:
    """Define dimension, attributes and variables of a netCDF file."""
    file.dimensions = {"time": part.samples}
    file.attrs.update(_attributes(part, known))
    for name, of in {"time": "time", **part.variables}.items():
        quantity = quantities().get(of)
        meaning = of.replace("_", " ") if quantity is None else quantity.meaning
        packed = {**_PACKED, "fillvalue": np.nan} if name in part.set_points else {}
        chunks = (max(1, min(_ROWS, part.samples)),) if packed else None
        variable = file.create_variable(name, ("time",), np.float64, chunks=chunks, **packed)
        variable.attrs.update({"units": _unit(part, name) or "1", "long_name": meaning, "quantity": of})
        variable.attrs.update({**part.measured.get(name, {}), **_flags(name, part.lubricants)})
        if of in _STANDARD_NAMES:
            variable.attrs["standard_name"] = _STANDARD_NAMES[of]
    file["time"].attrs.update({"units": f"seconds since {utc_text(part.begun)}", "axis": "T"} | _CALENDAR)


def _flags(name: str, lubricants: Sequence[str]) -> dict[str, Any]:
    """Meanings of the numbers of a set point that stand for words, as CF has them: words without blanks."""
    words = {"motor_on": ("off", "on"), "lubricant_set": ("none", *lubricants)}.get(name, ())
    if not words:
        return {}
    plain = [re.sub(r"[^A-Za-z0-9_.+@-]+", "_", word) for word in words]
    return {"flag_values": np.arange(float(len(plain))), "flag_meanings": " ".join(plain)}


def _attributes(part: PartOfRecording, known: RunFacts) -> dict[str, str | float]:
    """Attributes of the file: origin, sample rate and caveats."""
    found: dict[str, str | float] = {
        **record_attributes(known, identifier=part.run_identifier),
        "sample_rate": part.sample_rate,
        "begun": utc_text(part.begun),
        "facts": json.dumps(dict(known.facts)),
    }
    if part.read_back:
        found["drive_read_back"] = "\n".join(part.read_back)
    if part.clock is not None:
        found |= {f"clock_{key}": value for key, value in asdict(part.clock).items()}
    if part.lubricants:
        found["lubricants"] = json.dumps(part.lubricants)
    caveats = [*part.caveats]
    if UNRESOLVED in known.facts and WAVES & set(part.variables.values()):
        caveats.append(str(known.facts[UNRESOLVED]))
    return found | ({"caveats": "\n".join(caveats)} if caveats else {})


def record_attributes(known: RunFacts, *, identifier: str) -> dict[str, str]:
    """Attributes of every netCDF file of a run: conventions, and where its values come from."""
    facts = known.facts
    program = f"sonolube {known.versions.get('sonolube', '')}".strip()
    stated = {name: next((str(facts[key]) for key in keys if facts.get(key)), "") for name, keys in _STATED.items()}
    given = {"protocol": facts.get("protocol"), "rig": facts.get("rig") or facts.get("rig_title")}
    told = {
        **stated,
        "id": identifier,
        "references": "; ".join(f"{kind} {name}" for kind, name in given.items() if name),
        "comment": "virtual: computed by a model of the rig, not measured" if facts.get("simulated") else "",
    }
    return {
        "Conventions": _CONVENTIONS,
        "title": known.title,
        "source": program,
        "history": f"{utc_text(known.begun)}: run begun, recorded by {program}",
        **{name: text for name, text in told.items() if text},
    }


def _waveform(part: PartOfRecording, name: str) -> Mapping[str, Any]:
    """Properties of a channel of TDMS."""
    common = {"unit_string": _unit(part, name) or "1"}
    if part.missing:
        return common
    return common | {"wf_start_time": _start(part), "wf_start_offset": 0.0, "wf_increment": 1 / part.sample_rate}


def _unit(part: PartOfRecording, name: str) -> str:
    """SI unit of a variable, or of the time; empty for pure numbers."""
    return part.units[name] if name in part.units else unit_of(part.variables.get(name, "time"))


def _start(part: PartOfRecording) -> np.datetime64:
    """Time of the first sample in UTC."""
    return np.datetime64(datetime.fromtimestamp(part.begun, UTC).replace(tzinfo=None), "us")


_WRITERS: Final[Mapping[str, tuple[str, Callable[[PartOfRecording, RunFacts, Path], Path]]]] = MappingProxyType(
    {
        "netcdf": (".nc", write_netcdf_recording),
        "tdms": (".tdms", write_tdms_recording),
        "csv": (".csv", write_csv_recording),
    }
)
EXPORT_FORMATS: Final = tuple(_WRITERS)
"""Formats in which a recording is written."""


def export_run(folder: Path, *, file_format: str, out: Path) -> list[Path]:
    """Write the recording of a run to files, one a part, streamed from its raw blocks, else its netCDF.

    Parameters
    ----------
    folder : Path
        Of the run; also of one that is at work or was killed.
    file_format : str
        Of `EXPORT_FORMATS`.
    out : Path
        Folder of the files, which are named by that of the run.

    Returns
    -------
    list of Path

    Raises
    ------
    UnknownName
        If there is no such format.
    InvalidInput
        If the folder holds no run with raw blocks, or a file cannot be written.
    """
    if file_format not in _WRITERS:
        raise UnknownName.among(EXPORT_FORMATS, kind="format", name=file_format)
    ending, write = _WRITERS[file_format]
    known, documents = read_run_facts(folder), read_documents(folder)
    blocks = raw_parts(folder)
    parts = {number: recorded_part(folder, number, documents, facts=known.facts) for number in blocks}
    clocks = part_clocks(documents)
    for number in numbered_parts(documents):
        path = recording_path(folder, number, clocks.get(number, ""))
        if number not in blocks and path.is_file():
            parts[number] = converted_part(path)
    filled = [(number, parts[number]) for number in sorted(parts) if parts[number].samples]
    if not filled:
        raise InvalidInput(f"{folder}: has no recording to export")
    name = folder.resolve().name
    of_clock = {number: f"-{part.clock_name}".rstrip("-") for number, part in filled}
    return [
        write(part, known, out / (f"{name}{ending}" if number == 1 else f"{name}-{number}{of_clock[number]}{ending}"))
        for number, part in filled
    ]
