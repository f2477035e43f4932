"""How results are printed: a few lines for people, or one JSON object for programs."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import typer

from sonolube.rig import Rig
from sonolube.units import format_si
from sonolube.vocabulary import quantities


def show(result: Any, *, rig: Rig, as_json: bool, written: Sequence[Path] = ()) -> None:
    """Print a record of results of one rig, with what was assumed, what is doubtful and the files written."""
    values = _flat(result)
    quantified = {
        name: value for name, value in values.items() if name in quantities() and isinstance(value, int | float)
    }
    told = {name: value for name, value in values.items() if isinstance(value, str)}
    if as_json:
        files = {"files": [str(path) for path in written]} if written else {}
        typer.echo(json.dumps(_object(quantified, told, rig, values["caveats"]) | files, indent=2, allow_nan=False))
    else:
        closing = closing_lines(written, assumptions=rig.assumptions, caveats=values["caveats"])
        typer.echo("\n".join([*_lines(quantified, told, rig), *closing]))


def _flat(result: Any) -> dict[str, Any]:
    """Return the fields of a record by name, and those of records within it that it has none of the name of."""
    own = {field.name: getattr(result, field.name) for field in fields(result)}
    values: dict[str, Any] = {}
    for value in own.values():
        values |= _flat(value) if is_dataclass(value) else {}
    values |= {name: value for name, value in own.items() if not is_dataclass(value)}
    return values


def closing_lines(written: Sequence[Path], *, assumptions: Mapping[str, str], caveats: Sequence[str] = ()) -> list[str]:
    """Return what every answer ends with: what is doubtful, what was assumed, and the files written."""
    return [
        *[f"  caveat: {caveat}" for caveat in caveats],
        *[f"  assumed {key}: {reason}" for key, reason in assumptions.items()],
        *[f"  {path}" for path in written],
    ]


def _object(quantified: dict[str, float], told: dict[str, str], rig: Rig, caveats: tuple[str, ...]) -> dict[str, Any]:
    return {
        "rig": rig.title,
        **told,
        **{name: {"value": value, "unit": quantities()[name].unit} for name, value in quantified.items()},
        "caveats": list(caveats),
        "assumptions": dict(rig.assumptions),
    }


def _lines(quantified: dict[str, float], told: dict[str, str], rig: Rig) -> list[str]:
    width = max(len(quantities()[name].meaning) for name in quantified)
    return [
        f"{rig.title}, {format_si(rig.normal_load, 'N')}",
        *[
            f"  {quantities()[name].meaning:<{width}}  {format_si(value, quantities()[name].unit)}"
            for name, value in quantified.items()
        ],
        *[f"  {name:<{width}}  {text}" for name, text in told.items() if name != "status"],
    ]
