"""Classification of attractors against linear theory, parametric resonance and neighbouring trajectories."""

from typing import Any

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.models.dynamics import ExponentialGap, LinearGap
from sonolube.models.dynamics.attractor import Attractors, beat, classify_attractor, settling_time
from sonolube.models.dynamics.linear import modes, poles
from sonolube.models.dynamics.motions import State, Trajectories
from sonolube.models.dynamics.structure import Structure, with_contact_spring
from sonolube.models.dynamics.transient import march, trajectory
from sonolube.models.dynamics.waveform import StartUpRamp

LOAD = 3.0
ROUGH = ExponentialGap(decay_length=2e-6)
REST_STIFFNESS = LOAD / 2e-6


def tribometer(*, c_2: float = 20.0) -> Structure:
    def chain(first: float, second: float) -> np.ndarray:
        return np.array([[first, -first, 0], [-first, first + second, -second], [0, -second, second]])

    return Structure(
        mass_matrix=np.diag([0.15, 0.35, 0.5]),
        damping_matrix=chain(30.0, c_2),
        stiffness_matrix=chain(2e9, 2e5),
        drive_vector=62 * 140e-12 * 2e9 * np.array([-1.0, 1.0, 0.0]),
        contact_vector=np.array([1.0, 0.0, 0.0]),
        clamped_capacitance=210e-9,
    )


def settle(s: Structure, *, periods: int, steps: int = 16, **drive: Any) -> tuple[Trajectories, Attractors]:
    f = drive["frequency"]
    conditions: dict[str, Any] = {"normal_load": LOAD, "steps_per_period": steps, **drive}
    marched = march(s, ROUGH, periods=periods, ramp=StartUpRamp(duration=100 / f), **conditions)
    return marched, classify_attractor(s, ROUGH, initial_state=marched.final_state, **conditions)


def test_a_small_drive_gives_a_periodic_motion_with_the_slowest_pole_as_lyapunov_exponent() -> None:
    s = tribometer()
    _, found = settle(s, frequency=300.0, voltage_peak_to_peak=1.0, periods=600, steps=128)
    slowest = poles(with_contact_spring(s, normal_stiffness=REST_STIFFNESS)).real.max()
    assert found.kind == "periodic"
    assert found.order == 1
    assert found.contact_loss_fraction == 0
    assert float(found.lyapunov_exponent) == approx(slowest / 300.0, abs=0.005)
    assert "a disturbance decays by exp(-0.0" in str(found.description)


def test_parametric_resonance_at_twice_the_contact_resonance_is_subharmonic() -> None:
    # parametric resonance of the contact's own oscillation
    s = tribometer()
    own = modes(with_contact_spring(s, normal_stiffness=REST_STIFFNESS)).natural_frequency[1]
    _, found = settle(s, frequency=2 * own, voltage_peak_to_peak=np.array([10.0, 100.0]), periods=1200, steps=128)
    assert found.kind.tolist() == ["periodic", "subharmonic"]
    assert found.order.tolist() == [1, 2]
    assert found.description[1].startswith("subharmonic, repeats after 2 periods")


def test_hard_impacting_is_chaotic_with_the_exponent_of_neighbouring_trajectories() -> None:
    s = tribometer()
    conditions: dict[str, Any] = {
        "normal_load": LOAD,
        "frequency": 300.0,
        "voltage_peak_to_peak": np.full(32, 1000.0),
        "steps_per_period": 256,
    }
    scattered = np.linspace(-1e-6, 1e-6, 32)[:, np.newaxis] * np.ones(3)
    start = march(
        s, ROUGH, periods=600, initial_state=State(coordinates=scattered, velocities=0 * scattered), **conditions
    ).final_state
    found = classify_attractor(s, ROUGH, initial_state=start, **conditions)
    assert set(found.kind) == {"chaotic"}
    assert set(found.order) == {0}
    assert "chaotic; a disturbance grows by exp(0." in found.description[0]
    assert "without contact for" in found.description[0]
    aside = State(coordinates=start.coordinates + np.array([1e-12, 0.0, 0.0]), velocities=start.velocities)
    one, other = (
        march(s, ROUGH, periods=40, initial_state=each, strobed_periods=40, **conditions).strobed.displacement
        for each in (start, aside)
    )
    apart = np.log(np.abs(one - other)).mean(axis=0)
    assert float(found.lyapunov_exponent.mean()) == approx((apart[35] - apart[5]) / 30, rel=0.15)


def test_the_contact_loss_fraction_is_that_of_fine_steps() -> None:
    s = tribometer(c_2=400.0)
    drive: dict[str, Any] = {"frequency": 22e3, "voltage_peak_to_peak": 16.0}
    marched, found = settle(s, periods=4000, **drive)
    fine = trajectory(
        s, ROUGH, normal_load=LOAD, periods=8, steps_per_period=1024, initial_state=marched.final_state, **drive
    )
    assert found.kind == "periodic"
    share = np.mean(fine.contact.normal_force[1:] < 0.01 * LOAD)
    assert float(found.contact_loss_fraction) == approx(share, abs=4e-3)
    assert share > 0.3


