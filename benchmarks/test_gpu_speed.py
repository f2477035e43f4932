"""Steady states and trajectories on a GPU, beside what the card could do.

Steady states come with friction at 16 sliding speeds and stability; points are those of `test_steady_state_speed.py`.
Trajectories are 2,200 periods of such points from rest, of 16 steps each, the first 220 ramping up. The time is that of
the whole call, transfers included. Bytes are what points bring along and answers take; what spills from a thread's
registers to its own memory is not counted. Operations are counted from the algorithm, for steady states at the
harmonics, samples and steps that each point took, sums, products, quotients and roots as one each, sines and
exponentials as twenty. The bars are the card's own: bandwidth from its bus, peak from its multiprocessors, their units
for doubles and its clock.
"""

import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from pytest_benchmark.fixture import BenchmarkFixture

from sonolube.contact import decay_length
from sonolube.dynamics import ExponentialGap, StartUpRamp, drive_receptance, march
from sonolube.dynamics.backend import device_name
from sonolube.dynamics.first_order_modes import state_pairs
from sonolube.dynamics.harmonic_balance.contact_kernel import law_of
from sonolube.dynamics.harmonic_balance.receptance import contact_port
from sonolube.dynamics.time_marching.integrator import quadrature
from sonolube.rig import read_rig

RIG = read_rig(Path(__file__).parent.parent / "examples" / "rigs" / "tribometer.toml")
LENGTH = float(decay_length(RIG.contact))
SPEEDS = np.geomspace(1e-3, 1.0, 16)
POINTS = int(os.environ.get("SONOLUBE_GPU_POINTS", "1000000"))
# per multiprocessor and clock, by compute capability (NVIDIA, CUDA C++ Programming Guide, arithmetic instructions)
DOUBLES = {(6, 0): 32, (7, 0): 32, (8, 0): 32, (9, 0): 64, (10, 0): 64}
FEW_DOUBLES = 2
TRAJECTORIES = int(os.environ.get("SONOLUBE_GPU_TRAJECTORIES", "262144"))
PERIODS, STEPS, RAMPED = 2200, 16, 220
SAMPLED = 40  # shares of force and voltage at each node of a step
HARD = 20  # operations that a sine or an exponential counts for


def drawn(points: int) -> dict[str, Any]:
    assert RIG.structure is not None
    random = np.random.default_rng(1)
    frequency, load = random.uniform(18e3, 26e3, points), random.uniform(1.0, 10.0, points)
    volts = random.uniform(0.5e-6, 14e-6, points) / np.abs(drive_receptance(RIG.structure, frequency=frequency))
    return {"omega": 2 * np.pi * frequency, "load": load, "voltage": volts[:, np.newaxis].astype(complex)}


def operations(found: Any, pairs: int, phases: NDArray[np.float64]) -> float:
    """Return how many operations the points took."""
    h, samples, n, steps = (values[found.done].astype(float) for values in found.effort)
    size, rows = 2.0 * pairs, 2 * n + 1
    instant = 2 * HARD + 10 * h + 2 * HARD + 10 * (h + n + 1)
    step = (samples / 2 + 1) * instant + 16 * h + 12 * rows**2 + 2 / 3 * rows**3
    kick = 3 * HARD + 16 * h + 7 * size**2
    growth = samples * kick + 22 * (2 * size**3 + 3 * size**2)
    means = phases * (20 + 16 * h + HARD + 9 * SPEEDS.size)
    return float(np.sum(steps * step + growth + means))


def operations_of_a_march(pairs: int, nodes: int) -> float:
    """Return how many operations a trajectory takes, the making of its step included, the ramp's curvature not."""
    states = 2 * pairs
    step = 13 * states + 10 + 30 + 9  # motion, what past forces foretell, the contact's force, sums
    made = pairs * nodes * (2 * (3 * HARD + 12) + 4 * SAMPLED)
    return float(PERIODS * STEPS * step + made)


