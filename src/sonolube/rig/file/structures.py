"""Structures of a rig file: the pin-on-disc chain, any chain of masses, springs and dampers, and modes."""

import json
from collections.abc import Callable, Mapping
from typing import Annotated, Any, Final, Literal, Self

from pydantic import Discriminator, Field, Tag, field_validator, model_validator

from sonolube.errors import InvalidInput
from sonolube.models.actuator import PiezoStack
from sonolube.models.dynamics import Structure, chain
from sonolube.rig.file.section import Section, quantity_in_si

Name = Annotated[str, Field(min_length=1)]
Ends = Annotated[list[Name], Field(min_length=2, max_length=2)]
EntryText = Callable[[str], tuple[str, str]]  # value and comment of an entry, as TOML, by its name


class PinOnDiscSection(Section):
    """Three masses in a line: tip, reaction mass and loading arm, the stack between the first two."""

    kind: Literal["pin_on_disc"] = "pin_on_disc"
    tip_mass: float
    reaction_mass: float
    arm_mass: float
    arm_stiffness: float
    arm_damping: float
    tip_damping: float = 0.0

    def structure(self, stack: PiezoStack) -> Structure:
        """Structure with a stack in it."""
        return chain.chain_structure(chain.pin_on_disc_chain(stack, **self.entries()))

    def entries(self) -> dict[str, float]:
        """Masses, stiffness and damping by key, in SI."""
        return self.model_dump(exclude={"kind"})

    def with_entries(self, values: Mapping[str, float]) -> Self:
        """Section with some of its entries replaced, in SI."""
        return self.model_copy(update=dict(values))

    def lines(self, entry: EntryText) -> list[str]:
        """Table as lines of TOML."""
        return [f"{name} = {''.join(entry(name))}" for name in self.entries()]


class SpringSection(Section):
    """A spring between two masses, or between a mass and the ground."""

    between: Ends
    spring_stiffness: float


class DamperSection(Section):
    """A viscous damper between two masses, or between a mass and the ground."""

    between: Ends
    viscous_damping: float


_ELEMENTS: Final = (
    ("springs", "spring_stiffness"),
    ("dampers", "viscous_damping"),
)  # tables of a chain, by their number


class ChainSection(Section):
    """Any chain of masses, springs and dampers along the normal of the contact, with the stack between two of them."""

    kind: Literal["chain"]
    masses: Annotated[dict[Name, float], Field(min_length=1, description="Mass of each body by name, such as 0.1 kg")]
    springs: list[SpringSection] = Field(default_factory=list)
    dampers: list[DamperSection] = Field(default_factory=list)
    stack_between: Ends
    contact: Name
    loaded: Name | None = Field(default=None, description="Mass that the weights of the dead load hang on")

    @field_validator("masses", mode="before")
    @classmethod
    def _masses_in_kilograms(cls, table: object) -> object:
        if not isinstance(table, dict):
            return table
        return {name: quantity_in_si(value, unit="kg") for name, value in table.items()}

    def entries(self) -> dict[str, float]:
        """Masses, stiffnesses and dampings in SI: "masses.tip", "springs.0.spring_stiffness" and so on."""
        masses = {f"masses.{name}": mass for name, mass in self.masses.items()}
        return masses | {
            f"{table}.{index}.{name}": getattr(each, name)
            for table, name in _ELEMENTS
            for index, each in enumerate(getattr(self, table))
        }

    def with_entries(self, values: Mapping[str, float]) -> Self:
        """Section with some of its entries replaced, in SI."""
        known = {**self.entries(), **values}
        masses = {name: known[f"masses.{name}"] for name in self.masses}
        elements = {
            table: [
                each.model_copy(update={name: known[f"{table}.{index}.{name}"]})
                for index, each in enumerate(getattr(self, table))
            ]
            for table, name in _ELEMENTS
        }
        return self.model_copy(update={"masses": masses, **elements})

    def lines(self, entry: EntryText) -> list[str]:
        """Table as lines of TOML."""

        def elements(table: str, name: str) -> list[str]:
            pairs = enumerate(json.dumps(each.between) for each in getattr(self, table))
            rows = ((pair, *entry(f"{table}.{index}.{name}")) for index, pair in pairs)
            written = (f"  {{ between = {pair}, {name} = {value} }},{comment}" for pair, value, comment in rows)
            return [f"{table} = [", *written, "]"]

        masses = ((name if name.isidentifier() else json.dumps(name), *entry(f"masses.{name}")) for name in self.masses)
        return [
            'kind = "chain"',
            *(f"masses.{name} = {value}{comment}" for name, value, comment in masses),
            *(line for each in _ELEMENTS for line in elements(*each)),
            f"stack_between = {json.dumps(self.stack_between)}",
            f"contact = {json.dumps(self.contact)}",
            *([f"loaded = {json.dumps(self.loaded)}"] if self.loaded else []),
        ]

    def structure(self, stack: PiezoStack) -> Structure:
        """Structure with a stack in it."""
        return chain.chain_structure(
            chain.LumpedChain(
                masses=self.masses,
                springs=tuple(
                    chain.Spring(between=_ends(each.between), spring_stiffness=each.spring_stiffness)
                    for each in self.springs
                ),
                dampers=tuple(
                    chain.Damper(between=_ends(each.between), viscous_damping=each.viscous_damping)
                    for each in self.dampers
                ),
                stack=stack,
                stack_between=_ends(self.stack_between),
                contact=self.contact,
                loaded=self.loaded,
            )
        )


