"""Steady states of the GPU kernel against the CPU: in the CUDA simulator, and on a GPU if there is one."""

import json
import math
import os
import subprocess
import sys
import warnings
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numba.cuda
import numpy as np
import pytest
from numpy.typing import NDArray
from pytest import approx, raises

from sonolube.errors import GpuUnused, InvalidInput
from sonolube.models.dynamics import ExponentialGap, HertzGap, Status, SteadyStates, contact_motion, steady_state
from sonolube.models.dynamics.backend import _tried_gpu, device_name, usable_backend
from sonolube.models.dynamics.friction_average.elliptic_quadrature import elliptic_nodes
from sonolube.models.dynamics.harmonic_balance.batch import BatchProblem
from sonolube.models.dynamics.kinematic_friction import FrictionAverages, friction_averages, steady_friction
from sonolube.models.dynamics.structure import Structure, drive_receptance

STACK, ARM = np.array([-1.0, 1.0, 0.0]), np.array([0.0, 1.0, -1.0])
ROUGH = ExponentialGap(decay_length=2e-6)
SPEEDS = np.array([0.0, *np.geomspace(1e-3, 1.0, 9)])
NUMBERS = (
    "mean_displacement",
    "vibration_amplitude",
    "mean_normal_force",
    "highest_normal_force",
    "lowest_normal_force",
    "dissipated_power",
)


def structure(spring_to_ground: float = 0.0) -> Structure:
    springs = 2e9 * np.outer(STACK, STACK) + 2e5 * np.outer(ARM, ARM)
    springs[2, 2] += spring_to_ground
    return Structure(
        mass_matrix=np.diag([0.15, 0.35, 0.5]),
        damping_matrix=30.0 * np.outer(STACK, STACK) + 20.0 * np.outer(ARM, ARM),
        stiffness_matrix=springs,
        drive_vector=17.36 * STACK,
        contact_vector=np.array([1.0, 0.0, 0.0]),
        clamped_capacitance=2.093e-7,
    )


def points(count: int, lowest: float, highest: float, seed: int = 3) -> dict[str, Any]:
    random = np.random.default_rng(seed)
    frequency = random.uniform(lowest, highest, count)
    swing = random.uniform(0.1e-6, 14e-6, count)
    return {
        "normal_load": random.uniform(1.0, 100.0, count),
        "frequency": frequency,
        "voltage_amplitude": np.abs(swing / drive_receptance(structure(), frequency=frequency)),
    }


def compare(body: Structure, given: dict[str, Any]) -> dict[str, float]:
    """Return the differences of the kernel's results from the CPU's, and the fraction of points that it solved."""
    there, means, done = with_gpu_solved_points(body, given)
    here, friction = steady_friction(body, ROUGH, sliding_speed=SPEEDS, **given)
    known = here.status != Status.NOT_CONVERGED
    ours, theirs = (np.stack([each.kinematic, each.force_weighted])[:, known, 1:] for each in (means, friction))
    apart = {name: np.max(np.abs(getattr(there, name) / getattr(here, name) - 1)[known]) for name in NUMBERS}
    apart |= {
        "contact_loss_fraction": np.max(np.abs(there.contact_loss_fraction - here.contact_loss_fraction)[known]),
        "friction": np.max(np.abs(ours / theirs - 1)),
        "at rest": np.max(np.abs(means.kinematic[known, 0])),
        "done": done.mean(),
        "statuses apart": np.sum(there.status != here.status),
        "statuses": np.unique(here.status).size,
    }
    return {name: float(value) for name, value in apart.items()}


def with_gpu_solved_points(
    body: Structure, given: dict[str, Any]
) -> tuple[SteadyStates, FrictionAverages, NDArray[np.bool_]]:
    from sonolube.models.dynamics import gpu

    solve, solved = gpu.solve_on_gpu, []

    def observed(problem: BatchProblem) -> Any:
        solution, effort = solve(problem)
        solved.append(solution.on_gpu.copy())
        return solution, effort

    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(gpu, "solve_on_gpu", observed)
        states, means = steady_friction(body, ROUGH, sliding_speed=SPEEDS, backend="gpu", **given)
    return states, means, solved[0]


def compare_all(count: int) -> dict[str, dict[str, float]]:
    return {
        "floating": compare(structure(), points(count, 5e3, 1e5)),
        "grounded": compare(structure(3e6), points(count, 5e3, 1e5, seed=4)),
        "slow": compare(structure(), points(count, 1e3, 6e3)),
    }


