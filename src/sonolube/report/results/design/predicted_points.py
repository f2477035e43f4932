"""Predicted friction ratios and verdicts of the points of a result: lines, a table and objects for JSON."""

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from sonolube.prediction.predicted_points import PredictedRig
from sonolube.prediction.verdict import VERDICTS, Verdict, verdict_counts, verdicts_text
from sonolube.report.blocks import Block, Table
from sonolube.report.page import PageTable
from sonolube.rig.datasets import PREDICTED_RATIO
from sonolube.text.units import format_si
from sonolube.vocabulary import quantities

if TYPE_CHECKING:
    import xarray as xr

_ROWS: Final = 9  # of a table, evenly spaced among the points
_SHORT: Final = {
    Verdict.IN_RANGE: "in range",
    Verdict.EXTRAPOLATED: "extrapolated",
    Verdict.OUTSIDE_MODEL_RANGE: "outside the model",
    Verdict.CONTRADICTED: "contradicted by runs",
}


def verdict_lines(points: "xr.Dataset") -> list[str]:
    """Line with the number of points of each verdict; none where the points have none."""
    text = verdicts_text(points["verdict"].values) if "verdict" in points else ""
    return [f"  {text}"] if text else []


def predicted_blocks(points: "xr.Dataset", predicted: PredictedRig) -> list[Block]:
    """Table of some points by friction model and prediction, or why there is no prediction."""
    if predicted.chances is None:
        return [f"  not predicted: {predicted.reason}"]
    heads, rows = _table(points)
    return ["friction ratio by the friction model and as predicted", Table(heads, rows)]


def predicted_tables(points: "xr.Dataset", predicted: PredictedRig) -> list[PageTable]:
    """The same table for a page; none without a prediction."""
    if predicted.chances is None:
        return []
    heads, rows = _table(points)
    title = "Friction ratio by the friction model and as predicted"
    return [PageTable(title=title, heads=tuple(heads), rows=tuple(map(tuple, rows)))]


def predicted_text(point: "xr.Dataset") -> str:
    """Predicted friction ratio of one point in words; empty without one."""
    if PREDICTED_RATIO[0] not in point:
        return ""
    median, interval = _quantiles(point)
    return f"{median}, {interval} (80 %)" if median else ""


def predicted_object(points: "xr.Dataset", predicted: PredictedRig) -> dict[str, Any]:
    """Number of points by verdict, own runs behind the prediction, and why there is none, for JSON."""
    return {
        "verdicts": verdict_counts(points["verdict"].values) if "verdict" in points else {},
        "prediction": {"runs": predicted.runs, "reason": predicted.reason or None},
    }


def point_object(point: "xr.Dataset") -> dict[str, Any]:
    """Predicted friction ratio and verdict of one point, for JSON."""
    found: dict[str, Any] = {}
    if "verdict" in point:
        found["verdict"] = VERDICTS[int(point["verdict"])]
    if predicted_text(point):
        low, median, high = (float(point[name]) for name in PREDICTED_RATIO)
        found["predicted_friction_ratio"] = {"median": median, "interval_80": [low, high]}
    return found


def _table(points: "xr.Dataset") -> tuple[list[str], list[list[str]]]:
    """Heads and rows of some points: settings, ratio by the friction model, prediction, verdict."""
    ratio = points["friction_ratio"]
    names = [str(name) for name, each in points.variables.items() if "key" in each.attrs] or list(map(str, ratio.dims))
    known = quantities()
    words = [str(points[name].attrs.get("key", name)).rpartition(".")[2] for name in names]
    heads = [known[word].meaning if word in known else word.replace("_", " ") for word in words]
    rows = []
    for place in np.unique(np.linspace(0, ratio.size - 1, _ROWS).round().astype(int)):
        index = dict(zip(ratio.dims, map(int, np.unravel_index(place, ratio.shape)), strict=True))
        point = points.isel(index)
        settings = [_setting(point[name].item(), word) for name, word in zip(names, words, strict=True)]
        value = float(point["friction_ratio"])
        verdict = VERDICTS[int(point["verdict"])]
        short = _SHORT[Verdict(verdict)] if verdict in set(Verdict) else "no result"
        rows.append([*settings, "" if np.isnan(value) else f"{value:.3g}", *_quantiles(point), short])
    model = str(points.attrs.get("friction_model", "friction model"))
    return [*heads, model, "predicted", "80 %", "verdict"], rows


def _quantiles(point: "xr.Dataset") -> tuple[str, str]:
    """Median and 80 % interval of the predicted friction ratio of one point; empty without one."""
    low, median, high = (float(point[name]) for name in PREDICTED_RATIO)
    return ("", "") if np.isnan(median) else (f"{median:.2g}", f"{low:.2g} to {high:.2g}")


def _setting(value: float | str, word: str) -> str:
    """Value of a swept quantity with its unit, or a word."""
    if isinstance(value, str):
        return value
    known = quantities()
    return format_si(value, known[word].unit) if word in known else f"{value:.4g}"
