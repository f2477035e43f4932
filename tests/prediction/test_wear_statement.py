"""Wear of a rig in words: its published pair, the body that wears, and what is not known."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from pytest import mark
from scipy.stats import norm

from sonolube.checks import Floats
from sonolube.prediction.bodies import WornBody, pair_of, wear_statement, worn_body
from sonolube.prediction.posterior import learned
from sonolube.rig import Rig, read_rig

RIGS = Path(__file__).parents[2] / "examples" / "rigs"
NOBODY = WornBody(names=(), sentence="Nobody knows.")
SOMEBODY = WornBody(names=("brass_c36000",), sentence="Brass wears.")


def rig_of(softer: str, harder: str) -> Rig:
    """Rig with two materials of the catalogue."""
    rig = read_rig(RIGS / "poisson_steel_steel.toml").replace("contact.softer.material", softer)
    return rig.replace("contact.harder.material", harder)


def lognormal(median: float, spread: float) -> Floats:
    """Draws of a wear rate ratio, evenly spread."""
    return np.asarray(median * np.exp(spread * norm.ppf((np.arange(4000) + 0.5) / 4000)))


@mark.parametrize(
    ("softer", "harder", "pair"),
    [
        ("aluminium_2024", "stainless_steel_316", "stainless steel on aluminium"),
        ("aluminium_6061", "steel_52100", "stainless steel on aluminium"),
        ("stainless_steel_304", "stainless_steel_316", "stainless steel on stainless steel"),
        ("steel_1045", "m50", "stainless steel on stainless steel"),
        ("m50", "m50", "M50 tool steel on M50 tool steel"),
        ("m50", "alumina", "ceramic on M50 tool steel"),
        ("titanium_6al4v", "titanium_grade_2", "titanium on titanium"),
        ("titanium_6al4v", "stainless_steel_304", "stainless steel on titanium"),
        ("brass_c36000", "stainless_steel_304", None),
        ("aluminium_2024", "alumina", None),
    ],
)
def test_a_pair_of_materials_is_that_of_table_2_14_in_either_order(softer: str, harder: str, pair: str | None) -> None:
    assert pair_of(rig_of(softer, harder)) == pair
    assert pair_of(rig_of(harder, softer)) == pair


def test_a_rig_without_names_has_no_pair_and_no_body_that_wears() -> None:
    rig = read_rig(RIGS / "tribometer.toml")
    assert pair_of(rig) is None
    assert worn_body(rig).names == ()
    assert "name the materials of both bodies" in worn_body(rig).sentence


def test_the_softer_body_wears() -> None:
    # 137 and 217 HV, D Table 2.15
    worn = worn_body(rig_of("stainless_steel_316", "aluminium_2024"))
    assert worn.names == ("aluminium_2024",)
    assert "Aluminium alloy 2024, 1.34 GPa against 2.13 GPa" in worn.sentence


def test_a_near_tie_of_hardness_is_said() -> None:
    # 140 HV of free-cutting brass, 129 HV of annealed 304
    worn = worn_body(rig_of("brass_c36000", "stainless_steel_304"))
    assert set(worn.names) == {"brass_c36000", "stainless_steel_304"}
    assert "Both bodies may wear" in worn.sentence
    assert "differ by 9 % in hardness" in worn.sentence


def test_bodies_of_one_material_both_wear() -> None:
    assert "Both bodies are of Bearing and tool steel M50" in worn_body(rig_of("m50", "m50")).sentence


def test_wear_of_unknown_materials_is_said_to_be_unknown() -> None:
    text = wear_statement(learned().wear.wear_rate_ratios(4000), pair=None, worn_body=NOBODY)
    assert text.startswith("Whether vibration reduces wear is not known")
    assert "name both materials" in text
    assert "wear fell by 45 to 73 % in 4, and not in 2" in text  # Tables 2.5, 2.7 and 2.14
    assert "name both" not in wear_statement(lognormal(0.7, 0.6), pair=None, worn_body=SOMEBODY)


def test_wear_of_steel_on_aluminium_falls_and_the_tests_are_named() -> None:
    pair = "stainless steel on aluminium"
    text = wear_statement(learned().wear.wear_rate_ratios(4000, pair=pair), pair=pair, worn_body=SOMEBODY)
    assert text.startswith("Wear falls by ")
    assert "In 6 tests of stainless steel on aluminium it fell by 45 %." in text
    assert text.endswith("Brass wears.")


def test_titanium_is_said_to_have_worn_no_less() -> None:
    pair = "titanium on titanium"
    text = wear_statement(learned().wear.wear_rate_ratios(4000, pair=pair), pair=pair, worn_body=SOMEBODY)
    assert text.startswith("Whether vibration reduces wear is not known")
    assert "In one test of titanium on titanium it did not fall." in text


@mark.parametrize(
    ("draws", "beginning"),
    [
        (np.ones(100), "Wear does not change: the vibration has no effect on the contact."),
        (lognormal(0.98, 0.06), "Wear goes from 6 % more to 9 % less (80 %)."),
        (lognormal(0.5, 0.1), "Wear falls by 43 to 56 % (80 %)."),
        (lognormal(1.6, 0.1), "Wear rises by 41 to 82 % (80 %)."),
    ],
)
def test_the_change_is_said_by_its_interval(draws: Floats, beginning: str) -> None:
    # 80 % of a lognormal lie within exp(+- 1.2816 s) of its median
    assert wear_statement(draws, pair=None, worn_body=SOMEBODY).startswith(beginning)


def reduction(low: float, high: float) -> Floats:
    """Draws of a wear rate ratio, 80 % of whose reductions lie evenly between two."""
    middle, half = (low + high) / 2, (high - low) / 2 / 0.8
    return 1 - np.linspace(middle - half, middle + half, 4001)


@mark.parametrize(
    ("low", "high", "sentence"),
    [
        (-0.019, 0.019, "Wear does not change: the vibration has no effect on the contact."),
        (-0.019, 0.021, "Wear falls by 0 to 2 % (80 %)."),
        (-0.019, 0.5, "Wear falls by 0 to 50 % (80 %)."),
        (0.12, 0.5, "Wear falls by 12 to 50 % (80 %)."),
        (-0.021, 0.5, "Wear goes from 2 % more to 50 % less (80 %)."),
        (-0.099, 0.5, "Wear goes from 10 % more to 50 % less (80 %)."),
        (-0.5, 0.099, "Wear goes from 50 % more to 10 % less (80 %)."),
        (-0.5, 0.021, "Wear goes from 50 % more to 2 % less (80 %)."),
        (-0.5, 0.019, "Wear rises by 0 to 50 % (80 %)."),
        (-0.5, -0.12, "Wear rises by 12 to 50 % (80 %)."),
    ],
)
def test_a_fiftieth_is_no_change_of_wear_and_a_tenth_a_large_one(low: float, high: float, sentence: str) -> None:
    assert wear_statement(reduction(low, high), pair=None, worn_body=SOMEBODY) == f"{sentence} Brass wears."


def test_wear_that_may_rise_or_fall_by_more_than_a_tenth_is_not_known() -> None:
    found = wear_statement(reduction(-0.101, 0.101), pair=None, worn_body=SOMEBODY)
    assert found.startswith(
        "Whether vibration reduces wear is not known, between 10 % more and 10 % less (80 %); measure wear with and"
        " without vibration. Of 6 published pairs of materials wear fell by 45 to 73 % in 4, and not in 2."
    )


def with_hardness(softer: str, harder: str) -> Rig:
    rig = rig_of("stainless_steel_304", "m50").replace("contact.softer.hardness", softer)
    return rig.replace("contact.harder.hardness", harder)


def test_hardnesses_within_a_quarter_are_a_near_tie() -> None:
    tie = worn_body(with_hardness("2 GPa", "2.49 GPa"))
    assert tie.names == ("stainless_steel_304", "m50")
    assert tie.sentence.startswith("Both bodies may wear: ")
    assert tie.sentence.endswith("differ by 25 % in hardness, 2 GPa against 2.49 GPa.")
    assert worn_body(with_hardness("2 GPa", "2.51 GPa")).names == ("stainless_steel_304",)
    other = worn_body(with_hardness("3 GPa", "2 GPa"))
    assert other.names == ("m50",)
    assert "2 GPa against 3 GPa of Stainless steel" in other.sentence


def test_an_estimated_hardness_is_said_and_an_unknown_one_leaves_the_worn_body_open() -> None:
    # bronze C51000 has no hardness in the catalogue but a yield strength; the coating has neither
    estimated = worn_body(rig_of("bronze_c51000", "m50").replace("contact.softer.yield_strength", "500 MPa"))
    assert "about 1.5 GPa (three times its yield strength) against" in estimated.sentence
    rig = replace(rig_of("m50", "m50"), pin_material="pzt4", disc_material="alumina")
    for changed in (rig, replace(rig, pin_material="alumina", disc_material="pzt4")):
        unknown = worn_body(changed)
        assert unknown.names == ()
        assert unknown.sentence.startswith("Which body wears is not known: no source states the hardness of ")
        assert "PZT" in unknown.sentence
