"""Flash temperature of a sliding contact at any Peclet number, and the partition of its heat between two bodies."""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.thermal.moving_ellipse import mean_rise, peak_rise
from sonolube.models.thermal.source import EllipticSource, HeatSource, ThermalSolid
from sonolube.variants import VariantTable


class FlashRise(NamedTuple):
    """Peak and mean surface temperature rise under a heat source, over the bulk temperature.

    Parameters
    ----------
    peak_temperature_rise : ndarray
        Maximum under the source. [K]
    mean_temperature_rise : ndarray
        Mean over the area of the source. [K]
    """

    peak_temperature_rise: Floats
    mean_temperature_rise: Floats


class MovingRise(Protocol):
    """Model of the flash temperature rise under a sliding source: `flash_rise`, `moving_ellipse_rise`."""

    def __call__(
        self, solid: ThermalSolid, source: HeatSource, /, *, heat_flux: ArrayLike, sliding_speed: ArrayLike
    ) -> FlashRise:
        """Steady rise under the source, for a mean flux in W/m2 and a speed in m/s."""


class ContactRise(NamedTuple):
    """Flash temperature of a contact and the partition of its heat between both bodies.

    Parameters
    ----------
    heat_partition : ndarray
        Fraction of the heat that flows into the body at which the source is stationary. []
    peak_temperature_rise : ndarray
        Peak rise of the contact over the bulk temperature of both bodies. [K]
    mean_temperature_rise : ndarray
        Mean rise of the contact. [K]
    """

    heat_partition: Floats
    peak_temperature_rise: Floats
    mean_temperature_rise: Floats


def peclet_number(solid: ThermalSolid, source: HeatSource, *, sliding_speed: ArrayLike) -> Floats:
    r"""Peclet number of a heat source that moves over a solid. []

    Parameters
    ----------
    solid : ThermalSolid
    source : HeatSource
    sliding_speed : array_like, any shape
        Speed of the source over the solid, zero for a stationary source. [m/s]

    Returns
    -------
    ndarray, shape of `sliding_speed`

    Raises
    ------
    InvalidInput
        If a speed is negative or not finite.

    Notes
    -----
    With the speed V, the half length b of the source along the sliding and the diffusivity kappa,

    .. math:: \mathrm{Pe} = \frac{V b}{2\kappa} ,

    the definition of Jaeger and of Tian and Kennedy; other authors leave out the factor 2.
    """
    v = require_non_negative(sliding_speed=sliding_speed)
    return v * source.half_length / (2 * solid.thermal_diffusivity)


def low_peclet_rise(solid: ThermalSolid, source: HeatSource, *, heat_flux: ArrayLike) -> FlashRise:
    r"""Steady rise under a stationary source, the limit of zero Peclet number.

    Parameters
    ----------
    solid : ThermalSolid
    source : HeatSource
    heat_flux : array_like, any shape
        Heat flux into the solid, mean over the source. [W/m2]

    Returns
    -------
    FlashRise

    Raises
    ------
    InvalidInput
        If a flux is negative or not finite.

    See Also
    --------
    high_peclet_rise : the limit of a fast source.
    flash_rise : any Peclet number.

    Notes
    -----
    .. math:: \Delta T_0 = c_0 \frac{\bar q b}{k}

    with :math:`c_0` the source's `peak_low_peclet` or `mean_low_peclet` (Jaeger, as in `high_peclet_rise`).
    """
    scale = _rise_scale(solid, source, heat_flux)
    return FlashRise(scale * source.peak_low_peclet, scale * source.mean_low_peclet)


