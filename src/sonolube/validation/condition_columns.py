"""Inputs of many conditions on one contact as arrays, for models that compute all of them at once."""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from sonolube.checks import Floats
from sonolube.models.contact import RoughContact


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ConditionColumns:
    """Inputs of n conditions on one contact; NaN where a condition lacks one.

    Parameters
    ----------
    contact : RoughContact
        That of all; without one, only models without contact can be computed.
    normal_load : ndarray, shape (n,)
        Force pressing the bodies together. [N]
    friction_coefficient : ndarray, shape (n,)
        Coefficient of friction without vibration. []
    sliding_speed : ndarray, shape (n,)
        Sliding speed. [m/s]
    vibration_amplitude : ndarray, shape (n,)
        Amplitude along the surface normal. [m]
    frequency : ndarray, shape (n,)
        Frequency of the vibration. [Hz]
    """

    contact: RoughContact
    normal_load: Floats
    friction_coefficient: Floats
    sliding_speed: Floats
    vibration_amplitude: Floats
    frequency: Floats


_COLUMNS = tuple(field.name for field in fields(ConditionColumns) if field.name != "contact")


def condition_columns(conditions: Sequence[object]) -> ConditionColumns | None:
    """Inputs of conditions as arrays.

    None where the conditions are on different contacts.
    """
    contact: Any = getattr(conditions[0], "contact", None)
    if any(getattr(one, "contact", None) is not contact for one in conditions):
        return None
    columns = {name: np.array([getattr(one, name, None) for one in conditions], dtype=np.float64) for name in _COLUMNS}
    return ConditionColumns(contact=contact, **columns)
