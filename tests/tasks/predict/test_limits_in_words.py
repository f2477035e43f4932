"""Limits of an operating point that every task says or refuses: crushed bodies, lubricated wear, no change."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from pytest import mark, raises

import sonolube as sl
from sonolube.errors import InvalidInput
from sonolube.report.blocks import Bars

RIG = Path(__file__).parents[3] / "examples" / "rigs" / "power_map.toml"
# above the 129 HV of its steel 304 in the catalogue, 1.27 GPa, on a surface so rough that a gap is left
CRUSHED = ["contact.nominal_area=5 mm2", "contact.roughness.rms_height=20um", "contact.normal_load=15kN"]
SENTENCE = "a load of 15 kN over 5 mm2 is 3 GPa, above the hardness 1.27 GPa of the softer body, which cannot bear it"


@mark.parametrize("task", [sl.wear, sl.simulate])
def test_a_load_that_the_softer_body_cannot_bear_stands_above_the_result(task: Callable[..., Any]) -> None:
    rig = sl.read_rig(RIG, changes=CRUSHED)
    assert task(rig).leading_caveats()[0].startswith(SENTENCE)
    assert SENTENCE in " ".join(task(rig).json_object()["caveats"])
    borne = sl.read_rig(RIG, changes=[*CRUSHED[:2], "contact.normal_load=6kN"])
    assert not [each for each in task(borne).every_caveat() if "cannot bear" in each]


def test_heat_of_a_load_that_the_softer_body_cannot_bear_is_refused() -> None:
    with raises(InvalidInput, match=SENTENCE):
        sl.thermal(sl.read_rig(RIG, changes=CRUSHED), pin="m50", disc="m50")


@mark.parametrize(("coefficient", "said"), [(0.1, True), (0.2, False)])
def test_wear_of_a_contact_that_counts_as_lubricated_is_said_to_be_unknown(coefficient: float, said: bool) -> None:
    rig = sl.read_rig(RIG, changes=[f"friction.friction_coefficient={coefficient}"])
    for task in (sl.wear, sl.simulate):
        found = [each for each in task(rig).leading_caveats() if "wear is not known of a lubricated contact" in each]
        assert len(found) == said


def test_where_vibration_does_nothing_no_run_is_advised_and_no_change_has_a_sign() -> None:
    answer = sl.predict(sl.read_rig(RIG, changes=["sliding.sliding_speed=30m/s"]), draws=200)
    text = answer.text()
    assert "Friction does not change." in text
    assert "-0 %" not in text
    assert "One run of yours here" not in text
    assert answer.json_object()["one_run"] is None
    (bars,) = (each for each in answer.first_blocks() if isinstance(each, Bars))
    assert [bar.text.partition(" %")[0] for bar in bars.bars[:2]] == ["0", "0"]
