"""Sweep of a rig: statuses, failures and the point of least friction as text, JSON and page."""

from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.design import SweepPlan
from sonolube.design.point_statistics import extreme_place, extreme_point, failure_counts, status_counts
from sonolube.report.blocks import Block, Rows
from sonolube.report.page import Page
from sonolube.report.results.design.parametric_study import OUTCOMES, power_balance
from sonolube.report.results.design.status_tables import failure_objects, status_tables
from sonolube.report.results.rig_text import amplitude_object, amplitude_rows
from sonolube.rig import Rig
from sonolube.text.units import format_quantity
from sonolube.vocabulary import si

if TYPE_CHECKING:
    import xarray as xr

_LABELS = {"energy_balance": "energy"}


def sweep_blocks(rig: Rig, plan: SweepPlan, result: "xr.Dataset") -> list[Block]:
    """Number of points by status, failures, and the point of least friction."""
    device = f", on {result.attrs['device']}" if "device" in result.attrs else ""
    least = _least_texts(plan, result)
    return [
        f"{result.attrs['rig']}, {result['friction_ratio'].size} points{device}",
        Rows([*amplitude_rows(rig), *((name, f"{count}") for name, count in status_counts(result).items())]),
        *[f"  without result: {count}: {reason}" for reason, count in _failures(result).items()],
        *(("least friction", Rows(least)) if least else ()),
    ]


def sweep_object(rig: Rig, plan: SweepPlan, result: "xr.Dataset") -> dict[str, Any]:
    """Number of points by status, failures, and the point of least friction, for JSON."""
    return {
        "rig": result.attrs["rig"],
        **amplitude_object(rig),
        **({"device": str(result.attrs["device"])} if "device" in result.attrs else {}),
        "points": int(result["friction_ratio"].size),
        "statuses": status_counts(result),
        "without_result": failure_objects(_failures(result)),
        "least_friction": _least(plan, result),
    }


def sweep_page(rig: Rig, plan: SweepPlan, result: "xr.Dataset") -> Page:
    """Page of a sweep: rig, point of least friction, and statuses."""
    source = str(plan.content.get("source", ""))
    points, failures = int(result["friction_ratio"].size), _failures(result)
    return Page(
        name="sweep",
        title=result.attrs["title"],
        settings=[
            ("rig", f"{result.attrs['rig']} ({rig.name})"),
            *([("source of its numbers", source)] if source else []),
            *amplitude_rows(rig),
        ],
        facts=[
            ("points", f"{points}, {points - sum(failures.values())} with a result"),
            *[(f"least friction: {name}", text) for name, text in _least_texts(plan, result)],
            ("fingerprint", plan.digest[:16]),
        ],
        tables=status_tables(result, failures),
    )


def _failures(result: "xr.Dataset") -> dict[str, int]:
    """Number of points without a result, by the reason."""
    return failure_counts(result, outcome="friction_ratio")


def _least(plan: SweepPlan, result: "xr.Dataset") -> dict[str, Any]:
    """Values of the swept keys and outcomes at the point of least friction; empty where no point has a result."""
    place = extreme_place(result, outcome="friction_ratio")
    point = extreme_point(result[list(OUTCOMES)], outcome="friction_ratio")
    if place is None or point is None:
        return {}
    swept = {key: values[0].item() for key, values in plan.rows(place, place + 1).items()}
    balance = power_balance(point)
    return (
        swept
        | si({name: float(point[name]) for name in OUTCOMES if np.isfinite(point[name])})
        | ({} if balance is None else {"energy_balance": balance})
    )


def _least_texts(plan: SweepPlan, result: "xr.Dataset") -> list[tuple[str, str]]:
    """The same as text."""
    return [(_LABELS.get(name, name), _as_text(name, value)) for name, value in _least(plan, result).items()]


def _as_text(name: str, value: Any) -> str:
    """Value of a swept key, or of an outcome, with its unit."""
    if isinstance(value, dict):
        return format_quantity(value["value"], name)
    return value if isinstance(value, str) else format_quantity(value, name.rpartition(".")[2])
