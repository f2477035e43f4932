"""Worn volumes of a ball on a disc: from lengths as ASTM G99 takes them, and of the ball from its height map."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import binary_dilation, label, median_filter, uniform_filter
from scipy.optimize import least_squares

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput, NoGroove
from sonolube.surfaces.form_removal import fit_form
from sonolube.surfaces.grooves.plane_coordinates import centred_coordinates
from sonolube.surfaces.height_map import HeightMap

Mask = NDArray[np.bool_]

_POINTS = 4000  # of a map, to which a ball is fitted
_ROUNDS = 20
_SMOOTHED = 5  # pixels
_WORN = 6.0  # spreads of the smoothed map
_LEAST_SCAR = 50  # pixels
_LEVELS = 16  # at which the scar's area is counted
_LEVELS_REACH = 3.0  # times the least depth that can be told
_LEVELS_SHARE = 0.2  # of the depth of the scar, where that reaches further
_DEVIATION_OVER_MEDIAN = 1.4826  # of Gaussian heights
_LEAST_DEPTH = 1e-12  # m: no instrument shows less


def disc_volume_loss(*, groove_diameter: ArrayLike, groove_width: ArrayLike, tip_radius: ArrayLike) -> Floats:
    """Return the volume of a groove whose section is that of the unworn ball. [m3]

    Parameters
    ----------
    groove_diameter : array_like
        Diameter of the ring. [m]
    groove_width : array_like
        Width of the groove, at most twice the tip's radius. [m]
    tip_radius : array_like
        Radius of the ball. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a length is not positive, or the groove wider than the ball.

    Notes
    -----
    Where the ball wears too, the groove is shallower than its sphere, and this overestimates the volume: measure the
    section (`measure_groove`).

    References
    ----------
    .. [1] ASTM G99-17, 9.1.2.1: 2 pi R [r^2 asin(d/2r) - (d/4) sqrt(4 r^2 - d^2)].
    """
    d, r = _within_ball(tip_radius, groove_width=groove_width)
    ring = np.pi * require_positive(groove_diameter=groove_diameter)
    return np.asarray(ring * (r**2 * np.arcsin(d / (2 * r)) - d / 4 * np.sqrt(4 * r**2 - d**2)))


def pin_volume_loss(*, scar_diameter: ArrayLike, tip_radius: ArrayLike) -> Floats:
    """Return the volume of the cap that a flat scar cuts off a ball. [m3]

    Parameters
    ----------
    scar_diameter : array_like
        Diameter of the scar, at most twice the tip's radius. [m]
    tip_radius : array_like
        Radius of the ball. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a length is not positive, or the scar wider than the ball.

    References
    ----------
    .. [1] ASTM G99-17, 9.1.1.1: (pi h/6) (3 d^2/4 + h^2), h = r - sqrt(r^2 - d^2/4).
    """
    d, r = _within_ball(tip_radius, scar_diameter=scar_diameter)
    h = (d**2 / 4) / (r + np.sqrt(r**2 - d**2 / 4))  # r - sqrt(...) without cancellation
    return np.asarray(np.pi * h / 6 * (3 * d**2 / 4 + h**2))


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class WearScar:
    """What a ball has lost, from a map of its tip.

    Parameters
    ----------
    tip_radius : float
        Radius of the ball, as given or fitted to what is unworn. [m]
    scar_diameter : float
        Diameter of a circle of the scar's area, counted to where the depth ends. [m]
    wear_volume : float
        Volume between the scar and the ball. [m3]
    wear_volume_uncertainty : float
        Standard uncertainty, from the fit of the ball. [m3]
    levelled : HeightMap
        Heights above the ball.
    worn : bool array, shape of the heights
        Pixels that clearly belong to the scar.
    """

    tip_radius: float
    scar_diameter: float
    wear_volume: float
    wear_volume_uncertainty: float
    levelled: HeightMap
    worn: Mask


def wear_scar(surface: HeightMap, *, tip_radius: float | None = None) -> WearScar:
    """Measure the scar of a ball against the ball around it.

    Parameters
    ----------
    surface : HeightMap
        The tip, with unworn surface all around the scar; more of it unworn than worn.
    tip_radius : float, optional
        Radius of the ball, where it is known; otherwise it is fitted. [m]

    Returns
    -------
    WornCap

    Raises
    ------
    NoGroove
        If nothing lies clearly below the ball.
    InvalidInput
        If the map bends the other way, or too little of it was measured.

    Notes
    -----
    Of a flat on a ball, and of any paraboloid, the area deeper than a level falls in proportion to the level: a line
    through several levels that can be told from noise gives the area at none. Heights pass a median filter before,
    which leaves straight edges where they are. The diameter is good to 1.5 pixels, of flats to 0.5, but lies inside
    an edge so flat that noise hides more than a fifth of the depth.
    """
    if tip_radius is not None:
        require_positive(tip_radius=tip_radius)
    start = fit_form(surface, degree=2, robust=True).height
    levelled = surface.with_height(surface.height - start)
    worn = np.zeros(surface.height.shape, dtype=np.bool_)
    ball = _starting_ball(surface, start, tip_radius)
    covariance = np.zeros((3, 3))
    for _ in range(_ROUNDS):
        scar = _scar(levelled, worn)
        ball, covariance = _fitted_ball(surface, ~_with_rim(scar), ball, tip_radius)
        levelled = surface.with_height(surface.height - _ball_height(surface, ball))
        if np.array_equal(scar, worn):
            break
        worn = scar
    if not worn.any():
        raise NoGroove("no scar found: nothing lies clearly below the ball")
    pixel = surface.spacing_x * surface.spacing_y
    rimmed = _with_rim(worn)
    depth = -np.where(levelled.measured, levelled.height, _smooth(levelled))
    slopes = np.array([column[rimmed].sum() for column in _ball_slopes(surface, ball, len(covariance))]) * pixel
    return WearScar(
        tip_radius=float(ball[3]),
        scar_diameter=math.sqrt(4 / math.pi * pixel * _area(levelled, worn)),
        wear_volume=float(depth[rimmed].sum()) * pixel,
        wear_volume_uncertainty=math.sqrt(max(0.0, float(slopes @ covariance @ slopes))),
        levelled=levelled,
        worn=worn,
    )


def _within_ball(tip_radius: ArrayLike, **chord: ArrayLike) -> tuple[Floats, Floats]:
    r, d = require_positive(tip_radius=tip_radius), require_positive(**chord)
    if np.any(d > 2 * r):
        raise InvalidInput(f"{next(iter(chord))} must not exceed the ball's diameter, got {float(np.max(d)):g} m")
    return d, r


def _starting_ball(surface: HeightMap, paraboloid: Floats, tip_radius: float | None) -> Floats:
    x, y = centred_coordinates(surface)
    u, v = np.broadcast_to(x, paraboloid.shape).ravel(), np.broadcast_to(y, paraboloid.shape).ravel()
    scale = max(float(np.ptp(u)), float(np.ptp(v))) / 2
    design = np.stack([np.ones_like(u), u / scale, v / scale, (u**2 + v**2) / scale**2], axis=1)
    a, b, c, q = np.linalg.lstsq(design, paraboloid.ravel())[0]
    if q >= 0:
        raise InvalidInput("the map bends upwards all around: a worn ball is expected, with its tip up")
    x0, y0 = -b * scale / (2 * q), -c * scale / (2 * q)
    top = a - (b**2 + c**2) / (4 * q)
    return np.array([x0, y0, top, tip_radius or scale**2 / (-2 * q)])


def _ball_height(surface: HeightMap, ball: Floats) -> Floats:
    x, y = centred_coordinates(surface)
    x0, y0, top, r = ball
    square = (x - x0) ** 2 + (y - y0) ** 2
    if float(square.max()) > r**2:
        raise InvalidInput(f"the map reaches beyond the ball's radius of {r:.3g} m; cut it to the tip")
    return np.asarray(top - square / (r + np.sqrt(r**2 - square)))


def _ball_slopes(surface: HeightMap, ball: Floats, count: int) -> list[Floats]:
    """Return the change of the ball's height with its centre, top and radius."""
    x, y = centred_coordinates(surface)
    x0, y0, _, r = ball
    root = np.sqrt(r**2 - (x - x0) ** 2 - (y - y0) ** 2)
    return [(x - x0) / root, (y - y0) / root, np.ones_like(root), r / root - 1][:count]


