"""Rigs of soft bodies: friction of the examples, the model by default, and what is carried and what is refused."""

from pathlib import Path

import numpy as np
import pytest
from pytest import approx, raises

import sonolube as sl
from sonolube.errors import InvalidInput, MissingProperty
from sonolube.prediction.applicability import applicability, friction_interval
from sonolube.rig import friction_point, read_rig, simulate, wear_point
from sonolube.rig.file.reader import rig_from
from sonolube.rig.simulation import operating_caveats

RIGS = Path(__file__).parents[2] / "examples" / "rigs"
SOFT = ("finger_on_glass", "pom_on_steel", "webbing_on_ring")


def felt(**contact: str) -> dict[str, object]:
    """Content of the rig of the cutter head, its softer body named as felt and no friction model."""
    content = read_rig(RIGS / "cutter_head.toml").content()
    content["contact"] |= contact
    content["contact"]["softer"]["material"] = "felt"
    del content["friction"]["model"]
    del content["assumptions"]["friction.model"]
    return content


def test_a_finger_on_glass_floats_for_the_most_part() -> None:
    point = friction_point(read_rig(RIGS / "finger_on_glass.toml"))
    assert point.friction_model == "squeeze_film"
    assert 0.9 < point.friction_reduction < 1.0  # up to 95 % is reported of fingers on glass, under unlike conditions


def test_plastic_on_steel_is_eased_by_bouncing_on_its_own_elasticity() -> None:
    ratios = [
        friction_point(read_rig(RIGS / "pom_on_steel.toml", changes=[f"sliding.sliding_speed={v}mm/s"])).friction_ratio
        for v in (1, 20, 100)
    ]
    assert np.all(np.diff(ratios) > 0)
    assert ratios[-1] == 1.0


@pytest.mark.parametrize("name", SOFT)
def test_every_answer_says_how_far_it_was_tested(name: str) -> None:
    rig = read_rig(RIGS / f"{name}.toml")
    for caveats in (
        friction_point(rig).caveats,
        simulate(rig).caveats,
        wear_point(rig).caveats,
        operating_caveats(rig),
    ):
        assert any("theory alone" in line for line in caveats)


@pytest.mark.parametrize("name", SOFT)
def test_wear_is_withheld_with_the_reason_and_friction_is_not(name: str) -> None:
    rig = read_rig(RIGS / f"{name}.toml")
    result, point = simulate(rig), wear_point(rig)
    assert np.isfinite(result.friction.friction_ratio)
    for wear in (result.wear, point):
        assert np.isnan(wear.wear_rate)
        assert np.isnan(wear.intrinsic_wear_rate)
        assert wear.reason is not None
        assert "whose wear no model here has; measure it" in wear.reason


@pytest.mark.parametrize("name", SOFT)
def test_a_prediction_is_refused_in_one_line_with_what_remains(name: str) -> None:
    rig = read_rig(RIGS / f"{name}.toml")
    refusal = applicability(rig).refusal or ""
    assert "is of a soft or floating contact" in refusal
    assert "theory alone" in refusal
    assert "\n" not in refusal
    assert friction_interval(rig).low is None
    with raises(InvalidInput, match="sonolube friction"):
        sl.predict(rig)


def test_temperature_is_carried_where_the_bodies_have_thermal_properties_and_refused_where_not() -> None:
    found = sl.thermal(RIGS / "pom_on_steel.toml").object()
    rig = read_rig(RIGS / "pom_on_steel.toml")
    expected = friction_point(rig).friction_ratio * 0.22 * 20 * 20e-3
    assert found["frictional_heat_rate"]["value"] == approx(expected)
    with raises(MissingProperty, match="skin has no thermal_conductivity"):
        sl.thermal(RIGS / "finger_on_glass.toml", pin="skin", disc="soda_lime_glass")


def test_the_terminal_tells_the_share_of_the_film_and_the_stiffness_of_the_layer() -> None:
    film = sl.friction(RIGS / "finger_on_glass.toml").object()["mechanism"]
    assert film.startswith("the air film carries 98.5 % of the load at a mean gap of 11.8 um")
    layer = sl.friction(RIGS / "pom_on_steel.toml").object()["mechanism"]
    assert layer.startswith("layer of 1.63e+08 N/m at rest, indented by 0.122 um")
    assert "mechanism" not in sl.friction(RIGS / "tribometer.toml", interval=False).object()


def test_felt_with_a_decay_length_of_its_own_is_a_soft_layer_by_default() -> None:
    assert rig_from(felt(decay_length="1.3 um")).friction_model.name == "soft_layer"
    assert rig_from(felt()).friction_model.name == "asperity_stick_slip"
    of_others = felt(decay_length="1.3 um", decay_length_origin="published_tests")
    assert rig_from(of_others).friction_model.name == "asperity_stick_slip"


def test_a_stated_model_and_a_hard_body_keep_what_they_have() -> None:
    content = felt(decay_length="1.3 um")
    content["friction"]["model"] = "kinematic"  # type: ignore[index]
    assert rig_from(content).friction_model.name == "kinematic"
    changes = ["contact.decay_length=1.3um"]
    assert read_rig(RIGS / "poisson_al_steel.toml", changes=changes).friction_model.name == "asperity_stick_slip"


def test_a_layer_thickness_means_a_soft_layer() -> None:
    content = felt()
    content["friction"]["layer_thickness"] = "2 mm"  # type: ignore[index]
    rig = rig_from(content)
    assert rig.friction_model.name == "soft_layer"
    # 2.5 um change the pressure of 2 mm of felt by 4 to 9 % (Johnson 1985, 4.3 and 5.8), as the rig of the head says
    assert 0.9 < friction_point(rig).friction_ratio < 0.96
