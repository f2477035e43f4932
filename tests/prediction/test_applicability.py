"""Limits of a prediction: direction, soft bodies, lubricants and frequencies."""

from dataclasses import replace
from pathlib import Path

from pytest import mark

from sonolube.prediction.applicability import NORMAL_VIBRATION, applicability
from sonolube.rig import Rig, read_rig

RIGS = Path(__file__).parents[2] / "examples" / "rigs"


def rig_of(softer: str, harder: str = "stainless_steel_304") -> Rig:
    """Rig with two materials of the catalogue."""
    rig = read_rig(RIGS / "poisson_steel_steel.toml").replace("contact.softer.material", softer)
    return rig.replace("contact.harder.material", harder)


@mark.parametrize("name", ["tribometer", "poisson_al_steel", "welder_round", "flextensional", "power_map"])
def test_the_rigs_of_the_published_tests_are_predicted_without_a_caveat(name: str) -> None:
    found = applicability(read_rig(RIGS / f"{name}.toml"))
    assert (found.refusal, found.caveats, found.any_ratio) == (None, (), False)


def test_motion_in_the_plane_of_contact_is_refused_with_what_takes_it() -> None:
    rig = read_rig(RIGS / "tribometer.toml").replace("friction.in_plane_fraction", 0.2)
    refusal = applicability(rig).refusal or ""
    assert "vibration along the normal" in refusal
    assert "fit and compare" in refusal
    assert "\n" not in refusal
    assert "normal" in NORMAL_VIBRATION


def test_the_cutter_head_on_felt_is_refused_with_the_models_of_soft_layers() -> None:
    refusal = applicability(read_rig(RIGS / "cutter_head.toml")).refusal or ""
    assert "1.19 MPa" in refusal
    assert "sonolube friction" in refusal
    assert "soft_layer" in refusal
    assert "\n" not in refusal


@mark.parametrize("polymer", ["ptfe", "uhmwpe", "pmma"])
def test_polymers_are_refused_by_name(polymer: str) -> None:
    assert "is soft" in (applicability(rig_of(polymer)).refusal or "")


def test_friction_below_that_of_dry_metals_leaves_any_reduction_possible() -> None:
    found = applicability(replace(rig_of("brass_c36000"), friction_coefficient=0.1))
    assert found.any_ratio
    assert "0.1 without vibration is below 0.15" in found.caveats[0]
    assert "0 to 100 %" in found.caveats[0]
    assert not applicability(replace(rig_of("brass_c36000"), friction_coefficient=0.2)).any_ratio


def test_low_friction_of_a_ceramic_or_a_coating_is_dry() -> None:
    ceramic = rig_of("alumina", "alumina").replace("friction.friction_coefficient", 0.12)
    assert not applicability(ceramic).any_ratio
    assert not applicability(read_rig(RIGS / "coated_plate.toml")).any_ratio


def test_a_stated_lubricant_leaves_any_reduction_possible_at_any_friction() -> None:
    found = applicability(rig_of("brass_c36000"), lubricant=True)
    assert found.any_ratio
    assert found.caveats[0].startswith("the contact is lubricated: a dry prediction does not hold")


@mark.parametrize(("frequency", "is_said"), [(12e3, True), (16e3, False), (22e3, False), (40e3, True)])
def test_frequencies_beyond_the_tests_rest_on_one_scaling(frequency: float, is_said: bool) -> None:
    rig = read_rig(RIGS / "poisson_steel_steel.toml").replace("drive.frequency", f"{frequency} Hz")
    caveats = applicability(rig).caveats
    assert bool(caveats) == is_said
    if is_said:
        assert "16 kHz to 22 kHz" in caveats[0]
        assert "v_r/(omega a)" in caveats[0]
