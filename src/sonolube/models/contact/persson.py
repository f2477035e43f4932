"""Persson's theory of elastic contact: real area, mean gap and stiffness from the power spectrum of a rough surface."""

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
from sonolube.models.surfaces import RadialSpectrum

ENERGY_FRACTION = 0.45
"""Default of `PerssonContact.energy_fraction`, from molecular dynamics of elastic contact. []"""

_CELLS = 800
_ABSCISSAE = np.linspace(0.0, 6.0, 1201)  # of the tabulated integral; exp(-s^2) is negligible beyond 6


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class PerssonContact:
    """Rough elastic half-space on a rigid flat, or two with their effective modulus, without friction or adhesion.

    Parameters
    ----------
    spectrum : RadialSpectrum
        Power spectrum of the heights of both surfaces together, the sum of their spectral densities.
    effective_modulus : float
        Effective contact modulus of both bodies. [Pa]
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
    Isotropic Gaussian surfaces with slopes well below one. Exact in full contact. Compared with boundary elements a
    small area is a quarter to a third too low; the gap agrees within a tenth of the rms height once a few per cent of
    the nominal area touch, and is too wide below, where it depends on the few highest summits.

    See Also
    --------
    sonolube.models.contact.RoughContact : Statistical contact of asperities.

    References
    ----------
    .. [1] B. N. J. Persson, J. Chem. Phys. 115, 3840 (2001). doi:10.1063/1.1388626
    .. [2] C. Yang and B. N. J. Persson, J. Phys.: Condens. Matter 20, 215214 (2008). doi:10.1088/0953-8984/20/21/215214
    """

    spectrum: RadialSpectrum
    effective_modulus: float
    nominal_area: float
    energy_fraction: float = ENERGY_FRACTION
    _bands: tuple[Floats, Floats] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        require_positive(effective_modulus=self.effective_modulus, nominal_area=self.nominal_area)
        require_positive(energy_fraction=self.energy_fraction)
        require_within(0.0, 1.0, energy_fraction=self.energy_fraction)
        k, density = self.spectrum.wavenumber, self.spectrum.areal_spectral_density
        if k.size < 2 or not (k[0] > 0 and np.all(np.diff(k) > 0)):
            raise InvalidInput(f"a spectrum needs two or more wavenumbers above 0 in rising order, got {k.size}")
        if not (np.all(density >= 0) and density.max() > 0):
            raise InvalidInput("areal_spectral_density must not be negative, and somewhere positive")
        object.__setattr__(self, "_bands", _bands(self.spectrum))

    @property
    def rms_gradient(self) -> float:
        """Root mean square of the surface gradient. []"""
        inverse_width = self._bands[1]
        return math.sqrt(2 / inverse_width[-1] ** 2)


def persson_area_fraction(
    *, nominal_pressure: ArrayLike, effective_modulus: ArrayLike, rms_gradient: ArrayLike
) -> Floats:
    r"""Real contact area over the nominal one by Persson's theory. []

    Parameters
    ----------
    nominal_pressure : array_like, any shape
        Load over the nominal area. [Pa]
    effective_modulus : array_like, broadcastable to `nominal_pressure`
        Effective contact modulus of both bodies. [Pa]
    rms_gradient : array_like, broadcastable to `nominal_pressure`
        Root mean square of the surface gradient, h'; sqrt(2 m2) for an isotropic surface. []

    Returns
    -------
    ndarray, the broadcast shape
        sqrt(8/pi) p/(E* h') for low pressure, 1 for high.

    Raises
    ------
    InvalidInput
        If an argument is not positive.

    Notes
    -----
    .. math:: \frac{A_r}{A_n} = \operatorname{erf}\!\left( \frac{\sqrt2\, p}{E^* h'} \right)

    References
    ----------
    .. [1] B. N. J. Persson, J. Chem. Phys. 115, 3840 (2001). doi:10.1063/1.1388626

    Examples
    --------
    >>> from sonolube.models.contact import persson_area_fraction
    >>> fraction = persson_area_fraction(nominal_pressure=1e6, effective_modulus=60e9, rms_gradient=0.1)
    >>> round(1e4 * float(fraction), 2)  # 1e4 sqrt(8/pi) p/(E* h')
    2.66
    """
    p = require_positive(nominal_pressure=nominal_pressure)
    E = require_positive(effective_modulus=effective_modulus)
    return np.asarray(erf(math.sqrt(2) * p / (E * require_positive(rms_gradient=rms_gradient))))


