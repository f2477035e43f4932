"""Marching of the tribometer-like rig from rest, beside scipy's DOP853 with a compiled right-hand side.

A trajectory is 2,200 periods of a sine at 22 kHz, of which the first 220 ramp up, to amplitudes of 0.5 to 14 um. Ours
run on one core in a batch of 1,000; the rival at rtol 1e-8 is timed over a part of the periods. Accuracy is that of the
amplitude of the first harmonic, the mean force and the mean kinematic friction of the last period against DOP853 at
rtol 1e-10.
"""

import time
from typing import Any

import numba
import numpy as np
import pytest
from numpy.typing import NDArray
from pytest_benchmark.fixture import BenchmarkFixture
from scipy.integrate import solve_ivp

from sonolube.models.dynamics import ExponentialGap
from sonolube.models.dynamics.structure import Structure
from sonolube.models.dynamics.transient import march
from sonolube.models.dynamics.waveform import StartUpRamp

Array = NDArray[np.float64]
FREQUENCY, LOAD, DECAY_LENGTH, PERIODS, RAMPED, POINTS = 22e3, 3.0, 2e-6, 2200, 220, 1000
VOLTAGES = np.linspace(0.585, 17.2, POINTS)  # amplitudes of 0.5 to 14 um
STEPS = 12
SLIDING_SPEED = 0.05


def chain(first: float, second: float) -> Array:
    return np.array([[first, -first, 0], [-first, first + second, -second], [0, -second, second]])


RIG = Structure(
    mass_matrix=np.diag([0.15, 0.35, 0.5]),
    damping_matrix=chain(30.0, 20.0),
    stiffness_matrix=chain(2e9, 2e5),
    drive_vector=62 * 140e-12 * 2e9 * np.array([-1.0, 1.0, 0.0]),
    contact_vector=np.array([1.0, 0.0, 0.0]),
    clamped_capacitance=210e-9,
)


def go(voltages: Array, steps: int, workers: int = 1) -> Any:
    return march(
        RIG,
        ExponentialGap(decay_length=DECAY_LENGTH),
        normal_load=LOAD,
        frequency=FREQUENCY,
        voltage_peak_to_peak=voltages,
        periods=PERIODS,
        steps_per_period=steps,
        ramp=StartUpRamp(duration=RAMPED / FREQUENCY),
        workers=workers,
    )


@numba.njit
def rate(t: float, z: Array, generator: Array, drive: Array, contact: Array, swing: float) -> Any:
    voltage = swing * min(t * FREQUENCY / RAMPED, 1.0) * 0.5 * np.sin(2 * np.pi * FREQUENCY * t)
    return generator @ z + drive * voltage + contact * (LOAD * np.exp(-z[0] / DECAY_LENGTH) - LOAD)


def by_dop853(swing: float, *, periods: int, rtol: float, samples: int) -> Array:
    """Return displacements of the contact at equal intervals of the last period, the end included."""
    inverse, omega, zeros = np.linalg.inv(RIG.mass_matrix), 2 * np.pi * FREQUENCY, np.zeros(3)
    springs, dampers = -inverse @ RIG.stiffness_matrix / omega, -inverse @ RIG.damping_matrix
    system = (
        np.block([[np.zeros((3, 3)), omega * np.eye(3)], [springs, dampers]]),
        np.r_[zeros, inverse @ RIG.drive_vector / omega],
        np.r_[zeros, inverse @ RIG.contact_vector / omega],
        swing,
    )
    times = (periods - 1 + np.arange(1, samples + 1) / samples) / FREQUENCY
    z = np.zeros(6)
    for start, end in ((0.0, RAMPED / FREQUENCY), (RAMPED / FREQUENCY, times[-1])):
        if end > start:
            solution = solve_ivp(
                rate,
                (start, end),
                z,
                method="DOP853",
                rtol=rtol,
                atol=1e-7 * rtol,
                args=system,
                t_eval=times if end == times[-1] else None,
            )
            z = solution.y[:, -1]
    return np.asarray(solution.y[0])


def measures(displacement: Array) -> Array:
    """Return amplitude of the first harmonic, mean force and mean kinematic friction of one sampled period."""
    n, fine = displacement.size, 512
    lines = np.fft.rfft(displacement) / n
    lines[-1] *= 0.5 if n % 2 == 0 else 1.0  # the highest line of an even number stands for both its signs
    spread = np.zeros(fine // 2 + 1, dtype=np.complex128)
    spread[: lines.size] = lines
    x = np.fft.irfft(spread) * fine
    v = np.fft.irfft(spread * 2j * np.pi * FREQUENCY * np.arange(spread.size)) * fine
    force = LOAD * np.exp(-x / DECAY_LENGTH)
    return np.array([2 * abs(lines[1]), force.mean(), np.mean(force * SLIDING_SPEED / np.hypot(SLIDING_SPEED, v))])


def rival_seconds(part: int = 440) -> float:
    swing = float(VOLTAGES[POINTS // 2])
    by_dop853(swing, periods=RAMPED + 1, rtol=1e-3, samples=1)  # compiles
    began = time.perf_counter()
    by_dop853(swing, periods=part, rtol=1e-8, samples=1)
    return (time.perf_counter() - began) * PERIODS / part


@pytest.mark.parametrize("steps", [12, 16])
def test_a_thousand_start_ups(benchmark: BenchmarkFixture, steps: int) -> None:
    go(VOLTAGES[:32], steps)
    marched = benchmark(go, VOLTAGES, steps)
    assert set(marched.status) == {"marched"}
    ours = benchmark.stats.stats.median / POINTS if benchmark.stats else float("nan")
    rival = rival_seconds()
    benchmark.extra_info |= {
        "ms_a_trajectory_and_core": 1e3 * ours,
        "dop853_ms_a_trajectory": 1e3 * rival,
        "speed_ratio": rival / ours,
    }


@pytest.mark.parametrize("steps", [12, 16])
def test_the_accuracy_that_goes_with_it(benchmark: BenchmarkFixture, steps: int) -> None:
    chosen = VOLTAGES[[0, POINTS // 2, POINTS - 1]]
    marched = benchmark(go, chosen, steps)
    errors = [
        measures(period) / measures(by_dop853(float(swing), periods=PERIODS, rtol=1e-10, samples=steps)) - 1
        for period, swing in zip(marched.last_periods.displacement, chosen, strict=True)
    ]
    largest = np.abs(errors).max(axis=0)
    benchmark.extra_info |= dict(zip(("amplitude", "mean_force", "mean_friction"), largest.tolist(), strict=True))
    assert largest.max() < 1e-4
