"""Sweeps and parametric studies of a rig: statuses, failures, rows of main results, JSON and tables of pages."""

from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.design import SweepPlan
from sonolube.design.point_statistics import extreme_place, extreme_point, failure_counts, status_counts
from sonolube.report.blocks import Block, Rows
from sonolube.report.page import Page, PageTable
from sonolube.report.results.design.predicted_points import point_object, predicted_text
from sonolube.report.results.record_object import amplitude_object, amplitude_rows
from sonolube.rig import Rig, power_to_supply, quantity_of_axis
from sonolube.rig.datasets import PREDICTED_RATIO
from sonolube.rig.driven_rig import NO_DISSIPATED_POWER
from sonolube.rig.power import POWERS, PowerToSupply, with_former_key
from sonolube.text.units import format_quantity, format_si
from sonolube.vocabulary import quantity, si

if TYPE_CHECKING:
    import xarray as xr

Named = Iterator[tuple[str, str]]

OUTCOMES = ("friction_ratio", "vibration_amplitude", *POWERS)
"""Quantities that the answer of a sweep has of a point."""


def _level_rows(study: "xr.Dataset") -> Named:
    """Least friction, voltage or amplitude at which contact is lost, and the highest power to supply where known."""
    quantity = quantity_of_axis(study.dims)
    for best in _best_points(study):
        at = f"ratio {_text(best, 'friction_ratio')} at {_text(best, quantity.name)}"
        yield "least friction", f"{at}{_predicted(best)}"
    lost = study[quantity.name].values[study["contact_loss_fraction"].values > 0]
    yield "contact is lost", f"from {format_si(float(lost.min()), quantity.unit)}" if lost.size else "nowhere"
    highest = extreme_point(study, outcome="power_to_supply", highest=True) if "power_to_supply" in study else None
    power = None if highest is None else _power(highest)
    if highest is not None and power is not None:
        yield "power to supply", f"{power.text} at {_text(highest, quantity.name)}, the highest"


def _speed_rows(study: "xr.Dataset") -> Named:
    """Range of the friction ratio at each voltage or amplitude."""
    quantity = quantity_of_axis(study.dims)
    for index in range(study.sizes[quantity.name]):
        curve = study.isel({quantity.name: index})
        low, high = float(curve["friction_ratio"].min()), float(curve["friction_ratio"].max())
        yield f"at {_text(curve, quantity.name)}", f"ratio {low:.3g} to {high:.3g}, slow to fast"


def _frequency_rows(study: "xr.Dataset") -> Named:
    """Least friction at each voltage."""
    for best in _best_points(study):
        at = f"{_text(best, 'frequency', digits=4)}, {_text(best, 'vibration_amplitude')}"
        text = f"least friction ratio {_text(best, 'friction_ratio')} at {at}, {_supplied(best)}{_predicted(best)}"
        yield f"at {_text(best, 'voltage_peak_to_peak')}", text


def _power_rows(study: "xr.Dataset") -> Named:
    """Least power to supply that the friction ratio takes."""
    if not study["power_to_supply"].isnull().all():
        least = study.isel(frequency=extreme_place(study, outcome="power_to_supply") or 0)
        at = f"{_text(least, 'frequency', digits=4)} and {_text(least, 'voltage_peak_to_peak')}"
        power = _power(least)
        text = "" if power is None else power.text
        yield "least power to supply", f"{text} at {at} for friction ratio {_text(least, 'friction_ratio')}"


def _waveform_rows(study: "xr.Dataset") -> Named:
    """Friction ratio of each waveform, the least first."""
    for index in study["friction_ratio"].values.argsort():
        one = study.isel(waveform=int(index))
        text = f"ratio {_text(one, 'friction_ratio')}, {_text(one, 'vibration_amplitude')}{_predicted(one)}"
        yield str(one["waveform"].values), text


