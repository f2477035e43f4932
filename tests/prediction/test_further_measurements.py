"""Width of an interval after a measurement by normal distributions, and resonances of one mass in closed form."""

from dataclasses import replace
from math import log, pi, sqrt
from pathlib import Path

import numpy as np
from pytest import approx, mark, raises
from tests.prediction.linear_rigs import LINEAR, conditions

from sonolube.errors import InvalidInput
from sonolube.models.dynamics import Structure
from sonolube.prediction.evidence import UncertainConditions
from sonolube.prediction.further_measurements import (
    KNOWN_WELL,
    Probe,
    Target,
    measures,
    own_logarithms,
    probe_sentences,
    stiffness_probes,
    told_probes,
)
from sonolube.prediction.inputs import rig_inputs
from sonolube.prediction.posterior import Posterior, learned
from sonolube.prediction.predictive import rig_prediction
from sonolube.rig import read_rig

RIGS = Path(__file__).parents[2] / "examples" / "rigs"
MASS, STIFFNESS, DAMPING = 2.0, 2.0 * (2 * pi * 50) ** 2, 20.0  # 50 Hz


def one_mass(*, stiffness: float = STIFFNESS, damping: float = DAMPING) -> Structure:
    return Structure(
        mass_matrix=np.array([[MASS]]),
        damping_matrix=np.array([[damping]]),
        stiffness_matrix=np.array([[stiffness]]),
        drive_vector=np.array([1.0]),
        contact_vector=np.array([1.0]),
        clamped_capacitance=1e-9,
    )


def test_a_mass_on_its_spring_and_the_contact_has_the_shift_width_and_sensitivity_of_an_oscillator() -> None:
    # omega^2 = (k + F/l)/m; half width c/(4 pi m), the same for both; df/dln k_n = k_n/(8 pi^2 m f)
    length = np.array([1e-5, 4e-5])
    (found,) = stiffness_probes(
        one_mass(), normal_load=3.0, decay_length=length, resolution=0.02, modal_mass_deviation=0.07
    )
    contact = 3.0 / length
    pressed = np.sqrt((STIFFNESS + contact) / MASS) / (2 * pi)
    half_width = DAMPING / (4 * pi * MASS)
    assert found.mode == 0
    assert found.name == "mode at 50 Hz"
    assert found.free_frequency == approx(50)
    assert found.modal_mass == approx(MASS)
    assert found.decay_length == approx(length)
    assert found.pressed_frequency == approx(pressed)
    assert found.shift == approx(pressed - 50)
    assert found.peak_half_width == approx([half_width, half_width])
    shift_uncertainty = 0.02 * sqrt(2) * half_width
    assert found.shift_uncertainty == approx([shift_uncertainty] * 2)
    slope = contact / (8 * pi**2 * MASS * pressed)
    assert found.log_stiffness_deviation == approx(np.hypot(shift_uncertainty / slope, 0.07), rel=1e-4)
    assert found.resolvable.tolist() == [True, True]


def test_a_floating_mass_has_no_free_width_and_usual_resolution_and_mass_are_a_fiftieth_and_a_tenth() -> None:
    (found,) = stiffness_probes(one_mass(stiffness=0.0), normal_load=3.0, decay_length=1e-5)
    pressed = sqrt(3e5 / MASS) / (2 * pi)
    assert found.name == "floating mode"
    assert found.free_frequency == approx(0, abs=1e-6)
    half_width = DAMPING / (4 * pi * MASS)
    assert found.shift_uncertainty == approx([half_width / 50], rel=1e-3)
    # f goes with the root of k_n: df/dln k_n = f/2
    assert found.log_stiffness_deviation == approx([sqrt((half_width / 50 / (pressed / 2)) ** 2 + 0.01)], rel=1e-3)


@mark.parametrize(("share", "is_resolved"), [(1.05, True), (0.95, False)])
def test_a_shift_is_resolved_from_three_times_its_uncertainty_on(share: float, is_resolved: bool) -> None:
    uncertainty = 0.02 * sqrt(2) * DAMPING / (4 * pi * MASS)
    shift = share * 3 * uncertainty
    contact = MASS * (2 * pi) ** 2 * ((50 + shift) ** 2 - 50**2)
    (found,) = stiffness_probes(one_mass(), normal_load=3.0, decay_length=3.0 / contact)
    assert bool(found.resolvable[0]) is is_resolved
    assert bool(np.isfinite(found.log_stiffness_deviation[0])) is is_resolved


