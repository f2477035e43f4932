"""Root mean square height of a surface whose Ra, Rz or finish is stated, with the spread of the relation."""

from dataclasses import dataclass
from math import exp, hypot, log

from sonolube.surfaces import (
    RmsHeightEstimate,
    rms_height_from_maximum_height,
    rms_height_from_roughness_average,
    surface_finish,
)
from sonolube.units import format_si


@dataclass(frozen=True, kw_only=True, slots=True)
class StatedHeight:
    """Root mean square height inferred from what is stated of a surface.

    Parameters
    ----------
    rms_height : float
        Median. [m]
    factor : float
        Geometric standard deviation: 68 % lies between the median over it and the median times it.
    reason : str
        What was stated, and the relation.
    """

    rms_height: float
    factor: float
    reason: str


def deviation_of_range(low: float, high: float) -> float:
    """Return the standard deviation of the logarithm of a quantity of which a range holds 95 of 100. []"""
    return log(high / low) / 4


def height_from_roughness_average(*, roughness_average: float) -> StatedHeight:
    """Return the root mean square height of a surface by its Ra.

    Parameters
    ----------
    roughness_average : float
        Arithmetic mean roughness. [m]

    Returns
    -------
    StatedHeight
    """
    found = rms_height_from_roughness_average(arithmetic_mean_height=roughness_average)
    return _stated(found, f"Ra {format_si(roughness_average, 'm')}")


def height_from_maximum_height(*, maximum_height: float) -> StatedHeight:
    """Return the root mean square height of a surface by its Rz.

    Parameters
    ----------
    maximum_height : float
        Maximum height of a section, mean over the sections. [m]

    Returns
    -------
    StatedHeight
    """
    found = rms_height_from_maximum_height(mean_section_height=maximum_height)
    return _stated(found, f"Rz {format_si(maximum_height, 'm')}")


def height_of_finish(text: str) -> StatedHeight:
    """Return the root mean square height of a surface by its process, its ISO grade or both.

    Parameters
    ----------
    text : str
        Such as "ground N6".

    Returns
    -------
    StatedHeight

    Raises
    ------
    UnknownName
        If the finish is unknown.
    """
    finish = surface_finish(text)
    low, high = finish.roughness_average_low, finish.roughness_average_high
    found = rms_height_from_roughness_average(arithmetic_mean_height=finish.arithmetic_mean_height)
    stated = f"{finish.title}, Ra {format_si(low, 'm')} to {format_si(high, 'm')} by {finish.source}"
    return _stated(found, stated, deviation=deviation_of_range(low, high))


def _stated(found: RmsHeightEstimate, stated: str, *, deviation: float = 0.0) -> StatedHeight:
    """Return a height with the spread of the relation and that of what was stated."""
    return StatedHeight(
        rms_height=found.rms_height,
        factor=exp(hypot(deviation, deviation_of_range(found.low, found.high))),
        reason=f"from {stated}; {found.source}",
    )