def test_the_slow_beat_after_a_start_is_the_mode_of_the_arm_on_its_contact() -> None:
    s = tribometer()
    marched, found = settle(s, frequency=22e3, voltage_peak_to_peak=2.0, periods=2200)
    arm = modes(with_contact_spring(s, normal_stiffness=REST_STIFFNESS)).damped_frequency[0]
    assert found.kind in ("beating", "settling")
    assert float(found.beat_frequency) == approx(arm, rel=0.02)
    windows = marched.envelope.time[100:]
    slow = beat(displacement=marched.envelope.mean_displacement[100:], interval=windows[1] - windows[0])
    assert float(slow.beat_frequency) == approx(arm, rel=0.02)
    assert f"{float(found.beat_frequency):.4g} Hz" in str(found.description)


@pytest.mark.parametrize("decay", [0.0, 20.0])
def test_the_frequency_of_a_sampled_beat_is_found(decay: float) -> None:
    t = np.arange(400) / 4000
    slow = beat(displacement=1e-6 + 2e-6 * np.exp(-decay * t) * np.cos(2 * np.pi * 97.3 * t), interval=1 / 4000)
    assert float(slow.beat_frequency) == approx(97.3, rel=1e-6)
    assert float(slow.beat_amplitude) == approx(2e-6 * np.exp(-decay * 0.05), rel=0.2)


def test_constant_samples_have_no_beat() -> None:
    still = beat(displacement=np.full((3, 20), 4.2e-6), interval=1.0)
    assert still.beat_frequency.tolist() == [0.0] * 3
    assert still.beat_amplitude.tolist() == [0.0] * 3


def test_rounding_of_constant_samples_is_no_beat() -> None:
    rounding = 1e-15 * np.cos(2 * np.pi * 0.11 * np.arange(64))
    assert beat(displacement=4.2e-6 * (1 + rounding), interval=1.0).beat_frequency == 0.0


def test_a_decaying_transient_is_classified_as_settling() -> None:
    _, found = settle(tribometer(c_2=400.0), frequency=22e3, voltage_peak_to_peak=16.0, periods=150)
    assert found.kind == "settling"
    assert "march on for longer" in str(found.description)


def test_a_resonance_settles_after_the_logarithm_of_the_inverse_band_over_its_decay_rate() -> None:
    # amplitude 1 - exp(-100 t): within 2 % after ln(50)/100 s
    s = Structure(
        mass_matrix=np.array([[0.1]]),
        damping_matrix=np.array([[20.0]]),
        stiffness_matrix=np.array([[1e7]]),
        drive_vector=np.array([10.0]),
        contact_vector=np.array([1.0]),
        clamped_capacitance=1e-7,
    )
    f = np.sqrt(1e8) / (2 * np.pi)
    marched = march(
        s,
        LinearGap(normal_stiffness=0.0),
        normal_load=LOAD,
        frequency=f,
        voltage_peak_to_peak=[1.0, 2.0],
        periods=200,
        periods_per_window=1,
    )
    assert settling_time(marched.envelope) == approx(np.log(50) / 100, abs=2 / f)
    assert settling_time(marched.envelope, band=0.5) == approx(np.log(2) / 100, abs=2 / f)


def test_a_solution_that_runs_away_is_classified_as_diverged() -> None:
    # a contact pressed in by a hundred decay lengths flies off for good
    s = tribometer()
    start = State(coordinates=np.array([-2e-4, 0.0, 0.0]), velocities=np.zeros(3))
    found = classify_attractor(
        s, ROUGH, normal_load=100.0, frequency=5e3, voltage_peak_to_peak=1000.0, initial_state=start, steps_per_period=8
    )
    assert found.kind == "diverged"
    assert np.isnan(found.lyapunov_exponent)
    assert "diverged; the solution grew without bound; take" in str(found.description)


def test_periods_that_are_not_a_multiple_of_sixteen_are_refused() -> None:
    start = State(coordinates=np.zeros(3), velocities=np.zeros(3))
    with raises(InvalidInput, match="periods must be a multiple of 16, at least 32, got 20"):
        classify_attractor(
            tribometer(), ROUGH, normal_load=1, frequency=1, voltage_peak_to_peak=1, initial_state=start, periods=20
        )


def test_invalid_bands_and_too_few_samples_are_refused() -> None:
    marched = march(tribometer(), ROUGH, normal_load=1.0, frequency=22e3, voltage_peak_to_peak=1.0, periods=4)
    with raises(InvalidInput, match=r"band must lie between 0 and 1, got -0\.1"):
        settling_time(marched.envelope, band=-0.1)
    with raises(InvalidInput, match=r"at least 8 samples, got shape \(3,\)"):
        beat(displacement=np.zeros(3), interval=1.0)