def high_peclet_rise(
    solid: ThermalSolid, source: HeatSource, *, heat_flux: ArrayLike, sliding_speed: ArrayLike
) -> FlashRise:
    r"""Steady rise under a fast source, the limit of high Peclet number.

    Parameters
    ----------
    solid : ThermalSolid
    source : HeatSource
    heat_flux : array_like
        Heat flux into the solid, mean over the source. [W/m2]
    sliding_speed : array_like, broadcast against `heat_flux`
        Speed of the source over the solid. [m/s]

    Returns
    -------
    FlashRise

    Raises
    ------
    InvalidInput
        If a flux is negative, a speed not positive, or a value not finite.

    See Also
    --------
    low_peclet_rise : the limit of a stationary source.
    flash_rise : any Peclet number.

    Notes
    -----
    For Peclet numbers above about ten. Heat flows only normal to the surface: each point is heated like a half-space
    for as long as the source takes to pass it, so that

    .. math:: \Delta T_\infty = c_\infty \frac{\bar q b}{k} \frac{1}{\sqrt{\mathrm{Pe}}}

    with :math:`c_\infty` the source's `peak_high_peclet`, for the mean times `mean_to_peak_high_peclet`.

    References
    ----------
    .. [1] J. C. Jaeger, J. Proc. R. Soc. N.S.W. 76, 203 (1942).
    """
    require_positive(sliding_speed=sliding_speed)
    pe = peclet_number(solid, source, sliding_speed=sliding_speed)
    peak = _rise_scale(solid, source, heat_flux) * source.peak_high_peclet / np.sqrt(pe)
    return FlashRise(peak, source.mean_to_peak_high_peclet * peak)


def flash_rise(solid: ThermalSolid, source: HeatSource, *, heat_flux: ArrayLike, sliding_speed: ArrayLike) -> FlashRise:
    r"""Steady flash temperature rise under a sliding source by Tian and Kennedy's interpolation.

    Parameters
    ----------
    solid : ThermalSolid
    source : HeatSource
    heat_flux : array_like
        Heat flux into the solid, mean over the source. [W/m2]
    sliding_speed : array_like, broadcast against `heat_flux`
        Speed of the source over the solid, zero for a stationary source. [m/s]

    Returns
    -------
    FlashRise

    Raises
    ------
    InvalidInput
        If a flux or speed is negative or not finite.

    See Also
    --------
    low_peclet_rise, high_peclet_rise : the limits between which this interpolates.
    moving_ellipse_rise : without the error of the interpolation, for a uniform elliptic source.
    moving_rectangle_rise : the integral that this approximates.

    Notes
    -----
    .. math:: \Delta T = \left( \Delta T_0^{-2} + \Delta T_\infty^{-2} \right)^{-1/2} ,

    which has the form :math:`c/\sqrt{\mathrm{Pe}_0 + \mathrm{Pe}}` and leaves no constant to fit. It reproduces the
    published constants of Tian and Kennedy, whose paper was not available in full: 2 and 1.273 for the peak and 1.22
    and 0.6575 for the mean of the circle, 2 and 1.011 for the peak of the square, 2.32 and 1.234 for the peak of a
    round `HertzianSource`, which is 18 % above that of a uniform flux. Against numerical integrals over circle and
    square the peak is within 2.5 % and the mean within 4 %; for the Hertzian source within 1.5 % and 5 %. Of a uniform
    circle the peak is at most 2.3 % too high (Pe = 0.6) and 0.7 % too low (Pe = 9), and the mean at most 3.8 % too low
    (Pe = 0.8); of an ellipse 0.3 as wide as long both are up to 16 % too high, of one 4 times as wide the mean is up to
    12 % too low.

    References
    ----------
    .. [1] X. Tian, F. E. Kennedy, J. Tribol. 116, 167 (1994). doi:10.1115/1.2927035
    .. [2] Y. S. Muzychka, M. M. Yovanovich, J. Tribol. 123, 624 (2001). doi:10.1115/1.1370516
    """
    scale = _rise_scale(solid, source, heat_flux)
    pe = peclet_number(solid, source, sliding_speed=sliding_speed)
    peak = scale / np.sqrt(source.peak_low_peclet**-2 + pe / source.peak_high_peclet**2)
    mean = scale / np.sqrt(
        source.mean_low_peclet**-2 + pe / (source.mean_to_peak_high_peclet * source.peak_high_peclet) ** 2
    )
    return FlashRise(peak, mean)


