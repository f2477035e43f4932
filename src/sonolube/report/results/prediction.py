"""Prediction of a rig: rows of its tables, and objects for JSON."""

from typing import Any, Final

import numpy as np

from sonolube.prediction.hierarchy import PROBABILITIES
from sonolube.prediction.rig_statement import change_range, interval, is_unchanged
from sonolube.report.blocks import Bar, Bars
from sonolube.rig import Rig
from sonolube.rig.datasets import LabelledArrays
from sonolube.rig.power import POWERS, with_former_key
from sonolube.text.units import format_quantity, format_si
from sonolube.vocabulary import quantity

HEADS: Final = ["", "median", *(f"{100 * probability:.0f} %" for probability in PROBABILITIES)]
"""Heads of the table of predicted quantities."""

INPUT_HEADS: Final = ["least known inputs", "value", "known well, it leaves of ratio and force", "known from"]
"""Heads of the table of uncertain inputs."""

_INPUT_COLUMNS: Final = (
    *("input", "input_label", "input_value", "input_spread", "reason"),
    *("interval_share_left", "force_interval_share_left"),
)
_OF_WEAR: Final = ("wear_rate_ratio", "wear_reduction")
_PERCENT: Final = ("friction_reduction", "wear_reduction")


def quantity_rows(prediction: LabelledArrays) -> list[list[str]]:
    """Median and intervals of each predicted quantity."""
    rows = []
    for name in predicted_names(prediction):
        ends = [interval(prediction, name, probability) for probability in PROBABILITIES]
        text = [f"{_text(name, low)} to {_text(name, high)}" for low, high in ends]
        rows.append([quantity(name).meaning, _text(name, _median(prediction, name)), *text])
    return rows + [
        [quantity(name).meaning, "not known", *("" for _ in PROBABILITIES)] for name in unknown_names(prediction)
    ]


CHANGE_SCALE: Final = ("no change", "50 % less", "gone")
"""Words of the scale of a reduction."""

_BAR_ENDS: Final = (0.1, 0.25, 0.5, 0.75, 0.9)


def change_bars(prediction: LabelledArrays) -> Bars:
    """Changes of friction and wear as intervals, and the power to supply."""
    coefficient = format_si(_median(prediction, "friction_coefficient"), "", digits=2)
    bars = [_change_bar(prediction, "friction_reduction", "friction", f"coefficient {coefficient}")]
    if "wear_reduction" in prediction.variables:
        is_open = interval(prediction, "wear_reduction")[0] < 0
        bars.append(_change_bar(prediction, "wear_reduction", "wear", "may not fall" if is_open else ""))
    else:
        bars.append(Bar(name="wear", text="not known"))
    power = next((each["text"] for each in operating_texts(prediction) if each["name"] == POWERS[0]), "not known")
    return Bars(CHANGE_SCALE, [*bars, Bar(name="power to supply", text=power)])


def _change_bar(prediction: LabelledArrays, name: str, label: str, note: str) -> Bar:
    """Interval of a reduction with its median in percent."""
    ends = np.quantile(prediction[name].to_numpy(), _BAR_ENDS)
    change = round(-100 * ends[2])
    return Bar(name=label, text=f"{f'{change:+d}' if change else '0'} % {note}".rstrip(), ends=ends.tolist())


def measurement_objects(prediction: LabelledArrays) -> list[dict[str, Any]]:
    """Key, words and share of the interval that each further measurement would leave."""
    names = ("key", "label", "share_left")
    columns = (column(prediction, f"measure_{name}") for name in names)
    return [dict(zip(names, row, strict=True)) for row in zip(*columns, strict=True)]


def one_run_object(prediction: LabelledArrays) -> dict[str, Any] | None:
    """Reduction of friction as one run at the operating point would leave it, about the median of now.

    None where it is not known, or friction does not change.
    """
    left = column(prediction, "measure_share_left")
    if not left or is_unchanged(prediction):
        return None
    middle = _median(prediction, "friction_reduction")
    found = {
        f"interval_{100 * each:.0f}": [
            middle + left[0] * (end - middle) for end in interval(prediction, "friction_reduction", each)
        ]
        for each in (0.5, 0.8)
    }
    before, after = (
        change_range(*(100 * end for end in ends), joined="to")
        for ends in (interval(prediction, "friction_reduction"), found["interval_80"])
    )
    reduction = {"median": middle, **found, "unit": quantity("friction_reduction").unit}
    return {"friction_reduction": reduction, "text": f"{before} becomes about {after}"}


