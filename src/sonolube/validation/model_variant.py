"""Model variants: a model of friction under vibration with its free parameters, required inputs and source.

Contact and vibration are as the experiments state them. Only what was not measured on a rig may vary: nominal area and
yield strength, which only shift the gap at rest so that one factor stands for both; the coefficient of friction within
its scatter; the compliance of the holder; and in-plane motion along the sliding direction. Memory length and amplitude
fraction belong to the friction model and are the same for all rigs, as is the decay length Rq/lambda. Defaults, initial
values and bounds with their reasons are in free_parameters.toml.
"""

import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import lru_cache, partial
from math import inf, isfinite, pi
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, SupportsFloat

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.models.contact import RoughContact, separation
from sonolube.models.friction import FRICTION_MODELS, FrictionModel, MeanGap
from sonolube.models.friction.models.range_check import checked_ratio
from sonolube.rig import Rig, steady_vibration
from sonolube.rig.resolved_rig import resolved_rig
from sonolube.validation.published_tests import Conditions

RIGS: Final = {"tribometer": "ACDEF", "power map": "B", "welder": "G", "flextensional": "H"}
"""Letters of the sets measured on each rig."""


@dataclass(frozen=True, kw_only=True, slots=True)
class FreeParameter:
    """Parameter of a model variant that is fitted to tests.

    Parameters
    ----------
    name : str
        Name; that of the vocabulary for a quantity.
    unit : str
        Unit in reports.
    default : float
        Value where no fitted test determines it, in SI.
    initial_values : tuple of float
        Initial values of the fit, in SI.
    low, high : float
        Physical bounds, in SI.
    reason : str
        Reason for these bounds.
    applicable_sets : str
        Letters of the sets to which it applies; empty for all.
    """

    name: str
    unit: str = ""
    default: float
    initial_values: tuple[float, ...]
    low: float
    high: float
    reason: str
    applicable_sets: str = ""

    def applies_to(self, sets: str) -> bool:
        """Whether the parameter applies to any of the sets of the given letters."""
        return not self.applicable_sets or bool(set(self.applicable_sets) & set(sets))

    @property
    def is_angle(self) -> bool:
        """Whether the parameter is periodic, so that its bounds only limit the search."""
        return self.unit == "rad"


def per_rig(parameters: tuple[FreeParameter, ...], *rigs: str) -> tuple[FreeParameter, ...]:
    """Copy of each parameter for each of the named rigs, specific to that rig."""
    return tuple(replace(parameter, applicable_sets=RIGS[rig]) for rig in rigs for parameter in parameters)


def _parameters() -> dict[str, FreeParameter]:
    """Parameters of the file beside this one, by name."""
    content = tomllib.loads(Path(__file__).with_name("free_parameters.toml").read_text(encoding="utf-8"))
    return {
        name: FreeParameter(name=name, **entry | {"initial_values": tuple(entry["initial_values"])})
        for name, entry in content.items()
    }


_PARAMETERS: Final = _parameters()
MEMORY_LENGTH: Final[FreeParameter] = _PARAMETERS["memory_length"]
IN_PLANE_MOTION: Final = _PARAMETERS["in_plane_fraction"], _PARAMETERS["in_plane_phase"]


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
    """Inputs of conditions as arrays; None where the conditions are on different contacts."""
    contact: Any = getattr(conditions[0], "contact", None)
    if any(getattr(one, "contact", None) is not contact for one in conditions):
        return None
    columns = {name: np.array([getattr(one, name, None) for one in conditions], dtype=np.float64) for name in _COLUMNS}
    return ConditionColumns(contact=contact, **columns)


REQUIRED_INPUTS: Final[Mapping[str, Mapping[str, str]]] = MappingProxyType(
    tomllib.loads(Path(__file__).with_name("required_inputs.toml").read_text(encoding="utf-8"))
)
"""Inputs that a model may require of the conditions: `meaning` in words, and `remedy` where own runs lack one."""

NORMAL_VIBRATION_AND_FRICTION: Final = (
    *("contact", "normal_load", "vibration_amplitude"),
    *("frequency", "sliding_speed", "friction_coefficient"),
)
"""Inputs of a contact that vibrates along the normal, with its friction coefficient without vibration."""

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


def read_variants(path: Path, **ratios: Callable[..., SupportsFloat]) -> tuple[ModelVariant, ...]:
    """Variants of a file, each with one of the functions by its name; with a friction model, that of this model.

    Parameters of single rigs are in the groups of `rig_parameters`; `seen` names the variant with the constant fitted.
    """
    entries = tomllib.loads(path.read_text(encoding="utf-8"))
    seen = {name: entry.pop("seen") for name, entry in entries.items() if "seen" in entry}
    made = {name: _variant(name, ratios[entry.pop("ratio")], **entry) for name, entry in entries.items()}
    for name, sets in seen.items():
        made[name] = replace(made[name], seen=SeenSets(sets["sets"], made[sets["refitted"]]))
    return tuple(made.values())