def moving_ellipse_rise(
    solid: ThermalSolid, source: HeatSource, *, heat_flux: ArrayLike, sliding_speed: ArrayLike
) -> FlashRise:
    r"""Steady flash temperature rise under a uniform elliptic source at any speed, by quadrature.

    Parameters
    ----------
    solid : ThermalSolid
    source : EllipticSource
        A circle or an ellipse of uniform flux.
    heat_flux : array_like
        Heat flux into the solid, mean over the source. [W/m2]
    sliding_speed : array_like, broadcast against `heat_flux`
        Speed of the source over the solid, zero for a stationary source. [m/s]

    Returns
    -------
    FlashRise

    Raises
    ------
    InvalidInput
        If the source is no `EllipticSource`, a flux or speed is negative or not finite.

    See Also
    --------
    flash_rise : an interpolation, a thousand times as fast, for any source.

    Notes
    -----
    Superposition of moving point sources,

    .. math:: \Delta T(\mathbf r) = \frac{q}{2\pi k} \int
        \frac{1}{R} \exp\left[-\frac{V}{2\kappa}(R + x - x')\right] dA' , \qquad R = |\mathbf r - \mathbf r'| ,

    whose peak on the middle chord and mean over the source reduce to one and two integrals. Accurate to 1e-9 of the
    rise for Peclet numbers to 1e8 and widths of 0.1 to 10 times the length; 20 ms for each distinct speed.

    References
    ----------
    .. [1] J. C. Jaeger, J. Proc. R. Soc. N.S.W. 76, 203 (1942).
    .. [2] H. S. Carslaw, J. C. Jaeger, Conduction of Heat in Solids, 2nd ed., Oxford (1959), section 10.7.
    """
    if not isinstance(source, EllipticSource):
        raise InvalidInput(f"source must be an EllipticSource, got a {type(source).__name__}; use flash_rise")
    scale = _rise_scale(solid, source, heat_flux)
    aspect = source.half_width / source.half_length
    distinct, places = np.unique(peclet_number(solid, source, sliding_speed=sliding_speed), return_inverse=True)
    peak, mean = (
        np.array([rise(peclet=float(pe), aspect=aspect) for pe in distinct])[places].reshape(np.shape(sliding_speed))
        for rise in (peak_rise, mean_rise)
    )
    return FlashRise(scale * peak, scale * mean)


def contact_rise(
    stationary: ThermalSolid,
    moving: ThermalSolid,
    source: HeatSource,
    *,
    heat_rate: ArrayLike,
    sliding_speed: ArrayLike,
    moving_rise: MovingRise = flash_rise,
) -> ContactRise:
    r"""Flash temperature of a contact and its heat partition by equal mean temperatures, after Jaeger.

    Parameters
    ----------
    stationary : ThermalSolid
        The body to which the contact is fixed, such as a pin.
    moving : ThermalSolid
        The body over which the contact moves, such as a disc.
    source : HeatSource
        The contact.
    heat_rate : array_like
        Heat generated in the contact. [W]
    sliding_speed : array_like, broadcast against `heat_rate`
        Speed of the sliding, zero at rest. [m/s]
    moving_rise : MovingRise
        Model of the rise of the moving body.

    Returns
    -------
    ContactRise

    Raises
    ------
    InvalidInput
        If a heat or speed is negative or not finite.

    See Also
    --------
    blok_partition : the partition by equal peak temperatures.

    Notes
    -----
    Both bodies are half-spaces of the same bulk temperature. With the mean rises per unit flux :math:`\theta_1` of the
    stationary and :math:`\theta_2` of the moving body, the fraction of the heat into the stationary body is

    .. math:: \alpha = \frac{\theta_2}{\theta_1 + \theta_2} .

    The peak rise returned is the higher of both bodies', whose surface temperatures agree in the mean only.

    References
    ----------
    .. [1] H. Blok, Proc. Gen. Disc. Lubrication, Inst. Mech. Eng. 2, 222 (1937).
    .. [2] J. C. Jaeger, J. Proc. R. Soc. N.S.W. 76, 203 (1942).
    """
    q = require_non_negative(heat_rate=heat_rate) / source.area
    first = low_peclet_rise(stationary, source, heat_flux=1.0)
    second = moving_rise(moving, source, heat_flux=1.0, sliding_speed=sliding_speed)
    partition = _partition(first.mean_temperature_rise, second.mean_temperature_rise)
    peak = np.maximum(partition * first.peak_temperature_rise, (1 - partition) * second.peak_temperature_rise)
    return ContactRise(partition + 0 * q, q * peak, q * partition * first.mean_temperature_rise)


