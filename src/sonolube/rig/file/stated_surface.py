"""Root mean square height of a surface whose Ra, Rz or finish is stated, with the spread of the relation."""

import re
from dataclasses import dataclass, replace
from math import exp, hypot, log
from typing import Final

from sonolube.errors import InvalidInput, UnknownName
from sonolube.models import surfaces
from sonolube.text.units import format_si, to_si

FINISH_FORMS: Final = (
    "write a process, an ISO grade, both, Ra or Rz: 'ground', 'lapped', 'turned', 'N6', 'ground N6', 'Ra 0.4um',"
    " 'Rz 3.2um'"
)
"""Forms of a finish that are read, for refusals."""

_NUMBER: Final = re.compile(
    r"(?:(?!(?:ra|rz|rq|sa|sq|rms)\b)(?P<process>[a-z][a-z _-]*?)[ ,]+)?(?P<parameter>ra|rz|rq|sa|sq|rms)?[ ]*[=:]?[ ]*"
    r"(?P<number>(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:e-?\d+)?)[ ]*(?P<unit>[a-zµμ\"]*)",
    re.IGNORECASE,
)
_THOUSANDS: Final = re.compile(r"[1-9]\d{0,2},\d{3}")
_FINISHES: Final = (1e-10, 2e-4)  # m
_RMS_BETWEEN_PLACES: Final = (1 / 1.2, 1.2)  # two standard deviations of 10 %


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
    """Standard deviation of the logarithm of a quantity of which a range holds 95 of 100. []"""
    return log(high / low) / 4


def height_from_roughness_average(*, roughness_average: float) -> StatedHeight:
    """Root mean square height of a surface by its Ra."""
    found = surfaces.rms_height_from_roughness_average(arithmetic_mean_height=roughness_average)
    return _stated(found, f"Ra {format_si(roughness_average, 'm')}")


def height_from_maximum_height(*, maximum_height: float) -> StatedHeight:
    """Root mean square height of a surface by its Rz."""
    found = surfaces.rms_height_from_maximum_height(mean_section_height=maximum_height)
    return _stated(found, f"Rz {format_si(maximum_height, 'm')}")


def height_of_finish(text: str) -> StatedHeight:
    """Root mean square height of a surface by its process, its ISO grade or both, or by Ra, Rz or Rq."""
    number = _NUMBER.fullmatch(text.strip())
    if number is not None:
        return _height_of_number(text.strip(), **number.groupdict(default=""))
    finish = _finish(text)
    low, high = finish.roughness_average_low, finish.roughness_average_high
    found = surfaces.rms_height_from_roughness_average(arithmetic_mean_height=finish.arithmetic_mean_height)
    stated = f"{finish.title}, Ra {format_si(low, 'm')} to {format_si(high, 'm')} by {finish.source}"
    return _stated(found, stated, deviation=deviation_of_range(low, high))


def _finish(text: str) -> surfaces.SurfaceFinish:
    """Process, a grade or both; refuse others with the forms that are read."""
    try:
        return surfaces.surface_finish(text)
    except (InvalidInput, UnknownName) as refusal:
        raise type(refusal)(f"{str(refusal).partition('; known:')[0]}; {FINISH_FORMS}") from None


def is_roughness(text: str) -> bool:
    """Whether a finish is stated as a number, such as "Ra 0.4" or "0.4um"."""
    return _NUMBER.fullmatch(text.strip()) is not None


def _height_of_number(text: str, *, process: str, parameter: str, number: str, unit: str) -> StatedHeight:
    """Height by Ra, Rz or Rq, with what was assumed in reading it."""
    if process:
        _finish(process)
    if _THOUSANDS.fullmatch(number):
        raise InvalidInput(f"surface finish {text!r} may mean two numbers; write it without a comma")
    assumed = "" if parameter else "read as Ra"
    if not unit:
        if not parameter:
            raise InvalidInput(f"surface finish {text!r} has neither a unit nor Ra, Rz or Rq; {FINISH_FORMS}")
        unit, assumed = "um", "um assumed"
    height = to_si(f"{number.replace(',', '.')} {unit}", unit="m", name="surface finish")
    low, high = _FINISHES
    if not low <= height <= high:
        raise InvalidInput(
            f"surface finish {text!r} lies beyond any finish: expected {format_si(low, 'm')} to {format_si(high, 'm')}"
        )
    said = f"stated as {text!r}" + f", {assumed}" * bool(assumed)
    if parameter.lower() in ("rq", "sq", "rms"):
        deviation = deviation_of_range(*_RMS_BETWEEN_PLACES)
        return StatedHeight(
            rms_height=height, factor=exp(deviation), reason=f"Rq {format_si(height, 'm')}, {said}; 10 % between places"
        )
    named = (
        height_from_maximum_height(maximum_height=height)
        if parameter.lower() == "rz"
        else height_from_roughness_average(roughness_average=height)
    )
    relation = named.reason.partition("; ")[2]
    letter = "Rz" if parameter.lower() == "rz" else "Ra"
    return replace(named, reason=f"from {letter} {format_si(height, 'm')}, {said}; {relation}")


def _stated(found: surfaces.RmsHeightEstimate, stated: str, *, deviation: float = 0.0) -> StatedHeight:
    """Height with the spread of the relation and that of what was stated."""
    return StatedHeight(
        rms_height=found.rms_height,
        factor=exp(hypot(deviation, deviation_of_range(found.low, found.high))),
        reason=f"from {stated}; {found.source}",
    )
