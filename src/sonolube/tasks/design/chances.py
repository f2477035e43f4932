"""Arguments of tasks for a target reduction and the chance with which it is to be reached."""

from typing import Final

from sonolube.errors import InvalidInput
from sonolube.tasks.parameters import Number, Quantity
from sonolube.tasks.task import in_si, shown

TARGET_REDUCTION: Final = Quantity("Reduction of friction whose chance is mapped, such as 80 %.", "", kind="SHARE")
"""Argument for the reduction."""

CONFIDENCE: Final = Quantity("Chance with which it is to be reached, such as 90 %.", "", kind="SHARE")
"""Argument for its chance."""


def target_chance(target_reduction: Number | None, confidence: Number | None) -> tuple[float | None, float | None]:
    """Target reduction and wanted chance as shares, each None where it is not given."""
    target, wanted = in_si("target_reduction", target_reduction), in_si("confidence", confidence)
    if wanted is not None and target is None:
        raise InvalidInput(f"{shown('confidence')} needs {shown('target_reduction')}, the reduction that it is of")
    for name, value in (("target_reduction", target), ("confidence", wanted)):
        if value is not None and not 0 < value < 1:
            raise InvalidInput(f"{shown(name)} must lie between 0 and 100 %, got {100 * value:.4g} %")
    return target, wanted
