"""Electrical impedance spectra, and their reading from files of impedance analysers.

A format is one class and one line of `IMPEDANCE_FORMATS`; detection and documentation derive from the table.
"""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Complexes, Floats, require_finite_complex, require_positive
from sonolube.errors import InvalidInput, UnknownName
from sonolube.measurement.measured_files import HEAD_SIZE, FileFormat, detect_format, refuse_unreadable, require_points
from sonolube.measurement.recordings.text_tables import decoded_content
from sonolube.measurement.time_series import require_equal_length
from sonolube.storage.user_files import input_bytes
from sonolube.variants import VariantTable


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ImpedanceSpectrum:
    """Electrical impedance over frequency, with its provenance.

    Parameters
    ----------
    frequency : ndarray, shape (n,)
        Increasing. [Hz]
    impedance : ndarray, shape (n,)
        Complex, not zero; the magnitude where only that was measured. [ohm]
    has_phase : bool
        Whether the phase was measured.
    sweep : str
        Name of the sweep in its file.
    file_name : str
        File it was read from; empty where it was not read from a file.
    file_format : str
        Name of the format of that file.
    sha256 : str
        Digest of that file.
    columns : str
        Headings of the columns of that file that it was read from.
    caveats : tuple of str
        Of its reading.

    Raises
    ------
    InvalidInput
        If the shapes differ, a frequency is not positive or does not increase, or an impedance is zero or not finite.

    Examples
    --------
    >>> import numpy as np
    >>> from sonolube.identification.circuit_fit import fit_circuit
    >>> from sonolube.measurement import ImpedanceSpectrum
    >>> s = 2j * np.pi * np.linspace(15e3, 30e3, 400)
    >>> admittance = 1e-8 * s + 1 / (20 + 0.1 * s + 1 / (6e-10 * s))
    >>> fit = fit_circuit(ImpedanceSpectrum(frequency=s.imag / (2 * np.pi), impedance=1 / admittance))
    >>> fit.resonances.series_frequency.round().tolist()  # 1/(2 pi sqrt(0.1 H 0.6 nF))
    [20547.0]
    """

    frequency: Floats
    impedance: Complexes
    has_phase: bool = True
    sweep: str = ""
    file_name: str = ""
    file_format: str = ""
    sha256: str = ""
    columns: str = ""
    caveats: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        f = require_positive(frequency=self.frequency)
        z = require_finite_complex(impedance=self.impedance)
        require_equal_length(frequency=f, impedance=z)
        if np.any(falls := np.diff(f) <= 0):
            raise InvalidInput(f"frequency must increase, got {f[1:][falls][0]:.10g} Hz after as much or more")
        if np.any(z == 0):
            raise InvalidInput(f"impedance must not be zero, as it is at {f[z == 0][0]:.10g} Hz")
        object.__setattr__(self, "frequency", f)
        object.__setattr__(self, "impedance", z)

    @property
    def admittance(self) -> Complexes:
        """Electrical admittance 1/Z, complex, in siemens; its magnitude where the phase was not measured."""
        return np.asarray(1 / self.impedance)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ImpedanceSweep:
    """One sweep as a file holds it, in SI but not yet validated, with the line of each point.

    Parameters
    ----------
    frequency : ndarray, shape (n,)
        As written, in SI. [Hz]
    impedance : ndarray, shape (n,)
        As written, in SI. [ohm]
    lines : ndarray of int, shape (n,)
        Line number of each point in the file.
    has_phase : bool
        Whether the file holds the phase.
    columns : str
        Headings of the columns that it was read from; empty where the format has none.
    caveats : tuple of str
        What had to be assumed.
    """

    frequency: Floats
    impedance: Complexes
    lines: NDArray[np.int64]
    has_phase: bool = True
    columns: str = ""
    caveats: tuple[str, ...] = ()


_LEAST, _MOST = 1e-12, 1e18  # ohm, beyond any instrument


def sorted_by_frequency(sweep: ImpedanceSweep, *, path: Path) -> ImpedanceSweep:
    """Sweep in order of increasing frequency, validated."""
    f, z, lines = sweep.frequency, sweep.impedance, sweep.lines
    if f.size > 1 and f[-1] < f[0]:
        f, z, lines = f[::-1], z[::-1], lines[::-1]
    _refuse(~(np.isfinite(f) & (f > 0)), "the frequency must be positive", lines, path)
    _refuse(np.concatenate([[False], np.diff(f) <= 0]), "the frequency is not monotonic", lines, path)
    usable = np.isfinite(z) & (np.abs(z) > _LEAST) & (np.abs(z) < _MOST)
    first = f"{abs(z[int(np.argmin(usable))]):g} ohm"
    _refuse(~usable, f"the impedance of {first} is none that an instrument reads", lines, path)
    return replace(sweep, frequency=f, impedance=z, lines=lines)