def operating_line(rig: Rig, prediction: LabelledArrays) -> str:
    """Rig with its load, speed and vibration."""
    attributes = prediction.attrs
    parts = [(rig.normal_load, "N"), (attributes["sliding_speed"], "m/s"), (attributes["vibration_amplitude"], "m")]
    frequency = "" if rig.drive is None else f" at {format_si(rig.drive.frequency, 'Hz')}"
    return f"{rig.title}, {', '.join(format_si(value, unit) for value, unit in parts)}{frequency}"


def input_rows(prediction: LabelledArrays) -> list[list[str]]:
    """Uncertain inputs with their spread, what of the intervals is left if each is known well, and its origin."""
    rows = []
    for name, label, value, spread, reason, *shares in zip(
        *(column(prediction, n) for n in _INPUT_COLUMNS), strict=True
    ):
        known = f"{format_si(value, quantity(name).unit)} within {100 * spread:.0f} %"
        rows.append([label, known, " and ".join(f"{100 * share:.0f} %" for share in shares), reason])
    return rows


def measurement_shares(prediction: LabelledArrays) -> dict[str, float]:
    """Share of the interval that each further measurement would leave."""
    return dict(zip(column(prediction, "measure_label"), column(prediction, "measure_share_left"), strict=True))


def predicted_object(prediction: LabelledArrays, name: str) -> dict[str, Any]:
    """Median and intervals of a predicted quantity in SI."""
    intervals = {
        f"interval_{100 * probability:.0f}": list(interval(prediction, name, probability))
        for probability in PROBABILITIES
    }
    return {"median": _median(prediction, name), **intervals, "unit": quantity(name).unit}


def predicted_names(prediction: LabelledArrays) -> list[str]:
    """Predicted quantities in their order."""
    return [name for name, values in prediction.variables.items() if values.dims == ("draw",)]


def power_object(prediction: LabelledArrays) -> dict[str, Any]:
    """Power to supply with its parts, in W, those that are known, and whether it is a lower bound."""
    known = {name: prediction.attrs[name] for name in POWERS if name in prediction.attrs}
    bound = {"at_least": ["power_to_supply"]} if prediction.attrs.get("power_is_at_least") else {}
    return {"actuator_power": None, **with_former_key(known), **bound}


def evidence_object(prediction: LabelledArrays) -> dict[str, Any] | None:
    """File, fingerprint and sources of the posterior that took the place of the shipped one; None without one."""
    attributes = prediction.attrs
    if "evidence" not in attributes:
        return None
    return {
        "file": attributes["evidence"],
        "fingerprint": attributes["evidence_fingerprint"],
        "sources": attributes["evidence_sources"].split("\n"),
    }


def unknown_names(prediction: LabelledArrays) -> list[str]:
    """Quantities of wear that a prediction leaves open."""
    return [name for name in _OF_WEAR if name not in prediction.variables]


def column(prediction: LabelledArrays, name: str) -> list[Any]:
    """Values of a variable over the uncertain inputs or measurements."""
    values: list[Any] = prediction[name].to_numpy().tolist()
    return values


def _median(prediction: LabelledArrays, name: str) -> float:
    """Median of the draws of a quantity."""
    return float(np.median(prediction[name].to_numpy()))


def _text(name: str, value: float) -> str:
    """Value with two or three digits, reductions in percent."""
    return f"{100 * value:.0f} %" if name in _PERCENT else format_si(value, quantity(name).unit, digits=2)


def operating_texts(prediction: LabelledArrays) -> list[dict[str, str]]:
    """Amplitude with its spread, and power to supply with its parts where they are known, as labels and texts."""
    spread = dict(zip(column(prediction, "input"), column(prediction, "input_spread"), strict=True))
    found = []
    for name in ("vibration_amplitude", *POWERS):
        value = prediction.attrs.get(name)
        if value is not None:
            within = f" within {100 * spread[name]:.0f} %" if name in spread else ""
            bound = "at least " if name == POWERS[0] and prediction.attrs["power_is_at_least"] else ""
            text = f"{bound}{format_quantity(value, name)}{within}"
            found.append({"name": name, "label": quantity(name).meaning, "text": text})
    return found