class ModesSection(Section):
    """Modes of a structure, such as those that finite elements give, in a file beside the rig's or as lists."""

    kind: Literal["modes"]
    file: Name | None = Field(
        default=None, description="File that sonolube modes --contact wrote, or CSV file, relative to the rig's folder"
    )
    natural_frequency: list[float] | None = Field(default=None, description="Of each mode, in Hz; 0 for rigid ones")
    damping_ratio: list[float] | None = Field(default=None, description="Damping over critical damping of each mode")
    drive_participation: list[float] | None = Field(
        default=None, description="Modal force per volt of each mode, in N/V, for a modal mass of 1 kg"
    )
    contact_participation: list[float] | None = Field(
        default=None, description="Displacement of the contact in each shape, for a modal mass of 1 kg"
    )
    clamped_capacitance: float | None = None

    @model_validator(mode="after")
    def _file_or_lists(self) -> Self:
        given = [name for name in MODE_LISTS if getattr(self, name) is not None]
        if self.file is not None and given:
            raise ValueError(f"give either the file of the modes or their lists, got file and {given[0]}")
        if self.file is None and len(given) < len(MODE_LISTS):
            missing = next(name for name in MODE_LISTS if name not in given)
            raise ValueError(f"give the file of the modes, or all of their lists; {missing} is missing")
        if self.file is None and self.clamped_capacitance is None:
            raise ValueError("clamped_capacitance is missing")
        return self

    def structure(self, stack: PiezoStack) -> Structure:
        """Structure; the stack is part of its modes."""
        if self.clamped_capacitance is None:
            raise InvalidInput("the file of the modes has not been read, or has no clamped_capacitance; give it here")
        return chain.modal_structure(
            frequencies=self.natural_frequency or (),
            damping_ratios=self.damping_ratio or (),
            drive_participation=self.drive_participation or (),
            contact_participation=self.contact_participation or (),
            clamped_capacitance=self.clamped_capacitance,
        )


MODE_LISTS = ("natural_frequency", "damping_ratio", "drive_participation", "contact_participation")
"""Lists of a table of modes, each also a column of a file of modes."""


def _ends(names: list[str]) -> tuple[str, str]:
    first, second = names
    return first, second


def _kind(table: Any) -> str:
    return str(table.get("kind", "pin_on_disc") if isinstance(table, dict) else getattr(table, "kind", "pin_on_disc"))


STRUCTURES = ("pin_on_disc", "chain", "modes")
"""Kinds of structures."""

StructureSection = Annotated[
    Annotated[PinOnDiscSection, Tag("pin_on_disc")]
    | Annotated[ChainSection, Tag("chain")]
    | Annotated[ModesSection, Tag("modes")],
    Discriminator(
        _kind, custom_error_type="unknown_kind", custom_error_message=f"kind must be one of {', '.join(STRUCTURES)}"
    ),
]
"""The table `structure`; its key `kind` says which, the pin-on-disc chain where absent."""
