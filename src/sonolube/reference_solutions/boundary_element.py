"""Elastic contact of a height map by boundary elements, with the ContactMechanics library, behind an extra."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.surfaces import HeightMap

_PERIMETER_SHARE = (math.pi - 1 + math.log(2)) / 24  # of a pixel's width, along each edge of the contact


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class BoundaryElementContact:
    """What pressing a surface against a rigid flat does.

    Parameters
    ----------
    normal_load : ndarray, shape (n,)
        Force pressing the bodies together. [N]
    separation : ndarray, shape (n,)
        Mean gap between the deformed surfaces; for a lone body the height of the flat over the zero of heights. [m]
    real_contact_area : ndarray, shape (n,)
        Real contact area. [m2]
    peak_pressure : ndarray, shape (n,)
        Highest pressure of any pixel. [Pa]
    reason : tuple of str, length n
        Why a load was not solved, empty where it was; its numbers are then NaN.
    """

    normal_load: Floats
    separation: Floats
    real_contact_area: Floats
    peak_pressure: Floats
    reason: tuple[str, ...]


def boundary_element_contact(
    surface: HeightMap, *, normal_load: ArrayLike, effective_modulus: float, periodic: bool = True
) -> BoundaryElementContact:
    """Press an elastic surface against a rigid flat, without friction or adhesion.

    Parameters
    ----------
    surface : HeightMap
        Without missing pixels; if periodic, its opposite edges fit each other: see `mirror_extension`.
    normal_load : array_like, shape (n,)
        Force pressing the bodies together, over the whole map. [N]
    effective_modulus : float
        Combined modulus of both bodies. [Pa]
    periodic : bool
        Whether the map repeats for ever, or stands alone on a half-space.

    Returns
    -------
    BoundaryElementContact

    Raises
    ------
    InvalidInput
        If a load or the modulus is not positive, pixels are missing, or ContactMechanics is not installed.

    Notes
    -----
    Constrained conjugate gradients on the Fourier-transformed half-space. The pixels under pressure overrate the area
    along their outline; the excess that an outline of that length has on average is taken off.

    References
    ----------
    .. [1] I. A. Polonsky and L. M. Keer, Wear 231, 206 (1999). doi:10.1016/S0043-1648(99)00113-1
    .. [2] V. A. Yastrebov, G. Anciaux and J.-F. Molinari, Tribol. Int. 114, 161 (2017).
       doi:10.1016/j.triboint.2017.04.023
    """
    loads = np.atleast_1d(require_positive(normal_load=normal_load))
    require_positive(effective_modulus=effective_modulus)
    if not surface.measured.all():
        raise InvalidInput(
            f"boundary elements need every height, but {100 * surface.missing_fraction:.2g} % of the pixels are "
            "missing: crop the map or fill them"
        )
    system = _system(surface, effective_modulus, periodic)
    # a load is met, and the surfaces kept apart, to this share of the heights
    tolerance = 1e-5 * float(np.ptp(surface.height)) or math.inf
    solved = [_solve(system, surface, float(load), tolerance, periodic) for load in loads]
    gap, area, peak = np.array([numbers for numbers, _ in solved]).T
    return BoundaryElementContact(
        normal_load=loads,
        separation=gap,
        real_contact_area=area,
        peak_pressure=peak,
        reason=tuple(reason for _, reason in solved),
    )


def mirror_extension(surface: HeightMap) -> HeightMap:
    """Return the map with its mirror images beside it, which makes a periodic map of any.

    Parameters
    ----------
    surface : HeightMap

    Returns
    -------
    HeightMap
        Of twice as many rows and columns, with the same distribution of heights.
    """
    beside = np.concatenate([surface.height, surface.height[:, ::-1]], axis=1)
    return HeightMap(
        height=np.concatenate([beside, beside[::-1]], axis=0),
        spacing_x=surface.spacing_x,
        spacing_y=surface.spacing_y,
    )


def _system(surface: HeightMap, modulus: float, periodic: bool) -> Any:
    try:
        from ContactMechanics import FreeFFTElasticHalfSpace, PeriodicFFTElasticHalfSpace
        from ContactMechanics.Factory import make_system
        from SurfaceTopography import Topography
    except ImportError:
        raise InvalidInput(
            'boundary elements need ContactMechanics: pip install "sonolube[boundary-element]"'
        ) from None
    points = surface.height.T.shape
    sizes = (points[0] * surface.spacing_x, points[1] * surface.spacing_y)
    substrate = (PeriodicFFTElasticHalfSpace if periodic else FreeFFTElasticHalfSpace)(points, modulus, sizes)
    topography = Topography(np.ascontiguousarray(surface.height.T), sizes, periodic=periodic)
    return make_system(substrate=substrate, surface=topography)


def _solve(
    system: Any, surface: HeightMap, load: float, tolerance: float, periodic: bool
) -> tuple[tuple[float, float, float], str]:
    found = system.minimize_proxy(external_force=load, pentol=tolerance, maxiter=2000)
    if not found.success:
        return (math.nan, math.nan, math.nan), f"{load:.4g} N was not solved in 2000 steps: {found.message}"
    pixel = surface.spacing_x * surface.spacing_y
    columns, rows = surface.height.T.shape
    pressed = system.force[:columns, :rows] > 0
    gap = float(np.mean(system.disp) - np.mean(surface.height)) if periodic else 0.0
    area, peak = _area(pressed, surface, periodic), float(system.force.max()) / pixel
    return (gap - float(system.offset), area, peak), ""


def _area(pressed: NDArray[np.bool_], surface: HeightMap, periodic: bool) -> float:
    """Return the area of the pixels under pressure, less what their outline overrates on average."""
    across, along = (
        np.count_nonzero(pressed ^ np.roll(pressed, 1, axis))
        if periodic
        else np.count_nonzero(np.diff(pressed, axis=axis))
        for axis in (0, 1)
    )
    pixel = surface.spacing_x * surface.spacing_y
    return pixel * max(np.count_nonzero(pressed) - _PERIMETER_SHARE * (across + along), 0.0)
