"""Actuators one can buy, as their data sheets describe them, and the stacks they make in a rig."""

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files
from pathlib import Path
from types import MappingProxyType
from typing import Any

from sonolube.actuator.stack import PiezoStack
from sonolube.checks import require_finite, require_positive
from sonolube.errors import InvalidInput, MissingProperty, UnknownName

ACTUATOR_KINDS = ("stack", "flextensional")
"""What an actuator of the catalogue can be."""


@dataclass(frozen=True, kw_only=True, slots=True)
class CatalogueActuator:
    """One actuator as its data sheet prints it; what the sheet does not print is None.

    Parameters
    ----------
    name : str
        Its name in commands and rig files, such as "sa050510".
    title : str
        Maker, type and size.
    kind : str
        "stack" or "flextensional".
    source : str
        Where the numbers were read.
    stroke : float
        Stroke with both ends free, well below resonance. [m]
    stroke_voltage : float
        Change of voltage that gives it. [V]
    free_capacitance : float
        Capacitance with both ends free, at small signals. [F]
    resonance_frequency : float
        Lowest resonance with both ends free. [Hz]
    blocked_force : float or None
        Force on held ends for the same change of voltage. [N]
    actuator_mass : float or None
        Mass of the whole. [kg]
    lowest_voltage : float or None
        Lowest voltage it bears. [V]
    highest_voltage : float or None
        Highest voltage it bears. [V]
    tension_limit : float or None
        Most it may be pulled without preload. [N]
    preload_limit : float or None
        Most it may be pressed at rest. [N]
    note : str
        What else to know of it, such as numbers of the sheet that disagree.

    Raises
    ------
    InvalidInput
        If a number is not positive, the limits of the voltage are in the wrong order, or the kind is unknown.
    """

    name: str
    title: str
    kind: str
    source: str
    stroke: float
    stroke_voltage: float
    free_capacitance: float
    resonance_frequency: float
    blocked_force: float | None = None
    actuator_mass: float | None = None
    lowest_voltage: float | None = None
    highest_voltage: float | None = None
    tension_limit: float | None = None
    preload_limit: float | None = None
    note: str = ""

    def __post_init__(self) -> None:
        names = ("stroke", "stroke_voltage", "free_capacitance", "resonance_frequency", "blocked_force")
        limits = ("actuator_mass", "tension_limit", "preload_limit")
        require_positive(**{name: getattr(self, name) for name in (*names, *limits) if getattr(self, name) is not None})
        low, high = self.lowest_voltage, self.highest_voltage
        require_finite(lowest_voltage=low or 0.0, highest_voltage=high or 0.0)
        if low is not None and high is not None and low >= high:
            raise InvalidInput(f"lowest_voltage must lie below highest_voltage, {high!r} V, got {low!r} V")
        if self.kind not in ACTUATOR_KINDS:
            raise UnknownName.among(ACTUATOR_KINDS, kind="kind of actuator", name=self.kind)

    @property
    def complete(self) -> bool:
        """Whether the sheet says enough to compute with."""
        return self.blocked_force is not None

    @property
    def stiffness(self) -> float:
        """Stiffness between the ends, short-circuited: blocked force over stroke, in N/m.

        Raises
        ------
        MissingProperty
            If the sheet prints no blocked force.
        """
        if self.blocked_force is None:
            raise MissingProperty(
                f"{self.name}: its source prints no blocked_force; give the maker's in a catalogue file"
            )
        return self.blocked_force / self.stroke

    @property
    def moving_mass(self) -> float:
        """Mass as printed, or else as the resonance and the stiffness imply it, in kg.

        A bar with free ends resonates at half the root of stiffness over mass; an amplified one, whose ends move and
        whose frame bends, has at its ends what the stiffness carries at the resonance.
        """
        if self.actuator_mass is not None:
            return self.actuator_mass
        turn = 2 if self.kind == "stack" else 2 * math.pi
        return self.stiffness / (turn * self.resonance_frequency) ** 2


def catalogue_names() -> tuple[str, ...]:
    """Return the names of all actuators of the house's own catalogue, in order of the alphabet."""
    return tuple(sorted(_own()))


def catalogue_actuator(name: str) -> CatalogueActuator:
    """Return the actuator of this name.

    Raises
    ------
    UnknownName
        If there is none.
    """
    try:
        return _own()[name]
    except KeyError:
        raise UnknownName.among(_own(), kind="actuator", name=name) from None


