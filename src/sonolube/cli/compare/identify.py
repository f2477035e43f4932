"""Command `identify rig`: entries of a rig's stack and structure from ranked facts, as tables of a rig file."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from sonolube.cli.console.answer import Answer, deliver, grid, si
from sonolube.cli.console.options import Json
from sonolube.cli.console.outputs import OutputFile
from sonolube.cli.console.progress import progress
from sonolube.errors import InvalidInput
from sonolube.identification import Identification, rig_tables
from sonolube.input_files import input_text
from sonolube.models.actuator import PiezoStack
from sonolube.rig import read_rig, with_tables
from sonolube.rig.facts_file import identify_from_facts
from sonolube.units import format_si
from sonolube.validation.tribometer import tribometer_identification, tribometer_stack
from sonolube.vocabulary import quantities


def identify_rig(
    base: Annotated[
        Path | None, typer.Argument(metavar="[RIG.toml]", help="Rig whose tables stack and structure to replace.")
    ] = None,
    facts: Annotated[
        Path | None,
        typer.Option(
            metavar="FACTS.toml", help="Facts about the rig; those of the dissertation's tribometer by default."
        ),
    ] = None,
    out: Annotated[Path | None, typer.Option(help="File to write; standard output by default."), OutputFile()] = None,
    seed: Annotated[int, typer.Option(help="Seed of the search; equal seeds give equal results.", min=0)] = 0,
    json: Json = False,
) -> None:
    """Masses, springs and dampers of a rig from ranked facts, with the facts that contradict each other.

    Example: sonolube identify rig examples/rigs/tribometer.toml --facts examples/facts/tribometer.toml --out my.toml
    """
    if facts is not None and base is None:
        raise InvalidInput("--facts needs the rig they are of: sonolube identify rig RIG.toml --facts FACTS.toml")
    if base is not None:
        read_rig(base)
    with progress("identifying"):
        if facts is None or base is None:
            identification, stack = tribometer_identification(seed=seed), tribometer_stack()
            tables = rig_tables(identification, stack)
        else:
            identification, stack, tables = identify_from_facts(base, facts, seed=seed)
    text = tables if base is None else with_tables(input_text(base), tables)
    answer = IdentificationAnswer(
        identification=identification, stack=stack, text=text, file_name=None if out is None else out.name
    )
    deliver(answer, folder=Path() if out is None else out.parent, as_json=json)


@dataclass(frozen=True, kw_only=True)
class IdentificationAnswer(Answer):
    """Identified parameters with the facts that are satisfied or not, and the rig file with its tables."""

    identification: Identification
    stack: PiezoStack
    text: str
    file_name: str | None

    def lines(self) -> list[str]:
        """Findings; as comments before the rig file itself where no file is written."""
        if self.file_name is not None:
            return self._findings()
        return [*(f"# {line}".rstrip() for line in self._findings()), *self.text.splitlines()]

    def _findings(self) -> list[str]:
        """Parameters with their ranges, facts that hold and that do not, conflicts and what the facts leave open."""
        found = self.identification
        known = quantities()
        parameters = [
            [
                f"  {name}",
                *(
                    format_si(value, known[name].unit if name in known else "")
                    for value in (estimate.value, estimate.lower, estimate.upper)
                ),
            ]
            for name, estimate in found.estimates.items()
        ]
        satisfied = [fact.name for fact in found.facts if fact.name in found.satisfied]
        missed = [fact.name for fact in found.facts if fact.name not in found.satisfied]
        return [
            *grid([["  parameter", "estimate", "lowest", "highest"], *parameters]),
            f"  facts that hold: {', '.join(satisfied) or 'none'}",
            *([f"  facts that do not hold: {', '.join(missed)}"] if missed else []),
            *(f"  contradict each other: {', '.join(sorted(conflict))}" for conflict in found.conflicts),
            *(
                "  not determined: " + " ".join(f"{name}^{power:.2g}" for name, power in direction.exponents.items())
                for direction in found.unidentifiable_directions
            ),
        ]

    def object(self) -> dict[str, Any]:
        """Stack, parameters with their ranges, facts with their misses, conflicts and free directions."""
        found = self.identification
        return {
            "stack": si({name: value for name, value in asdict(self.stack).items() if value and name in quantities()}),
            "parameters": {
                name: si({name: known.value})[name] | asdict(known) for name, known in found.estimates.items()
            },
            "facts": [
                asdict(fact) | {"observed": found.observed[fact.name], "satisfied": fact.name in found.satisfied}
                for fact in found.facts
            ],
            "conflicts": [sorted(conflict) for conflict in found.conflicts],
            "unidentifiable_directions": [dict(direction.exponents) for direction in found.unidentifiable_directions],
        }

    def files(self) -> Mapping[str, str]:
        """Rig file with the identified tables."""
        return {} if self.file_name is None else {self.file_name: self.text}
