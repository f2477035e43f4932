"""Elastic contact of a height map with a rigid flat by the boundary element method of the ContactMechanics library."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.extras import missing_package
from sonolube.models.surfaces import HeightMap

_PERIMETER_CORRECTION = (math.pi - 1 + math.log(2)) / 24  # area per pixel edge of the contact's outline, in pixels [2]


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class BoundaryElementContact:
    """Elastic contact of a surface with a rigid flat under given loads.

    Parameters
    ----------
    normal_load : ndarray, shape (n,)
        Force pressing the bodies together. [N]
    separation : ndarray, shape (n,)
        Mean gap between the deformed surfaces; for a single body the height of the flat above zero height. [m]
    real_contact_area : ndarray, shape (n,)
        Real contact area. [m2]
    peak_pressure : ndarray, shape (n,)
        Largest pressure of a pixel. [Pa]
    reason : tuple of str, length n
        Reason why a load has no solution, whose values are then NaN; empty where it has one.
    """

    normal_load: Floats
    separation: Floats
    real_contact_area: Floats
    peak_pressure: Floats
    reason: tuple[str, ...]


def boundary_element_contact(
    surface: HeightMap, *, normal_load: ArrayLike, effective_modulus: float, periodic: bool = True
) -> BoundaryElementContact:
    r"""Frictionless, non-adhesive contact of an elastic height map with a rigid flat, by boundary elements.

    Parameters
    ----------
    surface : HeightMap
        Without missing pixels; if periodic, with continuous opposite edges, such as a map beside its mirror images.
    normal_load : array_like, shape (n,)
        Force pressing the bodies together, over the whole map. [N]
    effective_modulus : float
        Effective modulus E* of both bodies. [Pa]
    periodic : bool
        Whether the map is repeated periodically, or is a single body on a half-space.

    Returns
    -------
    BoundaryElementContact

    Raises
    ------
    InvalidInput
        If a load or the modulus is not positive, pixels are missing, or ContactMechanics is not installed.

    Notes
    -----
    The displacements follow from the pressures by convolution with the Boussinesq kernel of the half-space; the contact
    conditions

    .. math:: p \ge 0, \qquad g \ge 0, \qquad p\, g = 0, \qquad \sum p\, \Delta x \Delta y = F_N

    for pressure :math:`p` and gap :math:`g` are solved by constrained conjugate gradients [1]_ with fast Fourier
    transforms. The pixels under pressure overestimate the area along their outline; the mean excess of an outline of
    that length is subtracted [2]_.

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
            f"boundary elements require every height, but {100 * surface.missing_fraction:.2g} % of the pixels are "
            "missing: crop the map or fill them"
        )
    system = _system(surface, effective_modulus, periodic)
    # of load and penetration, relative to the range of heights
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


def _system(surface: HeightMap, modulus: float, periodic: bool) -> Any:
    """Contact system of the library; refused with the remedy where it is not installed."""
    try:
        from ContactMechanics import FreeFFTElasticHalfSpace, PeriodicFFTElasticHalfSpace
        from ContactMechanics.Factory import make_system
        from SurfaceTopography import Topography
    except ImportError:
        raise missing_package("boundary-element") from None
    points = surface.height.T.shape
    sizes = (points[0] * surface.spacing_x, points[1] * surface.spacing_y)
    substrate = (PeriodicFFTElasticHalfSpace if periodic else FreeFFTElasticHalfSpace)(points, modulus, sizes)
    topography = Topography(np.ascontiguousarray(surface.height.T), sizes, periodic=periodic)
    return make_system(substrate=substrate, surface=topography)


def _solve(
    system: Any, surface: HeightMap, load: float, tolerance: float, periodic: bool
) -> tuple[tuple[float, float, float], str]:
    """Mean gap, real area and peak pressure under a load, and the reason of a failure."""
    found = system.minimize_proxy(external_force=load, pentol=tolerance, maxiter=2000)
    if not found.success:
        return (math.nan, math.nan, math.nan), f"no convergence for {load:.4g} N in 2000 iterations: {found.message}"
    pixel = surface.spacing_x * surface.spacing_y
    columns, rows = surface.height.T.shape
    contact = system.force[:columns, :rows] > 0
    gap = float(np.mean(system.disp) - np.mean(surface.height)) if periodic else 0.0
    area, peak = _corrected_area(contact, surface, periodic), float(system.force.max()) / pixel
    return (gap - float(system.offset), area, peak), ""


def _corrected_area(contact: NDArray[np.bool_], surface: HeightMap, periodic: bool) -> float:
    """Area of the pixels in contact less the mean excess along their outline."""
    across, along = (
        np.count_nonzero(contact ^ np.roll(contact, 1, axis))
        if periodic
        else np.count_nonzero(np.diff(contact, axis=axis))
        for axis in (0, 1)
    )
    pixel = surface.spacing_x * surface.spacing_y
    return pixel * max(np.count_nonzero(contact) - _PERIMETER_CORRECTION * (across + along), 0.0)
