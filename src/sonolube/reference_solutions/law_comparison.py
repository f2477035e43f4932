"""Statistical laws, Persson's theory and boundary elements on one and the same surface."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats, require_positive
from sonolube.contact import (
    ASPERITY_LAWS,
    ContactPair,
    ExponentialHeights,
    GaussianHeights,
    HeightDistribution,
    PerssonContact,
    RoughContact,
    normal_stiffness,
    persson_area,
    persson_separation,
    persson_stiffness,
    real_contact_area,
    separation,
)
from sonolube.errors import InvalidInput
from sonolube.reference_solutions.boundary_element import press
from sonolube.surfaces import HeightMap, areal_spectrum, radial_spectrum, roughness, spectral_moments, summits

QUANTITIES = ("separation", "real_contact_area", "normal_stiffness")
"""What the laws are compared in."""

REFEREE = "boundary_element"
"""The law that judges the others."""

_HEIGHTS: Mapping[str, HeightDistribution] = {"exponential": ExponentialHeights(), "gaussian": GaussianHeights()}


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class LawCurve:
    """What one law says of a surface under some loads.

    Parameters
    ----------
    separation : ndarray, shape (n,)
        Mean gap; for the statistical laws separation of the undeformed mean planes. [m]
    real_contact_area : ndarray, shape (n,)
        Real contact area. [m2]
    normal_stiffness : ndarray, shape (n,)
        Normal stiffness. [N/m]
    """

    separation: Floats
    real_contact_area: Floats
    normal_stiffness: Floats


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class LawComparison:
    """The laws beside each other on one surface.

    Parameters
    ----------
    rms_height : float
        Standard deviation of the heights of the surface. [m]
    rms_slope : float
        Root mean square of the gradient. []
    nominal_area : float
        Area of the map. [m2]
    effective_modulus : float
        Combined modulus of both bodies. [Pa]
    normal_load : ndarray, shape (n,)
        Force pressing the bodies together. [N]
    laws : mapping of str to LawCurve
        "exponential" and "gaussian" asperities, "persson" and "boundary_element".
    """

    rms_height: float
    rms_slope: float
    nominal_area: float
    effective_modulus: float
    normal_load: Floats
    laws: Mapping[str, LawCurve]

    @property
    def reduced_pressure(self) -> Floats:
        """Nominal pressure over modulus and slope, p/(E* h'), an array of shape (n,)."""
        return self.normal_load / (self.nominal_area * self.effective_modulus * self.rms_slope)


def compare_laws(
    surface: HeightMap, *, effective_modulus: float, reduced_pressure: ArrayLike | None = None
) -> LawComparison:
    """Press a surface against a rigid flat by every law, all elastic, with no number fitted.

    Parameters
    ----------
    surface : HeightMap
        Periodic, without missing pixels: see `mirrored`.
    effective_modulus : float
        Combined modulus of both bodies. [Pa]
    reduced_pressure : array_like, shape (n,), optional
        Nominal pressures p/(E* h') in rising order, three or more; 13 from 0.001 to 0.3 where absent. []

    Returns
    -------
    LawComparison

    Raises
    ------
    InvalidInput
        If a value is not positive, fewer than three pressures are given or not in rising order, pixels are missing,
        a load was not solved, or ContactMechanics is not installed.

    Notes
    -----
    The asperities of the statistical laws are the summits counted on the map; Persson's theory takes the map's own
    spectrum. The stiffness of boundary elements is the slope of the logarithm of their load over their gap, by
    differences of the second order.
    """
    level = np.geomspace(1e-3, 0.3, 13) if reduced_pressure is None else np.atleast_1d(reduced_pressure)
    x = require_positive(reduced_pressure=level)
    if x.size < 3 or not np.all(np.diff(x) > 0):
        raise InvalidInput(f"reduced_pressure needs three or more values in rising order, got {x.size}")
    slope = math.sqrt(2 * spectral_moments(surface).slope_variance)
    area = surface.height.size * surface.spacing_x * surface.spacing_y
    load = x * require_positive(effective_modulus=effective_modulus) * slope * area
    return LawComparison(
        rms_height=float(np.std(surface.height)),
        rms_slope=slope,
        nominal_area=area,
        effective_modulus=effective_modulus,
        normal_load=load,
        laws={
            **{
                name: _statistical(surface, heights, load, area, effective_modulus)
                for name, heights in _HEIGHTS.items()
            },
            "persson": _persson(surface, load, area, effective_modulus),
            REFEREE: _boundary_element(surface, load, effective_modulus),
        },
    )


def where_laws_hold(
    comparison: LawComparison, *, tolerance: float = 0.2
) -> Mapping[str, Mapping[str, tuple[float, float] | None]]:
    """Return for each law and quantity the real area shares between which it keeps within a tolerance of the referee.

    Parameters
    ----------
    comparison : LawComparison
    tolerance : float
        Greatest deviation from boundary elements: of the gap as a share of the rms height, of the others of their
        value.

    Returns
    -------
    mapping of str to mapping of str to tuple of two floats, or None
        The longest unbroken range of the referee's real area over the nominal one; None where no two neighbouring
        loads keep within the tolerance: curves that merely cross do not hold.
    """
    share = comparison.laws[REFEREE].real_contact_area / comparison.nominal_area
    return {
        law: {
            quantity: _longest(np.abs(deviation(comparison, law=law, quantity=quantity)) <= tolerance, share)
            for quantity in QUANTITIES
        }
        for law in comparison.laws
        if law != REFEREE
    }


def deviation(comparison: LawComparison, *, law: str, quantity: str) -> Floats:
    """Return how far a law lies from boundary elements.

    Parameters
    ----------
    comparison : LawComparison
    law : str
        Its name in the comparison.
    quantity : {"separation", "real_contact_area", "normal_stiffness"}

    Returns
    -------
    ndarray, shape (n,)
        Of the gap in rms heights, of the others in their own value.
    """
    one, judge = (getattr(comparison.laws[name], quantity) for name in (law, REFEREE))
    return np.asarray((one - judge) / (comparison.rms_height if quantity == "separation" else judge))


def _statistical(
    surface: HeightMap, heights: HeightDistribution, load: Floats, area: float, modulus: float
) -> LawCurve:
    contact = RoughContact(
        roughness=roughness(surface),
        # neither Poisson's ratio nor the tangential stiffness enters where nothing yields
        pair=ContactPair(effective_modulus=modulus, poisson_ratio=0.3, yield_strength=math.inf, mindlin_ratio=1.0),
        nominal_area=area,
        heights=heights,
        asperity=ASPERITY_LAWS["elastic"],
    )
    d = separation(contact, normal_load=load)
    return LawCurve(
        separation=d + summits(surface).mean_summit_height,
        real_contact_area=real_contact_area(contact, separation=d),
        normal_stiffness=normal_stiffness(contact, separation=d),
    )


def _persson(surface: HeightMap, load: Floats, area: float, modulus: float) -> LawCurve:
    spectrum = radial_spectrum(areal_spectrum(surface, window="none"))
    contact = PerssonContact(spectrum=spectrum, effective_modulus=modulus, nominal_area=area)
    return LawCurve(
        separation=persson_separation(contact, normal_load=load),
        real_contact_area=persson_area(contact, normal_load=load),
        normal_stiffness=persson_stiffness(contact, normal_load=load),
    )


def _boundary_element(surface: HeightMap, load: Floats, modulus: float) -> LawCurve:
    pressed = press(surface, normal_load=load, effective_modulus=modulus)
    unsolved = next((reason for reason in pressed.reason if reason), "")
    if unsolved:
        raise InvalidInput(f"boundary elements did not converge: {unsolved}; take fewer or lower pressures")
    slope = np.gradient(np.log(load), pressed.separation, edge_order=2)
    return LawCurve(
        separation=pressed.separation,
        real_contact_area=pressed.real_contact_area,
        normal_stiffness=np.asarray(-load * slope),
    )


def _longest(held: NDArray[np.bool_], share: Floats) -> tuple[float, float] | None:
    """Return the area shares at the ends of the longest run of true values, of two or more."""
    runs = np.flatnonzero(np.diff(np.concatenate([[0], held.astype(int), [0]]))).reshape(-1, 2)
    first, last = max(runs.tolist(), key=lambda run: run[1] - run[0], default=(0, 0))
    return (float(share[first]), float(share[last - 1])) if last - first > 1 else None
