"""Files of facts for the identification of a rig: TOML tables to an identification problem and its forward model."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any

from pydantic import Field

from sonolube.errors import InvalidInput, UnknownName, suggestion
from sonolube.identification import (
    Conditions,
    Identification,
    identify,
    parametric_structure,
    reference_parameters,
    rig_tables,
)
from sonolube.identification.fact import Bounds, Fact, ForwardModel, Relation, parameter_unit
from sonolube.identification.observables import IdentificationProblem, Observation, observable_unit, structure_model
from sonolube.models.actuator import PiezoStack
from sonolube.models.dynamics import Structure
from sonolube.rig.file.contact_section import Text
from sonolube.rig.file.reader import rig_content, rig_from
from sonolube.rig.file.section import Section, plausible_si
from sonolube.rig.file.sections import RigFile, StackSection
from sonolube.rig.file.structures import ChainSection, ModesSection, PinOnDiscSection
from sonolube.rig.file.toml_file import prefixed, validated
from sonolube.text.toml_text import read_toml
from sonolube.text.units import to_si, unit_description

_MAX_FACTS = 16
_MIN_NUMBER, _LARGEST_NUMBER = 1e-9, 1e9  # of a pure number
_FREE = [
    name
    for section in (PinOnDiscSection, StackSection)
    for name, field in section.model_fields.items()
    if field.annotation is float
]


_CHAIN_ENTRY = re.compile(r"masses\.\w+|springs\.\d+\.spring_stiffness|dampers\.\d+\.viscous_damping")


class ConditionsSection(Section):
    """Conditions of an observation; see `sonolube.identification.Conditions`."""

    frequency: float | None = None
    voltage_peak_to_peak: float | None = None
    normal_load: float | None = None
    decay_length: float | None = None
    observation_time: float | None = None
    added_mass: float | None = None
    added_to: Text | None = None


class FactSection(ConditionsSection):
    """One fact: an observable, its value or limit, tolerance, rank and source, and conditions of its own."""

    observable: Text
    value: str | float
    tolerance: str | float
    rank: Annotated[int, Field(ge=1)]
    relation: Relation = "="
    name: Text | None = None
    meaning: str = ""
    source: Text


class FactsFile(Section):
    """A file of facts about a rig."""

    title: Text
    source: Text
    parameters: Annotated[dict[str, list[str]], Field(min_length=1)]
    conditions: ConditionsSection = ConditionsSection()
    facts: Annotated[list[FactSection], Field(min_length=1, max_length=_MAX_FACTS)]


def read_facts(path: str | Path) -> IdentificationProblem:
    """Identification problem from a TOML file of facts."""
    path = Path(path)
    with prefixed(str(path)):
        return _problem(validated(FactsFile, read_toml(path, kind="a file of facts")))


def rig_forward_model(path: str | Path, problem: IdentificationProblem) -> ForwardModel:
    """Forward model of a rig for the observations of an identification problem.

    See `sonolube.identification.structure_model`.
    """
    stack, structure = _stack_and_structure(path)
    entries = structure.entries()
    for name in problem.bounds:
        if name not in stack and name not in entries:
            raise UnknownName.among([*entries, *stack], kind="entry of the tables structure and stack", name=name)

    def build(parameters: Mapping[str, float]) -> Structure:
        own_stack = {name: parameters.get(name, value) for name, value in stack.items()}
        own_stack["coupling_factor"] = None  # the stated one belongs to the file's stack
        own = {name: value for name, value in parameters.items() if name in entries}
        return structure.with_entries(own).structure(PiezoStack(**own_stack))

    reference = reference_parameters(build, bounds=problem.bounds)
    return structure_model(parametric_structure(build, reference=reference), problem.observations)


def identified_tables(path: str | Path, identification: Identification) -> str:
    """Tables `stack` and `structure` of a rig with identified parameters, as text for `with_tables`.

    TOML, with comments on facts and feasible intervals.
    """
    stack, structure = _stack_and_structure(path)
    return rig_tables(
        identification, PiezoStack(**stack), structure=structure.entries(), structure_lines=structure.lines
    )


def identify_from_facts(
    path: str | Path, facts: str | Path, *, seed: int = 0
) -> tuple[Identification, PiezoStack, str]:
    """Identification of a rig from a file of facts, the rig's stack, and the identified tables.

    The last as `identified_tables`.
    """
    problem = read_facts(facts)
    found = identify(rig_forward_model(path, problem), facts=problem.facts, bounds=problem.bounds, seed=seed)
    return found, PiezoStack(**_stack_and_structure(path)[0]), identified_tables(path, found)


def _stack_and_structure(path: str | Path) -> tuple[dict[str, Any], PinOnDiscSection | ChainSection]:
    """Entries of the table stack and the table structure of a rig's file, checked, in SI."""
    content = rig_content(path)
    with prefixed(str(path)):
        rig_from(content)
        file = RigFile.model_validate(content)
        if file.stack is None or file.structure is None:
            raise InvalidInput("the tables stack and structure are missing; give both to identify their entries")
        if isinstance(file.structure, ModesSection):
            raise InvalidInput('structure.kind: "modes" has no entries to identify; "pin_on_disc" and "chain" have')
        return file.stack.model_dump(), file.structure


