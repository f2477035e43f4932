"""Design space: actuators, waveforms, drive frequencies and entries of the structure, and the rig of a candidate."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType

from sonolube.checks import require_positive
from sonolube.design.optimisation.requirements import NOMINAL, Deviation
from sonolube.errors import InvalidInput, UnknownName
from sonolube.models.actuator import CatalogueActuator, PiezoStack, PreloadBolt, bolted_stack, catalogue_stack
from sonolube.models.dynamics import Structure, chain_structure, pin_on_disc_chain
from sonolube.rig.driven_rig import DrivenRig

OWN_ACTUATOR = "own"
"""Name that stands for the rig's own actuator."""

Range = tuple[float, float]
"""Lowest and highest value of a design variable."""


@dataclass(frozen=True, kw_only=True)
class DesignSpace:
    """Design variables of a rig with their ranges; everything else is kept.

    Parameters
    ----------
    rig : DrivenRig
    entries : mapping of str to float
        Entries of its table `structure`, in SI.
    frequencies : pair of float
        Lowest and highest drive frequency, in Hz.
    ranges : mapping of str to pair of float
        Lowest and highest value of each entry of `structure` that is a design variable, in SI.
    actuators : tuple of str
        Names of the catalogue, or "own" for the rig's own stack.
    waveforms : tuple of str
        Waveforms of the drive voltage.
    catalogue : mapping of str to CatalogueActuator
        Actuators by name.
    mechanical_quality_factor : float
        Quality factor assumed for the catalogue's ceramics, which data sheets do not state. []
    bolt : PreloadBolt or None
        Bolt that preloads the stack, and adds its stiffness.

    Raises
    ------
    InvalidInput
        If a range does not increase from above zero.
    UnknownName
        If a range is of no entry of the structure, or an actuator is not in the catalogue.
    """

    rig: DrivenRig
    entries: Mapping[str, float]
    frequencies: Range
    ranges: Mapping[str, Range] = field(default_factory=lambda: MappingProxyType({}))
    actuators: tuple[str, ...] = (OWN_ACTUATOR,)
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
                raise InvalidInput(f"{name}: a range must increase from above 0, got {low:g} to {high:g}")
        for name in self.actuators:
            if name != OWN_ACTUATOR and name not in self.catalogue:
                raise UnknownName.among((OWN_ACTUATOR, *self.catalogue), kind="actuator", name=name)

    @cached_property
    def bounds(self) -> dict[str, Range]:
        """Ranges of all continuous design variables: the frequency, then the entries of the structure."""
        return {"frequency": self.frequencies, **self.ranges}


@dataclass(frozen=True, kw_only=True, slots=True)
class Candidate:
    """One choice of actuator, waveform and structure; frequency and voltage are open.

    Parameters
    ----------
    actuator : str
        Name in the catalogue, or "own".
    waveform : str
        Waveform of the drive voltage.
    entries : mapping of str to float
        Values of the entries of the structure that are design variables, in SI.
    """

    actuator: str
    waveform: str
    entries: Mapping[str, float]


def candidate_stack(space: DesignSpace, actuator: str) -> PiezoStack:
    """Piezoelectric stack of an actuator, with the preload bolt in parallel.

    Parameters
    ----------
    space : DesignSpace
    actuator : str
        Name in the catalogue, or "own".

    Returns
    -------
    PiezoStack
        For a catalogue actuator with the damping of its quality factor at the centre of the frequency range.

    Raises
    ------
    InvalidInput
        If the bolt's preload exceeds what the actuator admits.
    MissingProperty
        If the data sheet lacks a property.
    """
    if actuator == OWN_ACTUATOR:
        stack = space.rig.stack
    else:
        stack = catalogue_stack(
            space.catalogue[actuator],
            frequency=sum(space.frequencies) / 2,
            mechanical_quality_factor=space.mechanical_quality_factor,
            preload=None if space.bolt is None else space.bolt.preload,
        )
    return stack if space.bolt is None else bolted_stack(stack, space.bolt)


def candidate_structure(
    space: DesignSpace, stack: PiezoStack, entries: Mapping[str, float], deviation: Deviation = NOMINAL
) -> tuple[PiezoStack, Structure]:
    r"""Stack and structure of a candidate with a manufacturing deviation.

    Parameters
    ----------
    space : DesignSpace
    stack : PiezoStack
        Nominal stack.
    entries : mapping of str to float
        Entries of the structure that replace those of the rig, in SI.
    deviation : Deviation

    Returns
    -------
    tuple of PiezoStack and Structure

    Notes
    -----
    With the factors :math:`\kappa` of stiffness, :math:`\mu` of masses and :math:`\gamma` of gain,

    .. math::

        k_p \to \kappa k_p, \quad N d_{33} \to \frac{\gamma}{\sqrt\kappa} N d_{33}, \quad
        c \to \frac{c}{\gamma}, \quad m \to \mu m

    so that the stiffness alone leaves the coupling factor :math:`k^2 = (N d_{33})^2 k_p / C` unchanged.
    """
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


def candidate_rig(space: DesignSpace, candidate: Candidate, deviation: Deviation = NOMINAL) -> DrivenRig:
    """Rig of a candidate with a manufacturing deviation, at the frequency and voltage of the original rig.

    Parameters
    ----------
    space : DesignSpace
    candidate : Candidate
    deviation : Deviation

    Returns
    -------
    DrivenRig

    Raises
    ------
    InvalidInput
        If the actuator cannot be used with the bolt.
    MissingProperty
        If the data sheet of the actuator lacks a property.
    """
    stack, structure = candidate_structure(
        space, candidate_stack(space, candidate.actuator), candidate.entries, deviation
    )
    drive = space.rig.drive
    if candidate.waveform != "sampled":
        drive = replace(drive, waveform=candidate.waveform, waveform_samples=None)
    return replace(
        space.rig,
        stack=stack,
        structure=structure,
        drive=drive,
        capacitance=stack.free_capacitance,
        amplitude_source="computed",  # a measured amplitude is of another design
    )
