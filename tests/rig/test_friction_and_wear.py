"""Parameters of friction models in rig files, the friction and wear they give, and what withholds them, by hand."""

import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pytest import approx, raises
from scipy.special import i0
from tests.same import same

from sonolube.errors import InvalidInput, OutsideRange, UnknownName
from sonolube.models.contact import ContactMotion
from sonolube.models.friction import dong_2015_half_period_ratio, sine_stick_slip_ratio
from sonolube.models.friction.models.range_check import CheckedRatio
from sonolube.models.wear import cube_wear_rate
from sonolube.rig import Rig, friction_point, read_rig, rig_from, simulate, steady_vibration
from sonolube.rig.friction_and_wear import (
    PUBLISHED_DECAY_LENGTH,
    _mean_ratio,
    decay_length_caveat,
    direction_caveats,
    friction_at_speeds,
    input_caveats,
    mean_over_time,
    mean_wear,
    prescribed_sine,
    range_text,
    resting_caveats,
    rise_caveats,
    wear_model_of,
    wear_model_that_holds,
)
from sonolube.rig.resolved_rig import PRESSED_LAYER, resolved_rig

RIGS = Path(__file__).parents[2] / "examples" / "rigs"


def tribometer(*changes: str) -> Rig:
    return read_rig(RIGS / "tribometer.toml", changes=changes)


def undriven() -> Rig:
    """The tribometer's contact and vibration, of which nobody knows the frequency."""
    known = tribometer()
    return Rig(
        title="undriven",
        source="none",
        contact=known.contact,
        normal_load=known.normal_load,
        friction_coefficient=known.friction_coefficient,
        sliding_speed=known.sliding_speed,
        vibration_amplitude=known.vibration_amplitude,
    )


def test_a_shorter_memory_leaves_less_of_the_sine_to_gain() -> None:
    for length in (0.5e-6, 1.5e-6, 5e-6):
        rig = tribometer(f"friction.memory_length={length}m", "vibration.amplitude_source=per-volt")
        expected = sine_stick_slip_ratio(
            decay_length=2e-6,
            vibration_amplitude=steady_vibration(rig).vibration_amplitude,
            frequency=22e3,
            sliding_speed=20.3e-3,
            memory_length=length,
        )
        assert friction_point(rig).friction_ratio == approx(float(expected), rel=1e-9)


def test_a_soft_holder_lets_slow_sliding_keep_what_the_widest_gap_carries() -> None:
    # in series with a spring much softer than the contact the bristle never reaches its limit but at the widest gap
    soft = tribometer(
        "friction.model=bristle_with_holder", "friction.holder_stiffness=1e4N/m", "sliding.sliding_speed=1um/s"
    )
    beta = steady_vibration(soft).vibration_amplitude / 2e-6
    assert friction_point(soft).friction_ratio == approx(np.exp(-beta) / i0(beta), rel=1e-3)


def test_in_plane_motion_changes_the_friction_of_either_model_that_takes_it() -> None:
    for model in ("asperity_stick_slip", "bristle_with_holder"):
        still = tribometer(f"friction.model={model}")
        moved = tribometer(f"friction.model={model}", "friction.in_plane_fraction=0.3", "friction.in_plane_phase=90deg")
        assert getattr(moved.friction_model, "in_plane_phase") == approx(np.pi / 2)  # noqa: B009
        assert abs(simulate(moved).friction.friction_ratio - simulate(still).friction.friction_ratio) > 0.02


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        (
            ["friction.holder_stiffness=1e6N/m"],
            r"friction\.holder_stiffness: model asperity_stick_slip does not take it; bristle_with_holder does",
        ),
        (
            ["friction.model=bristle_with_holder", "friction.memory_length=1um"],
            r"friction\.memory_length: model bristle_with_holder",
        ),
        (
            ["friction.model=kinematic", "friction.in_plane_fraction=0.1"],
            "asperity_stick_slip and bristle_with_holder do$",
        ),
        (["friction.in_plane_phase=1rad"], r"needs friction\.in_plane_fraction"),
        (["friction.memory_length=0m"], r"memory_length must be positive, got 0\.0 m"),
        (["friction.in_plane_fraction=-0.1"], "in_plane_fraction must not be negative"),
        (["friction.memory_length=1"], "memory_length: 1 has no unit"),
    ],
)
def test_a_parameter_that_the_model_does_not_have_is_refused_by_name(changes: list[str], complaint: str) -> None:
    with raises(InvalidInput, match=complaint):
        tribometer(*changes)