def phases_of(found: Any, omega: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the phases that each point's means took, at least."""
    from sonolube.dynamics.friction_average.elliptic_quadrature import crowding_of
    from sonolube.dynamics.gpu.friction_average import crowded_levels

    fastest = omega[found.done] * np.abs(found.solutions.harmonics[found.done, 0])
    return np.asarray(crowded_levels(1e-7).numbers[0][crowding_of(SPEEDS[0] / fastest)], dtype=np.float64)


def limits() -> dict[str, float]:
    """Return the card's bandwidth, in bytes per second, and its peak of operations on doubles, in 1/s."""
    import numba.cuda

    card: Any = numba.cuda.get_current_device()  # type: ignore[no-untyped-call]
    doubles = DOUBLES.get(tuple(card.compute_capability), FEW_DOUBLES)
    return {
        "bandwidth": 2e3 * card.MEMORY_CLOCK_RATE * card.GLOBAL_MEMORY_BUS_WIDTH / 8,
        "peak": 2 * doubles * 1e3 * card.CLOCK_RATE * card.MULTIPROCESSOR_COUNT,
    }


@pytest.mark.gpu
@pytest.mark.skipif(not device_name("gpu"), reason="there is no NVIDIA GPU with numba-cuda here")
def test_steady_states_with_friction_beside_the_limits_of_the_card(benchmark: BenchmarkFixture) -> None:
    from sonolube.dynamics.gpu import solve_on_gpu

    assert RIG.structure is not None
    port, law, given = contact_port(RIG.structure), law_of(ExponentialGap(decay_length=LENGTH))[1], drawn(POINTS)
    chosen = {"speeds": SPEEDS, "least": 1, "falling": False, "stability": True, "tolerance": 1e-6}

    def solved(count: int) -> Any:
        own = {name: values[:count] for name, values in given.items()}
        return solve_on_gpu(port, law, own["omega"], own["load"], own["voltage"], np.zeros(count), **chosen)  # type: ignore[arg-type]

    solved(1000)  # compiles
    found = benchmark.pedantic(solved, args=(POINTS,), rounds=5)  # type: ignore[no-untyped-call]
    assert found.done.mean() > 0.99
    assert benchmark.stats is not None
    seconds, card = benchmark.stats.stats.min, limits()
    bytes_moved = 8.0 * POINTS * (3 + 2 + 10 + 24 + 2 + 2 * SPEEDS.size + 5)
    done = operations(found, port.trace.size, phases_of(found, given["omega"]))
    benchmark.extra_info |= {
        "device": device_name("gpu"),
        "points a second": POINTS / seconds,
        "bytes a second": bytes_moved / seconds,
        "share of the bandwidth": bytes_moved / seconds / card["bandwidth"],
        "operations a second": done / seconds,
        "share of the peak": done / seconds / card["peak"],
    }


@pytest.mark.gpu
@pytest.mark.skipif(not device_name("gpu"), reason="there is no NVIDIA GPU with numba-cuda here")
def test_trajectories_beside_the_limits_of_the_card(benchmark: BenchmarkFixture) -> None:
    assert RIG.structure is not None
    structure, given = RIG.structure, drawn(TRAJECTORIES)

    def marched(count: int, periods: int) -> Any:
        return march(
            structure,
            ExponentialGap(decay_length=LENGTH),
            normal_load=given["load"][:count],
            frequency=given["omega"][:count] / (2 * np.pi),
            voltage_peak_to_peak=2 * given["voltage"][:count, 0].real,
            periods=periods,
            steps_per_period=STEPS,
            ramp=StartUpRamp(duration=RAMPED / 22e3),
            periods_per_window=periods,
            strobed_periods=1,
            backend="gpu",
        )

    marched(1000, 4)  # compiles
    found = benchmark.pedantic(marched, args=(TRAJECTORIES, PERIODS), rounds=3)  # type: ignore[no-untyped-call]
    assert np.mean(found.status != "diverged") > 0.99
    assert benchmark.stats is not None
    pairs = state_pairs(structure)
    modes, slowest = pairs.generator.shape[0], float(given["omega"].min()) / (2 * np.pi)
    seconds, card = benchmark.stats.stats.min, limits()
    states = 2 * modes
    bytes_moved = 8.0 * TRAJECTORIES * (8 + states + 8 + STEPS * (states + 1) + states + states + 2)
    done = TRAJECTORIES * operations_of_a_march(modes, quadrature(pairs, steps=STEPS, slowest=slowest)[0].size)
    benchmark.extra_info |= {
        "device": device_name("gpu"),
        "trajectories a second": TRAJECTORIES / seconds,
        "bytes a second": bytes_moved / seconds,
        "share of the bandwidth": bytes_moved / seconds / card["bandwidth"],
        "operations a second": done / seconds,
        "share of the peak": done / seconds / card["peak"],
    }