def real_contact_spot(*, normal_load: float, hardness: float) -> EllipticSource:
    r"""Circular spot on which the softer body carries a load by plastic flow alone, as one heat source.

    Parameters
    ----------
    normal_load : float
        Force pressing the bodies together. [N]
    hardness : float
        Indentation hardness of the softer body. [Pa]

    Returns
    -------
    EllipticSource

    Raises
    ------
    InvalidInput
        If a value is not positive and finite.

    See Also
    --------
    contact_rise : the flash temperature of it.

    Notes
    -----
    .. math:: \pi a^2 = \frac{F_N}{H} .

    One spot is the hottest case: the same area in n equal spots apart from each other is hotter by
    :math:`1/\sqrt{n}` of its rise at low Peclet number.

    References
    ----------
    .. [1] F. P. Bowden, D. Tabor, The Friction and Lubrication of Solids, Oxford (1950), chapters 1 and 2.

    Examples
    --------
    >>> from sonolube.models.thermal import real_contact_spot
    >>> round(1e6 * real_contact_spot(normal_load=5.0, hardness=3.3e9).half_length)  # um
    22
    """
    require_positive(normal_load=normal_load, hardness=hardness)
    radius = float(np.sqrt(normal_load / (np.pi * hardness)))
    return EllipticSource(half_length=radius, half_width=radius)


def blok_partition(
    stationary: ThermalSolid, moving: ThermalSolid, source: HeatSource, *, sliding_speed: ArrayLike
) -> Floats:
    r"""Fraction of the heat into the stationary body by equal peak temperatures, after Blok. []

    Parameters
    ----------
    stationary : ThermalSolid
        The body to which the contact is fixed, such as a pin.
    moving : ThermalSolid
        The body over which the contact moves, such as a disc.
    source : HeatSource
        The contact.
    sliding_speed : array_like, any shape
        Speed of the sliding, zero at rest. [m/s]

    Returns
    -------
    ndarray, shape of `sliding_speed`

    Raises
    ------
    InvalidInput
        If a speed is negative or not finite.

    See Also
    --------
    contact_rise : the partition by equal mean temperatures.

    Notes
    -----
    As in `contact_rise`, :math:`\alpha = \theta_2/(\theta_1 + \theta_2)`, here with the peak rises per unit flux.

    References
    ----------
    .. [1] H. Blok, Proc. Gen. Disc. Lubrication, Inst. Mech. Eng. 2, 222 (1937).
    """
    first = low_peclet_rise(stationary, source, heat_flux=1.0).peak_temperature_rise
    second = flash_rise(moving, source, heat_flux=1.0, sliding_speed=sliding_speed).peak_temperature_rise
    return _partition(first, second)


def _partition(first: Floats, second: Floats) -> Floats:
    """Fraction of the heat into the first of two bodies, from their rises under equal flux."""
    return second / (first + second)


def _rise_scale(solid: ThermalSolid, source: HeatSource, heat_flux: ArrayLike) -> Floats:
    """Unit of dimensionless rises, mean flux times half length over conductivity, in K."""
    return require_non_negative(heat_flux=heat_flux) * source.half_length / solid.thermal_conductivity


FLASH_MODELS: VariantTable[MovingRise] = VariantTable(
    "flash temperature model",
    {
        "quadrature": "sonolube.models.thermal.flash:moving_ellipse_rise",
        "tian_kennedy_1994": "sonolube.models.thermal.flash:flash_rise",
    },
)
"""Models of the flash temperature by name: the integral over a uniform ellipse, and the published interpolation."""