def _variant(
    name: str,
    ratio: Callable[..., SupportsFloat],
    *,
    parameters: Sequence[str] = (),
    rig_parameters: Sequence[Mapping[str, Sequence[str]]] = (),
    required_inputs: Sequence[str] = NORMAL_VIBRATION_AND_FRICTION,
    friction_model: str = "",
    **others: Any,
) -> ModelVariant:
    """Variant of an entry of a file."""
    model = FRICTION_MODELS[friction_model] if friction_model else None
    own = [_PARAMETERS[each] for each in parameters]
    for group in rig_parameters:
        own += per_rig(tuple(_PARAMETERS[each] for each in group["parameters"]), *group["rigs"])
    return ModelVariant(
        name=name,
        ratio=ratio if model is None else partial(ratio, model),
        parameters=tuple(own),
        required_inputs=tuple(required_inputs),
        friction_model=model,
        **others,
    )


@lru_cache(maxsize=2**16)
def _cached_ratio(
    ratio: Callable[..., SupportsFloat], conditions: Conditions, values: tuple[tuple[str, float], ...]
) -> float | str:
    """Friction ratio, or the reason why the conditions are outside the range of the model."""
    try:
        return float(ratio(conditions, **dict(values)))
    except OutsideRange as reason:
        return str(reason)


_FIELDS_OF_RIG = ("contact", "normal_load", "friction_coefficient", "sliding_speed")


@dataclass(frozen=True, kw_only=True, slots=True)
class VibratedRig:
    """Conditions of a rig at its operating point; unknown ones are None.

    Parameters
    ----------
    label : str
        Name in tables.
    contact : RoughContact
    normal_load : float
        Force pressing the bodies together. [N]
    friction_coefficient : float
        Coefficient of friction without vibration. []
    sliding_speed : float
        Sliding speed during vibration. [m/s]
    vibration_amplitude : float or None
        Amplitude along the surface normal. [m]
    frequency : float or None
        Frequency of the vibration. [Hz]
    in_plane_amplitude : float or None
        Amplitude along the sliding direction. [m]
    vibration_direction : float or None
        Angle between vibration and sliding within the plane. [rad]
    vibration_velocity : float or None
        Peak velocity of the vibration within the plane. [m/s]
    holder_stiffness : float or None
        Stiffness of the holder along the sliding direction. [N/m]
    holder_mass : float or None
        Mass that moves with the holder. [kg]
    """

    label: str
    contact: RoughContact
    normal_load: float
    friction_coefficient: float
    sliding_speed: float
    vibration_amplitude: float | None
    frequency: float | None = None
    in_plane_amplitude: float | None = None
    vibration_direction: float | None = None
    vibration_velocity: float | None = None
    holder_stiffness: float | None = None
    holder_mass: float | None = None

    @property
    def set_name(self) -> str:
        """Letter of no set, to which no rig-specific parameter applies."""
        return "-"


def vibrated_rig(rig: Rig) -> VibratedRig:
    """Conditions of a rig at its operating point."""
    amplitude = steady_vibration(rig).vibration_amplitude
    for name, value in (("vibration_amplitude", amplitude), ("sliding_speed", rig.sliding_speed)):
        if value == 0:
            raise InvalidInput(f"{rig.title}: {name} is 0; models of friction under vibration need it positive")
    stiffness = getattr(rig.friction_model, "holder_stiffness", inf)
    normal, plane, angle = _amplitudes_by_direction(rig, amplitude)
    frequency = None if rig.drive is None else rig.drive.frequency
    return VibratedRig(
        label=rig.title,
        **{name: getattr(rig, name) for name in _FIELDS_OF_RIG},
        vibration_amplitude=normal,
        frequency=frequency,
        in_plane_amplitude=plane if angle == 0.0 else None,
        vibration_direction=angle,
        vibration_velocity=None if plane is None or frequency is None else 2 * pi * frequency * plane,
        holder_stiffness=stiffness if isfinite(stiffness) else None,
    )


def _amplitudes_by_direction(rig: Rig, amplitude: float) -> tuple[float | None, float | None, float | None]:
    """Amplitude along the normal and within the plane, and the angle of the latter to the sliding."""
    direction = resolved_rig(rig).direction
    if direction.is_normal:
        return amplitude, None, None
    if direction.direction == "normal" and direction.second_direction == "along":
        return amplitude, direction.second_fraction * amplitude, 0.0
    if direction.angle is None:
        raise InvalidInput(
            f"{rig.title}: the models compared are of vibration in one direction, but this one is {direction.text};"
            " use friction"
        )
    return None, amplitude, direction.angle