def _predicted(point: "xr.Dataset") -> str:
    """Predicted friction ratio of a point, behind that of the friction model; empty without a prediction."""
    text = predicted_text(point)
    return f"; predicted {text}" if text else ""


def _load_rows(study: "xr.Dataset") -> Named:
    """Range of the friction ratio and, of a structure, of the natural frequency of the loading arm."""
    ratios = study["friction_ratio"]
    yield "friction ratio", f"{float(ratios.min()):.4g} to {float(ratios.max()):.4g}"
    if "natural_frequency" in study:
        arm = study["natural_frequency"]
        yield "arm's frequency", f"{format_si(float(arm.min()), 'Hz')} to {format_si(float(arm.max()), 'Hz')}"


def _energy_rows(study: "xr.Dataset", of: str) -> Named:
    """Comparison of the powers of the study, at its point of least friction, or least power for one friction."""
    best = extreme_point(study, outcome="power_to_supply" if of == "power" else "friction_ratio")
    balance = None if best is None else power_balance(best)
    if balance is not None:
        yield "energy", balance


def power_balance(point: "xr.Dataset") -> str | None:
    """Comparison of the parts of the power to supply of a point; None where it has no power."""
    if "charging_power" not in point:
        return None
    power = _power(point)
    return NO_DISSIPATED_POWER if power is None else power.energy_balance


def _power(point: "xr.Dataset") -> PowerToSupply | None:
    """Power to supply at a point of a study."""
    parts = {name: float(point[name]) for name in ("charging_power", "dissipated_power")}
    return power_to_supply(**parts)


def _bound(point: "xr.Dataset") -> dict[str, Any]:
    """Quantities of a point of which a lower bound is known, for JSON."""
    power = _power(point) if "charging_power" in point else None
    return {"at_least": ["power_to_supply"]} if power is not None and power.is_at_least else {}


def _supplied(point: "xr.Dataset") -> str:
    """Power to supply at a point as text."""
    power = _power(point)
    return "power not known" if power is None else f"{power.text} to supply"


_ROWS: "dict[str, Callable[[xr.Dataset], Named]]" = {
    "voltage": _level_rows,
    "amplitude": _level_rows,
    "speed": _speed_rows,
    "frequency": _frequency_rows,
    "power": _power_rows,
    "waveform": _waveform_rows,
    "load": _load_rows,
}


def rows(study: "xr.Dataset", of: str) -> list[tuple[str, str]]:
    """Main results of a study over a quantity such as "voltage", and how its powers compare."""
    return [*_ROWS[of](study), *_energy_rows(study, of)]


def best_objects(study: "xr.Dataset") -> list[dict[str, Any]]:
    """Point of least friction of each curve, for JSON."""
    return list(map(_point_object, _best_points(study)))


def _best_points(study: "xr.Dataset") -> "Iterator[xr.Dataset]":
    """Point of least friction of each curve that has a result."""
    dims = study["friction_ratio"].dims
    curves = [study] if len(dims) == 1 else [study.isel({dims[0]: i}) for i in range(study.sizes[dims[0]])]
    for curve in curves:
        best = extreme_point(curve, outcome="friction_ratio")
        if best is not None:
            yield best


def _point_object(point: "xr.Dataset") -> dict[str, Any]:
    """Coordinates and outcomes of a point, for JSON."""
    known = dict.fromkeys([*point.coords, *(name for name in OUTCOMES if name in point)])
    names = [str(name) for name in known if point[name].ndim == 0 and not _missing(point, name)]
    waveform = {"waveform": str(point["waveform"].values)} if "waveform" in names else {}
    balance, bound = power_balance(point), _bound(point)
    return (
        waveform
        | si(with_former_key({name: float(point[name]) for name in names if name != "waveform"}))
        | ({} if balance is None else {"energy_balance": balance})
        | bound
        | point_object(point)
    )


def _missing(point: "xr.Dataset", name: Any) -> bool:
    """Whether a number of a point is not known, as heat of a sine that no structure gives."""
    return bool(point[name].dtype.kind == "f" and np.isnan(point[name]))


