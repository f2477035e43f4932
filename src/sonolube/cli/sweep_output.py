"""What the command `sweep` says and writes."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import typer

from sonolube.cli.design_page import asked_of, notes_of, status_counts, status_tables
from sonolube.design import SweepPlan, sweep_figure, swept_variables
from sonolube.figure import publication_style
from sonolube.report import Finding, write_findings
from sonolube.units import format_si
from sonolube.vocabulary import quantities, quantity

if TYPE_CHECKING:
    import xarray as xr

_TOLD = ("friction_ratio", "vibration_amplitude", "actuator_power", "dissipated_power")
_CAPTIONS = {
    1: "What the rig does over the key that was swept.",
    2: "Friction over both keys that were swept.",
}
_CLOUD = (
    "Friction over each key that was swept, whatever the others are: points, at most 3000 of them, their median, and"
    " where 90 % of them lie."
)


def write_sweep(
    context: typer.Context, plan: SweepPlan, result: "xr.Dataset", told: dict[str, Any], *, folder: Path
) -> list[Path]:
    """Write the report of what a sweep has to tell, with its figure, and return the files."""
    failures = [(row["reason"], row["points"]) for row in told["without_result"]]
    drawn = result["friction_ratio"].dims == ("point",)
    with publication_style():
        figure = sweep_figure(result)
    return write_findings(
        title=result.attrs["title"],
        asked=asked_of(context, title=told["rig"], source=str(plan.content.get("source", ""))),
        facts=[
            ("points", f"{told['points']}, {told['points'] - sum(count for _, count in failures)} with a result"),
            *_least(told),
            ("fingerprint", plan.digest[:16]),
        ],
        tables=status_tables(told["statuses"], failures),
        figures=[
            Finding(
                name="sweep",
                caption=_CLOUD if drawn else _CAPTIONS.get(len(swept_variables(result)), _CLOUD),
                figure=figure,
            )
        ],
        notes=notes_of((), plan.content.get("assumptions", {})),
        folder=folder,
        name="sweep",
    )


def sweep_object(plan: SweepPlan, result: "xr.Dataset") -> dict[str, Any]:
    """Return the least friction of a sweep, and what became of its points, as they go into JSON."""
    ratio = result["friction_ratio"].values.ravel()
    failed = np.isnan(ratio)
    reasons, failures = np.unique(result["reason"].values.ravel()[failed], return_counts=True)
    least = {}
    if not failed.all():
        place = int(np.nanargmin(ratio))
        settings = {key: array[0] for key, array in plan.rows(place, place + 1).items()}
        least = {key: value.item() for key, value in settings.items()}
        at = np.unravel_index(place, result["friction_ratio"].shape)
        point = result[list(_TOLD)].isel(dict(zip(result["friction_ratio"].dims, map(int, at), strict=True)))
        least |= {name: _number(float(point[name]), quantity(name).unit) for name in _TOLD}
    return {
        "rig": result.attrs["rig"],
        **({"device": str(result.attrs["device"])} if "device" in result.attrs else {}),
        "points": int(ratio.size),
        "statuses": status_counts(result),
        "without_result": [
            {"reason": str(result["reason_text"].values[code]), "points": int(count)}
            for code, count in zip(reasons, failures, strict=True)
        ],
        "least_friction": least,
    }


def sweep_lines(told: dict[str, Any]) -> list[str]:
    """Return the same as lines."""
    lines = [f"{told['rig']}, {told['points']} points" + (f", on {told['device']}" if "device" in told else "")]
    lines += [f"  {name:<14} {count}" for name, count in told["statuses"].items()]
    lines += [f"  without result: {row['points']}: {row['reason']}" for row in told["without_result"]]
    if told["least_friction"]:
        lines.append("  least friction")
    lines += [f"    {key:<28} {text}" for key, text in _settings(told)]
    return [*lines, *[f"  {path}" for path in told["files"]]]


def _least(told: dict[str, Any]) -> list[tuple[str, str]]:
    texts = dict(_settings(told))
    if not texts:
        return []
    there = ", ".join(f"{name.replace('_', ' ')} {texts.pop(name)}" for name in _TOLD[1:])
    ratio = texts.pop(_TOLD[0])
    return [("least friction ratio", ratio), *((f"at {key}", text) for key, text in texts.items()), ("there", there)]


def _settings(told: dict[str, Any]) -> list[tuple[str, str]]:
    """Return what was swept, and what came of it, at the point of least friction."""
    texts = []
    for key, value in told["least_friction"].items():
        if isinstance(value, dict):
            text = format_si(value["value"], value["unit"])
        elif isinstance(value, str):
            text = value
        else:
            known = quantities().get(key.rpartition(".")[2])
            text = format_si(value, known.unit if known else "")
        texts.append((key, text))
    return texts


def _number(value: float, unit: str) -> dict[str, Any]:
    return {"value": float(value), "unit": unit}