def _fitted_ball(surface: HeightMap, unworn: Mask, start: Floats, tip_radius: float | None) -> tuple[Floats, Floats]:
    pixels = np.flatnonzero(unworn & surface.measured)
    if pixels.size < 20:
        raise InvalidInput(f"hardly anything of the ball is unworn, {pixels.size} pixels")
    pixels = np.random.default_rng(0).choice(pixels, min(_POINTS, pixels.size), replace=False)
    x, y = (np.broadcast_to(part, surface.height.shape).flat[pixels] for part in centred_coordinates(surface))
    z = surface.height.flat[pixels]
    reach = max(float(np.ptp(x)), float(np.ptp(y)))
    size = np.array([reach, reach, max(float(np.ptp(z)), np.finfo(float).tiny), start[3]])
    free = 3 if tip_radius is not None else 4

    def rest(shift: Floats) -> Floats:
        x0, y0, top, r = start + size * np.concatenate([shift, np.zeros(4 - free)])
        square = (x - x0) ** 2 + (y - y0) ** 2
        return np.asarray((top - square / (r + np.sqrt(np.maximum(r**2 - square, 0.0))) - z) / size[2])

    found = least_squares(rest, np.zeros(free), xtol=1e-12, ftol=1e-14)
    ball = start + size * np.concatenate([found.x, np.zeros(4 - free)])
    variance = 2 * found.cost / max(pixels.size - free, 1)
    covariance = np.linalg.pinv(found.jac.T @ found.jac) * variance * np.outer(size[:free], size[:free])
    return ball, covariance


