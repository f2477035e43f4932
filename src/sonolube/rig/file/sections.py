"""Sections of a rig file: tables and keys, with the checks between keys."""

from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Literal, Self

from pydantic import Field, create_model, field_validator, model_validator

from sonolube.contact import ASPERITY_LAWS, HEIGHT_DISTRIBUTIONS
from sonolube.friction.models import FRICTION_MODELS
from sonolube.rig.file.section import NameIn, Section
from sonolube.rig.file.structures import StructureSection
from sonolube.rig.record import AmplitudeSource
from sonolube.vocabulary import Quantity

Text = Annotated[str, Field(min_length=1, max_length=1000)]


class RoughnessSection(Section):
    """Combined roughness of both surfaces."""

    rms_height: float
    summit_radius: float
    summit_density: float


class BodySection(Section):
    """One body: a material of the catalogue, its own properties, or a material with some properties replaced."""

    material: Text | None = None
    youngs_modulus: float | None = None
    poisson_ratio: float | None = None
    yield_strength: float | None = None


class PairSection(Section):
    """Both bodies together, where only their combined properties are known."""

    effective_modulus: float
    poisson_ratio: float
    yield_strength: float


class ContactSection(Section):
    """The contact: its load, its bodies and their roughness."""

    normal_load: float
    nominal_area: float
    roughness: RoughnessSection
    softer: BodySection | None = None
    harder: BodySection | None = None
    pair: PairSection | None = None
    height_distribution: Annotated[str, NameIn(HEIGHT_DISTRIBUTIONS)] = "exponential"
    asperity_law: Annotated[str, NameIn(ASPERITY_LAWS)] = "chang_etsion_bogy"

    @model_validator(mode="after")
    def _one_description_of_the_bodies(self) -> Self:
        both_bodies = self.softer is not None and self.harder is not None
        any_body = self.softer is not None or self.harder is not None
        if both_bodies == (self.pair is not None) or any_body != both_bodies:
            raise ValueError("give either both tables contact.softer and contact.harder, or the table contact.pair")
        return self


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

    @model_validator(mode="after")
    def _parameters_of_the_model(self) -> Self:
        own = {each.name for each in FRICTION_MODELS[self.model].parameters()}
        for key, models in _MODELS_BY_PARAMETER.items():
            if getattr(self, key) is not None and key not in own:
                others = " and ".join(models) + (" does" if len(models) == 1 else " do")
                raise ValueError(f"friction.{key}: model {self.model} does not take it; {others}")
        if getattr(self, "in_plane_phase", None) is not None and not getattr(self, "in_plane_fraction", None):
            raise ValueError("friction.in_plane_phase: needs friction.in_plane_fraction, the size of that motion")
        return self

    def model_parameters(self) -> dict[str, float]:
        """Return the parameters of the model that the file gives, in SI."""
        given = {key: getattr(self, key) for key in _MODELS_BY_PARAMETER}
        return {key: value for key, value in given.items() if value is not None}


def _parameters() -> tuple[dict[str, Quantity], dict[str, list[str]]]:
    """Return the quantity of every parameter of a friction model, and the models that take it, by key."""
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


class DriveSection(Section):
    """Voltage on the actuator, with its ramp at switch-on."""

    voltage_peak_to_peak: float | None = None
    voltage_offset: float = 0.0
    frequency: float
    waveform: Literal["sine", "square", "triangle", "sawtooth", "sampled"] = "sine"
    waveform_samples: list[float] | None = None
    ramp_duration: float = 0.0
    ramp_shape: Literal["linear", "cosine"] = "linear"


class ActuatorSection(Section):
    """Amplitude and capacitance of an actuator."""

    capacitance: float | None = None
    amplitude_per_volt: float | None = None


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


class WaveguideSection(Section):
    """A half-wave bar whose lateral contraction vibrates the contact."""

    length: float
    thickness: float
    poisson_ratio: float
    axial_amplitude: float
    position: float = 0.0


class VibrationSection(Section):
    """Vibration normal to the contact as measured, with drive and load of the measurement, and the source to take."""

    vibration_amplitude: float | None = None
    voltage_peak_to_peak: float | None = None
    frequency: float | None = None
    normal_load: float | None = None
    amplitude_source: AmplitudeSource | None = None

    @model_validator(mode="after")
    def _conditions_of_a_measurement(self) -> Self:
        conditions = (self.voltage_peak_to_peak, self.frequency, self.normal_load)
        if self.vibration_amplitude is None and any(value is not None for value in conditions):
            raise ValueError("drive and load of a measurement need vibration_amplitude")
        return self


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

    @model_validator(mode="after")
    def _source_of_vibration(self) -> Self:
        per_volt = self.actuator is not None and self.actuator.amplitude_per_volt is not None
        if per_volt and (self.drive is None or self.drive.voltage_peak_to_peak is None):
            raise ValueError("actuator.amplitude_per_volt needs drive.voltage_peak_to_peak")
        measured = self.vibration is not None and self.vibration.vibration_amplitude is not None
        if not (per_volt or measured or self.waveguide or self.structure):
            raise ValueError(
                "no vibration: give vibration.vibration_amplitude, actuator.amplitude_per_volt, the table waveguide or"
                " the tables stack and structure"
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
    def _structure_with_its_stack(self) -> Self:
        if (self.stack is None) != (self.structure is None):
            raise ValueError("the tables stack and structure belong together: give both or neither")
        if self.structure is not None and (self.drive is None or self.drive.voltage_peak_to_peak is None):
            raise ValueError("the table structure needs drive.frequency and drive.voltage_peak_to_peak")
        return self
