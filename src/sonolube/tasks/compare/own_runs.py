"""Own runs in the answer of `compare`: as text and for JSON."""

from collections.abc import Iterator, Sequence
from typing import Any

from sonolube.tasks.blocks import Block, Table
from sonolube.validation.run_conditions import RunsTable
from sonolube.validation.runs_comparison import RunsPrediction


def run_blocks(table: RunsTable, predictions: Sequence[RunsPrediction]) -> Iterator[Block]:
    """Error of each model on own runs, beside the one to expect, and why others do not apply.

    Parameters
    ----------
    table : RunsTable
    predictions : sequence of RunsPrediction

    Returns
    -------
    iterator of Block
    """
    count = len(table.conditions)
    yield f"{table.title}: {table.runs} runs under {count} conditions, by models as published tests fitted them"
    rows = []
    for one in predictions:
        if one.rms is not None and one.mean is not None:
            expected = "" if one.cross_validated_rms is None else f"{one.cross_validated_rms:.3f}"
            reached = f"{one.reached}/{count}"
            rows.append((one.model.name, reached, f"{one.rms:.3f}", f"{one.mean:+.3f}", expected))
    yield Table(("model", "reached", "rms", "mean", "expected"), rows)
    reasons: dict[str, list[str]] = {}
    for one in predictions:
        if one.reason:
            reasons.setdefault(one.reason, []).append(one.model.name)
    for reason, names in reasons.items():
        yield f"  own runs not reached: {', '.join(names)}: {reason}"


def runs_object(table: RunsTable, predictions: Sequence[RunsPrediction]) -> dict[str, Any]:
    """Return own runs for JSON: conditions with measured ratios, and the ratios and errors of each model.

    Parameters
    ----------
    table : RunsTable
    predictions : sequence of RunsPrediction

    Returns
    -------
    dict
    """
    return {
        "runs": table.runs,
        "conditions": [{"label": one.label, "friction_ratio": one.friction_ratio} for one in table.conditions],
        "predictions": [
            {
                "model": one.model.name,
                "friction_ratios": list(one.ratios),
                "rms": one.rms,
                "mean_error": one.mean,
                "expected_rms": one.cross_validated_rms,
                "reason": one.reason,
            }
            for one in predictions
        ],
    }
