"""Uncertain entries of a rig as text and JSON: their distributions, or the posterior of an identified structure."""

from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.design.identified_structure import IdentifiedStructure
from sonolube.design.uncertainty_summary import BAND
from sonolube.rig import Distribution, Rig
from sonolube.text.units import format_si
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr


_MIN_TRUNCATION = 1e-4  # fraction of a distribution that is cut off, from which on it is printed
_MIN_EXPONENT = 0.1  # of a parameter in a free direction, from which on it is printed


def distributions(rig: Rig, result: "xr.Dataset", structure: IdentifiedStructure | None) -> dict[str, Distribution]:
    """Distributions that samples were drawn from, by key, those of an identified structure apart."""
    joint = {} if structure is None else structure.draws_by_key()
    drawn = result.attrs["uncertain"]
    return {key: law for key, law in rig.uncertainty.items() if key in drawn and key not in joint}


def entry_rows(rig: Rig, result: "xr.Dataset", structure: IdentifiedStructure | None) -> list[tuple[str, str]]:
    """Uncertain entries with their distributions, or with median and 90 % interval of their posterior."""
    rows = []
    for key, law in distributions(rig, result, structure).items():
        cut = law.truncated_fraction
        remark = f"; {cut:.1%} of it is impossible and cut off" if cut > _MIN_TRUNCATION else ""
        rows.append((key, f"{law.text}{remark}"))
    if structure is None:
        return rows
    for key, (low, median, high) in _quantiles(structure).items():
        unit = quantity(key.rpartition(".")[2]).unit
        remark = "; no fact settles it" if key.removeprefix("structure.") in structure.posterior.unidentified else ""
        ends = f"{format_si(low, unit)} to {format_si(high, unit)}"
        rows.append((key, f"{format_si(median, unit)}, 90 % within {ends}{remark}"))
    return rows


def free_lines(structure: IdentifiedStructure | None) -> list[str]:
    """Directions in which the facts leave a structure free, and the convergence of its draws."""
    if structure is None:
        return []
    lines = []
    for direction in structure.unidentifiable_directions:
        exponents = {name: exponent for name, exponent in direction.exponents.items() if abs(exponent) > _MIN_EXPONENT}
        product = " ".join(f"{name}^{exponent:+.2f}" for name, exponent in exponents.items())
        lines.append(f"  left free by the facts, to a factor of e and more: {product}")
    return [*lines, f"  {agreement(structure)}"]


def agreement(structure: IdentifiedStructure) -> str:
    """Agreement of independent populations of draws, by their potential scale reduction."""
    posterior = structure.posterior
    agree = "agree" if posterior.has_converged else "do not agree yet: take the ends with caution"
    return f"independent populations of draws {agree} ({posterior.potential_scale_reduction:.2f})"


def posterior_object(structure: IdentifiedStructure) -> dict[str, Any]:
    """Posterior of a structure for JSON: convergence, free parameters and directions, quantiles."""
    posterior = structure.posterior
    return {
        "potential_scale_reduction": posterior.potential_scale_reduction,
        "settled": posterior.has_converged,
        "free": [f"structure.{name}" for name in posterior.unidentified],
        "unidentifiable_directions": [dict(direction.exponents) for direction in structure.unidentifiable_directions],
        "quantiles": _quantiles(structure),
    }


def _quantiles(structure: IdentifiedStructure) -> dict[str, list[float]]:
    """Quantiles of 5, 50 and 95 % of the draws of each parameter, by key."""
    return {key: np.quantile(values, BAND).tolist() for key, values in structure.draws_by_key().items()}