@mark.parametrize(("ratio", "is_resolved"), [(0.49, True), (0.51, False)])
def test_from_half_of_critical_damping_on_no_peak_shows(ratio: float, is_resolved: bool) -> None:
    # a contact of three times the spring doubles the frequency, c = 2 zeta m omega
    contact = 3 * STIFFNESS
    damping = 2 * ratio * MASS * sqrt(4 * STIFFNESS / MASS)
    (found,) = stiffness_probes(one_mass(damping=damping), normal_load=3.0, decay_length=3.0 / contact)
    assert bool(found.resolvable[0]) is is_resolved


def test_a_mode_that_does_not_move_the_contact_is_no_probe_and_a_table_of_lengths_is_refused() -> None:
    two = Structure(
        mass_matrix=np.diag([2.0, 1.0]),
        damping_matrix=np.zeros((2, 2)),
        stiffness_matrix=np.diag([2.0e4, 9.0e6]),
        drive_vector=np.ones(2),
        contact_vector=np.array([0.0, 1.0]),
        clamped_capacitance=1e-9,
    )
    (found,) = stiffness_probes(two, normal_load=3.0, decay_length=1e-5)
    assert found.mode == 1
    assert found.free_frequency == approx(3000 / (2 * pi))
    with raises(InvalidInput, match=r"decay_length must be a number or a list, got shape \(1, 2\)"):
        stiffness_probes(two, normal_load=3.0, decay_length=[[1e-5, 2e-5]])


def probe(
    name: str, *, free: float, pressed: list[float], deviation: list[float], width: float = 1.0, mode: int = 0
) -> Probe:
    log_deviation = np.array(deviation)
    return Probe(
        mode=mode,
        name=name,
        modal_mass=1.0,
        free_frequency=free,
        decay_length=np.array([1e-6, 2e-6]),
        pressed_frequency=np.array(pressed),
        peak_half_width=np.array([width, width / 2]),
        shift_uncertainty=np.ones(2),
        resolvable=np.isfinite(log_deviation),
        log_stiffness_deviation=log_deviation,
    )


BOTH = probe("both", free=100.0, pressed=[150.25, 130.0], deviation=[0.104, 0.247])
ALIKE = probe("alike", free=20e3, pressed=[20012.34, 20010.0], deviation=[0.121, 0.124])
STIFF = probe("stiff", free=300.0, pressed=[310.0, 305.0], deviation=[0.05, np.inf])
BLIND = probe("blind", free=22e3, pressed=[22006.0, 22003.0], deviation=[np.inf, np.inf], width=36.0)
STILL = probe("still", free=500.0, pressed=[500.0, 500.0], deviation=[np.inf, np.inf])
DAMPED = probe("damped", free=40.0, pressed=[90.0, 60.0], deviation=[np.inf, np.inf], width=46.0)


def test_resonances_are_told_with_frequencies_and_what_their_shift_gives() -> None:
    found = probe_sentences((BLIND, STIFF, ALIKE, DAMPED, BOTH, STILL))
    assert found[:3] == (  # resolved at both, the surer first; then at one of two
        "both: pressed 150.2 Hz at l = 1 um and 130 Hz at l = 2 um; its shift gives k_n within 10 to 25 %",
        "alike: pressed 20.0123 kHz at l = 1 um and 20.01 kHz at l = 2 um; its shift gives k_n within 12 %",
        "stiff: pressed 310 Hz at l = 1 um and 305 Hz at l = 2 um; its shift gives k_n within 5 %, at the stiffer"
        " contacts only",
    )
    others = set(found[3:])
    assert "blind: shifts by 6 Hz at most, 1/12 of its width of 72 Hz: not resolvable" in others
    assert "still: shifts by 0 Hz at most, nothing of its width of 2 Hz: not resolvable" in others
    # a half width of 46 Hz at 90 Hz is more than half of critical damping
    assert "damped: pressed 90 Hz at l = 1 um and 60 Hz at l = 2 um; too damped to show a peak" in others


def test_six_resonances_at_most_are_told() -> None:
    assert len(probe_sentences((BOTH,) * 7)) == 6
    assert len(probe_sentences((BOTH,) * 5)) == 5


def test_a_prediction_tells_the_two_surest_that_are_resolved_and_the_mode_that_vibrates() -> None:
    assert told_probes((BLIND, STIFF, ALIKE, BOTH), frequency=21.9e3) == (BOTH, ALIKE, BLIND)
    assert told_probes((BLIND, STIFF, BOTH), frequency=101.0) == (BOTH, STIFF)
    assert told_probes((BLIND, STILL), frequency=510.0) == (STILL,)


