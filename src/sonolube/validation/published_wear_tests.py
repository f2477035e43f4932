"""Published wear tests under vibration as records, and the error of the wear models on them."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from math import exp, log
from pathlib import Path
from typing import Any

import numpy as np

from sonolube.facts.published import published_value, si_value
from sonolube.models.actuator.drive import Drive
from sonolube.rig import Rig, WearPoint, wear_point
from sonolube.validation.published_tests import FrictionTest, friction_tests


@dataclass(frozen=True, kw_only=True, slots=True)
class WearTest:
    """Measured wear under vibration along the normal, with its conditions; None for what is not printed.

    Parameters
    ----------
    label : str
        Such as "W-1".
    conditions : FrictionTest
        Friction test with its contact, load, speed and vibration.
    intrinsic_wear_rate : float or None
        Without vibration. [m2]
    reduced_wear_rate : float or None
        With vibration. [m2]
    overall_wear_rate : float or None
        Of a test in which the vibration was off and on, in m2.
    wear_rate_ratio : float or None
        With vibration over without. []
    source : str
        Bodies and where it was published.
    """

    label: str
    conditions: FrictionTest
    intrinsic_wear_rate: float | None
    reduced_wear_rate: float | None
    overall_wear_rate: float | None
    wear_rate_ratio: float | None
    source: str

    @property
    def rig(self) -> Rig:
        """Rig under the conditions of the test."""
        at = self.conditions
        return Rig(
            title=self.label,
            source=self.source,
            contact=at.contact,
            normal_load=at.normal_load,
            friction_coefficient=at.friction_coefficient,
            sliding_speed=at.sliding_speed,
            vibration_amplitude=at.vibration_amplitude,
            drive=Drive(frequency=at.frequency),
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class WearErrors:
    """Errors of a wear model on published tests.

    Parameters
    ----------
    ratio_rms : float
        Root mean square error of the wear rate ratio over the tests inside the range of the model.
    ratio_count : int
        Number of these tests.
    rate_factor : float
        Factor between computed and measured wear rates, the exponential of the root mean square of ln of it.
    rate_count : int
        Number of measured rates.
    largest_factor : float
        Largest of these factors, either way.
    largest_label : str
        Test that it is of.
    out_of_range : tuple of str
        Labels of the tests outside the range of the model.
    """

    ratio_rms: float
    ratio_count: int
    rate_factor: float
    rate_count: int
    largest_factor: float
    largest_label: str
    out_of_range: tuple[str, ...]


@cache
def wear_tests() -> tuple[WearTest, ...]:
    """Wear tests with vibration along the normal in order, W-1 to W-12."""
    content = tomllib.loads(Path(__file__).with_name("published_wear_tests.toml").read_text(encoding="utf-8"))
    by_label = {test.label: test for test in friction_tests()}
    return tuple(_test(entry, by_label[entry["friction_test"]]) for entry in content["tests"])


def _test(ids: Mapping[str, Any], conditions: FrictionTest) -> WearTest:
    """Test from the ids of its published numbers."""
    if "sliding_speed" in ids:
        conditions = replace(conditions, sliding_speed=si_value(ids["sliding_speed"]))
    intrinsic, reduced, overall = (
        _measured(ids[name]) if name in ids else None for name in ("intrinsic", "reduced", "overall")
    )
    ratio: float | None = ids.get("wear_rate_ratio")
    if intrinsic is not None and reduced is not None:
        ratio = reduced / intrinsic
    elif "reduction" in ids:
        ratio = 1 - _measured(ids["reduction"])
    return WearTest(
        label=ids["label"],
        conditions=conditions,
        intrinsic_wear_rate=intrinsic,
        reduced_wear_rate=reduced,
        overall_wear_rate=overall,
        wear_rate_ratio=ratio,
        source=ids["source"],
    )


def _measured(number: str) -> float:
    """Published number in SI, corrected where an erratum is recorded."""
    corrected = published_value(number).corrected
    return corrected[0].value if corrected else si_value(number)


@cache
def wear_model_errors(wear_model: str) -> WearErrors:
    r"""Errors of a wear model on the published wear tests, none of which it was fitted to here.

    Notes
    -----
    The factor of the rates is :math:`\exp\sqrt{\langle \ln^2 (W / W_\mathrm{measured}) \rangle}`. A rate that was
    measured while the vibration was off and on is compared with the nearest between both computed rates.
    """
    computed = [(test, wear_point(test.rig, model=wear_model)) for test in wear_tests()]
    within = [(test, point) for test, point in computed if point.reason is None]
    ratios = [
        point.wear_rate_ratio - test.wear_rate_ratio for test, point in within if test.wear_rate_ratio is not None
    ]
    logs = [(each, test.label) for test, point in within for each in _rate_errors(test, point)]
    largest, label = max(((abs(each), label) for each, label in logs), default=(float("nan"), ""))
    return WearErrors(
        ratio_rms=_root_mean_square(ratios),
        ratio_count=len(ratios),
        rate_factor=exp(_root_mean_square([each for each, _ in logs])),
        rate_count=len(logs),
        largest_factor=exp(largest),
        largest_label=label,
        out_of_range=tuple(test.label for test, point in computed if point.reason is not None),
    )


def _rate_errors(test: WearTest, point: WearPoint) -> list[float]:
    """Logarithms of computed over measured wear rates of a test."""
    off, on = point.intrinsic_wear_rate, point.wear_rate
    found = [
        log(computed / measured)
        for computed, measured in ((off, test.intrinsic_wear_rate), (on, test.reduced_wear_rate))
        if measured is not None
    ]
    if test.overall_wear_rate is not None:
        nearest = float(np.clip(test.overall_wear_rate, min(off, on), max(off, on)))
        found.append(log(nearest / test.overall_wear_rate))
    return found


def _root_mean_square(errors: list[float]) -> float:
    """Root mean square of some errors; NaN for none."""
    return float(np.sqrt(np.mean(np.square(errors)))) if errors else float("nan")
