"""Limits of a prediction: direction, soft bodies, lubricants, frequencies, ranges; its interval; heat of a contact."""

from dataclasses import replace
from math import pi, sqrt
from pathlib import Path

import numpy as np
from pytest import approx, mark, raises

from sonolube.errors import InvalidInput, MissingProperty
from sonolube.facts.materials import material
from sonolube.models.thermal import ThermalSolid, contact_rise, real_contact_spot
from sonolube.prediction import interval, predict
from sonolube.prediction.applicability import (
    NORMAL_VIBRATION,
    FrictionInterval,
    applicability,
    contact_heating,
    extrapolation_caveats,
    friction_interval,
)
from sonolube.prediction.bodies import softer_hardness
from sonolube.prediction.inputs import rig_inputs
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


@mark.parametrize(("frequency", "is_said"), [(15.3e3, False), (15.2e3, True), (23.0e3, False), (23.2e3, True)])
def test_a_frequency_counts_as_tested_up_to_a_twentieth_beyond_the_range(frequency: float, is_said: bool) -> None:
    # 16 kHz / 1.05 = 15.24 kHz; 22 kHz * 1.05 = 23.1 kHz
    rig = read_rig(RIGS / "poisson_steel_steel.toml").replace("drive.frequency", f"{frequency} Hz")
    assert bool(applicability(rig).caveats) == is_said


def test_no_frequency_is_judged_without_a_drive_or_by_coulombs_law_within_the_plane() -> None:
    assert applicability(replace(read_rig(RIGS / "welder_round.toml"), drive=None)).caveats == ()
    within_plane = applicability(read_rig(RIGS / "vibrating_base.toml"))  # 3 kHz
    assert within_plane.caveats
    assert not any("the frequency of" in each for each in within_plane.caveats)


@mark.parametrize(("modulus", "is_refused"), [("9.9 GPa", True), ("10.1 GPa", False)])
def test_unnamed_bodies_are_soft_below_an_effective_modulus_of_10_gpa(modulus: str, is_refused: bool) -> None:
    rig = read_rig(RIGS / "tribometer.toml").replace("contact.pair.effective_modulus", modulus)
    refusal = applicability(rig).refusal
    assert (refusal is not None) == is_refused
    assert not is_refused or "an effective modulus of 9.9 GPa is that of a soft body" in (refusal or "")
    one_named = replace(rig, pin_material="m50")
    assert (applicability(one_named).refusal is not None) == is_refused
    both_named = replace(one_named, disc_material="alumina")
    assert applicability(both_named).refusal is None


def test_two_polymers_are_named_together_and_a_model_of_soft_bodies_by_its_name() -> None:
    assert "are soft" in (applicability(rig_of("ptfe", "uhmwpe")).refusal or "")
    cutter = applicability(read_rig(RIGS / "cutter_head.toml").replace("friction.model", "squeeze_film")).refusal or ""
    assert "friction model squeeze_film is of a soft or floating contact" in cutter


def tribometer(*changes: str) -> Rig:
    return read_rig(RIGS / "tribometer.toml", changes=list(changes))


@mark.parametrize(
    ("change", "said"),
    [
        # tested are 3.5 to 265.9 mm/s, a twentieth more either way counting as tested: 3.333 and 279.2 mm/s;
        # and 59.6 to 109.2 GPa: 56.76 and 114.6 GPa
        ("sliding.sliding_speed=3.34mm/s", ""),
        ("sliding.sliding_speed=3.32mm/s", "sliding speed 3.32 mm/s (3.5 mm/s to 266 mm/s)"),
        ("sliding.sliding_speed=279mm/s", ""),
        ("sliding.sliding_speed=280mm/s", "sliding speed 280 mm/s (3.5 mm/s to 266 mm/s)"),
        ("contact.pair.effective_modulus=57GPa", ""),
        ("contact.pair.effective_modulus=56GPa", "effective modulus 56 GPa (59.6 GPa to 109 GPa)"),
        ("contact.pair.effective_modulus=114GPa", ""),
        ("contact.pair.effective_modulus=115GPa", "effective modulus 115 GPa (59.6 GPa to 109 GPa)"),
    ],
)
def test_a_condition_counts_as_tested_up_to_a_twentieth_beyond_its_range(change: str, said: str) -> None:
    rig = tribometer(change)
    found = extrapolation_caveats(rig, rig_inputs(rig))
    beginning = "outside the range of the published tests, so that the prediction extrapolates: "
    assert found == ((beginning + said,) if said else ())


