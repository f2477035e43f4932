"""Steady states by JAX, on the GPU or the CPU that it finds, against those of the compiled kernels."""

import subprocess
import sys
from dataclasses import replace
from typing import Any

import jax
import numpy as np
import pytest
from pytest import MonkeyPatch, approx
from tests.models.dynamics.tribometer_chain import TRIBOMETER

from sonolube.models.dynamics import (
    ExponentialGap,
    GapLaw,
    HertzGap,
    Status,
    SteadyStates,
    Structure,
    TabulatedGap,
    backend,
    drive_receptance,
    steady_state,
)

UPDATE: Any = jax.config.update  # untyped in some versions of JAX
UPDATE("jax_disable_most_optimizations", True)  # of the compiler, which takes longer than so few points

ARM = np.outer([0.0, 1.0, -1.0], [0.0, 1.0, -1.0])
ROUGH = ExponentialGap(decay_length=2e-6)
SEPARATION = np.linspace(0.0, 60e-6, 241)
FORCE = 1e4 * np.exp(-SEPARATION / 3e-6 - (SEPARATION / 4e-5) ** 2)
STIFFNESS = FORCE * (1 / 3e-6 + 2 * SEPARATION / 4e-5**2)
TABLE = TabulatedGap(separation=SEPARATION, normal_force=FORCE, normal_stiffness=STIFFNESS)
MEASURES = (
    "mean_displacement",
    "vibration_amplitude",
    "mean_normal_force",
    "highest_normal_force",
    "lowest_normal_force",
    "dissipated_power",
    "contact_loss_fraction",
)


@pytest.fixture(autouse=True)
def _with_the_device_of_jax(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(backend, "_gpu", lambda: ("device of JAX", ""))


def grounded() -> Structure:
    springs = TRIBOMETER.stiffness_matrix + 3e6 * np.diag([0.0, 0.0, 1.0])
    return replace(TRIBOMETER, stiffness_matrix=springs)


def drawn(count: int, lowest: float, highest: float) -> dict[str, Any]:
    random = np.random.default_rng(3)
    frequency = random.uniform(lowest, highest, count)
    swing = random.uniform(0.1e-6, 14e-6, count)
    return {
        "normal_load": random.uniform(1.0, 100.0, count),
        "frequency": frequency,
        "voltage_amplitude": np.abs(swing / drive_receptance(TRIBOMETER, frequency=frequency)),
    }


def check(by_jax: SteadyStates, by_kernels: SteadyStates) -> None:
    """Compare to 1e-9 of the largest of each kind of a point where the state is stable, and all statuses."""
    assert by_jax.status.tolist() == by_kernels.status.tolist()
    assert by_jax.harmonic_count.tolist() == by_kernels.harmonic_count.tolist()
    stable = by_kernels.status == Status.PERIODIC
    assert stable.any()
    ours, theirs = (each.harmonics[stable] for each in (by_jax, by_kernels))
    assert np.all(np.abs(ours - theirs) <= 1e-9 * np.abs(theirs).max(axis=1, keepdims=True))
    for name in MEASURES:
        expected = getattr(by_kernels, name)[stable]
        assert getattr(by_jax, name)[stable] == approx(expected, rel=1e-9, abs=1e-9 * np.abs(expected).max()), name


@pytest.mark.parametrize(
    ("body", "law", "points", "more"),
    [
        (grounded(), ROUGH, (60, 5e3, 1e5), {"voltage_offset": 5.0}),
        (TRIBOMETER, HertzGap(tip_radius=2e-3, effective_modulus=70e9), (8, 15e3, 30e3), {}),
        (TRIBOMETER, TABLE, (60, 15e3, 30e3), {}),
        (TRIBOMETER, ROUGH, (8, 2e3, 6e3), {"upper_branch": True}),
    ],
    ids=["held by a spring", "sphere", "table", "slow and multistable"],
)
def test_steady_states_by_jax_are_those_of_the_compiled_kernels(
    body: Structure, law: GapLaw, points: tuple[int, float, float], more: dict[str, Any]
) -> None:
    given = drawn(*points) | more
    check(steady_state(body, law, backend="gpu", **given), steady_state(body, law, **given))


def test_a_square_wave_and_batches_in_parts_give_the_same(monkeypatch: MonkeyPatch) -> None:
    given = drawn(70, 15e3, 30e3)
    orders = np.array([1, 0, -1 / 3, 0, 1 / 5])
    given["voltage_harmonics"] = given.pop("voltage_amplitude")[:, np.newaxis] * orders
    by_kernels = steady_state(TRIBOMETER, ROUGH, **given)
    check(steady_state(TRIBOMETER, ROUGH, backend="gpu", workers=2, **given), by_kernels)


def test_stability_is_determined_beside_a_nearly_rigid_damper() -> None:
    # the motion of the damper decays faster than a double can represent; one mass in the place of the joined ones
    stiff = 2e9 * np.outer([-1.0, 1.0], [-1.0, 1.0])
    one = Structure(
        mass_matrix=np.diag([0.15, 0.85]),
        damping_matrix=1.5e-8 * stiff,
        stiffness_matrix=stiff,
        drive_vector=17.36 * np.array([-1.0, 1.0]),
        contact_vector=np.array([1.0, 0.0]),
        clamped_capacitance=2.093e-7,
    )
    joined = replace(TRIBOMETER, damping_matrix=TRIBOMETER.damping_matrix + 1e9 * ARM)
    frequency = np.array([10e3, 24e3])
    given: dict[str, Any] = {
        "normal_load": np.array([30.0, 5.0]),
        "frequency": frequency,
        "voltage_amplitude": np.abs(8e-6 / drive_receptance(one, frequency=frequency)),
    }
    for processor in ("cpu", "gpu"):
        own: Any = processor
        statuses = [steady_state(body, ROUGH, backend=own, **given).status.tolist() for body in (joined, one)]
        assert statuses == [[Status.UNSTABLE, Status.PERIODIC]] * 2


def test_the_precision_of_the_calling_program_stays_as_it_is() -> None:
    steady_state(TRIBOMETER, ROUGH, backend="gpu", **drawn(3, 15e3, 30e3))
    assert jax.numpy.ones(1).dtype == np.float32


def test_jax_is_not_imported_unless_a_gpu_is_requested() -> None:
    code = (
        "import sys; from sonolube.models.dynamics import ExponentialGap, steady_state;"
        "from tests.models.dynamics.tribometer_chain import TRIBOMETER;"
        "law = ExponentialGap(decay_length=2e-6);"
        "steady_state(TRIBOMETER, law, normal_load=5.0, frequency=2e4, voltage_amplitude=1.0);"
        "assert 'jax' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
