"""Steady states and trajectories on a GPU against the limits of the card.

Steady states include friction at 16 sliding speeds and stability; points are those of `test_steady_state_speed.py`.
Trajectories are 2,200 periods of such points from rest with 16 steps per period, the first 220 with a ramp. The time is
that of the whole call, transfers included. Bytes are those transferred; registers spilled to local memory do not count.
Operations are counted from the algorithm, for steady states with the harmonics, samples and steps that each point took:
sums, products, quotients and roots as one each, sines and exponentials as twenty. The limits are the card's own:
bandwidth from its bus, peak from its multiprocessors, their double-precision units and its clock.
"""

import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from pytest_benchmark.fixture import BenchmarkFixture

from sonolube.models.contact import decay_length
from sonolube.models.dynamics import ExponentialGap, StartUpRamp, drive_receptance, march
from sonolube.models.dynamics.backend import device_name
from sonolube.models.dynamics.first_order_modes import first_order_modes
from sonolube.models.dynamics.harmonic_balance.batch import BatchProblem, BatchSolution
from sonolube.models.dynamics.harmonic_balance.receptance import pole_residue_model
from sonolube.models.dynamics.time_marching.integrator import step_quadrature
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


def operations(found: tuple[BatchSolution, Any], pairs: int, nodes: NDArray[np.float64]) -> float:
    """Return the number of operations of the solved points."""
    solution, effort = found
    h, samples, n, steps = (values[solution.on_gpu].astype(float) for values in effort)
    size, rows = 2.0 * pairs, 2 * n + 1
    instant = 2 * HARD + 10 * h + 2 * HARD + 10 * (h + n + 1)
    step = (samples / 2 + 1) * instant + 16 * h + 12 * rows**2 + 2 / 3 * rows**3
    kick = 3 * HARD + 16 * h + 7 * size**2
    growth = samples * kick + 22 * (2 * size**3 + 3 * size**2)
    means = nodes * (20 + 16 * h + HARD + 9 * SPEEDS.size)
    return float(np.sum(steps * step + growth + means))


def operations_of_a_march(pairs: int, nodes: int) -> float:
    """Return the number of operations of a trajectory, with its integrator, without the curvature of the ramp."""
    states = 2 * pairs
    step = 13 * states + 10 + 30 + 9  # motion, predictor, contact force, sums
    made = pairs * nodes * (2 * (3 * HARD + 12) + 4 * SAMPLED)
    return float(PERIODS * STEPS * step + made)


def nodes_of(solution: BatchSolution, omega: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the least number of quadrature nodes of each solved point's friction averages."""
    from sonolube.models.dynamics.friction_average.elliptic_quadrature import node_table_row
    from sonolube.models.dynamics.gpu.friction_average import node_tables

    fastest = omega[solution.on_gpu] * np.abs(solution.harmonics[solution.on_gpu, 0])
    return np.asarray(node_tables(1e-7).sizes[0][node_table_row(SPEEDS[0] / fastest)], dtype=np.float64)


def limits() -> dict[str, float]:
    """Return bandwidth, in bytes per second, and peak rate of double-precision operations of the card, in 1/s."""
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
    from sonolube.models.dynamics.gpu import solve_on_gpu

    assert RIG.structure is not None
    model, law, given = pole_residue_model(RIG.structure), ExponentialGap(decay_length=LENGTH), drawn(POINTS)
    problem = BatchProblem(
        model=model,
        gap_law=law,
        omega=given["omega"],
        load=given["load"],
        voltage=given["voltage"],
        static_displacement=np.zeros(POINTS),
        minimum_harmonics=1,
        upper_branch=False,
        stability=True,
        tolerance=1e-6,
        speeds=SPEEDS,
    )

    def solved(count: int) -> tuple[BatchSolution, Any]:
        return solve_on_gpu(problem.select(np.arange(count)))

    solved(1000)  # compiles
    found = benchmark.pedantic(solved, args=(POINTS,), rounds=5)  # type: ignore[no-untyped-call]
    assert found[0].on_gpu.mean() > 0.99
    assert benchmark.stats is not None
    seconds, card = benchmark.stats.stats.min, limits()
    bytes_moved = 8.0 * POINTS * (3 + 2 + 10 + 24 + 2 + 2 * SPEEDS.size + 5)
    done = operations(found, model.trace.size, nodes_of(found[0], given["omega"]))
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
    pairs = first_order_modes(structure)
    modes, slowest = pairs.state_matrix.shape[0], float(given["omega"].min()) / (2 * np.pi)
    seconds, card = benchmark.stats.stats.min, limits()
    states = 2 * modes
    bytes_moved = 8.0 * TRAJECTORIES * (8 + states + 8 + STEPS * (states + 1) + states + states + 2)
    done = TRAJECTORIES * operations_of_a_march(modes, step_quadrature(pairs, steps=STEPS, slowest=slowest)[0].size)
    benchmark.extra_info |= {
        "device": device_name("gpu"),
        "trajectories a second": TRAJECTORIES / seconds,
        "bytes a second": bytes_moved / seconds,
        "share of the bandwidth": bytes_moved / seconds / card["bandwidth"],
        "operations a second": done / seconds,
        "share of the peak": done / seconds / card["peak"],
    }
