"""Electrical impedance spectra: the validated record, and the sweep of a file before validation."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Complexes, Floats, require_finite_complex, require_positive
from sonolube.errors import InvalidInput
from sonolube.measurement.time_series import require_equal_length


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
    """

    frequency: Floats
    impedance: Complexes
    lines: NDArray[np.int64]
    has_phase: bool = True


def sorted_by_frequency(sweep: ImpedanceSweep, *, path: Path) -> ImpedanceSweep:
    """Sweep in order of increasing frequency, validated."""
    f, z, lines = sweep.frequency, sweep.impedance, sweep.lines
    if f.size > 1 and f[-1] < f[0]:
        f, z, lines = f[::-1], z[::-1], lines[::-1]
    _refuse(~(np.isfinite(f) & (f > 0)), "the frequency must be positive", lines, path)
    _refuse(np.concatenate([[False], np.diff(f) <= 0]), "the frequency is not monotonic", lines, path)
    usable = np.isfinite(z) & (np.abs(z) > np.finfo(float).tiny) & (np.abs(z) < 1 / np.finfo(float).tiny)
    _refuse(~usable, "the impedance is zero or not finite", lines, path)
    return ImpedanceSweep(frequency=f, impedance=z, lines=lines, has_phase=sweep.has_phase)


def _refuse(invalid: NDArray[np.bool_], reason: str, lines: NDArray[np.int64], path: Path) -> None:
    """Refuse a sweep with invalid points, naming the line of the first."""
    if invalid.any():
        raise InvalidInput(f"{path}: line {lines[int(np.argmax(invalid))]}: {reason}")
