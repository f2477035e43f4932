"""Export of the recording of a run to files for other programs."""

from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Final

from sonolube.errors import InvalidInput, UnknownName
from sonolube.laboratory.records.converted_part import converted_part
from sonolube.laboratory.records.documents import numbered_parts, part_clocks, read_documents
from sonolube.laboratory.records.recorded_part import PartOfRecording, recorded_part
from sonolube.laboratory.records.recording_files import (
    write_csv_recording,
    write_netcdf_recording,
    write_tdms_recording,
)
from sonolube.laboratory.records.run_folder import RunFacts, raw_parts, read_run_facts, recording_path

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
