"""Reading of impedance spectra from files of impedance analysers, in any format of `IMPEDANCE_FORMATS`."""

import hashlib
from collections.abc import Mapping
from pathlib import Path

from sonolube.errors import InvalidInput, UnknownName
from sonolube.measurement.file_format import HEAD_SIZE, detect_format, refuse_unreadable
from sonolube.measurement.impedance.formats import IMPEDANCE_FORMATS
from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum, ImpedanceSweep, sorted_by_frequency
from sonolube.measurement.limits import require_points
from sonolube.storage.input_files import input_bytes

_LARGEST_FILE = 1 << 28  # bytes; far above any sweep


def read_impedance(path: Path, *, sweep: str | None = None) -> ImpedanceSpectrum:
    """Impedance spectrum read from a file.

    Parameters
    ----------
    path : Path
        In any format of `IMPEDANCE_FORMATS`, which is detected by content; touchstone by its suffix.
    sweep : str or None
        Name of one of several sweeps, such as "memory" of a 4294A or a chunk number of an MFIA. None selects the
        measured sweep, and is refused where several remain.

    Returns
    -------
    ImpedanceSpectrum
        Of a file that holds magnitudes only, its `has_phase` is False.

    Raises
    ------
    InvalidInput
        Naming the file, the line and the reason, if the file cannot be read as impedance over frequency.
    UnknownName
        Naming the file, if it has no such sweep.
    """
    content = sweep_bytes(path)
    lines = _lines(content, path)
    formats = tuple(IMPEDANCE_FORMATS.values())
    file_format = detect_format(formats, content[:HEAD_SIZE], path) or formats[-1]
    sweeps = file_format.read(path, lines)
    name = _selected_name(path, sweeps, sweep)
    selected = sorted_by_frequency(sweeps[name], path=path)
    return ImpedanceSpectrum(
        frequency=selected.frequency,
        impedance=selected.impedance,
        has_phase=selected.has_phase,
        sweep=name,
        file_name=path.name,
        file_format=file_format.name,
        sha256=hashlib.sha256(content).hexdigest(),
    )


def sweep_bytes(path: Path) -> bytes:
    """Bytes of a file of limited size."""
    with refuse_unreadable(path):
        if path.stat().st_size > _LARGEST_FILE:
            raise InvalidInput(f"{path}: line 1: is larger than {_LARGEST_FILE >> 20} MiB, more than any sweep")
        return input_bytes(path, most=_LARGEST_FILE)


def _lines(content: bytes, path: Path) -> list[str]:
    """Lines of a text file."""
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as failure:
        line = content[: failure.start].count(b"\n") + 1
        raise InvalidInput(f"{path}: line {line}: is not UTF-8 text") from None
    if not text.strip():
        raise InvalidInput(f"{path}: is empty")
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    require_points(len(lines), path, line=len(lines))
    return lines


def _selected_name(path: Path, sweeps: Mapping[str, ImpedanceSweep], requested: str | None) -> str:
    """Name of the requested sweep, without a request that of the measured or only one."""
    if requested is not None:
        if requested not in sweeps:
            raise UnknownName(f"{path}: has no sweep {requested!r}; it has {', '.join(map(repr, sweeps))}")
        return requested
    if "data" in sweeps or len(sweeps) == 1:
        return "data" if "data" in sweeps else next(iter(sweeps))
    names = ", ".join(name[:20] for name in list(sweeps)[:12])
    raise InvalidInput(f"{path}: holds {len(sweeps)} sweeps; name one of them: {names}")
