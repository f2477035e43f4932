"""Persson's theory of elastic contact: from the spectrum of a surface to area, gap and stiffness, no asperities."""

import math
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq
from scipy.special import erf, exp1

from sonolube.checks import Floats, require_positive, require_within
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.surfaces import RadialSpectrum

ENERGY_SHARE = 0.45
"""Elastic energy of the part in contact over that of full contact there, as found by molecular dynamics. []"""

_CELLS = 800
_ROOTS = np.linspace(0.0, 6.0, 1201)  # beyond 6, exp(-s^2) is nothing


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class PerssonContact:
    """A rough elastic half-space on a rigid flat, or two with one combined modulus, without friction or adhesion.

    Parameters
    ----------
    spectrum : RadialSpectrum
        Of the heights of both surfaces together; their densities add up.
    effective_modulus : float
        Combined modulus of both bodies. [Pa]
    nominal_area : float
        Area over which the bodies face each other. [m2]
    energy_fraction : float
        Elastic energy of the part in contact over that of full contact there, above 0 and up to 1. []

    Raises
    ------
    InvalidInput
        If a value is out of range, or the spectrum holds fewer than two wavenumbers in rising order, or no height.

    Notes
    -----
    Isotropic Gaussian surfaces with slopes well below one. Exact in full contact. Against boundary elements the area
    is a quarter to a third low while it is small; the gap is right within a tenth of the rms height once a few per cent
    touch, and too wide below, where it hangs on the few highest summits.

    References
    ----------
    .. [1] B. N. J. Persson, J. Chem. Phys. 115, 3840 (2001). doi:10.1063/1.1388626
    .. [2] C. Yang and B. N. J. Persson, J. Phys.: Condens. Matter 20, 215214 (2008). doi:10.1088/0953-8984/20/21/215214
    """

    spectrum: RadialSpectrum
    effective_modulus: float
    nominal_area: float
    energy_fraction: float = ENERGY_SHARE
    _bands: tuple[Floats, Floats] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        require_positive(
            effective_modulus=self.effective_modulus,
            nominal_area=self.nominal_area,
            energy_fraction=self.energy_fraction,
        )
        require_within(0.0, 1.0, energy_fraction=self.energy_fraction)
        k, density = self.spectrum.wavenumber, self.spectrum.areal_spectral_density
        if k.size < 2 or not (k[0] > 0 and np.all(np.diff(k) > 0)):
            raise InvalidInput(f"a spectrum needs two or more wavenumbers above 0 in rising order, got {k.size}")
        if not (np.all(density >= 0) and density.max() > 0):
            raise InvalidInput("areal_spectral_density must not be negative, and somewhere positive")
        object.__setattr__(self, "_bands", _bands(self.spectrum))

    @property
    def rms_gradient(self) -> float:
        """Root mean square of the gradient. []"""
        inverse_width = self._bands[1]
        return math.sqrt(2 / inverse_width[-1] ** 2)


def persson_area_fraction(
    *, nominal_pressure: ArrayLike, effective_modulus: ArrayLike, rms_gradient: ArrayLike
) -> Floats:
    """Return the real area over the nominal one. []

    Parameters
    ----------
    nominal_pressure : array_like, any shape
        Load over the nominal area. [Pa]
    effective_modulus : array_like, broadcastable to `nominal_pressure`
        Combined modulus of both bodies. [Pa]
    rms_gradient : array_like, broadcastable to `nominal_pressure`
        Root mean square of the gradient: sqrt(2 m2) for an isotropic surface. []

    Returns
    -------
    ndarray, the broadcast shape
        sqrt(8/pi) p/(E* h') for low pressure, 1 for high.

    Raises
    ------
    InvalidInput
        If an argument is not positive.

    References
    ----------
    .. [1] B. N. J. Persson, J. Chem. Phys. 115, 3840 (2001). doi:10.1063/1.1388626
    """
    p = require_positive(nominal_pressure=nominal_pressure)
    E = require_positive(effective_modulus=effective_modulus)
    return np.asarray(erf(math.sqrt(2) * p / (E * require_positive(rms_gradient=rms_gradient))))


def persson_area(contact: PerssonContact, *, normal_load: ArrayLike) -> Floats:
    """Return the real contact area. [m2]

    Parameters
    ----------
    contact : PerssonContact
    normal_load : array_like, any shape
        Force pressing the bodies together. [N]

    Returns
    -------
    ndarray, shape of `normal_load`

    Raises
    ------
    InvalidInput
        If a load is not positive and finite.
    """
    p = require_positive(normal_load=normal_load) / contact.nominal_area
    share = persson_area_fraction(
        nominal_pressure=p, effective_modulus=contact.effective_modulus, rms_gradient=contact.rms_gradient
    )
    return contact.nominal_area * share