def _refuse(invalid: NDArray[np.bool_], reason: str, lines: NDArray[np.int64], path: Path) -> None:
    """Refuse a sweep with invalid points, naming the line of the first."""
    if invalid.any():
        raise InvalidInput(f"{path}: line {lines[int(np.argmax(invalid))]}: {reason}")


class ImpedanceFormat(FileFormat, Protocol):
    """Reader of one text file format of impedance spectra."""

    def read(self, path: Path, lines: list[str]) -> dict[str, ImpedanceSweep]:
        """Sweeps of a file by name.

        Parameters
        ----------
        path : Path
            Of the file, for messages.
        lines : list of str
            All lines of the file.

        Returns
        -------
        dict of str to ImpedanceSweep
            The measured sweep is called "data" where the format also stores others; a single sweep may have an empty
            name.

        Raises
        ------
        InvalidInput
            Naming the file, the line and the reason, if the file cannot be read as impedance over frequency.
        """


IMPEDANCE_FORMATS: VariantTable[ImpedanceFormat] = VariantTable(
    "impedance format",
    {
        "touchstone": "sonolube.measurement.impedance.touchstone:Touchstone",
        "HP 4294A": "sonolube.measurement.impedance.instruments:Hp4294A",
        "Keysight E4990A": "sonolube.measurement.impedance.instruments:KeysightE4990A",
        "Zurich Instruments MFIA": "sonolube.measurement.impedance.instruments:Mfia",
        "table with named columns": "sonolube.measurement.impedance.named_columns:NamedColumns",
    },
    made=lambda known: known(),
)
"""File formats of impedance spectra in order of detection, the last as fallback; a new one takes a file and a line."""


_NEARLY_ALL = 0.95  # of the conductance summed over the points


def passive_spectrum(spectrum: ImpedanceSpectrum) -> tuple[ImpedanceSpectrum, tuple[str, ...]]:
    r"""Spectrum with a sign that a passive part can have, and a caveat where it was turned by 180 degrees.

    Parameters
    ----------
    spectrum : ImpedanceSpectrum
        As read.

    Returns
    -------
    spectrum : ImpedanceSpectrum
        With the opposite sign where nearly all conductance of the given one is negative, else the given one.
    caveats : tuple of str
        One line where it was turned.

    Notes
    -----
    A passive part takes power: :math:`\operatorname{Re} Y \ge 0` at every frequency. Where current or voltage is wired
    or defined in the opposite sense, the whole spectrum has the opposite sign. Of the conductance

    .. math:: \frac{\sum_i \max(-\operatorname{Re} Y_i, 0)}{\sum_i |\operatorname{Re} Y_i|} \ge 0.95

    is then negative; the sum has little weight where the conductance is so small that noise decides its sign.
    """
    if not spectrum.has_phase:
        return spectrum, ()
    conductance = spectrum.admittance.real
    total, negative = float(np.abs(conductance).sum()), float(np.maximum(-conductance, 0).sum())
    if not (total > 0 and negative >= _NEARLY_ALL * total):
        return spectrum, ()
    share = float(np.mean(conductance < 0))
    caveat = (
        f"the file holds a spectrum turned by 180 degrees: the conductance is negative at {share:.0%} of its points,"
        " which no passive part has; current or voltage has the opposite sign, and the spectrum was turned back"
    )
    return replace(spectrum, impedance=-spectrum.impedance), (caveat,)


_LARGEST_FILE = 1 << 28  # bytes; far above any sweep


def read_impedance(path: str | Path, *, sweep: str | None = None) -> ImpedanceSpectrum:
    """Impedance spectrum read from a file.

    Parameters
    ----------
    path : str or Path
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
    path = Path(path)
    content = sweep_bytes(path)
    text, caveats = decoded_content(content, path)
    lines = text_lines(text)
    require_points(len(lines), path, line=len(lines))
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
        columns=selected.columns,
        caveats=(*caveats, *selected.caveats),
    )


def sweep_bytes(path: Path) -> bytes:
    """Bytes of a file of limited size."""
    with refuse_unreadable(path):
        if path.stat().st_size > _LARGEST_FILE:
            raise InvalidInput(f"{path}: line 1: is larger than {_LARGEST_FILE >> 20} MiB, more than any sweep")
        return input_bytes(path, most=_LARGEST_FILE)


def text_lines(text: str) -> list[str]:
    """Lines of a text, whatever ends them."""
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


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
