"""Model variants: a model of friction under vibration with its free parameters, required inputs and source."""

import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, SupportsFloat

import numpy as np

from sonolube.errors import OutsideRange
from sonolube.models.contact import separation
from sonolube.models.friction import FrictionModel, MeanGap
from sonolube.models.friction.models.range_check import checked_ratio
from sonolube.validation.condition_columns import condition_columns
from sonolube.validation.free_parameters import FreeParameter
from sonolube.validation.published_tests import Conditions

REQUIRED_INPUTS: Final[Mapping[str, Mapping[str, str]]] = MappingProxyType(
    tomllib.loads(Path(__file__).with_name("required_inputs.toml").read_text(encoding="utf-8"))
)
"""Inputs that a model may require of the conditions: `meaning` in words, and `remedy` where own runs lack one."""

SINUSOIDAL_VIBRATION: Final = ("vibration_amplitude", "frequency", "sliding_speed")
"""Inputs of a model without contact."""

NORMAL_VIBRATION: Final = ("contact", "normal_load", *SINUSOIDAL_VIBRATION)
"""Inputs of a contact that vibrates along the normal."""

NORMAL_VIBRATION_AND_FRICTION: Final = (*NORMAL_VIBRATION, "friction_coefficient")
"""The same with the friction coefficient without vibration."""

_MIN_TOGETHER: Final = 8  # conditions, from which arrays are worth their making


@dataclass(frozen=True, slots=True)
class SeenSets:
    """Published sets of tests that a constant of a model was taken from.

    Parameters
    ----------
    sets : str
        Their letters.
    refitted : ModelVariant
        The model with that constant fitted, which predicts each of these sets by the others.
    """

    sets: str
    refitted: "ModelVariant"


@dataclass(frozen=True, slots=True)
class ModelVariant:
    """Model of friction under vibration with its free parameters.

    Parameters
    ----------
    name : str
        Name in tables and figures.
    description : str
        Model and free parameters in words.
    ratio : callable
        Function that returns the friction ratio for conditions, and for values of the free parameters by name.
    parameters : tuple of FreeParameter
        Parameters to fit; empty where nothing is fitted.
    required_inputs : tuple of str
        Inputs that the conditions must have, keys of `REQUIRED_INPUTS`.
    source : str
        Publication of the model.
    friction_model : type of FrictionModel, optional
        Friction model of the program whose range of validity the variant has.
    takes_columns : bool
        Whether `ratio` takes `ConditionColumns` too, and then returns the ratios of all conditions.
    seen : SeenSets, optional
        Published tests that a fixed constant was taken from; none where absent.
    """

    name: str
    description: str
    ratio: Callable[..., SupportsFloat]
    parameters: tuple[FreeParameter, ...] = ()
    required_inputs: tuple[str, ...] = NORMAL_VIBRATION_AND_FRICTION
    source: str = "this program"
    friction_model: type[FrictionModel] | None = None
    takes_columns: bool = False
    seen: SeenSets | None = None

    @property
    def seen_constants(self) -> int:
        """Number of fixed constants that were taken from published tests."""
        return 0 if self.seen is None else len(self.seen.refitted.parameters) - len(self.parameters)

    def inapplicability(self, conditions: Conditions) -> str | None:
        """Required inputs that the conditions lack, as a sentence; None if they lack none."""
        missing = [
            REQUIRED_INPUTS[name]["meaning"] for name in self.required_inputs if getattr(conditions, name, None) is None
        ]
        return f"needs {', '.join(missing)}: not known here" if missing else None

    def predict(self, conditions: Conditions, *values: float) -> float | None:
        """Friction ratio for values of the free parameters; None outside the range of the model. []"""
        result = self._evaluate(conditions, values)
        return None if isinstance(result, str) else result

    def predict_all(self, conditions: Sequence[Conditions], *values: float) -> list[float | None]:
        """Predictions for each of several conditions, computed at once where the model can."""
        return self._together(conditions, values) or [self.predict(one, *values) for one in conditions]

    def range_violation(self, conditions: Conditions, *values: float) -> str | None:
        """Reason why the conditions are outside the range of the model; None inside it."""
        result = self._evaluate(conditions, values)
        return result if isinstance(result, str) else None

    def range_objection(self, conditions: Conditions, ratio: float | None) -> str | None:
        """Why a ratio of the formula is beyond what the friction model can mean; None where it is not."""
        if self.friction_model is None or ratio is None:
            return None
        contact, load, amplitude = (
            getattr(conditions, name) for name in ("contact", "normal_load", "vibration_amplitude")
        )
        about_rest = self.friction_model.mean_gap is MeanGap.AT_REST
        closed = about_rest and amplitude >= float(separation(contact, normal_load=load))
        found = checked_ratio(self.friction_model(), ratio, mean_force_ratio=1.0, gap_closed=closed)
        return str(found.reason) or None

    def _together(self, conditions: Sequence[Conditions], values: tuple[float, ...]) -> list[float | None] | None:
        """Friction ratios of conditions at once; None where they have to be computed one by one."""
        if not self.takes_columns or len(conditions) < _MIN_TOGETHER:
            return None
        columns = condition_columns(conditions)
        if columns is None or any(parameter.applicable_sets for parameter in self.parameters):
            return None
        try:
            ratio: Any = self.ratio(columns, **dict(zip((each.name for each in self.parameters), values, strict=True)))
        except OutsideRange:  # of one of them
            return None
        return list(np.broadcast_to(ratio, len(conditions)).tolist())

    def _evaluate(self, conditions: Conditions, values: tuple[float, ...]) -> float | str:
        """Friction ratio, or the reason why the conditions are outside the range of the model."""
        applicable = tuple(
            (parameter.name, value)
            for parameter, value in zip(self.parameters, values, strict=True)
            if parameter.applies_to(conditions.set_name)
        )
        return _cached_ratio(self.ratio, conditions, applicable)


@lru_cache(maxsize=2**16)
def _cached_ratio(
    ratio: Callable[..., SupportsFloat], conditions: Conditions, values: tuple[tuple[str, float], ...]
) -> float | str:
    """Friction ratio, or the reason why the conditions are outside the range of the model."""
    try:
        return float(ratio(conditions, **dict(values)))
    except OutsideRange as reason:
        return str(reason)
