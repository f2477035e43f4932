"""Rig at its operating point: lubrication regime, published measurements beside it, and the error of its model."""

from collections.abc import Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import TYPE_CHECKING, Any, Final

from sonolube.models.wear import WearMechanismAssessment
from sonolube.report.results.record_object import picked
from sonolube.rig import LubricationPoint, Rig
from sonolube.text.units import format_quantity, format_si
from sonolube.validation.published_tests import NORMAL_VIBRATION_SETS, FrictionTest, friction_tests
from sonolube.vocabulary import si

if TYPE_CHECKING:
    from sonolube.models.friction import FrictionModel
    from sonolube.prediction.applicability import FrictionInterval
    from sonolube.prediction.evidence_posterior import EvidencePosterior
    from sonolube.prediction.verdict import PointVerdict
    from sonolube.rig import ResolvedRig
    from sonolube.validation.assessment import ErrorStatistics
    from sonolube.validation.published_wear_tests import WearErrors, WearTest


@dataclass(frozen=True, kw_only=True, slots=True)
class BeyondTheModel:
    """Error of a rig's friction model, which no interval from the rig's inputs holds, and the interval that does.

    Parameters
    ----------
    error : ErrorStatistics or None
        On published tests, each unseen; None where it is not known.
    interval : FrictionInterval or None
        None where it is not asked for.
    """

    error: "ErrorStatistics | None"
    interval: "FrictionInterval | None"

    def rows(self) -> list[tuple[str, str]]:
        """Names and texts."""
        return [*self.left_out(), *self.predicted()]

    def predicted(self) -> list[tuple[str, str]]:
        """Interval with the error of the model, where it is asked for."""
        return [] if self.interval is None else [("predicted ratio", self.interval.text)]

    def left_out(self) -> list[tuple[str, str]]:
        """What a number of the model alone leaves out."""
        if self.interval is None:
            return [("left out", "the error of the model, which --interval states")]
        error = "the error of the model, which with these parameters is not known"
        if self.error is not None:
            error = (
                f"the error of the model: +-{self.error.rms:.2g} in the ratio on {self.error.count} published tests,"
                " each unseen"
            )
        return [("left out", error)]

    def caveats(self) -> tuple[str, ...]:
        """Own published tests that the interval was learned from too."""
        return () if self.interval is None else self.interval.caveats

    def object(self) -> dict[str, Any]:
        """Entries for JSON."""
        if self.interval is None:
            return {}
        ends = None if self.interval.low is None else [self.interval.low, self.interval.high]
        return {
            "model_error": None if self.error is None else {"rms": self.error.rms, "tests": self.error.count},
            "predicted_friction_ratio": {
                "median": self.interval.median,
                "interval_80": ends,
                "reason": self.interval.reason or None,
            },
        }


def beyond_the_model(
    rig: "Rig | ResolvedRig", model: "FrictionModel", *, interval: bool, evidence: "EvidencePosterior | None" = None
) -> BeyondTheModel:
    """Model error and prediction interval that the friction ratio of a rig by a friction model leaves out."""
    if not interval:
        return BeyondTheModel(error=None, interval=None)
    from sonolube.prediction.applicability import friction_interval
    from sonolube.rig.resolved_rig import resolved_rig
    from sonolube.validation.assessment import unseen_error  # which fits, with scipy.optimize

    is_tested = resolved_rig(rig).rig.direction.is_normal  # as all tests behind that error
    return BeyondTheModel(
        error=unseen_error(model) if is_tested else None, interval=friction_interval(rig, evidence=evidence)
    )


def own_point_lines(rig: Rig) -> list[str]:
    """Verdict on a rig's own operating point as a line, for results over many points about it; none without one."""
    found = _own_verdict(rig)
    return [] if found is None else [f"  the rig's own point is {found.text}"]


def own_point_object(rig: Rig) -> dict[str, Any]:
    """The same for JSON."""
    found = _own_verdict(rig)
    return {} if found is None else found.object()


def _own_verdict(rig: Rig) -> "PointVerdict | None":
    """Verdict on a rig's own operating point; None where it has none."""
    from sonolube.prediction.verdict import verdict_of_rig

    return verdict_of_rig(rig)


_OF_BOTH = attrgetter(
    *("contact.nominal_area", "contact.pair.effective_modulus", "contact.pair.yield_strength"),
    *("normal_load", "sliding_speed", "friction_coefficient"),
)
_OF_TEST = attrgetter("frequency", "vibration_amplitude")
_SAME = 0.02  # relative difference of conditions that were rounded in print


def measured_text(test: FrictionTest) -> str:
    """Measured friction ratio of a published test with its uncertainty, and where it was published."""
    error = "" if test.uncertainty is None else f" +- {test.uncertainty:.2g}"
    return f"friction ratio {test.friction_ratio:.3g}{error}: {NORMAL_VIBRATION_SETS[test.set_name]}"


def measured_object(test: FrictionTest) -> dict[str, Any]:
    """Test, set, measured friction ratio and uncertainty for JSON."""
    return {
        "test": test.label,
        "set": NORMAL_VIBRATION_SETS[test.set_name],
        **picked(test, "friction_ratio", "uncertainty"),
    }