def test_wear_follows_the_friction_model_where_it_has_one_of_its_name() -> None:
    balanced = simulate(tribometer("friction.model=dong_2015_load_balanced"))
    assert balanced.wear.wear_model == "dong_2015_load_balanced"
    # with the area in proportion to the force only the cube's height matters: 1 + [l ln I0 - a I1/I0]/d
    assert 0.9 < balanced.wear.wear_rate / float(cube_wear_rate(tribometer().contact, normal_load=3.0)) < 1
    assert simulate(tribometer()).wear.wear_model == "dong_2015_half_period"


def test_friction_is_by_the_rigs_own_model_unless_another_is_named() -> None:
    rig = tribometer("friction.model=kinematic", "vibration.amplitude_source=per-volt")
    assert friction_point(rig).friction_model == "kinematic"
    cube = dong_2015_half_period_ratio(
        rig.contact, normal_load=rig.normal_load, vibration_amplitude=steady_vibration(rig).vibration_amplitude
    )
    assert friction_point(rig, model="dong_2015_half_period").friction_ratio == approx(float(cube), rel=1e-4)
    with raises(UnknownName, match="did you mean asperity_stick_slip"):
        friction_point(rig, model="asperity_stickslip")


def test_a_named_model_keeps_the_in_plane_motion_of_the_rig() -> None:
    rig = tribometer("friction.in_plane_fraction=0.3", "friction.in_plane_phase=90deg")
    own = tribometer(
        "friction.model=bristle_with_holder", "friction.in_plane_fraction=0.3", "friction.in_plane_phase=90deg"
    )
    named = friction_point(rig, model="bristle_with_holder")
    same(named.friction_ratio, friction_point(own).friction_ratio)


def test_the_half_period_needs_no_frequency_and_other_models_say_that_they_do() -> None:
    rig = undriven()
    assert friction_point(rig, model="dong_2015_half_period").friction_ratio < 1
    with raises(InvalidInput, match=r"drive\.frequency is missing; friction model asperity_stick_slip needs it"):
        friction_point(rig)


STATED = read_rig(RIGS / "flextensional.toml")  # 0.693 um at 16 kHz under 2.6 N


def motion(displacement: list[float], frequency: float) -> ContactMotion:
    """Motion through places, each for as long."""
    moved = np.repeat(displacement, 8)
    return ContactMotion(displacement=moved, normal_force=np.ones(moved.size), frequency=frequency, normal_load=1.0)


def checked(ratio: float, raw: float, reason: str = "") -> CheckedRatio:
    return CheckedRatio(
        friction_ratio=np.array([ratio, 0.5]), raw_friction_ratio=np.array([raw, 0.5]), reason=np.array([reason, ""])
    )


def test_a_mean_ratio_weighs_its_parts_and_the_first_reason_withholds_it() -> None:
    mean = _mean_ratio([checked(0.2, 0.2), checked(0.6, 0.8)], [3.0, 1.0])
    assert mean.friction_ratio == approx([0.3, 0.5])
    assert mean.raw_friction_ratio == approx([0.35, 0.5])
    assert mean.reason.tolist() == ["", ""]
    withheld = _mean_ratio([checked(0.2, 0.2), checked(np.nan, 1.2, "first"), checked(np.nan, 1.4, "next")], [1.0] * 3)
    assert np.isnan(withheld.friction_ratio).tolist() == [True, False]
    assert withheld.reason.tolist() == ["first", ""]
    assert withheld.raw_friction_ratio == approx([2.8 / 3, 0.5])


def test_a_slow_motion_counts_longer() -> None:
    # 1 ms and 4 ms
    motions = (motion([0.0], 1000.0), motion([0.0], 250.0))
    assert float(mean_over_time([np.array(1.0), np.array(6.0)], motions)) == approx(5.0)


def test_one_speed_that_is_refused_leaves_the_others_their_friction() -> None:
    sine = prescribed_sine(STATED, vibration_amplitude=0.5e-6)
    found = friction_at_speeds(STATED, sine, np.array([5e-3, 0.0, 10.0]))
    assert np.isnan(found.friction_ratio).tolist() == [False, True, False]
    assert np.isnan(found.raw_friction_ratio).tolist() == [False, True, False]
    assert [bool(reason) for reason in found.reason] == [False, True, False]
    assert found.friction_ratio[2] == approx(1.0, abs=1e-3)
    alone = friction_at_speeds(STATED, sine, np.array([5e-3]))
    assert found.friction_ratio[0] == approx(float(alone.friction_ratio[0]))