@mark.parametrize(
    ("amplitude", "said"),
    [
        # 0.46 to 11.46 um, with the twentieth 0.4381 and 12.03 um
        (0.44e-6, ""),
        (0.436e-6, "vibration amplitude 436 nm (460 nm to 11.5 um)"),
        (12.0e-6, ""),
        (12.1e-6, "vibration amplitude 12.1 um (460 nm to 11.5 um)"),
    ],
)
def test_an_amplitude_counts_as_tested_up_to_a_twentieth_beyond_its_range(amplitude: float, said: str) -> None:
    inputs = rig_inputs(tribometer())
    inputs = replace(inputs, amplitude=replace(inputs.amplitude, value=amplitude))
    found = extrapolation_caveats(tribometer(), inputs)
    assert [each.rpartition(": ")[2] for each in found] == ([said] if said else [])


def test_two_conditions_beyond_the_tests_are_named_together() -> None:
    rig = tribometer("sliding.sliding_speed=1m/s", "contact.pair.effective_modulus=12GPa")
    (found,) = extrapolation_caveats(rig, rig_inputs(rig))
    assert "sliding speed 1 m/s (3.5 mm/s to 266 mm/s); effective modulus 12 GPa" in found


def test_a_watt_on_a_slow_circular_contact_heats_it_as_two_half_spaces_in_parallel() -> None:
    # uniform flux on a circle of radius a at rest: mean rise 8 Q/(3 pi^2 a k), Q shared so that both means are equal:
    # 8/(3 pi^2 a (k_1 + k_2)) for 1 W; A = 2.25 mm2, a = sqrt(A/pi) = 0.8463 mm; k of 316 is 16.3, of 2024 121 W/(m K)
    rig = tribometer("sliding.sliding_speed=1um/s")
    radius = sqrt(2.25e-6 / pi)
    expected = 8 / (3 * pi**2 * radius * (16.3 + 121.0))
    assert contact_heating(rig, "stainless_steel_316", "aluminium_2024") == approx(expected, rel=1e-3)


def test_the_pin_is_the_body_whose_contact_stays_so_that_a_moving_insulator_helps_more() -> None:
    # at speed the mean rise of the moving body falls as 1/sqrt(Pe), that of the pin stays: a disc of low diffusivity
    # takes heat where a pin of the same does not
    fast = tribometer("sliding.sliding_speed=100m/s")
    steel_pin, steel_disc = (
        contact_heating(fast, *each)
        for each in (("stainless_steel_316", "aluminium_2024"), ("aluminium_2024", "stainless_steel_316"))
    )
    assert isinstance(steel_pin, float)
    assert isinstance(steel_disc, float)
    # half-space under a fast circle of uniform flux: mean rise c q a/k/sqrt(Pe), Pe = v a/kappa (c of Tian and Kennedy
    # for the ellipse, 0.94 within 10 %); with the stationary body in parallel
    for rise, (pin, disc) in (
        (steel_pin, ((16.3, 8000, 500), (121.0, 2780, 875))),
        (steel_disc, ((121.0, 2780, 875), (16.3, 8000, 500))),
    ):
        radius, speed = sqrt(2.25e-6 / pi), 100.0
        peclet = speed * radius / (disc[0] / (disc[1] * disc[2]))
        still = 8 / (3 * pi) * radius / pin[0]
        moving = 0.94 * radius / disc[0] / sqrt(peclet)
        assert rise == approx(1 / 2.25e-6 / (1 / still + 1 / moving), rel=0.15)


def test_a_spot_of_22_micrometres_under_71_watts_flashes_by_2600_kelvin() -> None:
    # 5 N at 3.3 GPa: a = sqrt(5/(3.3e9 pi)) = 22.0 um. Steel on steel, k = 45 W/(m K), kappa = 45/(7850 * 475) =
    # 1.21e-5 m2/s, 30 m/s: v a/kappa = 30 * 22e-6/1.21e-5 = 54.7. Fixed body: 8/(3 pi) a/k per flux; moving one:
    # 0.94 (c of Tian and Kennedy for the mean of an ellipse, 10 %) a/(k sqrt(v a/kappa)); both in parallel
    spot = real_contact_spot(normal_load=5.0, hardness=3.3e9)
    assert spot.half_length == approx(22.0e-6, rel=2e-3)
    steel = ThermalSolid(thermal_conductivity=45.0, density=7850.0, specific_heat_capacity=475.0)
    rise = float(contact_rise(steel, steel, spot, heat_rate=71.0, sliding_speed=30.0).mean_temperature_rise)
    still, moving = 8 / (3 * pi) * 22e-6 / 45, 0.94 * 22e-6 / 45 / sqrt(54.7)
    assert rise == approx(71 / (pi * 22e-6**2) / (1 / still + 1 / moving), rel=0.1)
    assert rise == approx(2600, rel=0.1)