def test_a_measurement_leaves_of_a_normal_interval_what_its_noise_and_correlation_say() -> None:
    # of x known with the noise s by y = x + e and by one of correlation 0.6: sqrt(1 - rho^2 sigma^2/(sigma^2 + s^2))
    rng = np.random.default_rng(0)
    x = rng.standard_normal(40_000)
    y = 2 * (0.6 * x + 0.8 * rng.standard_normal(x.size))
    target = Target(5 + 3 * x)
    assert target.share_left(observed=x, noise=0.75) == approx(sqrt(1 - 1 / 1.5625), abs=0.02)
    assert target.share_left(observed=y, noise=1.0) == approx(sqrt(1 - 0.36 * 4 / 5), abs=0.02)
    assert target.share_left(observed=rng.standard_normal(x.size), noise=0.5) == approx(1, abs=0.02)
    assert Target(np.ones(1000)).share_left(observed=np.arange(1000.0), noise=1.0) <= 1


def test_length_and_amplitude_are_split_from_their_ratio_by_their_own_spreads() -> None:
    row = [0.4, 0.3, log(0.06), log(0.6), log(2e-4), log(0.7)]
    posterior = Posterior(closure=LINEAR, hyperparameters=np.tile(row, (64, 1)))
    at = UncertainConditions(conditions=conditions([2e-6], [0.02]), decay_length_spread=None, amplitude_spread=0.25)
    found = rig_prediction(posterior, at, count=20_000)
    logs = own_logarithms(found, intrinsic=np.full(20_000, 0.34), seed=0)
    length, amplitude = logs["decay_length"], logs["vibration_amplitude"]
    assert length.mean() == approx(0.3, abs=0.02)
    assert length.std() == approx(0.6, rel=0.02)
    assert amplitude.mean() == approx(0, abs=0.01)
    assert amplitude.std() == approx(0.25, rel=0.02)
    assert np.corrcoef(length, amplitude)[0, 1] == approx(0, abs=0.03)
    assert length - amplitude == approx(found.draws.parameters.log_factor)
    assert logs["friction_coefficient"] == approx(np.full(20_000, log(0.34)))
    measured = rig_prediction(posterior, replace(at, decay_length_spread=0.1), count=20_000)
    known = own_logarithms(measured, intrinsic=np.ones(20_000), seed=0)
    assert known["decay_length"].mean() == approx(0, abs=0.01)
    assert known["decay_length"].std() == approx(0.1, rel=0.02)
    assert known["vibration_amplitude"].std() == approx(0.25, rel=0.02)


def test_what_careful_measurements_leave_is_ten_two_and_three_percent() -> None:
    assert KNOWN_WELL == {"decay_length": 0.1, "vibration_amplitude": 0.02, "friction_coefficient": 0.03}


def test_a_run_tells_less_at_twice_the_speed_and_a_resonance_what_it_resolves() -> None:
    inputs = rig_inputs(read_rig(RIGS / "tribometer.toml"))
    found = rig_prediction(learned().friction, inputs.at(), count=4000)
    ratio = found.ratios(inputs.at().conditions)[:, 0]
    here, faster, both, stiff = measures(found, inputs, ratio=ratio, probes=(BOTH, BLIND, STIFF), seed=0)
    assert here.label == "one run at this point"
    assert faster.label == "one run at this point, for the ratio at 2 times the speed"
    assert here.share_left < faster.share_left < 1
    assert both.label == "contact stiffness by the both (130 Hz to 150 Hz when pressed)"
    assert stiff.label == "contact stiffness by the stiff (305 Hz to 310 Hz when pressed)"
    length = own_logarithms(found, intrinsic=np.ones(4000), seed=0)["decay_length"]
    target = Target(ratio)
    # within the mean of 10.4 and 24.7 %; of the other, half of the contacts are told within 5 %, the rest not at all
    assert both.share_left == approx(target.share_left(observed=length, noise=(0.104 + 0.247) / 2))
    assert stiff.share_left == approx(0.5 + 0.5 * target.share_left(observed=length, noise=0.05))
    _, _, third, tenth = measures(found, inputs, ratio=ratio, probes=(BLIND,), seed=0)
    assert (third.label, tenth.label) == ("contact stiffness within 30 %", "contact stiffness within 10 %")
    assert third.share_left == approx(target.share_left(observed=length, noise=0.3))
    assert tenth.share_left < third.share_left
    assert len(measures(found, replace(inputs, measured_length=True), ratio=ratio, probes=(BOTH,), seed=0)) == 2
