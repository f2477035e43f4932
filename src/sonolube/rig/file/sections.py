"""Sections of a rig file: tables and keys, with the checks between keys."""

import re
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal, Self

from pydantic import Field, create_model, field_validator, model_validator

from sonolube.checks import require_non_negative, require_positive
from sonolube.errors import InvalidInput, UnknownName
from sonolube.facts.materials import material
from sonolube.models.actuator import PiezoStack
from sonolube.models.actuator.drive import Drive
from sonolube.models.dynamics.waveform import sampled_waveform
from sonolube.models.friction.models import FRICTION_MODELS, FrictionModel
from sonolube.rig.file.contact_section import ContactSection, Text
from sonolube.rig.file.section import NameIn, Section
from sonolube.rig.file.structures import StructureSection
from sonolube.rig.record import AmplitudeSource, MeasuredUnder, check_stated
from sonolube.rig.vibration_direction import NORMAL, DirectionWord, SecondWord, VibrationDirection
from sonolube.rig.voltage_calibration import VoltageCalibration, voltage_calibration
from sonolube.vocabulary import Quantity


class FrictionKeys(Section):
    """Friction without vibration, and the model of friction under vibration with its parameters."""

    friction_coefficient: float
    model: Annotated[
        str,
        NameIn(FRICTION_MODELS),
        Field(
            description="Model of friction under vibration",
            json_schema_extra={"x-sources": {name: model.citation for name, model in FRICTION_MODELS.items()}},
        ),
    ] = "asperity_stick_slip"

    def require_possible(self) -> None:
        """Refuse a coefficient that is not positive, and parameters of other models than the one chosen."""
        require_positive(friction_coefficient=self.friction_coefficient)
        own = {each.name for each in FRICTION_MODELS[self.model].parameters()}
        for key, models in _MODELS_BY_PARAMETER.items():
            if getattr(self, key) is not None and key not in own:
                others = " and ".join(models) + (" does" if len(models) == 1 else " do")
                raise InvalidInput(f"friction.{key}: model {self.model} does not take it; {others}")
        if getattr(self, "in_plane_phase", None) is not None and not getattr(self, "in_plane_fraction", None):
            raise InvalidInput("friction.in_plane_phase: needs friction.in_plane_fraction, the size of that motion")
        self.friction_model()

    def friction_model(self) -> FrictionModel:
        """Model with the parameters that the file gives."""
        given = {key: getattr(self, key) for key in _MODELS_BY_PARAMETER}
        return FRICTION_MODELS[self.model](**{key: value for key, value in given.items() if value is not None})


def _parameters() -> tuple[dict[str, Quantity], dict[str, list[str]]]:
    """Quantity of every parameter of a friction model, and the models that take it, by key."""
    keys: dict[str, Quantity] = {}
    models: dict[str, list[str]] = {}
    for name, model in FRICTION_MODELS.items():
        for each in model.parameters():
            keys.setdefault(each.name, Quantity(name=each.name, symbol="", unit=each.unit, meaning=each.meaning))
            models.setdefault(each.name, []).append(name)
    taken = {key: f"{known.meaning} ({', '.join(models[key])})" for key, known in keys.items()}
    return {key: replace(known, meaning=taken[key]) for key, known in keys.items()}, models


_QUANTITY_BY_PARAMETER, _MODELS_BY_PARAMETER = _parameters()

if TYPE_CHECKING:

    class FrictionSection(FrictionKeys):
        """The table `friction`: its keys, and one for every parameter of every friction model."""

else:
    FrictionSection = create_model(
        "FrictionSection",
        __base__=FrictionKeys,
        __doc__=FrictionKeys.__doc__,
        **{key: (Annotated[float | None, known], None) for key, known in _QUANTITY_BY_PARAMETER.items()},
    )


class SlidingSection(Section):
    """The macroscopic motion."""

    sliding_speed: float

    def require_possible(self) -> None:
        """Refuse a negative speed."""
        require_non_negative(sliding_speed=self.sliding_speed)


