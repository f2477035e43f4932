"""Natural modes of a part: names and frequencies with their errors, as text and JSON."""

import tomllib
from typing import Any

from sonolube.models.fem import ConvergedModes
from sonolube.models.fem.results.mode_files import elastic_rows, frequency_text
from sonolube.models.fem.results.part_modes import PartModes
from sonolube.report.blocks import Block, Rows
from sonolube.vocabulary import si


def modes_blocks(solved: PartModes) -> list[Block]:
    """Name and natural frequency with its error of every elastic mode."""
    found, part = solved.found, solved.part
    rigid = found.modes.rigid_body_count
    support = f"{rigid} rigid motions, " if rigid else "held, "
    nodes = f"{found.nodes[-1]} nodes in the last of {len(found.nodes)} meshes"
    return [
        f"{part.name} of {part.material}: {support}{nodes}",
        Rows([(solved.names[row], _frequency(found, row)) for row in elastic_rows(found)]),
    ]


def modes_object(solved: PartModes, structure: str | None) -> dict[str, Any]:
    """Rigid motions, nodes of the meshes, structure as TOML, and name, frequency and error of every elastic mode."""
    found = solved.found
    return {
        "part": solved.part.name,
        "material": solved.part.material,
        "rigid_motions": found.modes.rigid_body_count,
        "nodes": list(found.nodes),
        **({} if structure is None else {"structure": tomllib.loads(structure)}),
        "modes": [_mode(solved, row) for row in elastic_rows(found)],
    }


def _mode(solved: PartModes, row: int) -> dict[str, Any]:
    """Name, frequency and error of a mode."""
    frequency, error = float(solved.found.natural_frequency[row]), float(solved.found.frequency_error[row])
    return {
        "name": solved.names[row],
        "text": _frequency(solved.found, row),
        **si({"uncertainty": frequency * error}, unit="Hz"),
        **si({"natural_frequency": frequency, "frequency_error": error}),
    }


def _frequency(found: ConvergedModes, row: int) -> str:
    """Natural frequency of a mode with its error."""
    return frequency_text(
        frequency=float(found.natural_frequency[row]), relative_error=float(found.frequency_error[row])
    )
