"""What the reports of all design commands hold: what was asked, what became of the points, caveats."""

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import typer

from sonolube.report import FindingTable
from sonolube.rig import Rig
from sonolube.units import format_si

if TYPE_CHECKING:
    import xarray as xr

_ELSEWHERE = ("rig", "out", "json", "keep")  # arguments that the page tells otherwise, or that change no number


def asked_of(context: typer.Context, *, title: str, source: str = "") -> list[tuple[str, str]]:
    """Return the rig and every option of a command as it stood, those left to their defaults too.

    Parameters
    ----------
    context : typer.Context
        Of the running command.
    title : str
        Of the rig.
    source : str
        Where the rig's numbers come from.

    Returns
    -------
    list of pair of str
    """
    told = [("rig", f"{title} ({context.params['rig'].name})")]
    if source:
        told.append(("source of its numbers", source))
    for option in context.command.params:
        value = context.params.get(option.name or "")
        if option.name in _ELSEWHERE or value is None or value in ([], ()):
            continue
        given = getattr(context.get_parameter_source(option.name or ""), "name", "") != "DEFAULT"
        text = _as_typed(value)
        told.append((option.opts[0], text if given else f"{text} (default)"))
    return told


def settings_of(rig: Rig) -> list[tuple[str, str]]:
    """Return at what load and speed a rig runs, with which friction model."""
    return [
        ("load and speed", f"{format_si(rig.normal_load, 'N')}, {format_si(rig.sliding_speed, 'm/s')}"),
        ("without vibration", f"coefficient of friction {rig.friction_coefficient:.3g}"),
        ("friction model", rig.friction_model.name),
    ]


def status_counts(points: "xr.Dataset") -> dict[str, int]:
    """Return how many points of a dataset came to each status, by its code or in words."""
    import numpy as np

    values, counts = np.unique(points["status"].values, return_counts=True)
    names = points["status"].attrs.get("flag_meanings", "").split()
    return {str(names[value] if names else value): int(count) for value, count in zip(values, counts, strict=True)}


def status_tables(counts: Mapping[str, int], failures: Iterable[tuple[str, int]]) -> list[FindingTable]:
    """Return what became of the points: how many came to each status, and why some have no result."""
    total = sum(counts.values())
    tables = [
        FindingTable(
            title="What became of the points",
            heads=("status", "points", "share"),
            rows=tuple((name, f"{count}", f"{count / total:.1%}") for name, count in counts.items()),
        )
    ]
    rows = tuple((reason, f"{count}") for reason, count in failures)
    if rows:
        tables.append(FindingTable(title="Points without a result", heads=("reason", "points"), rows=rows))
    return tables


def notes_of(caveats: Iterable[str], assumptions: Mapping[str, str]) -> list[str]:
    """Return caveats and assumptions as lines of a page."""
    return [
        *(f"Caveat: {caveat}." for caveat in caveats),
        *(f"Assumed {key}: {reason}." for key, reason in assumptions.items()),
    ]


def _as_typed(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list | tuple):
        return "; ".join(map(str, value))
    return str(value)
