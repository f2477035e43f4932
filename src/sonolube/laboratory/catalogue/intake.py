"""Intake of recordings that were made elsewhere: runs without protocol that refer to files where they lie."""

import hashlib
from pathlib import Path

from sonolube.errors import InvalidInput
from sonolube.laboratory.records.documents import DocumentLog
from sonolube.laboratory.records.run_folder import RESERVE, Facts, make_run_folder
from sonolube.measurement.recordings.reader import recording_format_name
from sonolube.operating_system import remove_file


def take_in(parent: Path, source: Path, *, facts: Facts | None = None, title: str = "") -> Path:
    """Add a recording, or the recordings in a folder, to a folder of runs as one run without protocol.

    Parameters
    ----------
    parent : Path
        Folder of all runs.
    source : Path
        A file in any format of `sonolube.measurement.RECORDING_FORMATS`, or a folder of such files.
    facts : mapping of str to str, float, int or bool, optional
        As of `new_run`: pin_material, disc_material, normal_load, sliding_speed, tags, ...
    title : str
        Name of the source by default.

    Returns
    -------
    Path
        Folder of the run.

    Raises
    ------
    InvalidInput
        If there is no recording, or the folder cannot be written.

    Notes
    -----
    The files stay where they are: they may be large, and their owner may have other programs that expect them there.
    Their SHA-256 is kept, so that a later change is told.
    """
    paths = [path.resolve() for path in _recordings(source)]
    if not paths:
        raise InvalidInput(f"{source}: holds no recording that can be read; it needs TDMS, CSV, HDF5 or netCDF files")
    digests = {}
    for path in paths:
        with path.open("rb") as stream:
            digests[str(path)] = hashlib.file_digest(stream, "sha256").hexdigest()
    begun = min(path.stat().st_mtime for path in paths)
    folder, known = make_run_folder(
        parent, title=title or source.stem, begun=begun, texts={}, facts=facts or {}, referenced=digests
    )
    log = DocumentLog(folder)
    log.start(known)
    log.note("taken in", time=begun, sample=None, facts={"source": str(source.resolve())})
    log.stop("completed", reason="", time=begun)
    log.close()
    remove_file(folder / RESERVE)
    return folder


def _recordings(source: Path) -> list[Path]:
    """Files of a source that are recordings, by name."""
    candidates = sorted(source.iterdir()) if source.is_dir() else [source]
    found = []
    for path in candidates:
        if not path.is_file() or path.name.startswith(".") or path.suffix.lower() in _NO_RECORDINGS:
            continue
        try:
            recording_format_name(path)
        except InvalidInput:
            continue
        found.append(path)
    return found


_NO_RECORDINGS = (".toml", ".json", ".jsonl", ".md", ".tdms_index", ".html", ".png", ".pdf", ".svg")