def _text(point: "xr.Dataset", name: str, *, digits: int = 3) -> str:
    """Quantity of a point with its unit."""
    return format_si(float(point[name]), quantity(name).unit, digits=digits)


def status_tables(points: "xr.Dataset", failures: Mapping[str, int]) -> list[PageTable]:
    """Number of points of each status, and of those without a result by reason, where there are any."""
    tables = [count_table("Points by status", "points", status_counts(points))]
    if failures:
        rows = tuple((reason, f"{count}") for reason, count in failures.items())
        tables.append(PageTable(title="Points without a result", heads=("reason", "points"), rows=rows))
    return tables


def failure_objects(failures: Mapping[str, int]) -> list[dict[str, Any]]:
    """Reasons for which points have no result, with their number, for JSON."""
    return [{"reason": reason, "points": count} for reason, count in failures.items()]


def count_table(title: str, counted: str, counts: Mapping[str, int], *, total: int | None = None) -> PageTable:
    """Counts by status with their fractions."""
    whole = sum(counts.values()) if total is None else total
    rows = tuple((name, f"{count}", f"{count / whole:.1%}") for name, count in counts.items())
    return PageTable(title=title, heads=("status", counted, "share"), rows=rows)


_LABELS = {"energy_balance": "energy"}
_FORMER = "actuator_power"  # key of the charging power in JSON before it had its own


def sweep_blocks(rig: Rig, plan: SweepPlan, result: "xr.Dataset") -> list[Block]:
    """Number of points by status, failures, and the point of least friction."""
    least = _least_texts(plan, result)
    return [
        f"{result.attrs['rig']}, {result['friction_ratio'].size} points",
        Rows([*amplitude_rows(rig), *((name, f"{count}") for name, count in status_counts(result).items())]),
        *[f"  without result: {count}: {reason}" for reason, count in _failures(result).items()],
        *(("least friction", Rows(least)) if least else ()),
    ]


def sweep_object(rig: Rig, plan: SweepPlan, result: "xr.Dataset") -> dict[str, Any]:
    """Number of points by status, failures, and the point of least friction, for JSON."""
    return {
        "rig": result.attrs["rig"],
        **amplitude_object(rig),
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
    names = [name for name in (*OUTCOMES, *PREDICTED_RATIO, "verdict") if name in result]
    point = extreme_point(result[names], outcome="friction_ratio")
    if place is None or point is None:
        return {}
    swept = {key: values[0].item() for key, values in plan.rows(place, place + 1).items()}
    balance, bound = power_balance(point), _bound(point)
    return (
        swept
        | si(with_former_key({name: float(point[name]) for name in OUTCOMES if np.isfinite(point[name])}))
        | ({} if balance is None else {"energy_balance": balance})
        | bound
        | point_object(point)
    )


def _least_texts(plan: SweepPlan, result: "xr.Dataset") -> list[tuple[str, str]]:
    """The same as text, "at least" before a lower bound."""
    least = _least(plan, result)
    bounds = least.pop("at_least", ())
    least.pop("verdict", None)
    predicted = least.pop("predicted_friction_ratio", None)
    texts = {name: _as_text(name, value) for name, value in least.items() if name != _FORMER}
    rows = [(_LABELS.get(name, name), f"at least {text}" if name in bounds else text) for name, text in texts.items()]
    if predicted is None:
        return rows
    low, high = predicted["interval_80"]
    return [*rows, ("predicted ratio", f"{predicted['median']:.2g}, {low:.2g} to {high:.2g} (80 %)")]


def _as_text(name: str, value: Any) -> str:
    """Value of a swept key, or of an outcome, with its unit."""
    if isinstance(value, dict):
        return format_quantity(value["value"], name)
    return value if isinstance(value, str) else format_quantity(value, name.rpartition(".")[2])
