"""Impedance over frequency, as an analyser measured it, and the points of a file before they are one."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Complexes, Floats, require_finite_complex, require_positive
from sonolube.errors import InvalidInput


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ImpedanceSpectrum:
    """Electrical impedance over frequency.

    Parameters
    ----------
    frequency : ndarray, shape (n,)
        Increasing. [Hz]
    impedance : ndarray, shape (n,)
        Complex; none is zero. [ohm]
    sweep : str
        Which sweep of its file it is.
    file_name : str
        File it was read from; empty where it was not.
    file_format : str
        Name of the format of that file.
    sha256 : str
        Digest of that file.

    Raises
    ------
    InvalidInput
        If the two differ in shape, a frequency is not positive or does not rise, or an impedance is zero or not finite.
    """

    frequency: Floats
    impedance: Complexes
    sweep: str = ""
    file_name: str = ""
    file_format: str = ""
    sha256: str = ""

    def __post_init__(self) -> None:
        f = require_positive(frequency=self.frequency)
        z = require_finite_complex(impedance=self.impedance)
        if f.ndim != 1 or f.shape != z.shape or not f.size:
            raise InvalidInput(
                f"frequency and impedance must be rows of one length, got shapes {f.shape} and {z.shape}"
            )
        if np.any(np.diff(f) <= 0):
            raise InvalidInput(f"frequency must rise, got {f[1:][np.diff(f) <= 0][0]:.10g} Hz after as much or more")
        if np.any(z == 0):
            raise InvalidInput(f"impedance must not be zero, as it is at {f[z == 0][0]:.10g} Hz")
        object.__setattr__(self, "frequency", f)
        object.__setattr__(self, "impedance", z)

    @property
    def admittance(self) -> Complexes:
        """Current per voltage, complex, in siemens."""
        return np.asarray(1 / self.impedance)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ImpedanceSweep:
    """The points of a sweep as a file gives them, not yet checked.

    Parameters
    ----------
    frequency : ndarray, shape (n,)
        As written, in SI. [Hz]
    impedance : ndarray, shape (n,)
        As written, in SI. [ohm]
    lines : ndarray of int, shape (n,)
        Line of the file on which each point stands.
    """

    frequency: Floats
    impedance: Complexes
    lines: NDArray[np.int64]


def sorted_by_frequency(points: ImpedanceSweep, *, path: Path) -> ImpedanceSweep:
    """Return the points of a sweep in order of frequency.

    Parameters
    ----------
    points : Points
        Of a sweep up or down.
    path : Path
        File they come from, for messages.

    Returns
    -------
    Points

    Raises
    ------
    InvalidInput
        Naming the file and the line, if a frequency is not positive, the sweep turns or stands still, or an impedance
        is zero or not finite.
    """
    f, z, lines = points.frequency, points.impedance, points.lines
    if f.size > 1 and f[-1] < f[0]:
        f, z, lines = f[::-1], z[::-1], lines[::-1]
    _refuse(~(np.isfinite(f) & (f > 0)), "the frequency must be positive", lines, path)
    _refuse(np.concatenate([[False], np.diff(f) <= 0]), "the frequency turns or stands still", lines, path)
    usable = np.isfinite(z) & (np.abs(z) > np.finfo(float).tiny) & (np.abs(z) < 1 / np.finfo(float).tiny)
    _refuse(~usable, "the impedance is zero or without bound", lines, path)
    return ImpedanceSweep(frequency=f, impedance=z, lines=lines)


def _refuse(wrong: NDArray[np.bool_], reason: str, lines: NDArray[np.int64], path: Path) -> None:
    if wrong.any():
        raise InvalidInput(f"{path}: line {lines[int(np.argmax(wrong))]}: {reason}")