def test_the_hardness_is_that_of_the_softer_body_or_three_times_the_yield_strength() -> None:
    assert softer_hardness(tribometer()) == approx(3 * 410e6)  # names no material
    aluminium = material("aluminium_2024").value("hardness")
    assert softer_hardness(tribometer(), "stainless_steel_316", "aluminium_2024") == approx(aluminium)
    assert softer_hardness(tribometer(), "aluminium_2024", "stainless_steel_316") == approx(aluminium)


def test_a_pressure_above_the_hardness_is_refused_with_load_area_and_hardness() -> None:
    # 3 kN over 2.25 mm2 are 1.33 GPa; three times 410 MPa are 1.23 GPa
    assert applicability(replace(tribometer(), normal_load=2.7e3)).refusal is None
    refusal = applicability(replace(tribometer(), normal_load=3.0e3)).refusal or ""
    assert "a load of 3 kN over 2.25 mm2 is 1.33 GPa, above the hardness 1.23 GPa of the softer body" in refusal


def test_a_roughness_far_above_that_of_the_published_tests_is_said() -> None:
    rough = [applicability(tribometer(f"contact.roughness.rms_height={height}um")) for height in (29, 31, 62)]
    assert [bool(each.caveats) for each in rough] == [False, True, True]
    assert "62 um is far above the 6 um of the published tests" in rough[2].caveats[0]


def test_heat_needs_both_materials_with_thermal_properties_and_says_which_lack() -> None:
    assert contact_heating(tribometer(), None, None) == "name the materials of pin and disc"
    for pin, disc in (("m50", None), (None, "m50")):
        with raises(InvalidInput, match="needs both materials; give pin and disc, or neither"):
            contact_heating(tribometer(), pin, disc)
    named = replace(tribometer(), pin_material="stainless_steel_316", disc_material="aluminium_2024")
    both = contact_heating(tribometer(), "stainless_steel_316", "aluminium_2024")
    assert contact_heating(named, None, None) == approx(both)
    assert contact_heating(named, None, "aluminium_2024") == approx(both)
    other = contact_heating(tribometer(), "aluminium_2024", "stainless_steel_316")
    assert contact_heating(named, "aluminium_2024", "stainless_steel_316") == approx(other)
    unknown = replace(named, pin_material="steel_52100")
    text = contact_heating(unknown, None, None)
    assert isinstance(text, str)
    assert "52100" in text
    with raises(MissingProperty):
        contact_heating(tribometer(), "steel_52100", "aluminium_2024")


def test_an_interval_is_told_in_words_or_why_there_is_none() -> None:
    assert FrictionInterval(low=0.123, high=0.456).text == "0.12 to 0.46 (80 %, `sonolube predict`)"
    assert FrictionInterval(low=0.123, median=0.3, high=0.456).text == "0.3, 0.12 to 0.46 (80 %, `sonolube predict`)"
    assert FrictionInterval(reason="felt is soft").text == "not predicted: felt is soft"
    assert FrictionInterval(high=0.5, reason="one end").text == "not predicted: one end"
    assert FrictionInterval(low=0.5, reason="one end").text == "not predicted: one end"


def test_the_interval_beside_friction_is_that_of_predict_along_the_normal() -> None:
    found = friction_interval(tribometer())
    assert (found.low, found.high) == approx(interval(predict(tribometer()), "friction_ratio"))
    assert found.low is not None
    assert found.high is not None
    draws = predict(tribometer())["friction_ratio"].to_numpy()
    assert np.mean(draws < found.low) == approx(0.1, abs=2e-3)
    assert np.mean(draws > found.high) == approx(0.1, abs=2e-3)


def test_rigs_without_a_prediction_have_the_reason_in_place_of_an_interval() -> None:
    soft = friction_interval(read_rig(RIGS / "cutter_head.toml"))
    assert (soft.low, soft.high) == (None, None)
    assert "soft_layer" in soft.reason
    oiled = friction_interval(replace(rig_of("brass_c36000"), friction_coefficient=0.1))
    assert oiled.low is None
    assert "the contact counts as lubricated" in oiled.reason
    still = friction_interval(replace(tribometer(), sliding_speed=0.0))
    assert still.low is None
    assert "needs a sliding speed above 0" in still.reason
