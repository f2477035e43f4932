"""Statistical contact laws and Persson's theory compared with boundary elements on one surface, as table and figure."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference_solutions.boundary_element import boundary_element_contact
from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.figure import COLOURS, LINES, MARKERS, subplots
from sonolube.models import surfaces
from sonolube.models.contact import (
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

if TYPE_CHECKING:
    from matplotlib.figure import Figure

QUANTITIES = ("separation", "real_contact_area", "normal_stiffness")
"""Quantities in which the contact laws are compared."""

REFERENCE_SOLUTION = "boundary_element"
"""Name of the reference solution among the laws."""

_HEIGHTS: Mapping[str, HeightDistribution] = {"exponential": ExponentialHeights(), "gaussian": GaussianHeights()}


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class LawCurve:
    """Contact of a surface over the load by one contact law.

    Parameters
    ----------
    separation : ndarray, shape (n,)
        Mean gap; for the statistical laws the separation of the undeformed mean planes. [m]
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
    """Contact laws compared on one surface.

    Parameters
    ----------
    rms_height : float
        Standard deviation of the heights of the surface. [m]
    rms_gradient : float
        Root mean square of the gradient. []
    nominal_area : float
        Area of the map. [m2]
    effective_modulus : float
        Effective modulus E* of both bodies. [Pa]
    normal_load : ndarray, shape (n,)
        Force pressing the bodies together. [N]
    laws : mapping of str to LawCurve
        "exponential" and "gaussian" asperities, "persson" and "boundary_element".
    """

    rms_height: float
    rms_gradient: float
    nominal_area: float
    effective_modulus: float
    normal_load: Floats
    laws: Mapping[str, LawCurve]

    @property
    def reduced_pressure(self) -> Floats:
        """Nominal pressure over effective modulus and rms gradient, p/(E* h'), shape (n,)."""
        return self.normal_load / (self.nominal_area * self.effective_modulus * self.rms_gradient)


def compare_laws(
    surface: surfaces.HeightMap, *, effective_modulus: float, reduced_pressure: ArrayLike | None = None
) -> LawComparison:
    r"""Elastic contact of a surface with a rigid flat by every contact law, without fitted parameters.

    Parameters
    ----------
    surface : HeightMap
        Periodic, without missing pixels: see `mirrored`.
    effective_modulus : float
        Effective modulus E* of both bodies. [Pa]
    reduced_pressure : array_like, shape (n,), optional
        Nominal pressures p/(E* h') in ascending order, three or more; by default 13 from 0.001 to 0.3. []

    Returns
    -------
    LawComparison

    Raises
    ------
    InvalidInput
        If a value is not positive, fewer than three pressures are given or they do not ascend, pixels are missing, the
        boundary elements do not converge, or ContactMechanics is not installed.

    Notes
    -----
    The statistical laws take the summits counted on the map, Persson's theory its power spectrum. The stiffness of the
    boundary elements is

    .. math:: k_n = -F_N\, \frac{\mathrm{d} \ln F_N}{\mathrm{d} \bar u}

    by differences of second order.
    """
    pressures = np.geomspace(1e-3, 0.3, 13) if reduced_pressure is None else np.atleast_1d(reduced_pressure)
    x = require_positive(reduced_pressure=pressures)
    if x.size < 3 or not np.all(np.diff(x) > 0):
        raise InvalidInput(f"reduced_pressure must have three or more values in ascending order, got {x.size}")
    gradient = math.sqrt(2 * surfaces.spectral_moments(surface).slope_variance)
    area = surface.height.size * surface.spacing_x * surface.spacing_y
    load = x * require_positive(effective_modulus=effective_modulus) * gradient * area
    return LawComparison(
        rms_height=float(np.std(surface.height)),
        rms_gradient=gradient,
        nominal_area=area,
        effective_modulus=effective_modulus,
        normal_load=load,
        laws={
            **{
                name: _statistical(surface, heights, load, area, effective_modulus)
                for name, heights in _HEIGHTS.items()
            },
            "persson": _persson(surface, load, area, effective_modulus),
            REFERENCE_SOLUTION: _boundary_element(surface, load, effective_modulus),
        },
    )