def read_catalogue(path: str | Path) -> Mapping[str, CatalogueActuator]:
    """Return the actuators of a file laid out as the house's own: a table to an actuator, numbers in SI.

    Parameters
    ----------
    path : str or Path
        TOML, with a table `sources` of citations by the words that the entries' `source` uses.

    Returns
    -------
    mapping of str to CatalogueActuator

    Raises
    ------
    InvalidInput
        In one line that names the file and the entry.
    """
    try:
        found = _actuators(Path(path).read_text(encoding="utf-8-sig"))
    except (OSError, UnicodeDecodeError) as failure:
        raise InvalidInput(f"{path}: cannot be read: {getattr(failure, 'strerror', None) or failure}") from None
    except (tomllib.TOMLDecodeError, InvalidInput, UnknownName) as failure:
        raise InvalidInput(f"{path}: {failure}") from None
    if not found:
        raise InvalidInput(f"{path}: holds no actuator")
    return found


def catalogue_stack(
    actuator: CatalogueActuator,
    *,
    frequency: float,
    mechanical_quality_factor: float,
    preload: float | None = None,
) -> PiezoStack:
    """Return the stack that acts between its ends as the actuator does.

    Parameters
    ----------
    actuator : CatalogueActuator
    frequency : float
        Frequency at which the stack is to lose what its quality factor says. [Hz]
    mechanical_quality_factor : float
        Quality factor of its material; sheets do not print it, data of ceramics do. []
    preload : float or None
        Compression at rest. [N]

    Returns
    -------
    PiezoStack
        Its whole mass is counted with the body behind it.

    Raises
    ------
    InvalidInput
        If frequency or quality factor is not positive, the preload more than the sheet allows, or the sheet's numbers
        imply more energy out than in.
    MissingProperty
        If the sheet prints no blocked force.

    Notes
    -----
    Stroke, force and capacitance are those of the sheet, though the first two belong to large signals and the last to
    small ones: within a third of what a drive of some volts finds. Damping is k_p/(2 pi f Q), as of a material whose
    loss does not depend on frequency.
    """
    quality = float(require_positive(mechanical_quality_factor=mechanical_quality_factor))
    f = float(require_positive(frequency=frequency))
    if preload is not None and actuator.preload_limit is not None and preload > actuator.preload_limit:
        raise InvalidInput(
            f"preload must not exceed {actuator.preload_limit:g} N, which {actuator.name} bears, got {preload:g} N"
        )
    return PiezoStack(
        free_capacitance=actuator.free_capacitance,
        free_stroke_per_volt=actuator.stroke / actuator.stroke_voltage,
        stack_stiffness=actuator.stiffness,
        stack_damping=actuator.stiffness / (2 * math.pi * f * quality),
        stack_mass=actuator.moving_mass,
        lowest_voltage=actuator.lowest_voltage,
        highest_voltage=actuator.highest_voltage,
        preload=preload,
    )


@cache
def _own() -> Mapping[str, CatalogueActuator]:
    return _actuators(files("sonolube.actuator").joinpath("catalogue.toml").read_text(encoding="utf-8"))


def _actuators(text: str) -> Mapping[str, CatalogueActuator]:
    content = tomllib.loads(text)
    sources = content.pop("sources", {})
    return MappingProxyType({name: _actuator(name, entry, sources) for name, entry in content.items()})


def _actuator(name: str, entry: Any, sources: Mapping[str, str]) -> CatalogueActuator:
    if not isinstance(entry, dict):
        raise InvalidInput(f"{name}: must be a table")
    known = set(CatalogueActuator.__dataclass_fields__) - {"name"}
    if unknown := sorted(set(entry) - known):
        raise UnknownName.among(known, kind=f"entry of {name}", name=unknown[0])
    needed = ("title", "kind", "source", "stroke", "stroke_voltage", "free_capacitance", "resonance_frequency")
    if missing := [key for key in needed if key not in entry]:
        raise InvalidInput(f"{name}.{missing[0]}: missing")
    try:
        found = CatalogueActuator(name=name, **entry)
    except (InvalidInput, UnknownName) as refusal:
        raise InvalidInput(f"{name}: {refusal}") from None
    return replace(found, source=sources.get(found.source, found.source))
