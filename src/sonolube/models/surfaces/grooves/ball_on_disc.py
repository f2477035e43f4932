"""Volume losses of a ball-on-disc test: disc and pin by the geometry of ASTM G99, and the pin from its height map."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.ndimage import binary_dilation, label, median_filter, uniform_filter
from scipy.optimize import least_squares

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput, NoGroove
from sonolube.models.surfaces.form_removal import fit_form, robust_deviation
from sonolube.models.surfaces.grooves.track import centred_coordinates
from sonolube.models.surfaces.height_map import HeightMap, Mask

_POINTS = 4000  # of a map, to which a sphere is fitted
_MAX_ITERATIONS = 20
_WINDOW = 5  # pixels, of the smoothing and the median filter
_WORN = 6.0  # depth over the noise of the smoothed map
_MIN_SCAR = 50  # pixels
_LEVELS = 16  # of depth, at which the scar's area is counted
_LEVELS_REACH = 3.0  # deepest level over the detection limit
_LEVELS_FRACTION = 0.2  # deepest level over the depth of the scar, where that is deeper
_HEIGHT_RESOLUTION = 1e-12  # m, below that of any instrument


def disc_volume_loss(*, groove_diameter: ArrayLike, groove_width: ArrayLike, tip_radius: ArrayLike) -> Floats:
    r"""Disc volume loss of ASTM G99: volume of a wear track whose section is that of the unworn ball. [m3]

    Parameters
    ----------
    groove_diameter : array_like
        Diameter of the wear track. [m]
    groove_width : array_like
        Width of the wear track, at most the diameter of the ball. [m]
    tip_radius : array_like
        Radius of the ball (pin end radius). [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a length is not positive, or the track wider than the ball.

    See Also
    --------
    sonolube.models.surfaces.grooves.groove.measure_groove : Volume from a scan.

    Notes
    -----
    With the track radius :math:`R`, the track width :math:`d` and the ball radius :math:`r`

    .. math:: V = 2\pi R \left[ r^2 \arcsin\frac{d}{2r} - \frac d4 \sqrt{4 r^2 - d^2} \right] .

    Where the ball wears as well, the groove is shallower than its sphere, and this overestimates the volume.

    References
    ----------
    .. [1] ASTM G99-17, 9.1.2.1.

    Examples
    --------
    >>> from sonolube.models.surfaces import disc_volume_loss
    >>> from sonolube.text.units import format_si
    >>> volume = disc_volume_loss(groove_diameter=50e-3, groove_width=0.5e-3, tip_radius=5e-3)
    >>> format_si(float(volume), "m3")  # about pi D d^3/(12 r)
    '0.327 mm3'
    """
    d, r = _within_ball(tip_radius, groove_width=groove_width)
    ring = np.pi * require_positive(groove_diameter=groove_diameter)
    return np.asarray(ring * (r**2 * np.arcsin(d / (2 * r)) - d / 4 * np.sqrt(4 * r**2 - d**2)))


def pin_volume_loss(*, scar_diameter: ArrayLike, tip_radius: ArrayLike) -> Floats:
    r"""Pin volume loss of ASTM G99: volume of the spherical cap cut off by a flat wear scar. [m3]

    Parameters
    ----------
    scar_diameter : array_like
        Diameter of the wear scar, at most the diameter of the ball. [m]
    tip_radius : array_like
        Radius of the ball (pin end radius). [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a length is not positive, or the scar wider than the ball.

    See Also
    --------
    wear_scar : Volume from a height map of the tip.

    Notes
    -----
    With the scar diameter :math:`d` and the ball radius :math:`r`

    .. math:: V = \frac{\pi h}{6} \left( \frac{3 d^2}{4} + h^2 \right), \qquad h = r - \sqrt{r^2 - d^2/4} .

    References
    ----------
    .. [1] ASTM G99-17, 9.1.1.1.
    """
    d, r = _within_ball(tip_radius, scar_diameter=scar_diameter)
    h = (d**2 / 4) / (r + np.sqrt(r**2 - d**2 / 4))  # r - sqrt(...) without cancellation
    return np.asarray(np.pi * h / 6 * (3 * d**2 / 4 + h**2))


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class WearScar:
    """Wear scar of a ball, measured in a height map of its tip.

    Parameters
    ----------
    tip_radius : float
        Radius of the ball, as given or fitted to its unworn surface. [m]
    scar_diameter : float
        Diameter of a circle of the scar's area, extrapolated to zero depth. [m]
    wear_volume : float
        Volume between the scar and the sphere. [m3]
    wear_volume_uncertainty : float
        Standard uncertainty of the volume, from the fit of the sphere. [m3]
    levelled : HeightMap
        Heights above the sphere.
    worn : bool array, shape of the heights
        Pixels of the scar whose depth exceeds the noise.
    """

    tip_radius: float
    scar_diameter: float
    wear_volume: float
    wear_volume_uncertainty: float
    levelled: HeightMap
    worn: Mask


def wear_scar(surface: HeightMap, *, tip_radius: float | None = None) -> WearScar:
    r"""Wear scar of a ball from a height map of its tip, against a sphere fitted to the unworn surface.

    Parameters
    ----------
    surface : HeightMap
        The tip with unworn surface on all sides of the scar; more of it unworn than worn.
    tip_radius : float, optional
        Radius of the ball, if known; otherwise it is fitted. [m]

    Returns
    -------
    WearScar

    Raises
    ------
    NoGroove
        If nothing lies below the sphere by more than the noise.
    InvalidInput
        If the map is concave, or too little of it was measured.

    See Also
    --------
    pin_volume_loss : Volume from the diameter of a flat scar alone.

    Notes
    -----
    The area of a flat on a ball, and of any paraboloid, deeper than a level z decreases linearly with z,

    .. math:: A(z) = A(0)\,(1 - z/z_{\max}) .

    A straight line through the areas at several levels above the noise, counted after a median filter that preserves
    straight edges, gives A(0) and the diameter. The diameter is accurate to 1.5 pixels, of flats to 0.5; it is too
    small where the edge is so shallow that noise hides more than a fifth of the depth.
    """
    if tip_radius is not None:
        require_positive(tip_radius=tip_radius)
    start = fit_form(surface, degree=2, robust=True).height
    levelled = surface.with_height(surface.height - start)
    worn = np.zeros(surface.height.shape, dtype=np.bool_)
    sphere = _initial_sphere(surface, start, tip_radius)
    covariance = np.zeros((3, 3))
    for _ in range(_MAX_ITERATIONS):
        scar = _scar(levelled, worn)
        sphere, covariance = _fitted_sphere(surface, ~_with_rim(scar), sphere, tip_radius)
        levelled = surface.with_height(surface.height - _sphere_height(surface, sphere))
        if np.array_equal(scar, worn):
            break
        worn = scar
    if not worn.any():
        raise NoGroove("no scar found: nothing lies below the sphere by more than the noise")
    pixel = surface.spacing_x * surface.spacing_y
    rimmed = _with_rim(worn)
    depth = -np.where(levelled.measured, levelled.height, _smooth(levelled))
    derivatives = _sphere_derivatives(surface, sphere, len(covariance))
    gradient = np.array([derivative[rimmed].sum() for derivative in derivatives]) * pixel
    return WearScar(
        tip_radius=float(sphere[3]),
        scar_diameter=math.sqrt(4 / math.pi * pixel * _area_at_zero_depth(levelled, worn)),
        wear_volume=float(depth[rimmed].sum()) * pixel,
        wear_volume_uncertainty=math.sqrt(max(0.0, float(gradient @ covariance @ gradient))),
        levelled=levelled,
        worn=worn,
    )


def _within_ball(tip_radius: ArrayLike, **chord: ArrayLike) -> tuple[Floats, Floats]:
    """Checked chord and radius, the chord at most the diameter of the ball."""
    r, d = require_positive(tip_radius=tip_radius), require_positive(**chord)
    if np.any(d > 2 * r):
        raise InvalidInput(f"{next(iter(chord))} must not exceed the ball's diameter, got {float(np.max(d)):g} m")
    return d, r


def _initial_sphere(surface: HeightMap, paraboloid: Floats, tip_radius: float | None) -> Floats:
    """Centre, top and radius of the sphere that osculates a fitted paraboloid, in m."""
    x, y = centred_coordinates(surface)
    u, v = np.broadcast_to(x, paraboloid.shape).ravel(), np.broadcast_to(y, paraboloid.shape).ravel()
    scale = max(float(np.ptp(u)), float(np.ptp(v))) / 2
    design = np.stack([np.ones_like(u), u / scale, v / scale, (u**2 + v**2) / scale**2], axis=1)
    a, b, c, q = np.linalg.lstsq(design, paraboloid.ravel())[0]
    if q >= 0:
        raise InvalidInput("the map is concave: a worn ball with its tip up is expected; invert the heights")
    x0, y0 = -b * scale / (2 * q), -c * scale / (2 * q)
    top = a - (b**2 + c**2) / (4 * q)
    return np.array([x0, y0, top, tip_radius or scale**2 / (-2 * q)])


def _sphere_height(surface: HeightMap, sphere: Floats) -> Floats:
    """Height of a sphere at every pixel, in m."""
    x, y = centred_coordinates(surface)
    x0, y0, top, r = sphere
    square = (x - x0) ** 2 + (y - y0) ** 2
    if float(square.max()) > r**2:
        raise InvalidInput(f"the map extends beyond the ball's radius of {r:.3g} m; crop it to the tip")
    return np.asarray(top - square / (r + np.sqrt(r**2 - square)))


def _sphere_derivatives(surface: HeightMap, sphere: Floats, count: int) -> list[Floats]:
    """Derivatives of the sphere's height with respect to its centre, top and radius."""
    x, y = centred_coordinates(surface)
    x0, y0, _, r = sphere
    root = np.sqrt(r**2 - (x - x0) ** 2 - (y - y0) ** 2)
    return [(x - x0) / root, (y - y0) / root, np.ones_like(root), r / root - 1][:count]


def _fitted_sphere(surface: HeightMap, unworn: Mask, start: Floats, tip_radius: float | None) -> tuple[Floats, Floats]:
    """Least-squares sphere through a sample of the unworn pixels, and the covariance of its free parameters."""
    pixels = np.flatnonzero(unworn & surface.measured)
    if pixels.size < 20:
        raise InvalidInput(f"only {pixels.size} pixels of the ball are unworn; scan more of it")
    pixels = np.random.default_rng(0).choice(pixels, min(_POINTS, pixels.size), replace=False)
    x, y = (np.broadcast_to(part, surface.height.shape).flat[pixels] for part in centred_coordinates(surface))
    z = surface.height.flat[pixels]
    reach = max(float(np.ptp(x)), float(np.ptp(y)))
    size = np.array([reach, reach, max(float(np.ptp(z)), np.finfo(float).tiny), start[3]])
    free = 3 if tip_radius is not None else 4

    def residual(shift: Floats) -> Floats:
        x0, y0, top, r = start + size * np.concatenate([shift, np.zeros(4 - free)])
        square = (x - x0) ** 2 + (y - y0) ** 2
        return np.asarray((top - square / (r + np.sqrt(np.maximum(r**2 - square, 0.0))) - z) / size[2])

    found = least_squares(residual, np.zeros(free), xtol=1e-12, ftol=1e-14)
    sphere = start + size * np.concatenate([found.x, np.zeros(4 - free)])
    variance = 2 * found.cost / max(pixels.size - free, 1)
    covariance = np.linalg.pinv(found.jac.T @ found.jac) * variance * np.outer(size[:free], size[:free])
    return sphere, covariance


def _with_rim(scar: Mask) -> Mask:
    """Scar with the rim whose depth does not exceed the noise."""
    return np.asarray(binary_dilation(scar, iterations=2 * _WINDOW)) if scar.any() else scar


def _smooth(levelled: HeightMap) -> Floats:
    """Moving average of the measured heights."""
    fraction = uniform_filter(levelled.measured.astype(np.float64), _WINDOW)
    total = uniform_filter(np.where(levelled.measured, levelled.height, 0.0), _WINDOW)
    return np.asarray(total / np.maximum(fraction, 1 / _WINDOW**2))


def _scar(levelled: HeightMap, worn: Mask) -> Mask:
    """Largest connected patch below the sphere by more than the noise."""
    smooth = _smooth(levelled)
    unworn = ~worn if not worn.all() else worn
    patches, count = label(smooth < -max(_WORN * _scatter(smooth[unworn]), _HEIGHT_RESOLUTION))
    sizes = np.bincount(patches.ravel())[1:]
    if not count or sizes.max() < _MIN_SCAR:
        return np.zeros_like(worn)
    return np.asarray(patches == 1 + int(np.argmax(sizes)))


def _area_at_zero_depth(levelled: HeightMap, worn: Mask) -> float:
    """Area of a scar in pixels, extrapolated linearly to zero depth."""
    rimmed = _with_rim(worn)
    depth = median_filter(-np.where(levelled.measured, levelled.height, _smooth(levelled)), _WINDOW)
    deep = max(float(np.quantile(depth[worn], 0.9)), _HEIGHT_RESOLUTION)
    low = max(_WORN * _scatter(depth[~rimmed]), _HEIGHT_RESOLUTION)
    high = min(max(_LEVELS_REACH * low, _LEVELS_FRACTION * deep), 0.8 * deep)
    levels = np.linspace(min(low, high / 2), high, _LEVELS)
    areas = np.count_nonzero(depth[rimmed] > levels[:, np.newaxis], axis=1)
    return float(np.polyfit(levels / high, areas, 1)[1])


def _scatter(values: Floats) -> float:
    """Standard deviation of Gaussian values about their median."""
    return robust_deviation(values - np.median(values))