def persson_area(contact: PerssonContact, *, normal_load: ArrayLike) -> Floats:
    """Real contact area under a load by Persson's theory. [m2]

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
    fraction = persson_area_fraction(
        nominal_pressure=p, effective_modulus=contact.effective_modulus, rms_gradient=contact.rms_gradient
    )
    return contact.nominal_area * fraction


def persson_separation(contact: PerssonContact, *, normal_load: ArrayLike) -> Floats:
    r"""Mean gap between the deformed surfaces under a load by Persson's theory. [m]

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
    The work of the load while the gap closes equals the elastic energy stored in the surface waves. With the power
    spectrum C(q), the width w(q) of the pressure distribution at the magnification of q, and the energy fraction gamma,

    .. math::

        \bar u = \sqrt\pi \int q^2 C(q)\, w(q) \int_p^\infty
                 \left[ \gamma + 3 (1 - \gamma) \operatorname{erf}^2\!\left( \frac{w p'}{E^*} \right) \right]
                 e^{-(w p'/E^*)^2}\, \frac{\mathrm{d}p'}{p'}\, \mathrm{d}q, \qquad
        w(q) = \left[ \pi \int_{q_0}^q q'^3 C(q')\, \mathrm{d}q' \right]^{-1/2}

    For low loads the gap falls with the logarithm of the load; it is zero in full contact.

    References
    ----------
    .. [1] C. Yang and B. N. J. Persson, J. Phys.: Condens. Matter 20, 215214 (2008). doi:10.1088/0953-8984/20/21/215214
    """
    load = require_positive(normal_load=normal_load)
    lengths, inverse_width = contact._bands
    s = np.multiply.outer(load / contact.nominal_area / contact.effective_modulus, inverse_width)
    gamma = contact.energy_fraction
    # integral over the pressure from p to infinity, of (gamma + 3 (1 - gamma) erf^2) exp(-s^2)/s
    tail = _tail_integral()(np.minimum(s, _ABSCISSAE[-1]))
    return np.asarray((gamma * exp1(s**2) / 2 + 3 * (1 - gamma) * tail) @ lengths)


def persson_stiffness(contact: PerssonContact, *, normal_load: ArrayLike) -> Floats:
    """Normal stiffness under a load by Persson's theory, -dF/du of the mean gap u. [N/m]

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
        If contact is so nearly full that the gap no longer changes with the load.
    """
    load = require_positive(normal_load=normal_load)
    lengths, inverse_width = contact._bands
    s = np.multiply.outer(load / contact.nominal_area / contact.effective_modulus, inverse_width)
    gamma = contact.energy_fraction
    decay = ((gamma + 3 * (1 - gamma) * erf(s) ** 2) * np.exp(-(s**2))) @ lengths  # -du/d ln p
    if not np.all(decay > 0):
        raise OutsideRange(f"normal_load {load.max():.4g} N closes the gap completely: reduce it")
    return np.asarray(load / decay)


def persson_load(contact: PerssonContact, *, separation: ArrayLike) -> Floats:
    """Load at a mean gap by Persson's theory, the inverse of `persson_separation`. [N]

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
        If a gap is so wide that its load underflows, or so narrow that contact is complete.
    """
    gaps = require_positive(separation=separation)
    unit = contact.nominal_area * contact.effective_modulus * contact.rms_gradient
    low, high = math.log(unit) - 300.0, math.log(4 * unit)

    def excess_gap(log_load: float, gap: float) -> float:
        return float(persson_separation(contact, normal_load=math.exp(log_load))) - gap

    widest, narrowest = excess_gap(low, 0.0), excess_gap(high, 0.0)
    if not np.all((gaps <= widest) & (gaps >= narrowest)):
        raise OutsideRange(f"separation must lie between {narrowest:.4g} and {widest:.4g} m for this spectrum")
    loads = [math.exp(brentq(excess_gap, low, high, args=(gap,), xtol=1e-13)) for gap in gaps.ravel()]
    return np.reshape(loads, gaps.shape)


def _bands(spectrum: RadialSpectrum) -> tuple[Floats, Floats]:
    """sqrt(pi) q^2 C w dq, a length, and w, for bands of the spectrum between neighbouring wavenumbers.

    w is E* over the width of the pressure distribution. The last band has zero length, and the w of the whole surface.
    """
    k = spectrum.wavenumber
    edges = np.unique(np.concatenate([k, np.geomspace(k[0], k[-1], _CELLS)]))
    middle, width = (edges[1:] + edges[:-1]) / 2, np.diff(edges)
    q, dq = 2 * math.pi * middle, 2 * math.pi * width
    C = np.interp(middle, k, spectrum.areal_spectral_density) / (2 * math.pi) ** 2  # over angular wavenumbers
    slopes = q**3 * C * dq
    before = np.concatenate([[0.0], np.cumsum(slopes)])
    nonzero = C > 0
    w = 1 / np.sqrt(math.pi * (before[:-1] + slopes / 2)[nonzero])
    lengths = math.sqrt(math.pi) * (q**2 * C * dq)[nonzero] * w
    return np.append(lengths, 0.0), np.append(w, 1 / math.sqrt(math.pi * before[-1]))


@lru_cache(maxsize=1)
def _tail_integral() -> CubicSpline:
    """Integral from s to infinity of erf^2(s) exp(-s^2)/s as a function of s up to 6."""
    node, weight = np.polynomial.legendre.leggauss(8)
    half = np.diff(_ABSCISSAE)[:, None] / 2
    s = _ABSCISSAE[:-1, None] + half * (1 + node)
    pieces = (half * weight * erf(s) ** 2 * np.exp(-(s**2)) / s).sum(axis=1)
    return CubicSpline(_ABSCISSAE, np.append(np.cumsum(pieces[::-1])[::-1], 0.0))