def validity_ranges(
    comparison: LawComparison, *, tolerance: float = 0.2
) -> Mapping[str, Mapping[str, tuple[float, float] | None]]:
    """Ranges of real area fraction in which each law is within a tolerance of the boundary elements, by quantity.

    Parameters
    ----------
    comparison : LawComparison
    tolerance : float
        Largest deviation from the boundary elements, of the gap over the rms height, of the others relative.

    Returns
    -------
    mapping of str to mapping of str to tuple of two floats, or None
        For each law and quantity, the longest range of real over nominal area of the boundary elements in which all
        loads are within the tolerance; None where no two neighbouring loads are, so that an intersection of two curves
        is not a range.
    """
    fraction = comparison.laws[REFERENCE_SOLUTION].real_contact_area / comparison.nominal_area
    return {
        law: {
            quantity: _longest_range(np.abs(deviation(comparison, law=law, quantity=quantity)) <= tolerance, fraction)
            for quantity in QUANTITIES
        }
        for law in comparison.laws
        if law != REFERENCE_SOLUTION
    }


def deviation(comparison: LawComparison, *, law: str, quantity: str) -> Floats:
    """Deviation of a contact law from the boundary elements.

    Parameters
    ----------
    comparison : LawComparison
    law : str
        Name of the law in the comparison.
    quantity : {"separation", "real_contact_area", "normal_stiffness"}

    Returns
    -------
    ndarray, shape (n,)
        Of the gap over the rms height, of the others relative.
    """
    value, reference = (getattr(comparison.laws[name], quantity) for name in (law, REFERENCE_SOLUTION))
    scale = comparison.rms_height if quantity == "separation" else reference
    return np.asarray((value - reference) / scale)


def _statistical(
    surface: surfaces.HeightMap, heights: HeightDistribution, load: Floats, area: float, modulus: float
) -> LawCurve:
    """Contact by a statistical law of elastic asperities with the summits counted on the map."""
    contact = RoughContact(
        roughness=surfaces.contact_roughness(surface),
        # without yielding, Poisson's ratio and the tangential stiffness have no effect
        pair=ContactPair(effective_modulus=modulus, poisson_ratio=0.3, yield_strength=math.inf, mindlin_ratio=1.0),
        nominal_area=area,
        heights=heights,
        asperity=ASPERITY_LAWS["elastic"],
    )
    d = separation(contact, normal_load=load)
    return LawCurve(
        separation=d + surfaces.summit_statistics(surface).mean_summit_height,
        real_contact_area=real_contact_area(contact, separation=d),
        normal_stiffness=normal_stiffness(contact, separation=d),
    )


def _persson(surface: surfaces.HeightMap, load: Floats, area: float, modulus: float) -> LawCurve:
    """Contact by Persson's theory with the spectrum of the map."""
    spectrum = surfaces.radial_spectrum(surfaces.areal_spectrum(surface, window="none"))
    contact = PerssonContact(spectrum=spectrum, effective_modulus=modulus, nominal_area=area)
    return LawCurve(
        separation=persson_separation(contact, normal_load=load),
        real_contact_area=persson_area(contact, normal_load=load),
        normal_stiffness=persson_stiffness(contact, normal_load=load),
    )


def _boundary_element(surface: surfaces.HeightMap, load: Floats, modulus: float) -> LawCurve:
    """Contact by boundary elements, refused where a load does not converge."""
    contact = boundary_element_contact(surface, normal_load=load, effective_modulus=modulus)
    unsolved = next((reason for reason in contact.reason if reason), "")
    if unsolved:
        raise InvalidInput(f"boundary elements did not converge: {unsolved}; take fewer or lower pressures")
    rate = np.gradient(np.log(load), contact.separation, edge_order=2)
    return LawCurve(
        separation=contact.separation,
        real_contact_area=contact.real_contact_area,
        normal_stiffness=np.asarray(-load * rate),
    )