def persson_separation(contact: PerssonContact, *, normal_load: ArrayLike) -> Floats:
    """Return the mean gap between the deformed surfaces. [m]

    Parameters
    ----------
    contact : PerssonContact
    normal_load : array_like, any shape
        Force pressing the bodies together. [N]

    Returns
    -------
    ndarray, shape of `normal_load`

    Raises
    ------
    InvalidInput
        If a load is not positive and finite.

    Notes
    -----
    The work of the load as the gap closes is the elastic energy stored in the waves of the surface. For low loads the
    gap falls with the logarithm of the load; it is zero in full contact.

    References
    ----------
    .. [1] C. Yang and B. N. J. Persson, J. Phys.: Condens. Matter 20, 215214 (2008). doi:10.1088/0953-8984/20/21/215214
    """
    load = require_positive(normal_load=normal_load)
    lengths, inverse_width = contact._bands
    s = np.multiply.outer(load / contact.nominal_area / contact.effective_modulus, inverse_width)
    gamma = contact.energy_fraction
    # integral over the pressure from p to infinity, of (gamma + 3 (1 - gamma) erf^2) exp(-s^2)/s
    return np.asarray((gamma * exp1(s**2) / 2 + 3 * (1 - gamma) * _crowded()(np.minimum(s, _ROOTS[-1]))) @ lengths)


def persson_stiffness(contact: PerssonContact, *, normal_load: ArrayLike) -> Floats:
    """Return the normal stiffness, -dF/du of the mean gap. [N/m]

    Parameters
    ----------
    contact : PerssonContact
    normal_load : array_like, any shape
        Force pressing the bodies together. [N]

    Returns
    -------
    ndarray, shape of `normal_load`
        In proportion to a low load.

    Raises
    ------
    InvalidInput
        If a load is not positive and finite.
    OutsideRange
        If the load brings so full a contact that the gap no longer changes.
    """
    load = require_positive(normal_load=normal_load)
    lengths, inverse_width = contact._bands
    s = np.multiply.outer(load / contact.nominal_area / contact.effective_modulus, inverse_width)
    gamma = contact.energy_fraction
    decay = ((gamma + 3 * (1 - gamma) * erf(s) ** 2) * np.exp(-(s**2))) @ lengths  # -du/d ln p
    if not np.all(decay > 0):
        raise OutsideRange(f"normal_load {load.max():.4g} N closes the gap altogether: lower it")
    return np.asarray(load / decay)


def persson_load(contact: PerssonContact, *, separation: ArrayLike) -> Floats:
    """Return the load that holds the surfaces at a mean gap. [N]

    Parameters
    ----------
    contact : PerssonContact
    separation : array_like, any shape
        Mean gap between the deformed surfaces. [m]

    Returns
    -------
    ndarray, shape of `separation`

    Raises
    ------
    InvalidInput
        If a gap is not positive and finite.
    OutsideRange
        If a gap is so wide that its load underflows, or so narrow that contact is full.
    """
    gaps = require_positive(separation=separation)
    unit = contact.nominal_area * contact.effective_modulus * contact.rms_gradient
    low, high = math.log(unit) - 300.0, math.log(4 * unit)

    def surplus(log_load: float, gap: float) -> float:
        return float(persson_separation(contact, normal_load=math.exp(log_load))) - gap

    widest, narrowest = surplus(low, 0.0), surplus(high, 0.0)
    if not np.all((gaps <= widest) & (gaps >= narrowest)):
        raise OutsideRange(f"separation must lie between {narrowest:.4g} and {widest:.4g} m for this spectrum")
    loads = [math.exp(brentq(surplus, low, high, args=(gap,), xtol=1e-13)) for gap in gaps.ravel()]
    return np.reshape(loads, gaps.shape)


def _bands(spectrum: RadialSpectrum) -> tuple[Floats, Floats]:
    """Return for bands of the spectrum sqrt(pi) q^2 C w dq, a length, and w, one over the width of the pressures by E*.

    The last element belongs to the end of the spectrum, of zero length, so that its w is that of the whole surface.
    """
    k = spectrum.wavenumber
    edges = np.unique(np.concatenate([k, np.geomspace(k[0], k[-1], _CELLS)]))
    middle, width = (edges[1:] + edges[:-1]) / 2, np.diff(edges)
    q, dq = 2 * math.pi * middle, 2 * math.pi * width
    C = np.interp(middle, k, spectrum.areal_spectral_density) / (2 * math.pi) ** 2  # over angular wavenumbers
    slopes = q**3 * C * dq
    before = np.concatenate([[0.0], np.cumsum(slopes)])
    held = C > 0
    w = 1 / np.sqrt(math.pi * (before[:-1] + slopes / 2)[held])
    lengths = math.sqrt(math.pi) * (q**2 * C * dq)[held] * w
    return np.append(lengths, 0.0), np.append(w, 1 / math.sqrt(math.pi * before[-1]))


@lru_cache(maxsize=1)
def _crowded() -> CubicSpline:
    """Return the integral from s to infinity of erf^2(s) exp(-s^2)/s as a function of s up to 6."""
    node, weight = np.polynomial.legendre.leggauss(8)
    half = np.diff(_ROOTS)[:, None] / 2
    s = _ROOTS[:-1, None] + half * (1 + node)
    pieces = (half * weight * erf(s) ** 2 * np.exp(-(s**2)) / s).sum(axis=1)
    return CubicSpline(_ROOTS, np.append(np.cumsum(pieces[::-1])[::-1], 0.0))