def check(found: dict[str, dict[str, float]]) -> None:
    for case in found.values():
        # amplitudes hold 1e-6, and the force at its highest that times the steepness; each side's friction holds 1e-5
        assert all(case[name] < 1e-6 for name in NUMBERS[:3])
        assert all(case[name] < 1e-5 for name in NUMBERS[3:])
        assert case["contact_loss_fraction"] < 1e-6
        assert case["friction"] < 2e-5
        assert case["at rest"] == 0.0
        assert case["statuses apart"] == 0
    assert found["floating"]["done"] > 0.9
    assert found["grounded"]["done"] > 0.9
    assert 0.3 < found["slow"]["done"] < 1.0  # the others have several vibrations, or require more harmonics
    assert found["slow"]["statuses"] > 1


@pytest.fixture(scope="module")
def simulated() -> dict[str, Any]:
    """Results of the kernel in the CUDA simulator, which must be selected before numba is imported."""
    code = (
        f"import json, sys; sys.path.insert(0, {str(Path(__file__).parent)!r}); import test_steady_state_batch as t;"
        "print(json.dumps({'apart': t.compare_all(10), 'errors': t.errors_of_friction(6),"
        "'unsupported': t.unsupported(), 'row': t.row_of_the_slowest(),"
        "'pieces': t.pieces_are_the_whole(), 'rigid': t.rigidly_damped()}))"
    )
    run = subprocess.run(
        [sys.executable, "-c", code],
        env=os.environ | {"NUMBA_ENABLE_CUDASIM": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    return dict(json.loads(run.stdout))


def test_steady_states_of_the_simulated_kernel_agree_with_the_cpu(simulated: dict[str, Any]) -> None:
    check(simulated["apart"])


def test_friction_of_the_simulated_kernel_is_that_of_four_hundred_thousand_samples(simulated: dict[str, Any]) -> None:
    kinematic, loaded = simulated["errors"]
    assert kinematic < 2e-6
    assert loaded < 5e-6


def test_what_the_kernel_does_not_support_is_reported(simulated: dict[str, Any]) -> None:
    assert simulated["unsupported"] == [
        "computed on the CPU: the GPU solves steady states of ExponentialGap only, not HertzGap",
        "computed on the CPU: the GPU solves steady states without force_damping only",
        "computed on the CPU: the GPU solves steady states with up to 12 harmonics, not 20",
    ]


def row_of_the_slowest() -> int:
    """Return the row of nodes for no sliding at all, where the logarithm rounds down."""
    from sonolube.models.dynamics.gpu import friction_average

    rounded = SimpleNamespace(log10=lambda x: math.nextafter(math.log10(x), -math.inf), ceil=math.ceil)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(friction_average, "math", rounded)
        return int(friction_average.row_of(0.0))


def test_the_slowest_sliding_has_a_row_of_nodes_whatever_the_rounding_of_its_logarithm(
    simulated: dict[str, Any],
) -> None:
    assert simulated["row"] == elliptic_nodes(0).count.size - 1


def pieces_are_the_whole() -> bool:
    """Return whether results are equal where blocks and chunks hold two points, and the last of them one."""
    from sonolube.models.dynamics.gpu import device, steady_state_batch

    given = points(3, 15e3, 30e3)
    whole, means = steady_friction(structure(), ROUGH, sliding_speed=SPEEDS, backend="gpu", **given)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(steady_state_batch, "THREADS", 2)
        patched.setattr(device, "THREADS", 2)
        patched.setattr(device, "_CAPACITY", 1)
        parts, shares = steady_friction(structure(), ROUGH, sliding_speed=SPEEDS, backend="gpu", **given)
    return np.array_equal(whole.harmonics, parts.harmonics) and np.array_equal(
        means.force_weighted, shares.force_weighted
    )


def test_results_do_not_depend_on_blocks_and_chunks(simulated: dict[str, Any]) -> None:
    assert simulated["pieces"]


def rigidly_damped(backend: Any = "gpu") -> list[list[int]]:
    """Return statuses of masses joined by a nearly rigid damper, and of one mass in their place."""
    stiff = 2e9 * np.outer([-1.0, 1.0], [-1.0, 1.0])
    one = Structure(
        mass_matrix=np.diag([0.15, 0.85]),
        damping_matrix=1.5e-8 * stiff,
        stiffness_matrix=stiff,
        drive_vector=17.36 * np.array([-1.0, 1.0]),
        contact_vector=np.array([1.0, 0.0]),
        clamped_capacitance=2.093e-7,
    )
    joined = replace(structure(), damping_matrix=30.0 * np.outer(STACK, STACK) + 1e9 * np.outer(ARM, ARM))
    frequency, load, swing = np.array([10e3, 24e3]), np.array([30.0, 5.0]), 8e-6
    given: dict[str, Any] = {
        "normal_load": load,
        "frequency": frequency,
        "voltage_amplitude": np.abs(swing / drive_receptance(one, frequency=frequency)),
    }
    return [steady_state(body, ROUGH, backend=backend, **given).status.tolist() for body in (joined, one)]


def test_stability_is_determined_beside_a_nearly_rigid_damper(simulated: dict[str, Any]) -> None:
    # the motion of the damper decays faster than a double can represent
    for joined, one in (simulated["rigid"], rigidly_damped("cpu")):
        assert joined == one
        assert Status.UNSTABLE in one
        assert Status.PERIODIC in one


@pytest.mark.skipif(numba.cuda.implementation != "Built-in", reason="numba-cuda is installed")
def test_numba_without_numba_cuda_is_not_used_on_a_gpu(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numba.cuda, "is_available", lambda: True)
    assert _tried_gpu() == ("", "numba-cuda is missing: pip install numba-cuda")


def errors_of_friction(count: int) -> tuple[float, float]:
    given = points(count, 15e3, 30e3)
    states, means = steady_friction(structure(), ROUGH, sliding_speed=SPEEDS[1:], backend="gpu", **given)
    errors = []
    for point in range(count):
        contact = contact_motion(states, point, samples=400_000)
        ratio = SPEEDS[1:, np.newaxis] / np.hypot(SPEEDS[1:, np.newaxis], contact.velocity)
        load = given["normal_load"][point]
        errors.append(
            [
                np.max(np.abs(means.kinematic[point] / ratio.mean(axis=1) - 1)),
                np.max(np.abs(means.force_weighted[point] / (ratio * contact.normal_force / load).mean(axis=1) - 1)),
            ]
        )
    kinematic, loaded = np.max(errors, axis=0)
    return float(kinematic), float(loaded)


def test_steady_friction_is_the_friction_of_the_steady_states() -> None:
    given = points(5, 15e3, 30e3)
    states, means = steady_friction(structure(), ROUGH, sliding_speed=SPEEDS, **given)
    apart = friction_averages(steady_state(structure(), ROUGH, **given), sliding_speed=SPEEDS)
    assert np.array_equal(means.kinematic, apart.kinematic)
    assert np.array_equal(means.force_weighted, apart.force_weighted)
    assert states.harmonics.shape[0] == 5


@pytest.mark.skipif(bool(device_name("gpu")), reason="there is a GPU")
def test_without_a_gpu_the_cpu_solves_with_a_warning() -> None:
    given = points(3, 15e3, 30e3)
    with pytest.warns(GpuUnused, match=r"computed on the CPU: .*sonolube\[gpu\]"):
        states = steady_state(structure(), ROUGH, backend="gpu", **given)
    assert states.harmonics == approx(steady_state(structure(), ROUGH, **given).harmonics, rel=0, abs=0)


def test_another_backend_is_refused() -> None:
    with raises(InvalidInput, match="backend must be cpu or gpu, got 'tpu'"):
        usable_backend("tpu")  # type: ignore[arg-type]


def unsupported() -> list[str]:
    given = points(2, 15e3, 30e3)
    damped = ExponentialGap(decay_length=2e-6, force_damping=0.1)
    with warnings.catch_warnings(record=True) as raised:
        warnings.simplefilter("always", GpuUnused)
        for law, least in ((HertzGap(tip_radius=2e-3, effective_modulus=70e9), 1), (damped, 1), (ROUGH, 20)):
            steady_state(structure(), law, backend="gpu", minimum_harmonics=least, stability=False, **given)
    return [str(each.message) for each in raised if issubclass(each.category, GpuUnused)]


@pytest.mark.gpu
@pytest.mark.skipif(not device_name("gpu"), reason="there is no NVIDIA GPU with numba-cuda here")
def test_steady_states_of_a_gpu_agree_with_the_cpu() -> None:
    check(compare_all(2000))