class DriveSection(Section):
    """Voltage on the actuator, with its ramp at switch-on."""

    voltage_peak_to_peak: float | None = None
    voltage_offset: float = 0.0
    frequency: float
    waveform: Literal["sine", "square", "triangle", "sawtooth", "sampled"] = "sine"
    waveform_samples: list[float] | None = None
    ramp_duration: float = 0.0
    ramp_shape: Literal["linear", "cosine"] = "linear"

    def require_possible(self) -> None:
        """Refuse voltages, frequencies, ramps and samples that no drive has."""
        self.drive()
        if self.waveform_samples is not None:
            sampled_waveform(self.waveform_samples)

    def drive(self) -> Drive:
        """Drive."""
        return Drive(**self.model_dump())


class ActuatorSection(Section):
    """Amplitude and capacitance of an actuator."""

    capacitance: float | None = None
    amplitude_per_volt: float | None = None

    def require_possible(self) -> None:
        """Refuse a capacitance that is not positive and a negative amplitude."""
        check_stated(require_positive, self, "capacitance")
        check_stated(require_non_negative, self, "amplitude_per_volt")


class StackSection(Section):
    """The piezoelectric stack."""

    free_capacitance: float
    free_stroke_per_volt: float
    stack_stiffness: float
    stack_damping: float
    stack_mass: float = 0.0
    lowest_voltage: float | None = None
    highest_voltage: float | None = None
    preload: float | None = None
    coupling_factor: float | None = None

    def require_possible(self) -> None:
        """Refuse constants that no stack has."""
        self.stack()

    def stack(self) -> PiezoStack:
        """Stack."""
        return PiezoStack(**self.model_dump())


class WaveguideSection(Section):
    """A half-wave bar whose lateral contraction vibrates the contact."""

    length: float
    thickness: float
    poisson_ratio: float
    axial_amplitude: float
    position: float = 0.0


_ANGLE: Final = re.compile(r"\s*[-+.\d]")


