"""Long-time responses against linear theory, harmonic balance and direct integration."""

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pytest import approx
from scipy.integrate import solve_ivp

from sonolube.models.dynamics import ExponentialGap, Status, SteadyStates, steady_state
from sonolube.models.dynamics.long_time_response import LongTimeResponse, march_until_settled, settling_periods
from sonolube.models.dynamics.structure import Structure, drive_receptance, with_contact_spring
from sonolube.models.dynamics.waveform import StartUpRamp

DECAY = 2e-6
ROUGH = ExponentialGap(decay_length=DECAY)


def chain(first: float, second: float) -> NDArray[np.float64]:
    return np.array([[first, -first, 0], [-first, first + second, -second], [0, -second, second]])


STROKE = 62 * 140e-12
TRIBOMETER = Structure(  # tip, reaction mass with its stack, arm; a damper from the tip to the ground
    mass_matrix=np.diag([0.1093, 2.48, 0.602]),
    damping_matrix=chain(30.0, 90.0) + np.diag([702.0, 0.0, 0.0]),
    stiffness_matrix=chain(2e9, 4.56e5),
    drive_vector=STROKE * 2e9 * np.array([-1.0, 1.0, 0.0]),
    contact_vector=np.array([1.0, 0.0, 0.0]),
    clamped_capacitance=210e-9,
)
BEATING: dict[str, Any] = {"normal_load": 61.209, "frequency": 22436.58}
BEATING_VOLTS = 32.9322
DOUBLE: dict[str, Any] = {"normal_load": 95.5875, "frequency": 446.00634}
DOUBLE_VOLTS = 285.297
SLOWLY = StartUpRamp(duration=0.2, shape="cosine")


@cache
def response(which: str) -> LongTimeResponse:
    drive, volts = {"beating": (BEATING, BEATING_VOLTS), "double": (DOUBLE, DOUBLE_VOLTS)}[which]
    return march_until_settled(TRIBOMETER, ROUGH, **drive, voltage_peak_to_peak=2 * volts, ramp=SLOWLY)


def steady(which: str, *, upper_branch: bool = False) -> SteadyStates:
    drive, volts = {"beating": (BEATING, BEATING_VOLTS), "double": (DOUBLE, DOUBLE_VOLTS)}[which]
    return steady_state(TRIBOMETER, ROUGH, **drive, voltage_amplitude=volts, upper_branch=upper_branch)


def integrated(
    load: float, frequency: float, volts: float, *, start: NDArray[np.float64], until: float
) -> NDArray[np.float64]:
    """Return the contact's displacement at eight samples per period, by DOP853 from a state, without a ramp."""
    s, omega = TRIBOMETER, 2 * np.pi * frequency
    inverse = np.linalg.inv(s.mass_matrix)

    def rate(time: float, state: NDArray[np.float64]) -> NDArray[np.float64]:
        x, v = np.split(state, 2)
        pull = s.drive_vector * volts * np.sin(omega * time) - s.damping_matrix @ v - s.stiffness_matrix @ x
        closing = min(float(-(s.contact_vector @ x)) / DECAY, 60.0)  # trial steps go far astray
        pull = pull + s.contact_vector * load * np.expm1(closing)
        return np.concatenate([v, inverse @ pull])

    instants = np.arange(0, round(until * frequency) * 8) / (8 * frequency)
    scale = np.concatenate([np.full(3, 1e-12), np.full(3, 1e-12 * omega)])
    found = solve_ivp(rate, (0, instants[-1]), start, t_eval=instants, method="DOP853", rtol=1e-8, atol=scale)
    return np.asarray(found.y[0])


