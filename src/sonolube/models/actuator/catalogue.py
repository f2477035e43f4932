"""Catalogue of commercial actuators by their data sheets, and their equivalent stacks."""

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files
from pathlib import Path
from types import MappingProxyType
from typing import Any

from sonolube.checks import require_positive
from sonolube.errors import InvalidInput, MissingProperty, UnknownName
from sonolube.models.actuator.stack import PiezoStack, require_voltage_limits
from sonolube.text.toml_text import read_toml

ACTUATOR_KINDS = ("stack", "flextensional")
"""Kinds of actuators in the catalogue."""


@dataclass(frozen=True, kw_only=True, slots=True)
class CatalogueActuator:
    """Commercial actuator by its data sheet; None stands for values missing there.

    Parameters
    ----------
    name : str
        Name in commands and rig files, such as "sa050510".
    title : str
        Manufacturer, type and size.
    kind : str
        "stack" or "flextensional".
    source : str
        Source of the data.
    stroke : float
        Stroke with both ends free, well below resonance. [m]
    stroke_voltage : float
        Change of voltage for that stroke. [V]
    free_capacitance : float
        Small-signal capacitance with both ends free. [F]
    resonance_frequency : float
        Lowest resonance with both ends free. [Hz]
    blocked_force : float or None
        Force on blocked ends for the same change of voltage. [N]
    actuator_mass : float or None
        Total mass. [kg]
    lowest_voltage : float or None
        Lowest admissible voltage. [V]
    highest_voltage : float or None
        Highest admissible voltage. [V]
    tension_limit : float or None
        Largest admissible tension without preload. [N]
    preload_limit : float or None
        Largest admissible preload. [N]
    note : str
        Remarks, such as inconsistent numbers of the data sheet.

    Raises
    ------
    InvalidInput
        If a number is not positive, or the voltage limits are in the wrong order.
    UnknownName
        If the kind is unknown.
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
        require_voltage_limits(self.lowest_voltage, self.highest_voltage)
        if self.kind not in ACTUATOR_KINDS:
            raise UnknownName.among(ACTUATOR_KINDS, kind="kind of actuator", name=self.kind)

    @property
    def complete(self) -> bool:
        """Whether the data sheet has everything that a computation needs."""
        return self.blocked_force is not None

    @property
    def stiffness(self) -> float:
        """Stiffness between the ends, short-circuited: blocked force over stroke, in N/m.

        Raises
        ------
        MissingProperty
            If the data sheet has no blocked force.
        """
        if self.blocked_force is None:
            raise MissingProperty(
                f"{self.name}: its source prints no blocked_force; give the maker's in a catalogue file"
            )
        return self.blocked_force / self.stroke

    @property
    def moving_mass(self) -> float:
        r"""Mass of the data sheet, or else the one that resonance and stiffness imply, in kg.

        A stack is taken as a uniform bar with free ends, f = sqrt(k/m)/2; a flextensional actuator as its effective
        mass on its stiffness, f = sqrt(k/m)/(2 pi).
        """
        if self.actuator_mass is not None:
            return self.actuator_mass
        factor = 2 if self.kind == "stack" else 2 * math.pi
        return self.stiffness / (factor * self.resonance_frequency) ** 2


def catalogue_names() -> tuple[str, ...]:
    """Names of all actuators of the built-in catalogue, in alphabetical order.

    Returns
    -------
    tuple of str
    """
    return tuple(sorted(_built_in()))


def catalogue_actuator(name: str) -> CatalogueActuator:
    """Actuator of the built-in catalogue by name.

    Parameters
    ----------
    name : str

    Returns
    -------
    CatalogueActuator

    Raises
    ------
    UnknownName
        If there is no such actuator.

    Examples
    --------
    >>> from sonolube.models.actuator import catalogue_actuator
    >>> catalogue_actuator("sa050510").title
    'PiezoDrive SA050510, 5 mm x 5 mm x 10 mm'
    """
    try:
        return _built_in()[name]
    except KeyError:
        raise UnknownName.among(_built_in(), kind="actuator", name=name) from None


def read_catalogue(path: str | Path) -> Mapping[str, CatalogueActuator]:
    """Actuators of a catalogue file in the format of the built-in one: one table per actuator, numbers in SI.

    Parameters
    ----------
    path : str or Path
        TOML file, with a table `sources` of citations by the keys used in the entries' `source`.

    Returns
    -------
    mapping of str to CatalogueActuator

    Raises
    ------
    InvalidInput
        If the file cannot be read or an entry is not valid; the message names file and entry.
    """
    try:
        found = _actuators(read_toml(Path(path), kind="a catalogue"))
    except (InvalidInput, UnknownName) as failure:
        raise InvalidInput(f"{path}: {failure}") from None
    if not found:
        raise InvalidInput(f"{path}: holds no actuator; give each one a table of its own")
    return found


def catalogue_stack(
    actuator: CatalogueActuator, *, frequency: float, mechanical_quality_factor: float, preload: float | None = None
) -> PiezoStack:
    r"""Equivalent stack of a commercial actuator.

    Parameters
    ----------
    actuator : CatalogueActuator
    frequency : float
        Frequency at which the damping corresponds to the quality factor. [Hz]
    mechanical_quality_factor : float
        Quality factor of its material, from the data of the ceramic. []
    preload : float or None
        Compression at rest. [N]

    Returns
    -------
    PiezoStack
        Its whole mass is attributed to the body at its back.

    Raises
    ------
    InvalidInput
        If frequency or quality factor is not positive, the preload above the limit of the data sheet, or its numbers
        imply a coupling factor above one.
    MissingProperty
        If the data sheet has no blocked force.

    Notes
    -----
    Stroke and force of data sheets are large-signal values and the capacitance is a small-signal one, so that they are
    within a third of the values at a drive of some volts. The damping is that of a loss factor independent of
    frequency,

    .. math:: c_p = \frac{k_p}{2\pi f Q}
    """
    quality = float(require_positive(mechanical_quality_factor=mechanical_quality_factor))
    f = float(require_positive(frequency=frequency))
    if preload is not None and actuator.preload_limit is not None and preload > actuator.preload_limit:
        raise InvalidInput(
            f"preload must not exceed {actuator.preload_limit:g} N, the limit of {actuator.name}, got {preload:g} N"
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
def _built_in() -> Mapping[str, CatalogueActuator]:
    """Actuators of the built-in catalogue."""
    text = files("sonolube.models.actuator").joinpath("catalogue.toml").read_text(encoding="utf-8")
    return _actuators(tomllib.loads(text))


def _actuators(content: dict[str, Any]) -> Mapping[str, CatalogueActuator]:
    """Actuators of the content of a catalogue file."""
    sources = content.pop("sources", {})
    if not isinstance(sources, dict):
        raise InvalidInput("sources: must be a table")
    return MappingProxyType({name: _actuator(name, entry, sources) for name, entry in content.items()})


def _actuator(name: str, entry: Any, sources: Mapping[str, str]) -> CatalogueActuator:
    """Actuator of one table, with its source spelled out."""
    if not isinstance(entry, dict):
        raise InvalidInput(f"{name}: must be a table")
    keys = set(CatalogueActuator.__dataclass_fields__) - {"name"}
    if unknown := sorted(set(entry) - keys):
        raise UnknownName.among(keys, kind=f"entry of {name}", name=unknown[0])
    needed = ("title", "kind", "source", "stroke", "stroke_voltage", "free_capacitance", "resonance_frequency")
    if missing := [key for key in needed if key not in entry]:
        raise InvalidInput(f"{name}.{missing[0]}: missing")
    for key in ("title", "kind", "source"):
        if not isinstance(entry[key], str):
            raise InvalidInput(f"{name}.{key}: must be text, got {entry[key]!r}")
    try:
        actuator = CatalogueActuator(name=name, **entry)
    except (InvalidInput, UnknownName) as refusal:
        raise InvalidInput(f"{name}: {refusal}") from None
    return replace(actuator, source=sources.get(actuator.source, actuator.source))
