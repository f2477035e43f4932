"""Conditions beyond those of the published tests, and inputs that a prediction knows least."""

from dataclasses import replace
from math import exp, log
from pathlib import Path

from pytest import approx, mark

from sonolube.prediction import interval, predict
from sonolube.rig import Distribution, LogNormal, Rig, read_rig

RIGS = Path(__file__).parents[2] / "examples" / "rigs"


def tribometer(*changes: str) -> Rig:
    return read_rig(RIGS / "tribometer.toml", changes=changes)


def extrapolation(rig: Rig) -> str:
    caveats: str = predict(rig).attrs["caveats"]
    (line,) = (each for each in caveats.split("\n") if "extrapolates" in each)
    return line


def test_a_rig_of_the_published_tests_is_no_extrapolation() -> None:
    assert "extrapolates" not in predict(tribometer()).attrs["caveats"]


@mark.parametrize(
    ("change", "label", "other"),
    [
        ("sliding.sliding_speed=1m/s", "sliding speed 1 m/s", "modulus"),
        ("sliding.sliding_speed=1mm/s", "sliding speed 1 mm/s", "modulus"),
        ("contact.pair.effective_modulus=12GPa", "effective modulus 12 GPa", "speed"),
    ],
)
def test_what_lies_outside_the_published_tests_is_named_and_nothing_else(change: str, label: str, other: str) -> None:
    line = extrapolation(tribometer(change))
    assert label in line
    assert other not in line


def test_the_speeds_of_the_published_tests_are_named_as_printed() -> None:
    # D Table 2.10 and section 2.5: the slowest test 3.5 mm/s; the welder rig 266 mm/s
    assert "3.5 mm/s to 266 mm/s" in extrapolation(tribometer("sliding.sliding_speed=1m/s"))


def with_friction_known_within(factor: float) -> Rig:
    known = Distribution(law=LogNormal(median=0.341, factor=factor), lowest=0.0, text=f"within {factor}")
    return replace(tribometer(), uncertainty={"friction.friction_coefficient": known})


def test_the_least_known_input_stands_first_and_each_names_a_measurement() -> None:
    found = predict(with_friction_known_within(2.5))
    assert found["input"].to_numpy().tolist()[:2] == ["friction_coefficient", "decay_length"]
    assert found["input"].size == 3
    assert found["input_spread"].to_numpy() == approx(sorted(found["input_spread"].to_numpy(), reverse=True))
    assert "without vibration" in found["remedy"].to_numpy()[0]
    assert all(found["remedy"].to_numpy())


def test_dry_friction_known_better_narrows_the_force_and_leaves_the_ratio() -> None:
    vague, known = predict(with_friction_known_within(1.5)), predict(with_friction_known_within(1.03))
    row = vague.sel(input="friction_coefficient")
    assert float(row["interval_share_left"]) == approx(1)
    assert interval(known, "friction_ratio") == approx(interval(vague, "friction_ratio"))
    narrowed = (interval(each, "friction_force") for each in (known, vague))
    better, now = (high - low for low, high in narrowed)
    # expected over what would be measured: in proportion to a lognormal coefficient, whose mean exceeds its median
    assert float(row["force_interval_share_left"]) == approx(better / now * exp(log(1.5) ** 2 / 2), abs=0.03)
    assert better / now < 0.95