def test_a_small_drive_ends_in_the_vibration_of_linear_theory() -> None:
    volts = 1e-9 / abs(drive_receptance(TRIBOMETER, frequency=20e3))
    found = march_until_settled(
        TRIBOMETER, ROUGH, normal_load=3.0, frequency=20e3, voltage_peak_to_peak=2 * float(volts)
    )
    touching = with_contact_spring(TRIBOMETER, normal_stiffness=3.0 / DECAY)
    expected = float(volts * abs(drive_receptance(touching, frequency=20e3)))
    assert found.attractor.order == 1
    assert found.amplitudes == approx(expected, rel=1e-3)


def test_the_settling_time_is_twelve_decay_times_of_the_slowest_mode() -> None:
    # one mass of 2 kg on its contact of 3 N over 2 um, damped by 40 N s/m: decays as exp(-10 t)
    one = Structure(
        mass_matrix=np.eye(1) * 2,
        damping_matrix=np.eye(1) * 40,
        stiffness_matrix=np.zeros((1, 1)),
        drive_vector=np.ones(1),
        contact_vector=np.ones(1),
        clamped_capacitance=1e-9,
    )
    assert settling_periods(one, ROUGH, normal_load=3.0, frequency=1e3) == approx(1200, abs=1)


def test_the_dissipated_power_is_the_electrical_power_of_harmonic_balance() -> None:
    states = steady_state(TRIBOMETER, ROUGH, normal_load=3.0, frequency=22e3, voltage_amplitude=14.0)
    found = march_until_settled(TRIBOMETER, ROUGH, normal_load=3.0, frequency=22e3, voltage_peak_to_peak=28.0)
    assert found.dissipated_power == approx(float(states.dissipated_power), rel=1e-3)
    assert found.amplitudes == approx(float(states.vibration_amplitude), rel=1e-3)


def test_an_unstable_vibration_is_replaced_by_a_beat_whatever_the_ramp_of_the_voltage() -> None:
    assert steady("beating").status == Status.UNSTABLE
    found, at_once = (
        response("beating"),
        march_until_settled(TRIBOMETER, ROUGH, **BEATING, voltage_peak_to_peak=2 * BEATING_VOLTS),
    )
    assert found.attractor.kind == at_once.attractor.kind == "beating"
    assert found.attractor.beat_frequency == approx(float(at_once.attractor.beat_frequency), rel=0.01)
    assert found.attractor.beat_amplitude == approx(float(at_once.attractor.beat_amplitude), rel=0.02)
    assert np.ptp(found.amplitudes) > 0.05 * found.amplitudes.mean()


def test_another_integrator_finds_the_same_beat() -> None:
    found = response("beating").attractor
    start = np.concatenate([found.final_state.coordinates, found.final_state.velocities]) * 0.98
    samples = integrated(61.209, 22436.58, BEATING_VOLTS, start=start, until=0.05)
    strobed = samples.reshape(-1, 8)[-512:, 0]
    assert np.ptp(strobed) / 2 == approx(float(found.beat_amplitude), rel=0.05)
    spectrum = np.abs(np.fft.rfft((strobed - strobed.mean()) * np.hanning(512), 8192))
    assert np.argmax(spectrum) / 8192 * 22436.58 == approx(float(found.beat_frequency), rel=0.02)


def test_of_two_coexisting_vibrations_a_slow_ramp_reaches_the_smaller() -> None:
    small, large = steady("double"), steady("double", upper_branch=True)
    assert small.status == large.status == Status.MULTISTABLE
    assert float(small.coexisting_amplitude) == approx(float(large.vibration_amplitude), rel=1e-6)
    assert response("double").attractor.order == 1
    assert response("double").amplitudes == approx(float(small.vibration_amplitude), rel=1e-3)


def test_another_integrator_started_from_the_final_state_repeats_the_motion() -> None:
    found = response("double").attractor
    start = np.concatenate([found.final_state.coordinates, found.final_state.velocities])
    samples = np.asarray(integrated(95.5875, 446.00634, DOUBLE_VOLTS, start=start, until=0.1)).reshape(-1, 8)
    assert samples[-1] == approx(samples[0], abs=2e-3 * float(response("double").amplitudes[0]))
