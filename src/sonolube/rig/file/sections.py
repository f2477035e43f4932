"""Rig files: what a rig looks like as TOML, and the schema of it."""

from typing import Annotated, Literal, Self

from pydantic import Field, field_validator, model_validator

from sonolube.rig.file.section import Section

Text = Annotated[str, Field(min_length=1)]


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
    height_distribution: Literal["exponential", "gaussian"] = "exponential"
    asperity_law: Literal["elastic", "as_published", "corrected", "kogut_etsion", "jackson_green"] = "as_published"

    @model_validator(mode="after")
    def _one_description_of_the_bodies(self) -> Self:
        both_bodies = self.softer is not None and self.harder is not None
        any_body = self.softer is not None or self.harder is not None
        if both_bodies == (self.pair is not None) or any_body != both_bodies:
            raise ValueError("give either both tables contact.softer and contact.harder, or the table contact.pair")
        return self


class FrictionSection(Section):
    """Friction without vibration, and the closure that says what vibration makes of it."""

    friction_coefficient: float
    closure: Literal[
        "as_published", "separating_half_period", "load_balanced", "kinematic", "stick_slip", "coupled"
    ] = "stick_slip"
    memory_length: float | None = None
    in_plane_fraction: float | None = None
    in_plane_phase: float | None = None
    holder_stiffness: float | None = None


class SlidingSection(Section):
    """The macroscopic motion."""

    sliding_speed: float


class DriveSection(Section):
    """The voltage on the actuator, and how it comes up when switched on."""

    voltage_peak_to_peak: float | None = None
    voltage_offset: float = 0.0
    frequency: float
    waveform: Literal["sine", "square", "triangle", "sawtooth", "sampled"] = "sine"
    waveform_samples: list[float] | None = None
    ramp_duration: float = 0.0
    ramp_shape: Literal["linear", "cosine"] = "linear"


class ActuatorSection(Section):
    """What turns voltage into vibration."""

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


class StructureSection(Section):
    """The masses, springs and dampers that the stack drives: tip, reaction mass and arm."""

    tip_mass: float
    reaction_mass: float
    arm_mass: float
    arm_stiffness: float
    arm_damping: float
    tip_damping: float = 0.0


class WaveguideSection(Section):
    """A half-wave bar whose lateral contraction vibrates the contact."""

    length: float
    thickness: float
    poisson_ratio: float
    axial_amplitude: float
    position: float = 0.0


class VibrationSection(Section):
    """Vibration normal to the contact, as measured."""

    vibration_amplitude: float


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
    def _one_source_of_vibration(self) -> Self:
        per_volt = self.actuator is not None and self.actuator.amplitude_per_volt is not None
        if per_volt and (self.drive is None or self.drive.voltage_peak_to_peak is None):
            raise ValueError("actuator.amplitude_per_volt needs drive.voltage_peak_to_peak")
        if [per_volt, self.waveguide is not None, self.vibration is not None].count(True) != 1:
            raise ValueError(
                "give the vibration once: vibration.vibration_amplitude, actuator.amplitude_per_volt or table waveguide"
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
