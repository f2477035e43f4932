"""A map of the tribometer, friction by stick-slip included, beside scipy's marching on all cores and a balance in JAX.

A point is one voltage, frequency, load and sliding speed, all drawn apart, so that no two share a vibration. Ours runs
in two threads, statuses, powers and stability included. The first rival marches each point with DOP853 at rtol 1e-8
through 0.05 s, its right-hand side in numpy, in one process to a core (what joblib would do); its time comes from four
points and a part of that time. The second is a harmonic balance in JAX, vmapped, of five harmonics, 32 samples and four
Newton steps, in doubles; friction, stability and powers are left out, which favours it.
"""

import multiprocessing
import os
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture
from scipy.integrate import solve_ivp

from sonolube.design import compute_points, latin_hypercube_plan, sweep
from sonolube.models.contact import decay_length
from sonolube.models.dynamics.structure import contact_receptance, drive_receptance
from sonolube.rig import read_rig

RIG_FILE = Path(__file__).parent.parent / "examples" / "rigs" / "tribometer.toml"
OVER = {
    "drive.voltage_peak_to_peak": (1.0, 28.0),
    "drive.frequency": (20e3, 24e3),
    "contact.normal_load": (1.0, 9.0),
    "sliding.sliding_speed": (1e-3, 0.3),
}
MARCHED, PART = 0.05, 0.002  # s: that a rival marches to its steady state, and that is timed


def marching_seconds(point: tuple[float, float, float]) -> float:
    """Return the processor time that DOP853 takes for one point."""
    volts, frequency, load = point
    rig = read_rig(RIG_FILE)
    assert rig.structure is not None
    s, length, size = rig.structure, float(decay_length(rig.contact)), rig.structure.coordinates
    inverse = np.linalg.inv(s.mass_matrix)
    springs, dampers = -inverse @ s.stiffness_matrix, -inverse @ s.damping_matrix
    drive, contact = inverse @ s.drive_vector, inverse @ s.contact_vector
    omega, swing = 2 * np.pi * frequency, volts / 2

    def rate(t: float, z: np.ndarray) -> np.ndarray:
        force = load * np.exp(-(s.contact_vector @ z[:size]) / length)
        bent = springs @ z[:size] + dampers @ z[size:] + drive * (swing * np.cos(omega * t)) + contact * (force - load)
        return np.concatenate([z[size:], bent])

    start = time.process_time()
    solve_ivp(rate, (0.0, PART), np.zeros(2 * size), method="DOP853", rtol=1e-8, atol=1e-15)
    return (time.process_time() - start) * MARCHED / PART


@pytest.mark.parametrize("points", [int(os.environ.get("SONOLUBE_SWEEP_POINTS", "200000"))])
def test_a_map_beside_marching_on_every_core(benchmark: BenchmarkFixture, points: int) -> None:
    plan = latin_hypercube_plan(RIG_FILE, over=OVER, points=points)
    compute_points(plan, 0, 64)  # compiles
    spent = time.process_time()
    found = benchmark.pedantic(sweep, args=(plan,), kwargs={"workers": 2}, rounds=1)  # type: ignore[no-untyped-call]
    spent = time.process_time() - spent
    assert not np.isnan(found["friction_ratio"].values).any()
    rows = plan.rows(0, 4)
    sample = list(zip(*(rows[key] for key in list(OVER)[:3]), strict=True))
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        each = float(np.mean(pool.map(marching_seconds, sample)))
    benchmark.extra_info |= {
        "processor time of ours, us a point": 1e6 * spent / points,
        "processor time of DOP853, s a point": each,
        "ratio": each * points / spent,
    }


def test_a_map_beside_jax_vmapped(benchmark: BenchmarkFixture) -> None:
    jax = pytest.importorskip("jax")
    jax.config.update("jax_enable_x64", True)
    jnp = jax.numpy
    rig = read_rig(RIG_FILE)
    assert rig.structure is not None
    points, orders, samples = 20_000, 5, 32
    plan = latin_hypercube_plan(RIG_FILE, over=OVER, points=points)
    rows = plan.rows(0, points)
    volts, frequency, load, _ = (rows[key] for key in OVER)
    multiples = frequency[:, np.newaxis] * np.arange(1, orders + 1)
    yielding = contact_receptance(rig.structure, frequency=multiples)
    free = drive_receptance(rig.structure, frequency=frequency) * volts / 2
    length = float(decay_length(rig.contact))
    turning = np.exp(2j * np.pi * np.multiply.outer(np.arange(samples) / samples, np.arange(1, orders + 1)))

    def residual(u: Any, yielding: Any, free: Any, load: Any) -> Any:
        x = u[0] + (turning.real @ u[1 : orders + 1] + turning.imag @ u[orders + 1 :])
        force = load * jnp.exp(-x)
        driven = jnp.zeros(orders, dtype=complex).at[0].set(free / length)
        moved = driven + yielding * (2 / length) * (turning.conj().T @ force) / samples
        return jnp.concatenate(
            [jnp.array([jnp.log(jnp.mean(force) / load)]), u[1 : orders + 1] - moved.real, u[orders + 1 :] + moved.imag]
        )

    def solved(yielding: Any, free: Any, load: Any) -> Any:
        beta = jnp.abs(free) / length
        start = jnp.zeros(2 * orders + 1).at[1].set(free.real / length).at[orders + 1].set(-free.imag / length)
        u = start.at[0].set(beta / (1 + 2 / (beta + 1e-9)))
        for _ in range(4):
            u = u - jnp.linalg.solve(jax.jacfwd(residual)(u, yielding, free, load), residual(u, yielding, free, load))
        return u

    batched = jax.jit(jax.vmap(solved))
    batched(yielding, free, load).block_until_ready()
    spent = time.process_time()
    u = np.asarray(batched(yielding, free, load).block_until_ready())
    theirs = (time.process_time() - spent) / points
    compute_points(plan, 0, 64)
    spent = time.process_time()
    ours = benchmark.pedantic(compute_points, args=(plan, 0, points), rounds=1)  # type: ignore[no-untyped-call]
    mine = (time.process_time() - spent) / points
    amplitude = length * np.hypot(u[:, 1], u[:, orders + 1])
    off = np.abs(amplitude / ours.numbers["vibration_amplitude"] - 1)
    benchmark.extra_info |= {
        "processor time of ours, us a point, friction and status included": 1e6 * mine,
        "processor time of JAX, us a point, the vibration alone": 1e6 * theirs,
        "ratio": theirs / mine,
        "amplitudes differ by, median": float(np.median(off)),
    }
    assert np.median(off) < 1e-3
