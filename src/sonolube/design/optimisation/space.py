"""What a designer may choose, actuator, waveform, frequency, entries of the structure, and the rig it makes."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType

from sonolube.actuator import CatalogueActuator, PiezoStack, PreloadBolt, bolted_stack, catalogue_stack
from sonolube.checks import require_positive
from sonolube.design.optimisation.tolerance import NOMINAL, Deviation
from sonolube.dynamics import Structure, chain_structure, pin_on_disc_chain
from sonolube.errors import InvalidInput, UnknownName
from sonolube.rig.driven_rig import DrivenRig

OWN = "own"
"""Name of the actuator that the rig has."""

Range = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class DesignSpace:
    """Choices about a rig; all else of it stays.

    Parameters
    ----------
    rig : DrivenRig
        With a stack, a structure and a drive voltage.
    entries : mapping of str to float
        Its table `structure`, in SI.
    frequencies : pair of float
        Lowest and highest frequency of the drive, in Hz.
    ranges : mapping of str to pair of float
        Lowest and highest value of each entry of `structure` that may be chosen, in SI.
    actuators : tuple of str
        Names of the catalogue, or "own" for the rig's own stack.
    waveforms : tuple of str
        Shapes of the drive voltage.
    catalogue : mapping of str to CatalogueActuator
        Actuators by name.
    mechanical_quality_factor : float
        Quality factor of the catalogue's ceramics, which sheets do not print. []
    bolt : PreloadBolt or None
        What presses the stack together; it stiffens it, too.

    Raises
    ------
    InvalidInput
        If a range is none, or an entry none of the structure.
    UnknownName
        If an actuator is in no catalogue.
    """

    rig: DrivenRig
    entries: Mapping[str, float]
    frequencies: Range
    ranges: Mapping[str, Range] = field(default_factory=lambda: MappingProxyType({}))
    actuators: tuple[str, ...] = (OWN,)
    waveforms: tuple[str, ...] = ("sine",)
    catalogue: Mapping[str, CatalogueActuator] = field(default_factory=lambda: MappingProxyType({}))
    mechanical_quality_factor: float = 80.0
    bolt: PreloadBolt | None = None

    def __post_init__(self) -> None:
        require_positive(mechanical_quality_factor=self.mechanical_quality_factor)
        for name, (low, high) in {"frequency": self.frequencies, **self.ranges}.items():
            if name not in ("frequency", *self.entries):
                raise UnknownName.among(self.entries, kind="entry of structure", name=name)
            if not 0 < low < high:
                raise InvalidInput(f"{name}: needs a range from above 0 that rises, got {low:g} to {high:g}")
        for name in self.actuators:
            if name != OWN and name not in self.catalogue:
                raise UnknownName.among((OWN, *self.catalogue), kind="actuator", name=name)

    @cached_property
    def bounds(self) -> dict[str, Range]:
        """Ranges of all numbers to choose: the frequency, then the entries of the structure."""
        return {"frequency": self.frequencies, **self.ranges}


@dataclass(frozen=True, kw_only=True, slots=True)
class Choice:
    """One choice out of a space, without the voltage that it takes.

    Parameters
    ----------
    actuator : str
        Name in the catalogue, or "own".
    waveform : str
        Shape of the drive voltage.
    entries : mapping of str to float
        Entries of the structure that were chosen, in SI.
    """

    actuator: str
    waveform: str
    entries: Mapping[str, float]


def stack_of(space: DesignSpace, actuator: str) -> PiezoStack:
    """Return the stack that an actuator makes, with the bolt that presses it.

    Parameters
    ----------
    space : DesignSpace
    actuator : str
        Name in the catalogue, or "own".

    Returns
    -------
    PiezoStack
        A catalogue's material loses what its quality factor says at the middle of the frequencies.

    Raises
    ------
    InvalidInput
        If the actuator does not bear the bolt's preload.
    MissingProperty
        If its source says too little.
    """
    if actuator == OWN:
        stack = space.rig.stack
    else:
        stack = catalogue_stack(
            space.catalogue[actuator],
            frequency=sum(space.frequencies) / 2,
            mechanical_quality_factor=space.mechanical_quality_factor,
            preload=None if space.bolt is None else space.bolt.preload,
        )
    return stack if space.bolt is None else bolted_stack(stack, space.bolt)


def structure_of(
    space: DesignSpace, stack: PiezoStack, entries: Mapping[str, float], deviation: Deviation = NOMINAL
) -> tuple[PiezoStack, Structure]:
    """Return stack and structure as they are built, off by a deviation."""
    built = replace(
        stack,
        stack_stiffness=stack.stack_stiffness * deviation.stiffness,
        free_stroke_per_volt=stack.free_stroke_per_volt * deviation.gain / deviation.stiffness**0.5,
        stack_damping=stack.stack_damping / deviation.gain,
        coupling_factor=None,
    )
    values = {**space.entries, **entries}
    masses = {name: values[name] * deviation.mass for name in values if name.endswith("_mass")}
    damping = {name: values[name] / deviation.gain for name in ("tip_damping", "arm_damping")}
    return built, chain_structure(pin_on_disc_chain(built, **{**values, **masses, **damping}))


def rig_of(space: DesignSpace, choice: Choice, deviation: Deviation = NOMINAL) -> DrivenRig:
    """Return the rig that a choice makes, its drive's frequency and swing as they were.

    Parameters
    ----------
    space : DesignSpace
    choice : Choice
    deviation : Deviation
        By what it is off.

    Returns
    -------
    DrivenRig
    """
    stack, structure = structure_of(space, stack_of(space, choice.actuator), choice.entries, deviation)
    drive = space.rig.drive
    if choice.waveform != "sampled":
        drive = replace(drive, waveform=choice.waveform, waveform_samples=None)
    return replace(space.rig, stack=stack, structure=structure, drive=drive, capacitance=stack.free_capacitance)