def _problem(file: FactsFile) -> IdentificationProblem:
    """Bounds, facts and observations of a checked file, in SI."""
    bounds = {name: _bounds(name, ends) for name, ends in file.parameters.items()}
    names = [section.name or section.observable for section in file.facts]
    for name in names:
        if names.count(name) > 1:
            raise InvalidInput(f"facts: two facts have the name {name}; give one of them a name of its own")
    facts, observations = [], {}
    common = file.conditions.model_dump(exclude_none=True)
    for index, (name, section) in enumerate(zip(names, file.facts, strict=True)):
        with prefixed(f"facts.{index}"):
            own = section.model_dump(include=set(ConditionsSection.model_fields), exclude_none=True)
            observations[name] = Observation(observable=section.observable, conditions=Conditions(**{**common, **own}))
            facts.append(_fact(name, section, bounds))
    return IdentificationProblem(
        facts=tuple(facts),
        observations=MappingProxyType(observations),
        bounds=MappingProxyType(bounds),
        title=file.title,
        source=file.source,
    )


def _fact(name: str, section: FactSection, bounds: Bounds) -> Fact:
    """Fact of one section, in the unit of its observable."""
    try:
        unit = observable_unit(section.observable, bounds)
    except UnknownName as refusal:
        raise InvalidInput(f"observable: {refusal}") from None
    return Fact(
        name=name,
        value=_quantity("value", section.value, unit),
        tolerance=_quantity("tolerance", section.tolerance, unit),
        unit=unit,
        **section.model_dump(include={"rank", "relation", "meaning", "source"}),
    )


def _quantity(key: str, value: str | float, unit: str) -> float:
    """Number in SI from text with a unit; pure numbers, such as quality factors, may stand without quotes."""
    if unit:
        if not isinstance(value, str):
            raise InvalidInput(f"{key} {value!r} has no unit; expected {unit_description(unit)}, in quotes")
        return plausible_si(value, unit=unit, name=key)
    number = to_si(value, unit="", name=key) if isinstance(value, str) else value
    if not _MIN_NUMBER <= number <= _LARGEST_NUMBER:
        raise InvalidInput(f"{key} must lie between {_MIN_NUMBER:g} and {_LARGEST_NUMBER:g}, got {value}")
    return number


def _bounds(name: str, ends: Sequence[str]) -> tuple[float, float]:
    """Lower and upper bound of a free parameter, in SI."""
    if name not in _FREE and not _CHAIN_ENTRY.fullmatch(name):
        close = suggestion(name, _FREE)
        raise InvalidInput(f"parameters.{name}: no entry of the tables structure and stack; {close}".removesuffix("; "))
    if len(ends) != 2:
        raise InvalidInput(f"parameters.{name}: must be a lower and an upper bound, got {len(ends)} values")
    lower, upper = (plausible_si(end, unit=parameter_unit(name), name=f"parameters.{name}") for end in ends)
    if not 0 < lower < upper:
        raise InvalidInput(f"parameters.{name}: bounds must be positive and rise, got {ends[0]} and {ends[1]}")
    return lower, upper