class VibrationSection(Section):
    """Vibration as measured, with drive and load of the measurement, the source to take, and the direction."""

    vibration_amplitude: float | None = None
    voltage_peak_to_peak: float | None = None
    frequency: float | None = None
    normal_load: float | None = None
    calibration: Text | None = Field(
        default=None,
        description='Drive voltage, peak to peak, and the amplitude that it gives, taken as linear: "25 V = 2 um"',
    )
    amplitude_source: AmplitudeSource | None = None
    direction: DirectionWord | None = Field(
        default=None, description='Direction of the vibration, which its amplitude is of; "normal" where absent'
    )
    vibrating_body: Literal["pin", "disc"] | None = Field(
        default=None,
        description='Body that vibrates, for sentences and drawings alone; "pin", the upper one, where absent',
    )
    vibration_direction: float | None = None
    torsion_radius: float | None = None
    second_direction: SecondWord | None = Field(
        default=None, description="Direction of a second component of the vibration, of the same frequency"
    )
    second_amplitude: float | None = None
    second_fraction: float | None = Field(default=None, description="in place of second_amplitude")
    second_phase: float | None = None

    @model_validator(mode="before")
    @classmethod
    def _angle_in_place_of_a_word(cls, content: Any) -> Any:
        """Take an angle that stands for the direction as `vibration_direction`."""
        told = content.get("direction") if isinstance(content, Mapping) else None
        if not isinstance(told, str) or not _ANGLE.match(told) or content.get("vibration_direction") is not None:
            return content
        return {**{key: value for key, value in content.items() if key != "direction"}, "vibration_direction": told}

    def require_possible(self) -> None:
        """Refuse a negative amplitude, conditions of a measurement that is not there or has none, and directions."""
        if self.calibration is not None and self.voltage_peak_to_peak is not None:
            raise InvalidInput("calibration and voltage_peak_to_peak both relate an amplitude to a voltage: give one")
        self.calibrated()
        conditions = (self.voltage_peak_to_peak, self.frequency, self.normal_load)
        if self.vibration_amplitude is None and any(value is not None for value in conditions):
            raise InvalidInput("drive and load of a measurement need vibration_amplitude")
        check_stated(require_non_negative, self, "vibration_amplitude", "second_amplitude", "second_fraction")
        self.measured_under()
        self._require_one_second_component()
        self.path()

    def calibrated(self) -> VoltageCalibration | None:
        """Calibration of the drive; None where there is none."""
        return None if self.calibration is None else voltage_calibration(self.calibration)

    def path(self) -> VibrationDirection:
        """Direction with the second component."""
        if self.direction is not None and self.vibration_direction is not None:
            raise InvalidInput("give either direction or vibration_direction, an angle within the plane, got both")
        return VibrationDirection(
            direction=self.direction or ("normal" if self.vibration_direction is None else "oblique"),
            vibration_direction=self.vibration_direction,
            torsion_radius=self.torsion_radius,
            second_direction=self.second_direction,
            second_fraction=self._second_fraction(),
            second_phase=self.second_phase or 0.0,
        )

    def _second_fraction(self) -> float:
        """Amplitude of the second component over that of the main one."""
        if self.second_amplitude is None:
            return self.second_fraction or 0.0
        return self.second_amplitude / (self.vibration_amplitude or 1.0)

    def _require_one_second_component(self) -> None:
        """Refuse a second component without direction or size, and one of two sizes."""
        sizes = ("second_amplitude", "second_fraction")
        given = [name for name in (*sizes, "second_phase") if getattr(self, name) is not None]
        if given and self.second_direction is None:
            raise InvalidInput(f"{given[0]} is of a second component: give second_direction too")
        if self.second_direction is not None and not {*sizes} & {*given}:
            raise InvalidInput("second_direction needs second_amplitude or second_fraction, the size of that motion")
        if {*sizes} <= {*given}:
            raise InvalidInput("give either second_amplitude or second_fraction, got both")
        if self.second_amplitude is not None and not self.vibration_amplitude:
            raise InvalidInput("second_amplitude needs vibration_amplitude; give second_fraction without one")

    def measured_under(self) -> MeasuredUnder | None:
        """Drive and load of the measurement; None where there is none."""
        if self.vibration_amplitude is None:
            return None
        return MeasuredUnder(**self.model_dump(include={"voltage_peak_to_peak", "frequency", "normal_load"}))