def _with_rim(scar: Mask) -> Mask:
    """Return a scar with the rim that is too shallow to tell from the ball."""
    return np.asarray(binary_dilation(scar, iterations=2 * _SMOOTHED)) if scar.any() else scar


def _smooth(levelled: HeightMap) -> Floats:
    share = uniform_filter(levelled.measured.astype(np.float64), _SMOOTHED)
    total = uniform_filter(np.where(levelled.measured, levelled.height, 0.0), _SMOOTHED)
    return np.asarray(total / np.maximum(share, 1 / _SMOOTHED**2))


def _scar(levelled: HeightMap, worn: Mask) -> Mask:
    """Return the largest patch that lies clearly below the ball."""
    smooth = _smooth(levelled)
    unworn = ~worn if not worn.all() else worn
    patches, count = label(smooth < -max(_WORN * _spread(smooth[unworn]), _LEAST_DEPTH))
    sizes = np.bincount(patches.ravel())[1:]
    if not count or sizes.max() < _LEAST_SCAR:
        return np.zeros_like(worn)
    return np.asarray(patches == 1 + int(np.argmax(sizes)))


def _area(levelled: HeightMap, worn: Mask) -> float:
    """Return the area of a scar, in pixels, at the level of the ball."""
    rimmed = _with_rim(worn)
    depth = median_filter(-np.where(levelled.measured, levelled.height, _smooth(levelled)), _SMOOTHED)
    deep = max(float(np.quantile(depth[worn], 0.9)), _LEAST_DEPTH)
    low = max(_WORN * _spread(depth[~rimmed]), _LEAST_DEPTH)
    high = min(max(_LEVELS_REACH * low, _LEVELS_SHARE * deep), 0.8 * deep)
    levels = np.linspace(min(low, high / 2), high, _LEVELS)
    areas = np.count_nonzero(depth[rimmed] > levels[:, np.newaxis], axis=1)
    return float(np.polyfit(levels / high, areas, 1)[1])


def _spread(values: Floats) -> float:
    return _DEVIATION_OVER_MEDIAN * float(np.median(np.abs(values - np.median(values))))
