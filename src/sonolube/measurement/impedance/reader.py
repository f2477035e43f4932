"""Impedance spectra from the files of analysers, whatever wrote them."""

import hashlib
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType

from sonolube.errors import InvalidInput, UnknownName
from sonolube.measurement.impedance.hp4294a import HP_4294A, MAGIC, read_hp4294a
from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum, ImpedanceSweep, sorted_by_frequency
from sonolube.measurement.impedance.tables import (
    COLUMNS,
    KEYSIGHT_E4990A,
    MFIA,
    read_columns,
    read_keysight_e4990a,
    read_mfia,
)
from sonolube.measurement.impedance.touchstone import TOUCHSTONE, read_touchstone

_LARGEST = 1 << 28  # bytes; no sweep comes near

IMPEDANCE_READERS: Mapping[str, Callable[[Path, list[str]], dict[str, ImpedanceSweep]]] = MappingProxyType(
    {
        HP_4294A: read_hp4294a,
        KEYSIGHT_E4990A: read_keysight_e4990a,
        TOUCHSTONE: read_touchstone,
        MFIA: read_mfia,
        COLUMNS: read_columns,
    }
)


def read_impedance(path: Path, *, sweep: str | None = None) -> ImpedanceSpectrum:
    """Return the impedance spectrum that a file holds.

    Parameters
    ----------
    path : Path
        HP 4294A text, Keysight E4990A CSV, touchstone of one port, Zurich Instruments MFIA CSV or a table whose
        columns are named; known by its content, touchstone by its suffix.
    sweep : str or None
        Which of several sweeps, such as "memory" of a 4294A or a chunk number of an MFIA. None takes what was measured,
        and is refused where that leaves a choice.

    Returns
    -------
    ImpedanceSpectrum

    Raises
    ------
    InvalidInput
        Naming the file, the line and the reason, if the file cannot be read as impedance over frequency.
    UnknownName
        Naming the file, if it has no such sweep.
    """
    content, lines = _content(path)
    file_format = impedance_format_of(path, lines)
    sweeps = IMPEDANCE_READERS[file_format](path, lines)
    chosen = _chosen(path, sweeps, sweep)
    points = sorted_by_frequency(sweeps[chosen], path=path)
    return ImpedanceSpectrum(
        frequency=points.frequency,
        impedance=points.impedance,
        sweep=chosen,
        file_name=path.name,
        file_format=file_format,
        sha256=hashlib.sha256(content).hexdigest(),
    )


def impedance_format_of(path: Path, lines: list[str]) -> str:
    """Return the name of the format of a file of impedance, by its suffix for touchstone, else by its first lines.

    Parameters
    ----------
    path : Path
        Of the file.
    lines : list of str
        Of the file.

    Returns
    -------
    str
        A key of `IMPEDANCE_READERS`.
    """
    if path.suffix.lower() in (".s1p", ".ts") or lines[0].lower().startswith("[version]"):
        return TOUCHSTONE
    if lines[0].startswith(MAGIC):
        return HP_4294A
    if lines[0].startswith("!") and any("E4990A" in line for line in lines[:4]):
        return KEYSIGHT_E4990A
    cells = lines[0].replace(",", ";").lower().split(";")
    return MFIA if cells[0].strip() == "chunk" and "fieldname" in map(str.strip, cells) else COLUMNS


def _content(path: Path) -> tuple[bytes, list[str]]:
    try:
        if path.stat().st_size > _LARGEST:
            raise InvalidInput(f"{path}: line 1: is larger than {_LARGEST >> 20} MiB, more than any sweep")
        content = path.read_bytes()
    except OSError as failure:
        raise InvalidInput(f"{path}: cannot be read: {failure.strerror}") from None
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as failure:
        line = content[: failure.start].count(b"\n") + 1
        raise InvalidInput(f"{path}: line {line}: is not UTF-8 text") from None
    if not text.strip():
        raise InvalidInput(f"{path}: is empty")
    return content, text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


def _chosen(path: Path, sweeps: Mapping[str, ImpedanceSweep], sweep: str | None) -> str:
    if sweep is not None:
        if sweep not in sweeps:
            raise UnknownName(f"{path}: has no sweep {sweep!r}; it has {', '.join(map(repr, sweeps))}")
        return sweep
    if "data" in sweeps or len(sweeps) == 1:
        return "data" if "data" in sweeps else next(iter(sweeps))
    names = ", ".join(name[:20] for name in list(sweeps)[:12])
    raise InvalidInput(f"{path}: holds {len(sweeps)} sweeps; name one of them: {names}")
