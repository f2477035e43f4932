"""Lubrication regime of a rig: rows, and the object for JSON."""

from typing import Any, Final

from sonolube.models.wear import WearMechanismAssessment
from sonolube.report.results.record_object import picked
from sonolube.rig import LubricationPoint
from sonolube.text.units import format_si
from sonolube.vocabulary import si

_QUANTITIES: Final = ("vibration_amplitude", "sliding_speed", "nominal_pressure", "asperity_load_fraction")


def method_rows(result: LubricationPoint) -> list[list[str]]:
    """Coefficient of friction of each method, the best marked."""
    return [
        [name, f"{float(value):.3g}", "best" if name == result.best else ""]
        for name, value in result.coefficients._asdict().items()
    ]


def regime_rows(result: LubricationPoint, wear: WearMechanismAssessment | None) -> list[tuple[str, str]]:
    """Load on asperities, friction model, amplitude, and the kind of wear."""
    return [
        ("on asperities", f"{100 * result.asperity_load_fraction:.3g} % of the load through the lubricant"),
        ("friction model", result.friction_model),
        ("amplitude", f"{format_si(result.vibration_amplitude, 'm')}: {result.amplitude_origin}"),
        *([] if wear is None else _wear_rows(wear)),
    ]


def regime_object(result: LubricationPoint, wear: WearMechanismAssessment | None) -> dict[str, Any]:
    """Coefficients of friction by method, the best of them, and the kind of wear."""
    methods = result.coefficients._asdict()
    return {
        **picked(result, "best", "friction_model", "amplitude_source", "amplitude_origin"),
        **si(picked(result, *_QUANTITIES)),
        "friction_coefficient": si({name: float(value) for name, value in methods.items()}, unit=""),
        **({} if wear is None else {"wear": _wear_object(wear)}),
    }


def _wear_rows(wear: WearMechanismAssessment) -> list[tuple[str, str]]:
    """Kind of wear, effect of vibration on it, and their reasons."""
    return [
        ("wear", f"{wear.mechanism}; vibration: {wear.vibration_effect} in such pairs (a rule, not a law)"),
        *(("because", reason) for reason in wear.reasons),
        *(("evidence", line) for line in wear.evidence),
    ]


def _wear_object(wear: WearMechanismAssessment) -> dict[str, Any]:
    """Kind of wear, effect of vibration on it, and their reasons."""
    return {
        "kind": str(wear.mechanism),
        "effect": str(wear.vibration_effect),
        "reasons": list(wear.reasons),
        "evidence": list(wear.evidence),
    }
