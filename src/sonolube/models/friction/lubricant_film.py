"""Film of a lubricant from viscosity, speed, load and roughness: thickness, its share of the load, and its friction.

The film and the asperities carry the load together at one gap (Johnson, Greenwood and Poon), which goes from boundary
lubrication at rest to a full film at speed. A ball has the films of Hamrock and Dowson, a flat pad that of an inclined
one.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.contact.hertz import SphereOnFlat, hertz_mean_pressure
from sonolube.models.contact.rough import RoughContact, normal_force, separation_range

_ELLIPTICITY = 1.03  # of a circular contact, by k = 1.03 (Ry/Rx)^0.64
_RIGID_POINT = 128 * 0.6**2 * (0.131 * math.atan(0.5) + 1.683) ** 2
_HALVINGS = 80
_THINNEST, _THICKEST = 1e-12, 1e-2  # m
_LARGEST_LOG = 600.0


@dataclass(frozen=True, kw_only=True, slots=True)
class FilmLubricant:
    r"""Lubricant with the geometry of the contact that it enters.

    Parameters
    ----------
    dynamic_viscosity : float
        Viscosity at the temperature and pressure of the inlet. [Pa s]
    tip_radius : float or None
        Radius of a ball on a flat; None for a flat pad. [m]
    pressure_viscosity : float
        Coefficient of the viscosity's growth with pressure, after Barus; enters for balls only. [1/Pa]
    inlet_ratio : float
        Gap at the inlet over that at the outlet of a flat pad. []
    limiting_shear_ratio : float
        Largest shear stress of the film over the pressure; enters for balls only. []

    Raises
    ------
    InvalidInput
        If a value is not positive and finite, or the inlet ratio not above 1.

    Notes
    -----
    The defaults of the last three are orders of magnitude of mineral oils and the best inclination of a pad, 2.2, which
    makes its film an upper bound.
    """

    dynamic_viscosity: float
    tip_radius: float | None = None
    pressure_viscosity: float = 2e-8
    inlet_ratio: float = 2.2
    limiting_shear_ratio: float = 0.05

    def __post_init__(self) -> None:
        require_positive(
            dynamic_viscosity=self.dynamic_viscosity,
            pressure_viscosity=self.pressure_viscosity,
            inlet_ratio=self.inlet_ratio,
            limiting_shear_ratio=self.limiting_shear_ratio,
        )
        if self.tip_radius is not None:
            require_positive(tip_radius=self.tip_radius)
        if self.inlet_ratio <= 1:
            raise InvalidInput(f"inlet_ratio must exceed 1, got {self.inlet_ratio!r}: a parallel pad has no film")


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class MixedLubrication:
    """Share of the load on asperities and friction of the film, at one speed and load or many.

    Parameters
    ----------
    asperity_load_fraction : ndarray
        Share of the load that asperities carry. []
    film_coefficient : ndarray
        Coefficient of friction of the film: its shear force over the load that it carries. []
    film_thickness : ndarray
        Gap between the mean planes. [m]
    film_ratio : ndarray
        That gap over the combined rms height, lambda: below 1 mostly boundary, above 3 a full film. []
    """

    asperity_load_fraction: Floats
    film_coefficient: Floats
    film_thickness: Floats
    film_ratio: Floats


def elastohydrodynamic_thickness(
    *,
    dynamic_viscosity: ArrayLike,
    sliding_speed: ArrayLike,
    normal_load: ArrayLike,
    tip_radius: ArrayLike,
    effective_modulus: ArrayLike,
    pressure_viscosity: ArrayLike,
) -> tuple[Floats, Floats]:
    r"""Minimum and central film thickness of a ball that slides on a flat, piezoviscous and elastic. [m]

    Parameters
    ----------
    dynamic_viscosity : array_like
        Viscosity of the inlet. [Pa s]
    sliding_speed : array_like
        Speed of the flat past the ball; the film is entrained at its half. [m/s]
    normal_load : array_like
        Force pressing the bodies together. [N]
    tip_radius : array_like
        Radius of the ball. [m]
    effective_modulus : array_like
        Effective contact modulus E*. [Pa]
    pressure_viscosity : array_like
        Coefficient of Barus. [1/Pa]

    Returns
    -------
    minimum, central : ndarray, the broadcast shape

    Raises
    ------
    InvalidInput
        If an argument is not positive.

    Notes
    -----
    .. math::

        \frac{h_\text{min}}{R} = 3.63\, U^{0.68} G^{0.49} W^{-0.073} (1 - e^{-0.68 k}), \qquad
        \frac{h_c}{R} = 2.69\, U^{0.67} G^{0.53} W^{-0.067} (1 - 0.61\, e^{-0.73 k})

    with :math:`U = \eta u/(E' R)`, :math:`G = \alpha E'`, :math:`W = F_N/(E' R^2)`, E' = 2 E*, the mean speed u of both
    surfaces and k = 1.03.

    References
    ----------
    .. [1] B. J. Hamrock and D. Dowson, J. Lubr. Technol. 99, 264 (1977). doi:10.1115/1.3453074
    """
    U, G, W, R = _groups(
        require_positive(dynamic_viscosity=dynamic_viscosity) * require_positive(sliding_speed=sliding_speed) / 2,
        require_positive(normal_load=normal_load),
        require_positive(tip_radius=tip_radius),
        require_positive(effective_modulus=effective_modulus),
        require_positive(pressure_viscosity=pressure_viscosity),
    )
    least = 3.63 * U**0.68 * G**0.49 * W**-0.073 * (1 - math.exp(-0.68 * _ELLIPTICITY))
    central = 2.69 * U**0.67 * G**0.53 * W**-0.067 * (1 - 0.61 * math.exp(-0.73 * _ELLIPTICITY))
    return R * least, R * central


def _groups(
    dragged: Floats, load: Floats, R: Floats, effective_modulus: Floats, alpha: Floats
) -> tuple[Floats, Floats, Floats, Floats]:
    """Groups of speed, material and load, and the radius."""
    E = 2 * effective_modulus
    return dragged / (E * R), alpha * E, load / (E * R**2), R


def inclined_pad(*, inlet_ratio: float) -> tuple[float, float]:
    r"""Load and friction of an endlessly wide inclined pad, without units. []

    Parameters
    ----------
    inlet_ratio : float
        Gap at the inlet over that at the outlet, n. []

    Returns
    -------
    load, friction : float
        :math:`F_N h^2/(\eta v A L)` and :math:`F_t h/(\eta v A)` with the gap h at the outlet, length L and area A.

    Raises
    ------
    InvalidInput
        If the ratio is not above 1.

    Notes
    -----
    .. math:: 6 \left[ \frac{\ln n}{(n-1)^2} - \frac{2}{n^2 - 1} \right], \qquad \frac{4 \ln n}{n - 1} - \frac{6}{n + 1}

    The load is largest, 0.160, at n = 2.2.

    References
    ----------
    .. [1] O. Reynolds, Phil. Trans. R. Soc. 177, 157 (1886).
    """
    n = float(require_positive(inlet_ratio=inlet_ratio))
    if n <= 1:
        raise InvalidInput(f"inlet_ratio must exceed 1, got {n!r}")
    load = 6 * (math.log(n) / (n - 1) ** 2 - 2 / (n**2 - 1))
    return load, 4 * math.log(n) / (n - 1) - 6 / (n + 1)


def mixed_lubrication(
    lubricant: FilmLubricant, contact: RoughContact, *, sliding_speed: ArrayLike, normal_load: ArrayLike
) -> MixedLubrication:
    r"""Share of the load on asperities, and friction of the film, of a lubricated rough contact.

    Parameters
    ----------
    lubricant : FilmLubricant
    contact : RoughContact
    sliding_speed : array_like
        Mean sliding speed; 0 for a contact at rest, which has no film. [m/s]
    normal_load : array_like, broadcast against `sliding_speed`
        Force pressing the bodies together. [N]

    Returns
    -------
    MixedLubrication

    Raises
    ------
    InvalidInput
        If a speed is negative or a load not positive.

    Notes
    -----
    The gap h is that at which film and asperities carry the load together, :math:`F_f(h) + F_a(h) = F_N`, with the
    force of the rough contact at the separation h and the load of the film whose thickness is h. A ball has the
    thickest of three films: piezoviscous and elastic (central thickness), isoviscous and elastic,
    :math:`7.32 (1 - 0.72 e^{-0.28 k}) U^{0.64} W^{-0.22}`, and isoviscous and rigid,
    :math:`128 \lambda_b^2 [0.131 \arctan\frac12 + 1.683]^2 (U/W)^2` with :math:`\lambda_b = 0.6`. Its shear stress is
    that of the viscosity at its share of the mean Hertzian pressure, limited to a part of that pressure,
    :math:`\tau_L (1 - e^{-\eta v/(h \tau_L)})`. A flat pad has the film of `inclined_pad` of the length of its nominal
    area's square root, endlessly wide: side leakage makes it thinner.

    References
    ----------
    .. [1] K. L. Johnson, J. A. Greenwood and S. Y. Poon, Wear 19, 91 (1972). doi:10.1016/0043-1648(72)90445-0
    .. [2] B. J. Hamrock and D. Dowson, Ball Bearing Lubrication (1981), for the four regimes.
    .. [3] S. Bair and W. O. Winer, J. Lubr. Technol. 101, 258 (1979), for the limiting shear stress.
    """
    v, load = np.broadcast_arrays(
        require_non_negative(sliding_speed=sliding_speed), require_positive(normal_load=normal_load)
    )
    low, high = np.full(v.shape, math.log(_THINNEST)), np.full(v.shape, math.log(_THICKEST))
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        h = np.exp(middle)
        above = _film_load(lubricant, contact, v, h) + _asperity_load(contact, h) > load
        low, high = np.where(above, middle, low), np.where(above, high, middle)
    h = np.exp(low)
    film = np.minimum(_film_load(lubricant, contact, v, h), load)
    share = np.asarray(film / load)
    return MixedLubrication(
        asperity_load_fraction=1 - share,
        film_coefficient=_film_coefficient(lubricant, contact, v, load, share, h),
        film_thickness=h,
        film_ratio=h / contact.roughness.rms_height,
    )


def _asperity_load(contact: RoughContact, gap: Floats) -> Floats:
    """Force of the asperities at a gap; none beyond the range of their heights. [N]"""
    _, highest = separation_range(contact)
    near = gap < highest
    return np.where(near, normal_force(contact, separation=np.where(near, gap, 0.0)), 0.0)


def _film_load(lubricant: FilmLubricant, contact: RoughContact, v: Floats, h: Floats) -> Floats:
    """Load that a film of a thickness carries. [N]"""
    if lubricant.tip_radius is None:
        load, _ = inclined_pad(inlet_ratio=lubricant.inlet_ratio)
        return np.asarray(load * lubricant.dynamic_viscosity * v * contact.nominal_area**1.5 / h**2)
    R, E = lubricant.tip_radius, 2 * contact.pair.effective_modulus
    with np.errstate(divide="ignore"):
        log_u = np.log(lubricant.dynamic_viscosity * v / 2 / (E * R))
    log_g, log_h = math.log(lubricant.pressure_viscosity * E), np.log(h / R)
    hard = math.log(2.69 * (1 - 0.61 * math.exp(-0.73 * _ELLIPTICITY)))
    soft = math.log(7.32 * (1 - 0.72 * math.exp(-0.28 * _ELLIPTICITY)))
    logs = (
        (hard + 0.67 * log_u + 0.53 * log_g - log_h) / 0.067,
        (soft + 0.64 * log_u - log_h) / 0.22,
        log_u + (math.log(_RIGID_POINT) - log_h) / 2,
    )
    return np.asarray(E * R**2 * np.exp(np.minimum(np.maximum.reduce(logs), _LARGEST_LOG)))


def _film_coefficient(
    lubricant: FilmLubricant, contact: RoughContact, v: Floats, load: Floats, share: Floats, h: Floats
) -> Floats:
    """Shear stress of the film over its pressure; 0 without a film. []"""
    rate = v / h
    if lubricant.tip_radius is None:
        bearing, friction = inclined_pad(inlet_ratio=lubricant.inlet_ratio)
        return np.asarray(np.where(v > 0, friction / bearing * h / np.sqrt(contact.nominal_area), 0.0))
    ball = SphereOnFlat(tip_radius=lubricant.tip_radius, effective_modulus=contact.pair.effective_modulus)
    pressure = np.where(share > 0, share, 1.0) * hertz_mean_pressure(ball, normal_load=load)
    limit = lubricant.limiting_shear_ratio * pressure
    viscosity = lubricant.dynamic_viscosity * np.exp(np.minimum(lubricant.pressure_viscosity * pressure, _LARGEST_LOG))
    stress = limit * -np.expm1(-viscosity * rate / limit)
    return np.asarray(np.where(share > 0, stress / pressure, 0.0))
