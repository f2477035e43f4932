"""Harmonic balance against marching from rest, over random operating points of the tribometer.

Tip amplitudes of 0.5 to 14 um, frequencies of 5 to 100 kHz and loads of 1 to 100 N, all spread evenly. Each point is
marched with a cosine ramp of 50 ms and then for nine decay times of its slowest small motion.
"""

from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sonolube.models.contact import decay_length
from sonolube.models.dynamics import (
    ExponentialGap,
    StartUpRamp,
    Status,
    SteadyStates,
    drive_receptance,
    march,
    steady_state,
)
from sonolube.models.dynamics.linear import poles
from sonolube.models.dynamics.long_time_response import march_until_settled
from sonolube.models.dynamics.structure import with_contact_spring
from sonolube.rig import read_rig
from sonolube.rig.driven_rig import driven_rig

TRIBOMETER = read_rig(Path(__file__).parents[2] / "examples" / "rigs" / "tribometer.toml")
STRUCTURE = driven_rig(TRIBOMETER).structure
LAW = ExponentialGap(decay_length=float(decay_length(TRIBOMETER.contact)))
SLOWLY = StartUpRamp(duration=0.05, shape="cosine")
AGREES = 1e-3
LANES = 96  # points marched together for as long as the fastest drive among them needs

Array = NDArray[np.float64]
POINTS = 2400


@cache
def balanced() -> SteadyStates:
    chosen = np.random.default_rng(2024)
    frequency, load = chosen.uniform(5e3, 100e3, POINTS), chosen.uniform(1.0, 100.0, POINTS)
    free_amplitude = chosen.uniform(0.5e-6, 14e-6, POINTS)
    volts = free_amplitude / np.abs(drive_receptance(STRUCTURE, frequency=frequency))
    return steady_state(STRUCTURE, LAW, normal_load=load, frequency=frequency, voltage_amplitude=volts)


def slowest_decay() -> float:
    """The longest decay time of small motions about rest under any load of the range, from the poles."""
    loads = np.geomspace(1.0, 100.0, 40)
    touching = [with_contact_spring(STRUCTURE, normal_stiffness=load / LAW.decay_length) for load in loads]
    return max(-1 / float(poles(each).real.max()) for each in touching)


def marched(states: SteadyStates, steps: int) -> tuple[Array, NDArray[np.bool_]]:
    """First harmonic, mean displacement and mean force of the last periods, and whether the steps followed."""
    found = np.empty((3, states.frequency.size))
    followed = np.empty(states.frequency.size, dtype=bool)
    lasting, rising = SLOWLY.duration + 9 * slowest_decay(), np.argsort(states.frequency)
    for some in np.array_split(rising, -(-rising.size // LANES)):
        periods = int(np.ceil(lasting * states.frequency[some].max()))
        end = march(
            STRUCTURE,
            LAW,
            normal_load=states.normal_load[some],
            frequency=states.frequency[some],
            voltage_peak_to_peak=2 * np.abs(states.voltage_harmonics[some, 0]),
            ramp=SLOWLY,
            periods=periods,
            periods_per_window=-(-periods // 32),
            steps_per_period=steps,
            strobed_periods=1,
        )
        last = end.envelope
        found[:, some] = [
            each[:, -1] for each in (last.first_harmonic_amplitude, last.mean_displacement, last.mean_normal_force)
        ]
        followed[some] = end.status == "marched"
    return found, followed


def disagreement(states: SteadyStates) -> Array:
    """The largest relative difference of amplitude, mean displacement and mean force at each point."""
    found, followed = marched(states, 12)
    if not followed.all():
        chosen = np.flatnonzero(~followed)
        again = steady_state(
            STRUCTURE,
            LAW,
            normal_load=states.normal_load[chosen],
            frequency=states.frequency[chosen],
            voltage_amplitude=np.abs(states.voltage_harmonics[chosen, 0]),
        )
        found[:, chosen] = marched(again, 48)[0]
    expected = np.stack([np.abs(states.harmonics[:, 0]), states.mean_displacement, states.mean_normal_force])
    return np.asarray(np.abs(found / expected - 1).max(axis=0))


def test_a_slow_start_from_rest_ends_in_the_vibration_that_is_called_periodic() -> None:
    states = balanced()
    periodic = states.status == Status.PERIODIC
    agreeing = disagreement(states)[periodic] < AGREES
    assert periodic.mean() > 0.98
    assert agreeing.mean() >= 0.995


def test_every_point_has_a_status_and_every_solution_its_numbers() -> None:
    states = balanced()
    assert np.isin(states.status, [status.value for status in Status]).all()
    found = states.status != Status.NOT_CONVERGED
    assert np.isfinite(states.vibration_amplitude[found]).all()
    assert np.isfinite(states.coexisting_amplitude[states.status == Status.MULTISTABLE]).all()


def test_what_is_called_unstable_does_not_last() -> None:
    states = balanced()
    for point in np.flatnonzero(states.status == Status.UNSTABLE):
        found = march_until_settled(
            STRUCTURE,
            LAW,
            normal_load=float(states.normal_load[point]),
            frequency=float(states.frequency[point]),
            voltage_peak_to_peak=2 * float(np.abs(states.voltage_harmonics[point, 0])),
        )
        assert found.attractor.kind not in ("periodic", "diverged"), str(found.attractor.description)