def test_a_sine_lies_about_the_gap_that_its_friction_model_means() -> None:
    # of a balanced load the mean rises by l ln I0(a/l), l = 6 um/3
    amplitude = 1e-6
    balanced = prescribed_sine(STATED, vibration_amplitude=amplitude)
    assert balanced.displacement.mean() == approx(2e-6 * np.log(i0(0.5)), rel=1e-6)
    assert np.ptp(balanced.displacement) / 2 == approx(amplitude, rel=1e-4)
    assert balanced.frequency == 16e3
    at_rest = read_rig(RIGS / "flextensional.toml", changes=["friction.model=dong_2015_half_period"])
    still = prescribed_sine(at_rest, vibration_amplitude=amplitude, frequency=123.0, normal_load=1.5)
    assert still.displacement.mean() == approx(0.0, abs=1e-12)
    assert (still.frequency, still.normal_load) == (123.0, 1.5)
    assert balanced.normal_load == 2.6
    undriven = replace(STATED, drive=None)
    with raises(InvalidInput, match=r"drive\.frequency is missing; friction model asperity_stick_slip needs it"):
        prescribed_sine(undriven, vibration_amplitude=amplitude)
    assert prescribed_sine(undriven, vibration_amplitude=amplitude, frequency=5.0).frequency == 5.0
    assert prescribed_sine(replace(at_rest, drive=None), vibration_amplitude=amplitude).frequency == 1.0


def test_the_models_that_hold_are_told_by_their_range() -> None:
    assert range_text([], "wear") == "no wear model holds for this vibration"
    assert range_text([(0.4567, "one")], "wear") == "of the wear models one holds: ratio 0.457"
    three = [(0.5, "middle"), (0.9, "high"), (0.25, "low")]
    assert range_text(three, "friction") == "the friction models that hold give ratios from 0.25 (low) to 0.9 (high)"


def test_a_wear_model_has_the_name_of_the_friction_model_or_is_the_default() -> None:
    named = read_rig(RIGS / "flextensional.toml", changes=["friction.model=dong_2015_load_balanced"])
    assert wear_model_of(named) == "dong_2015_load_balanced"
    assert wear_model_of(STATED) == "dong_2015_half_period"


def test_a_rise_of_the_mean_gap_is_said_where_wear_leaves_it_out() -> None:
    # 2 ms at 1 um and 1 ms at 4 um
    motions = (motion([0.5e-6, 1.5e-6], 500.0), motion([4e-6], 1000.0))
    (line,) = rise_caveats(motions, wear_model="dong_2015_half_period")
    assert "has its mean gap 2 um above it, where wear is less" in line
    assert rise_caveats(motions, wear_model="dong_2015_load_balanced") == ()
    assert rise_caveats((motion([-1e-6, 1e-6], 500.0),), wear_model="dong_2015_half_period") == ()


def under(rig: Rig, amplitude: float) -> tuple[ContactMotion, ...]:
    return (prescribed_sine(rig, vibration_amplitude=amplitude),)


def test_wear_has_a_meaning_up_to_the_gap_at_rest() -> None:
    rest = resolved_rig(STATED).separation
    name = "dong_2015_half_period"
    inside, outside = 0.99 * rest, 1.01 * rest
    assert mean_wear(resolved_rig(STATED), under(STATED, inside), wear_model=name)[1] is None
    ratio, reason = mean_wear(resolved_rig(STATED), under(STATED, outside), wear_model=name)
    assert np.isfinite(ratio)
    assert reason is not None
    assert "exceeds the gap at rest" in reason
    assert "wear model dong_2015_half_period has no meaning; of the wear models dong_2015_load_balanced holds" in reason
    assert wear_model_that_holds(resolved_rig(STATED), under(STATED, inside)) == "dong_2015_load_balanced"
    along = read_rig(RIGS / "vibrating_base.toml")
    assert wear_model_that_holds(resolved_rig(along), under(along, 1e-7)) is None
    soft = read_rig(RIGS / "pom_on_steel.toml")
    assert wear_model_that_holds(resolved_rig(soft), under(soft, 1e-7)) is None


CONTACT = """
title = "a"
source = "b"
[contact]
normal_load = "6 N"
nominal_area = "7 mm2"
LENGTH
[contact.roughness]
rms_height = "HEIGHT"
summit_radius = "10 um"
summit_density = "5e9 /m2"
[contact.pair]
effective_modulus = "80 GPa"
poisson_ratio = 0.3
yield_strength = "0.5 GPa"
[friction]
friction_coefficient = 0.4
MODEL
[sliding]
sliding_speed = "1 nm/s"
[drive]
frequency = "20 kHz"
[vibration]
vibration_amplitude = "1.2 um"
"""


