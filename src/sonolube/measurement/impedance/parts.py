"""Impedance from the two real parts, or the complex number, by which instruments state it."""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Complexes, Floats
from sonolube.measurement.impedance.spectrum import ImpedanceSweep

Conversion = Callable[[Floats, Floats, Floats], Floats | Complexes]
"""Impedance from the angular frequency and two parts; of reflection over the reference impedance."""


def _reflected(reflection: Complexes) -> Complexes:
    """Impedance over the reference impedance of a reflection coefficient."""
    return np.asarray((1 + reflection) / (1 - reflection))


def _lossy(part: Floats, reactive: Floats, loss: Floats) -> Complexes:
    """Complex value of a capacitance or inductance with a loss factor, positive or of the sign of the part."""
    negative = part < 0
    follows = float(np.sum((loss * np.abs(reactive))[negative])) < 0
    return np.asarray(np.abs(reactive) * (loss * np.sign(part) if follows else loss) + 1j * reactive)


def _turned(angle: Floats) -> Complexes:
    """Complex number of magnitude one."""
    return np.asarray(np.exp(1j * angle))


_SERIES: Final[Mapping[str, Callable[[Floats, Floats], Floats]]] = MappingProxyType(
    {"Cs": lambda w, c: -1 / (w * c), "Ls": lambda w, inductance: w * inductance}
)
_PARALLEL: Final[Mapping[str, Callable[[Floats, Floats], Floats]]] = MappingProxyType(
    {"Cp": lambda w, c: w * c, "Lp": lambda w, inductance: -1 / (w * inductance)}
)


def _series(reactance: Callable[[Floats, Floats], Floats], other: str) -> Conversion:
    """Impedance of a series circuit by its reactance and a resistance, loss or quality factor."""
    if other == "R":
        return lambda w, part, r: r + 1j * reactance(w, part)
    if other == "D":
        return lambda w, part, loss: _lossy(part, reactance(w, part), loss)
    return lambda w, part, quality: _lossy(part, reactance(w, part), 1 / quality)


def _parallel(susceptance: Callable[[Floats, Floats], Floats], other: str) -> Conversion:
    """Impedance of a parallel circuit by its susceptance and a resistance, conductance, loss or quality factor."""
    if other == "Rp":
        return lambda w, part, r: 1 / (1 / r + 1j * susceptance(w, part))
    if other == "G":
        return lambda w, part, g: 1 / (g + 1j * susceptance(w, part))
    if other == "D":
        return lambda w, part, loss: 1 / _lossy(part, susceptance(w, part), loss)
    return lambda w, part, quality: 1 / _lossy(part, susceptance(w, part), 1 / quality)


_IMPEDANCE: Final[Mapping[tuple[str, str], Conversion]] = MappingProxyType(
    {
        ("R", "X"): lambda w, r, x: r + 1j * x,
        **{("|Z|", angle): lambda w, z, a: z * _turned(a) for angle in ("theta_Z", "theta")},
        ("G", "B"): lambda w, g, b: 1 / (g + 1j * b),
        **{("|Y|", angle): lambda w, y, a: _turned(-a) / y for angle in ("theta_Y", "theta")},
        ("|Z|", "theta_Y"): lambda w, z, a: z * _turned(-a),
        ("|Y|", "theta_Z"): lambda w, y, a: _turned(a) / y,
        **{(part, other): _series(own, other) for part, own in _SERIES.items() for other in ("R", "D", "Q")},
        **{(part, other): _parallel(own, other) for part, own in _PARALLEL.items() for other in ("Rp", "G", "D", "Q")},
        ("Rp", "Xp"): lambda w, r, x: 1 / (1 / r + 1 / (1j * x)),
        ("Re S", "Im S"): lambda w, re, im: _reflected(re + 1j * im),
        **{("|S|", angle): lambda w, s, a: _reflected(s * _turned(a)) for angle in ("theta_S", "theta")},
        ("|Z|", "|Z|"): lambda w, z, _: z,
        ("|Y|", "|Y|"): lambda w, y, _: 1 / y,
    }
)
MAGNITUDES: Final = (("|Z|", "|Z|"), ("|Y|", "|Y|"))
"""Of `IMPEDANCE_PARTS` those that define the magnitude only."""
IMPEDANCE_PARTS: Final = tuple(_IMPEDANCE)
"""Pairs of column symbols that define an impedance, in order of preference."""
COMPLEX_PARTS: Final = ("|Z|", "|Y|", "|S|")
"""Symbols of columns whose cells may be complex numbers: of impedance, admittance and reflection."""


def pair_of(symbols: frozenset[str]) -> tuple[str, str] | None:
    """First pair of `IMPEDANCE_PARTS` among symbols; a magnitude alone only where there is nothing else."""
    return next((pair for pair in IMPEDANCE_PARTS if symbols.issuperset(pair)), None)


def sweep_of_parts(
    columns: Mapping[str, Floats], pair: tuple[str, str], *, lines: NDArray[np.int64], reference: float = 1.0
) -> ImpedanceSweep:
    r"""Sweep over the column f from two real parts of impedance, admittance, reflection or an equivalent circuit.

    Its impedance is not finite where the parts define no finite one.

    With :math:`\omega = 2\pi f`: :math:`R + jX`, :math:`|Z| e^{j\theta}`, :math:`1/(G + jB)`, the series circuits
    :math:`R_s + j\omega L_s` and :math:`R_s + 1/(j\omega C_s)`, the parallel circuits
    :math:`(1/R_p + 1/(j\omega L_p))^{-1}` and :math:`(1/R_p + j\omega C_p)^{-1}`, in which a loss factor D or quality
    factor Q = 1/D gives :math:`R_s = D |X|` and :math:`G = D |B|`, and of the reflection coefficient S against the
    reference impedance :math:`Z_0`, `reference` in ohm, :math:`Z_0 (1 + S)/(1 - S)`.

    Where a capacitance or inductance is negative, instruments write D and Q positive or of its sign; of both
    conventions that is taken by which the part, as a whole, takes power.
    """
    first, second = pair
    with np.errstate(all="ignore"):
        omega = 2 * np.pi * columns["f"]
        impedance = np.asarray(_IMPEDANCE[pair](omega, columns[first], columns[second]), dtype=np.complex128)
        if "S" in first:
            impedance = reference * impedance
    return ImpedanceSweep(frequency=columns["f"], impedance=impedance, lines=lines, has_phase=pair not in MAGNITUDES)


def impedance_of_complex(values: Complexes, symbol: str, *, reference: float = 1.0) -> Complexes:
    """Impedance of complex numbers of a quantity of `COMPLEX_PARTS`. [ohm]"""
    with np.errstate(all="ignore"):
        if symbol == "|S|":
            return np.asarray(reference * _reflected(values))
        return np.asarray(1 / values if symbol == "|Y|" else values)