class RigFile(Section):
    """A rig of sonolube."""

    title: Text
    source: Text
    contact: ContactSection
    friction: FrictionSection
    sliding: SlidingSection
    drive: DriveSection | None = None
    actuator: ActuatorSection | None = None
    stack: StackSection | None = None
    structure: StructureSection | None = None
    waveguide: WaveguideSection | None = None
    vibration: VibrationSection | None = None
    assumptions: dict[str, Text] = Field(default_factory=dict)
    uncertainty: dict[str, Text] = Field(
        default_factory=dict,
        description='Distributions by dotted key, such as "contact.normal_load" = "normal 3 %"',
        examples=[{"contact.roughness.rms_height": "normal 0.5 um", "friction.memory_length": "uniform 1 um to 2 um"}],
    )

    @field_validator("uncertainty", mode="before")
    @classmethod
    def _keys_in_quotes(cls, table: object) -> object:
        for key, value in table.items() if isinstance(table, dict) else ():
            if isinstance(value, dict):
                inner = next(iter(value), "normal_load")
                raise ValueError(f'put the whole key in quotes, such as "{key}.{inner}" = "normal 3 %"')
        return table

    @model_validator(mode="before")
    @classmethod
    def _soft_layer_by_default(cls, content: object) -> object:
        if not isinstance(content, dict) or not _names_soft_layer(content):
            return content
        return content | {"friction": {**content["friction"], "model": "soft_layer"}}

    @model_validator(mode="after")
    def _source_of_vibration(self) -> Self:
        per_volt = self.actuator is not None and self.actuator.amplitude_per_volt is not None
        if per_volt and (self.drive is None or self.drive.voltage_peak_to_peak is None):
            raise ValueError("actuator.amplitude_per_volt needs drive.voltage_peak_to_peak")
        measured = self.vibration is not None and self.vibration.vibration_amplitude is not None
        driven = self.drive is not None and self.drive.voltage_peak_to_peak is not None
        if self.vibration is not None and self.vibration.calibration is not None:
            if per_volt:
                raise ValueError("vibration.calibration and actuator.amplitude_per_volt say the same: give one")
            if measured and driven:
                raise ValueError(
                    "vibration.calibration, vibration.vibration_amplitude and drive.voltage_peak_to_peak: two of them"
                    " give the third; leave one out"
                )
            per_volt = driven
        if not (per_volt or measured or self.waveguide or self.structure):
            raise ValueError(
                "no vibration: give vibration.vibration_amplitude, actuator.amplitude_per_volt or vibration.calibration"
                " with drive.voltage_peak_to_peak, the table waveguide or the tables stack and structure"
            )
        named = self.vibration is not None and self.vibration.amplitude_source is not None
        if self.waveguide is not None and self.structure is not None and not named:
            raise ValueError(
                "the tables waveguide and structure both compute the vibration: say which in"
                ' vibration.amplitude_source, "waveguide" or "computed"'
            )
        if self.waveguide is not None and self.drive is None:
            raise ValueError("the table waveguide needs drive.frequency")
        return self

    @model_validator(mode="after")
    def _law_of_direction(self) -> Self:
        path = self.direction()
        model = self.friction.friction_model()
        if not path.is_normal and getattr(model, "in_plane_fraction", None):
            raise ValueError(
                "friction.in_plane_fraction and a direction in the table vibration say the same twice: keep"
                " vibration.second_direction, second_fraction and second_phase"
            )
        if path.is_in_plane and "model" not in self.friction.model_fields_set:
            raise ValueError(
                f"friction.model: missing; of a vibration {path.text} take coulomb, or one of the models with springs,"
                " asperity_stick_slip"
            )
        missing = path.parts - model.directions - {"normal"}
        if missing:
            able = [name for name, each in FRICTION_MODELS.items() if path.parts - {"normal"} <= each.directions]
            raise ValueError(
                f"friction.model: {model.name} has no law for a vibration {' and '.join(sorted(missing))} the"
                f" sliding; take {' or '.join(able)}"
            )
        if path.is_in_plane and self.waveguide is not None:
            raise ValueError(
                "the table waveguide computes a vibration along the normal: leave vibration.direction out, or replace"
                " the table by vibration.vibration_amplitude"
            )
        return self

    def direction(self) -> VibrationDirection:
        """Direction of the vibration, along the normal where the file does not say."""
        return NORMAL if self.vibration is None else self.vibration.path()

    @model_validator(mode="after")
    def _structure_with_its_stack(self) -> Self:
        if (self.stack is None) != (self.structure is None):
            raise ValueError("the tables stack and structure belong together: give both or neither")
        if self.structure is not None and (self.drive is None or self.drive.voltage_peak_to_peak is None):
            raise ValueError("the table structure needs drive.frequency and drive.voltage_peak_to_peak")
        return self


_SOFT_LAYERS = frozenset({"felt", "webbing"})  # families whose friction under vibration is that of a soft layer, D 4.4


def _names_soft_layer(content: dict[str, Any]) -> bool:
    """Whether a file without a friction model has a layer thickness, or felt as a body with a stiffness of its own."""
    friction, contact = content.get("friction"), content.get("contact")
    if not isinstance(friction, dict) or not isinstance(contact, dict) or "model" in friction:
        return False
    if "layer_thickness" in friction:
        return True
    bodies = (contact.get(name) for name in ("softer", "harder"))
    names = {str(body["material"]) for body in bodies if isinstance(body, dict) and "material" in body}
    is_own = "normal_stiffness" in contact or (
        "decay_length" in contact and contact.get("decay_length_origin") != "published_tests"
    )
    return is_own and any(_family(name) in _SOFT_LAYERS for name in names)


def _family(name: str) -> str:
    """Family of a material; empty for an unknown one, which its own section refuses."""
    try:
        return material(name).family
    except UnknownName:
        return ""