def rough(height: str, *, length: str = "", model: str = "") -> Rig:
    text = CONTACT.replace("HEIGHT", height).replace("LENGTH", length).replace("MODEL", model)
    return rig_from(tomllib.loads(text))


@pytest.mark.parametrize(("height", "said"), [("1.4 um", True), ("1.7 um", False), ("14.5 um", False), ("16 um", True)])
def test_a_decay_length_by_roughness_is_doubted_beyond_those_of_published_tests(height: str, said: bool) -> None:
    # median 1.65 um, logarithm spread by 0.56: 95 % lie within a factor of e^(1.96 * 0.56) = 3.00, 0.551 to 4.94 um
    assert PUBLISHED_DECAY_LENGTH.central_range() == approx((0.5506e-6, 4.945e-6), rel=1e-3)
    caveat = decay_length_caveat(rough(height))
    assert (caveat is not None) is said


def test_the_doubt_of_a_decay_length_gives_both_frictions_of_slow_sliding() -> None:
    # slow sliding leaves exp(-a/l)/I0(a/l): with 0.3 um and with 1.65 um
    caveat = decay_length_caveat(rough("0.9 um")) or ""
    assert "decay length by roughness R_q/3 = 0.3 um" in caveat
    assert "worn contacts of published tests have 0.55 to 4.9 um (95 %); " in caveat
    own, published = (np.exp(-beta) / i0(beta) for beta in (1.2 / 0.3, 1.2 / 1.65))
    assert f"friction ratio {own:.2f} with the first, {published:.2f} with their median; give contact." in caveat
    other = decay_length_caveat(rough("0.9 um"), vibration_amplitude=0.3e-6) or ""
    own, published = (np.exp(-beta) / i0(beta) for beta in (1.0, 0.3 / 1.65))
    assert f"friction ratio {own:.2f} with the first, {published:.2f} with their median" in other


def test_no_doubt_where_the_length_is_stated_or_another_law_holds() -> None:
    assert decay_length_caveat(rough("0.9 um", length='decay_length = "0.3 um"')) is None
    gaussian = 'height_distribution = "gaussian"'
    assert decay_length_caveat(rough("0.9 um", length=gaussian)) is None
    assert decay_length_caveat(read_rig(RIGS / "vibrating_base.toml")) is None
    assert decay_length_caveat(read_rig(RIGS / "pom_on_steel.toml")) is None
    known = decay_length_caveat(rough("0.9 um"))
    assert known in resting_caveats(resolved_rig(rough("0.9 um")))
    pressed = read_rig(RIGS / "pom_on_steel.toml", changes=["contact.normal_load=1 MN"])
    assert resting_caveats(resolved_rig(pressed))[0] == PRESSED_LAYER


def test_what_a_model_leaves_out_of_a_direction_is_said_by_name() -> None:
    coulomb = read_rig(RIGS / "flextensional.toml", changes=["friction.model=coulomb"])
    (line,) = direction_caveats(resolved_rig(coulomb))
    assert line.startswith("friction model coulomb is of vibration within the plane")
    assert line.endswith("take friction.model asperity_stick_slip")
    assert direction_caveats(resolved_rig(STATED)) == ()
    assert np.isclose(friction_point(coulomb).friction_ratio, 1.0)


def test_friction_beyond_that_of_hard_bodies_in_air_and_a_roughness_of_the_size_of_the_body_are_said() -> None:
    rig = read_rig(RIGS / "tribometer.toml")  # radius of 2.25 mm2: 0.846 mm, of which a twentieth is 42 um
    assert input_caveats(replace(rig, friction_coefficient=2.0)) == ()
    (friction,) = input_caveats(replace(rig, friction_coefficient=3.0))
    assert friction.startswith("a coefficient of friction of 3 without vibration is above 2")
    assert friction in friction_point(replace(rig, friction_coefficient=3.0)).caveats
    assert input_caveats(rig.replace("contact.roughness.rms_height", "42 um")) == ()
    (rough,) = input_caveats(rig.replace("contact.roughness.rms_height", "63 um"))
    assert rough.startswith("the rms height of 63 um is 0.074 of the radius 846 um of the nominal area")


def test_a_load_that_leaves_no_separation_names_its_pressure_beside_the_hardness() -> None:
    # 100 kN over 2.25 mm2 are 44.4 GPa, three times 410 MPa 1.23 GPa
    rig = replace(read_rig(RIGS / "tribometer.toml"), normal_load=1e5)
    with raises(OutsideRange, match=r"44\.4 GPa over 2\.25 mm2 are above the hardness of the softer body, about 1\.23"):
        friction_point(rig)