def _longest_range(within: NDArray[np.bool_], fraction: Floats) -> tuple[float, float] | None:
    """Area fractions at the ends of the longest run of two or more true values."""
    runs = np.flatnonzero(np.diff(np.concatenate([[0], within.astype(int), [0]]))).reshape(-1, 2)
    first, last = max(runs.tolist(), key=lambda run: run[1] - run[0], default=(0, 0))
    return (float(fraction[first]), float(fraction[last - 1])) if last - first > 1 else None


_TITLES = {
    "exponential": "exponential heights",
    "gaussian": "Gaussian heights",
    "persson": "Persson",
    REFERENCE_SOLUTION: "boundary elements",
}


def comparison_table(comparison: LawComparison) -> list[str]:
    """Contact laws side by side as lines of text: gap over rms height, area fraction, and dimensionless stiffness.

    Parameters
    ----------
    comparison : LawComparison

    Returns
    -------
    list of str
        A heading of two lines, then one line per load.
    """
    laws = comparison.laws
    columns = [dimensionless_curve(comparison, curve) for curve in laws.values()]
    width = 8 * len(laws)
    heading = f"{'p/(E* h)':>10}  {'gap/Rq':^{width}}  {'area fraction':^{width}}  {'k Rq/F':^{width}}"
    names = "".join(f"{name[:7]:>8}" for name in laws)
    return [
        heading,
        f"{'':>10}  {names}  {names}  {names}",
        *[
            f"{pressure:>10.2g}  "
            + "  ".join("".join(f"{column[quantity][index]:>8.3g}" for column in columns) for quantity in range(3))
            for index, pressure in enumerate(comparison.reduced_pressure)
        ],
    ]


def comparison_figure(comparison: LawComparison) -> "Figure":
    """Figure of gap, real contact area and stiffness over the nominal pressure by every contact law.

    Parameters
    ----------
    comparison : LawComparison

    Returns
    -------
    Figure
    """
    figure, axes = subplots(1, 3, figsize=(9.6, 3.4))
    for index, (name, curve) in enumerate(comparison.laws.items()):
        style = (
            {"marker": MARKERS[0], "ls": "", "color": "black", "zorder": 3}
            if name == REFERENCE_SOLUTION
            else {"ls": LINES[index], "color": COLOURS[index]}
        )
        for panel, values in zip(axes, dimensionless_curve(comparison, curve), strict=True):
            panel.plot(comparison.reduced_pressure, values, label=_TITLES[name], **style)
    labels = ("Mean gap / rms height", "Real / nominal contact area", "Stiffness × rms height / load")
    for panel, label in zip(axes, labels, strict=True):
        panel.set(xscale="log", xlabel="Nominal pressure p / (E* h')", ylabel=label)
    axes[0].axhline(0, color="0.6", lw=0.8)
    axes[1].set_yscale("log")
    axes[2].set_ylim(0, 5)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=4)
    return figure


def dimensionless_curve(comparison: LawComparison, curve: LawCurve) -> tuple[Floats, Floats, Floats]:
    r"""Dimensionless gap, area and stiffness of one law.

    Parameters
    ----------
    comparison : LawComparison
    curve : LawCurve

    Returns
    -------
    tuple of three ndarray, shape (n,)
        Gap over rms height, real over nominal contact area, and stiffness times rms height over load,
        :math:`\bar u/R_q`, :math:`A_r/A_n` and :math:`k_n R_q/F_N`.
    """
    return (
        curve.separation / comparison.rms_height,
        curve.real_contact_area / comparison.nominal_area,
        np.asarray(curve.normal_stiffness * comparison.rms_height / comparison.normal_load),
    )