def measured_on(rig: Rig, *, vibration_amplitude: float) -> tuple[FrictionTest, ...]:
    """Published friction tests under the contact, load, speed, friction, frequency and amplitude of a rig.

    Roughness and asperity law are not compared: they are assumed for most tests.
    """
    if rig.drive is None or not rig.direction.is_normal:
        return ()
    own = (*_OF_BOTH(rig), rig.drive.frequency, vibration_amplitude)
    return tuple(test for test in friction_tests() if _near(own, (*_OF_BOTH(test), *_OF_TEST(test))))


def _near(own: Sequence[float], printed: Sequence[float]) -> bool:
    """Whether conditions are those of a test as far as print rounds them."""
    return all(abs(one - other) <= _SAME * abs(other) for one, other in zip(own, printed, strict=True))


_WORN_AREA: Final = 0.13  # relative difference of nominal areas, which grew by a quarter while the tips of D wore


def worn_on(rig: Rig, *, vibration_amplitude: float) -> "tuple[WearTest, ...]":
    """Published wear tests under the contact, load, speed, friction, frequency and amplitude of a rig, but for wear."""
    from sonolube.validation.published_wear_tests import wear_tests

    if rig.drive is None or not rig.direction.is_normal:
        return ()
    own = (*_OF_BOTH(rig), rig.drive.frequency, vibration_amplitude)
    found = []
    for test in wear_tests():
        printed = (*_OF_BOTH(test.conditions), *_OF_TEST(test.conditions))
        grown = abs(own[0] - printed[0]) / printed[0]  # the nominal area
        if grown <= _WORN_AREA and _near(own[1:], printed[1:]):
            found.append(test)
    return tuple(found)


def wear_error_rows(errors: "WearErrors") -> list[tuple[str, str]]:
    """Error of a wear model on the published tests, in words."""
    outside = f"; {', '.join(errors.out_of_range)} outside its range" if errors.out_of_range else ""
    text = (
        f"+-{errors.ratio_rms:.2g} in the ratio on {errors.ratio_count} published tests, a factor of"
        f" {errors.rate_factor:.3g} in the rate on {errors.rate_count} measured rates,"
        f" {errors.largest_factor:.3g} at most ({errors.largest_label}){outside}"
    )
    return [("error of the model", text)]


def wear_error_object(errors: "WearErrors") -> dict[str, Any]:
    """Error of a wear model on the published tests, for JSON."""
    return {
        "model_error": {
            "wear_rate_ratio": {"rms": errors.ratio_rms, "tests": errors.ratio_count},
            "wear_rate": {
                "factor": errors.rate_factor,
                "rates": errors.rate_count,
                "largest_factor": errors.largest_factor,
                "largest_test": errors.largest_label,
            },
            "outside_model_range": list(errors.out_of_range),
        }
    }


def worn_text(test: "WearTest") -> str:
    """Measured wear of a published test, and where it was published."""
    rates = (
        (test.intrinsic_wear_rate, "without vibration"),
        (test.reduced_wear_rate, "with it"),
        (test.overall_wear_rate, "of a test with the vibration off and on"),
    )
    parts = [f"{format_quantity(rate, 'wear_rate')} {state}" for rate, state in rates if rate is not None]
    if test.wear_rate_ratio is not None:
        parts.append(f"ratio {test.wear_rate_ratio:.3g}, a reduction of {100 * (1 - test.wear_rate_ratio):.3g} %")
    return f"{'; '.join(parts)}: {test.source}"


def worn_object(test: "WearTest") -> dict[str, Any]:
    """Test, source and measured wear, for JSON."""
    quantities = {
        "intrinsic_wear_rate": test.intrinsic_wear_rate,
        "reduced_wear_rate": test.reduced_wear_rate,
        "wear_rate": test.overall_wear_rate,
        "wear_rate_ratio": test.wear_rate_ratio,
    }
    known = si({name: value for name, value in quantities.items() if value is not None})
    return {"test": test.label, "source": test.source, **known}


_QUANTITIES: Final = ("vibration_amplitude", "sliding_speed", "nominal_pressure", "asperity_load_fraction")


_FILM: Final = ("film_thickness", "film_ratio", "film_coefficient")


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
        *([] if result.film_ratio is None else [("film", _film_text(result))]),
        ("friction model", result.friction_model),
        ("amplitude", f"{format_si(result.vibration_amplitude, 'm')}: {result.amplitude_origin}"),
        *([] if wear is None else _wear_rows(wear)),
    ]


def _film_text(result: LubricationPoint) -> str:
    """Thickness of the film, its ratio to the roughness with the regime of that name, and its coefficient."""
    ratio, share = result.film_ratio or 0.0, result.asperity_load_fraction
    regime = "boundary" if share > 0.9 else "mixed" if share > 0.1 else "full film"  # by the load, not by the ratio
    thickness = format_si(result.film_thickness or 0.0, "m")
    return (
        f"{thickness}, {ratio:.3g} times the rms height ({regime}), with a coefficient of {result.film_coefficient:.3g}"
    )


def regime_object(result: LubricationPoint, wear: WearMechanismAssessment | None) -> dict[str, Any]:
    """Coefficients of friction by method, the best of them, and the kind of wear."""
    methods = result.coefficients._asdict()
    return {
        **picked(result, "best", "friction_model", "amplitude_source", "amplitude_origin"),
        **si(picked(result, *_QUANTITIES)),
        **({} if result.film_ratio is None else si(picked(result, *_FILM))),
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
