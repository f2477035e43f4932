"""Task `identify rig`: entries of a rig's stack and structure from ranked facts, as tables of a rig file."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Unpack

from sonolube.errors import InvalidInput
from sonolube.identification import Identification, rig_tables
from sonolube.models.actuator import PiezoStack
from sonolube.report.results import identification as results
from sonolube.rig import read_rig, with_tables
from sonolube.rig.facts_file import identify_from_facts
from sonolube.storage.user_files import input_text
from sonolube.tasks.answer import Answer, Block, Table, answer, text_lines
from sonolube.tasks.files import InputFile, file_path
from sonolube.tasks.parameters import File, Parameter, Watched
from sonolube.tasks.progress import stage
from sonolube.tasks.task import shown, task
from sonolube.validation.tribometer import tribometer_identification, tribometer_stack

_FACTS = File("Facts about the rig; those of the dissertation's tribometer by default.", "FACTS.toml")


@task
def rig(
    base: Annotated[InputFile | None, File("Rig whose tables stack and structure to replace.", "[RIG.toml]")] = None,
    *,
    facts: Annotated[InputFile | None, _FACTS] = None,
    seed: Annotated[int, Parameter("Seed of the search; equal seeds give equal results.", lowest=0)] = 0,
    **watch: Unpack[Watched],
) -> "IdentificationAnswer":
    """Masses, springs and dampers of a rig from ranked facts, with the facts that contradict each other.

    Example: sonolube identify rig examples/rigs/tribometer.toml --facts examples/facts/tribometer.toml --out my.toml
    """
    if facts is not None and base is None:
        given = shown("facts")
        raise InvalidInput(f"{given} needs the rig they are of: sonolube identify rig RIG.toml --facts FACTS.toml")
    path = None if base is None else file_path(base)
    if path is not None:
        read_rig(path)
    with stage("identifying"):
        if facts is None or path is None:
            identification, stack = tribometer_identification(seed=seed), tribometer_stack()
            tables = rig_tables(identification, stack)
        else:
            identification, stack, tables = identify_from_facts(path, file_path(facts), seed=seed)
    text = tables if path is None else with_tables(input_text(path), tables)
    return IdentificationAnswer(identification=identification, stack=stack, rig_text=text)


@answer
class IdentificationAnswer(Answer):
    """Identified parameters with the facts that are satisfied or not, and the rig file with its tables."""

    identification: Identification
    stack: PiezoStack
    rig_text: str
    target: Path | None = None

    def blocks(self) -> Sequence[Block]:
        """Parameters with their ranges, facts that hold and that do not, conflicts and what the facts leave open."""
        found = self.identification
        return [
            Table(("parameter", "estimate", "lowest", "highest"), results.parameter_rows(found)),
            *results.fact_lines(found),
        ]

    def file_text(self) -> str:
        """Rig file, with the findings as comments before it."""
        comments = text_lines(self.blocks())
        return "\n".join([*(f"# {line}".rstrip() for line in comments), self.rig_text])

    def object(self) -> dict[str, Any]:
        """Stack, parameters with their ranges, facts with their misses, conflicts and free directions."""
        return results.identification_object(self.identification, self.stack)

    def files(self) -> Mapping[str, str]:
        """Rig file with the identified tables."""
        return {} if self.target is None else {self.target.name: self.rig_text}
