"""Steady states of the tribometer by harmonic balance, friction at 16 sliding speeds included, beside two rivals.

A point is one load, frequency and voltage of a sine; amplitudes of the tip run from 0.5 to 14 um. Everything but the
million points runs on one core. The rivals are scipy's DOP853 with a compiled right-hand side, marched through 0.05 s
at rtol 1e-8, and a harmonic balance in JAX: compiled, batched, in doubles, with the fewest harmonics, samples and
iterations that hold 1e-4. Accuracy is that of the amplitude of the first harmonic and of the mean friction, against the
periodic orbit that shooting with DOP853 at rtol 1e-10 finds.
"""

import os
import resource
import subprocess
import sys
import time
import timeit
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import numba
import numpy as np
import pytest
from numpy.typing import NDArray
from pytest_benchmark.fixture import BenchmarkFixture
from scipy.integrate import solve_ivp

from sonolube.models.contact import decay_length
from sonolube.models.dynamics import ExponentialGap, steady_state
from sonolube.models.dynamics.friction_average.elliptic_quadrature import elliptic_nodes, node_table_row
from sonolube.models.dynamics.kinematic_friction import friction_averages
from sonolube.models.dynamics.structure import contact_receptance, drive_receptance
from sonolube.rig import read_rig

Array = NDArray[np.float64]
RIG_FILE = Path(__file__).parent.parent / "examples" / "rigs" / "tribometer.toml"
RIG = read_rig(RIG_FILE)
DECAY_LENGTH = float(decay_length(RIG.contact))
GAP_LAW = ExponentialGap(decay_length=DECAY_LENGTH)
SPEEDS = np.geomspace(1e-3, 1.0, 16)
HARMONICS = 5  # of the rival in JAX, the fewest that hold 1e-4 in the friction
TOLERANCE = 1e-4  # of ours
SPINNING = 0.05  # s, for which threads of JAX may go on after an answer
MARCHED = 0.05  # s, that a rival marches to its steady state


def structure() -> Any:
    assert RIG.structure is not None
    return RIG.structure


def drawn(points: int) -> dict[str, Array]:
    random = np.random.default_rng(1)
    frequency, load = random.uniform(18e3, 26e3, points), random.uniform(1.0, 10.0, points)
    amplitude = random.uniform(0.5e-6, 14e-6, points)
    voltage = amplitude / np.abs(drive_receptance(structure(), frequency=frequency))
    return {"frequency": frequency, "normal_load": load, "voltage_amplitude": voltage}


def ours(
    points: dict[str, Array], *, stability: bool = False, workers: int = 1, tolerance: float = TOLERANCE
) -> tuple[Array, Array, Array]:
    """Return amplitude of the first harmonic, mean force, and mean friction over its limit at rest, per speed."""
    states = steady_state(
        structure(),
        GAP_LAW,
        normal_load=points["normal_load"],
        frequency=points["frequency"],
        voltage_amplitude=points["voltage_amplitude"],
        relative_tolerance=tolerance,
        stability=stability,
        workers=workers,
    )
    means = friction_averages(states, sliding_speed=SPEEDS, workers=workers)
    return np.abs(states.harmonics[:, 0]), states.mean_normal_force, means.force_weighted


@contextmanager
def one_core() -> Iterator[None]:
    cores = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {max(cores)})
    try:
        yield
    finally:
        os.sched_setaffinity(0, cores)


def system() -> tuple[Array, Array, Array]:
    """Return matrix and columns of z' = A z + b V + c (F_n - F_N), z displacements and velocities over 1e5/s."""
    s, scale = structure(), 1e5
    inverse, zeros = np.linalg.inv(s.mass_matrix), np.zeros(s.coordinates)
    springs, dampers = -inverse @ s.stiffness_matrix / scale, -inverse @ s.damping_matrix
    matrix = np.block([[np.zeros_like(springs), scale * np.eye(s.coordinates)], [springs, dampers]])
    drive, contact = inverse @ s.drive_vector / scale, inverse @ s.contact_vector / scale
    return matrix, np.r_[zeros, drive], np.r_[zeros, contact]


@numba.njit
def rate(
    t: float, z: Array, matrix: Array, drive: Array, contact: Array, omega: float, swing: float, load: float
) -> Any:
    force = load * np.exp(-z[0] / DECAY_LENGTH)
    return matrix @ z + drive * (swing * np.cos(omega * t)) + contact * (force - load)


def march(point: dict[str, float], start: Array, end: float, rtol: float, **options: Any) -> Any:
    omega, swing, load = 2 * np.pi * point["frequency"], point["voltage_amplitude"], point["normal_load"]
    arguments = (*system(), omega, swing, load)
    return solve_ivp(rate, (0.0, end), start, method="DOP853", rtol=rtol, atol=1e-7 * rtol, args=arguments, **options)


def marching_seconds(points: dict[str, Array], part: float = 0.004) -> float:
    rest, spent = np.zeros(2 * structure().coordinates), []
    for i in range(3):
        point = {name: float(values[i]) for name, values in points.items()}
        march(point, rest, 1e-5, 1e-8)  # compiles
        spent.append(min(timeit.repeat(partial(march, point, rest, part, 1e-8), number=1, repeat=3)))
    return float(np.mean(spent)) * MARCHED / part


def by_shooting(point: dict[str, float]) -> tuple[float, Array]:
    """Return amplitude of the first harmonic and mean friction of the orbit that closes after one period."""
    period, size, samples = 1 / point["frequency"], 2 * structure().coordinates, 2**16
    contact = structure().contact_vector

    def ending(z: Array) -> Array:
        return np.asarray(march(point, z, period, 1e-10).y[:, -1])

    z = np.zeros(size)
    for _ in range(12):
        closing = ending(z) - z
        slopes = np.array([(ending(z + 1e-9 * unit) - z - 1e-9 * unit - closing) / 1e-9 for unit in np.eye(size)]).T
        step = np.linalg.solve(slopes, -closing)
        z = z + step * min(1.0, 2 * DECAY_LENGTH / np.abs(step).max())
    assert np.abs(closing).max() < 1e-12
    y = march(point, z, period, 1e-10, dense_output=True).sol(np.arange(samples) * period / samples)
    x, v = contact @ y[: size // 2], 1e5 * contact @ y[size // 2 :]
    ratios = SPEEDS[:, np.newaxis] / np.hypot(SPEEDS[:, np.newaxis], v)
    first = 2 * abs(np.fft.rfft(x)[1]) / samples
    return first, np.asarray(np.mean(np.exp(-x / DECAY_LENGTH) * ratios, axis=1))


def eliminated(a: Any, b: Any, jnp: Any) -> Any:
    """Return the solution of a small system without pivots, written out: its matrix is all but the identity."""
    rows = b.size
    a, b = [[a[i, j] for j in range(rows)] for i in range(rows)], [b[i] for i in range(rows)]
    for p in range(rows):
        for i in range(p + 1, rows):
            factor = a[i][p] / a[p][p]
            a[i] = a[i][: p + 1] + [mine - factor * its for mine, its in zip(a[i][p + 1 :], a[p][p + 1 :], strict=True)]
            b[i] = b[i] - factor * b[p]
    for i in range(rows - 1, -1, -1):
        b[i] = (b[i] - sum(a[i][j] * b[j] for j in range(i + 1, rows))) / a[i][i]
    return jnp.stack(b)


def jax_motion(jax: Any, by_hand: bool, samples: int) -> Callable[..., Any]:
    """Return Newton's method for mean, cosines and sines of one point, two steps from the free motion."""
    jnp, rows = jax.numpy, 2 * HARMONICS + 1
    theta = 2 * np.pi * np.arange(samples) / samples
    orders = range(1, HARMONICS + 1)
    waves = np.vstack([np.ones(samples)] + [wave(k * theta) for k in orders for wave in (np.cos, np.sin)])
    first_only = np.arange(HARMONICS) == 0

    def residual(u: Any, load: Any, free: Any, received: Any) -> Any:
        f = load * jnp.exp(-(u @ waves) / DECAY_LENGTH)
        line = free * first_only + received * (waves[1::2] @ f - 1j * (waves[2::2] @ f)) * (2 / samples)
        pairs = jnp.stack([line.real - u[1::2], -line.imag - u[2::2]], axis=1)
        return jnp.concatenate([f.mean(keepdims=True) / load - 1, pairs.ravel()])

    def slopes(u: Any, load: Any, received: Any) -> Any:
        f = load * jnp.exp(-(u @ waves) / DECAY_LENGTH)
        stiff = (waves * (f / DECAY_LENGTH / samples)) @ waves.T
        g, c, s = received[:, np.newaxis], 2 * stiff[1::2], 2 * stiff[2::2]
        pairs = jnp.stack([g.real * c + g.imag * s, g.real * s - g.imag * c], axis=1).reshape(rows - 1, rows)
        return -jnp.concatenate([stiff[:1] / load, pairs]) - np.diag(np.r_[0.0, np.ones(rows - 1)])

    def solved(load: Any, free: Any, received: Any) -> Any:
        beta = jnp.abs(free) / DECAY_LENGTH
        mean = DECAY_LENGTH * (beta + jnp.log(jax.scipy.special.i0e(beta)))
        u = jnp.concatenate([jnp.stack([mean, free.real, -free.imag]), jnp.zeros(rows - 3)])
        for _ in range(2):
            wrong = residual(u, load, free, received)
            if by_hand:
                u = u - eliminated(slopes(u, load, received), wrong, jnp)
            else:
                u = u - jnp.linalg.solve(jax.jacfwd(residual)(u, load, free, received), wrong)
        return u

    return solved


def jax_balance(points: dict[str, Array], *, by_hand: bool) -> Callable[[], Any]:
    """Return a compiled harmonic balance of the same points in JAX.

    Newton's method takes `jacfwd` and `jnp.linalg.solve`, or by hand an analytic Jacobian and an elimination written
    out. Friction is averaged over nodes clustered at the extrema of the first harmonic.
    """
    jax = pytest.importorskip("jax", reason="the rival is a harmonic balance in JAX")
    jax.config.update("jax_enable_x64", True)
    jnp = jax.numpy
    omega, load = 2 * np.pi * points["frequency"], points["normal_load"]
    free = drive_receptance(structure(), frequency=points["frequency"]) * points["voltage_amplitude"]
    orders = np.arange(1, HARMONICS + 1)
    received = contact_receptance(structure(), frequency=np.multiply.outer(points["frequency"], orders))
    row, nodes = int(node_table_row(SPEEDS.min() / np.max(omega * np.abs(free)))), elliptic_nodes(8)
    inside = slice(0, nodes.count[row])
    circle, weight = nodes.cosine[row, inside] + 1j * nodes.sine[row, inside], nodes.weight[row, inside]
    motion = jax_motion(jax, by_hand, samples=24)

    def one(omega: Any, load: Any, free: Any, received: Any) -> Any:
        u = motion(load, free, received)
        first = u[1] - 1j * u[2]
        z = circle * 1j * jnp.conj(first / jnp.abs(first))  # clustered at +-90 degrees, extrema of the first harmonic
        power, x, v = jnp.ones_like(z), u[0], 0.0
        for k in range(HARMONICS):
            power = power * z
            line = (u[2 * k + 1] - 1j * u[2 * k + 2]) * power
            x, v = x + line.real, v - (k + 1) * omega * line.imag
        ratios = SPEEDS[:, np.newaxis] * jax.lax.rsqrt(v * v + SPEEDS[:, np.newaxis] ** 2)
        return jnp.abs(first), ratios @ (weight * jnp.exp(-x / DECAY_LENGTH))

    batched = jax.jit(jax.vmap(one))
    arguments = tuple(jnp.asarray(values) for values in (omega, load, free, received))
    return lambda: jax.block_until_ready(batched(*arguments))


def seconds(call: Callable[[], Any], *, pause: float = 0.0) -> float:
    time.sleep(pause)
    return timeit.timeit(call, number=1)


@pytest.mark.parametrize(
    ("stability", "tolerance"),
    [(False, TOLERANCE), (True, TOLERANCE), (False, 1e-6)],
    ids=["plain", "with_stability", "as_exact_as_can_be"],
)
def test_ten_thousand_points(benchmark: BenchmarkFixture, stability: bool, tolerance: float) -> None:
    points = drawn(10_000)
    with one_core():
        call = partial(ours, points, stability=stability, tolerance=tolerance)
        call()
        benchmark.pedantic(call, rounds=40)  # type: ignore[no-untyped-call]
        marching = marching_seconds(points)
        busy = min(timeit.repeat(call, time.process_time, number=1, repeat=20))
    if benchmark.stats:
        best, median = benchmark.stats.stats.min / 10_000, benchmark.stats.stats.median / 10_000
        benchmark.extra_info |= {
            "us_a_point_median": 1e6 * median,
            "us_a_point_best": 1e6 * best,
            "cpu_us_a_point": 100 * busy,
            "dop853_s_a_point": marching,
            "speed_ratio_median": marching / median,
            "speed_ratio_best": marching / best,
        }


@pytest.mark.parametrize("by_hand", [True, False], ids=["by_hand", "jacfwd_and_solve"])
def test_the_same_points_beside_jax(benchmark: BenchmarkFixture, by_hand: bool) -> None:
    points = drawn(10_000)
    with one_core():
        rival = jax_balance(points, by_hand=by_hand)
        amplitude, friction = (np.asarray(values) for values in rival())
        first, _, ratios = ours(points)
        assert np.abs(amplitude / first - 1).max() < 1e-4
        assert np.abs(friction / ratios - 1).max() < 1e-4
        # in turns, so that whatever else the machine does burdens both alike; JAX's threads spin for a while afterwards
        spent = [(seconds(rival), seconds(lambda: ours(points), pause=SPINNING)) for _ in range(25)]
        benchmark.pedantic(ours, args=(points,), rounds=5)  # type: ignore[no-untyped-call]
    theirs, own = np.transpose(spent)
    benchmark.extra_info |= {
        "jax_us_a_point_best": 100 * theirs.min(),
        "us_a_point_best": 100 * own.min(),
        "speed_ratio_best": theirs.min() / own.min(),
        "speed_ratio_median": float(np.median(theirs / own)),
    }


def test_the_accuracy_that_goes_with_it(benchmark: BenchmarkFixture) -> None:
    points = drawn(12)
    first, force, ratios = benchmark(ours, points)
    assert np.abs(force / points["normal_load"] - 1).max() < 0.1
    errors = []
    for i in range(12):
        amplitude, friction = by_shooting({name: float(values[i]) for name, values in points.items()})
        errors.append((abs(first[i] / amplitude - 1), np.abs(ratios[i] / friction - 1).max()))
    largest = np.max(errors, axis=0)
    benchmark.extra_info |= {"amplitude": float(largest[0]), "mean_friction": float(largest[1])}
    assert largest.max() < 1e-4


def in_batches(points: dict[str, Array]) -> Array:
    """Return the friction of a million points, 100,000 at a time so that all else about them need not be kept."""
    friction = np.empty((points["frequency"].size, SPEEDS.size))
    for start in range(0, friction.shape[0], 100_000):
        batch = slice(start, start + 100_000)
        friction[batch] = ours({name: values[batch] for name, values in points.items()}, workers=2)[2]
    return friction


def test_a_million_points_on_two_cores(benchmark: BenchmarkFixture) -> None:
    points = drawn(1_000_000)
    ours({name: values[:64] for name, values in points.items()})
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    spent, started = time.perf_counter(), time.process_time()
    benchmark.pedantic(in_batches, args=(points,), rounds=3)  # type: ignore[no-untyped-call]
    elapsed, busy = time.perf_counter() - spent, time.process_time() - started
    growth = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    benchmark.extra_info |= {
        "peak_growth_MB": growth / 1024,
        "cores_obtained": busy / elapsed,
        "cpu_us_a_point": busy / 3,
    }


FIRST_CALL = """
import time
import numpy as np
began = time.perf_counter()
from sonolube.models.dynamics.kinematic_friction import friction_averages
from sonolube.models.dynamics import steady_state
from sonolube.models.dynamics import ExponentialGap
from sonolube.models.dynamics.structure import Structure
imported, worked = time.perf_counter(), time.process_time()
structure = Structure(
    mass_matrix=np.diag([0.11, 2.5]), damping_matrix=30 * np.eye(2),
    stiffness_matrix=2e9 * np.array([[1, -1], [-1, 1.1]]),
    drive_vector=17 * np.array([-1.0, 1.0]), contact_vector=np.array([1.0, 0.0]), clamped_capacitance=2e-7,
)
states = steady_state(
    structure, ExponentialGap(decay_length=2e-6), normal_load=3.0, frequency=22e3, voltage_amplitude=14.0,
    stability=STABILITY,
)
friction_averages(states, sliding_speed=np.geomspace(1e-3, 1, 16))
print(imported - began, time.perf_counter() - imported, time.process_time() - worked)
"""


@pytest.mark.parametrize("stability", [False, True], ids=["plain", "with_stability"])
def test_the_first_call_after_installation_and_later_ones(
    benchmark: BenchmarkFixture, tmp_path: Path, stability: bool
) -> None:
    def fresh() -> list[float]:
        answer = subprocess.run(
            [sys.executable, "-c", FIRST_CALL.replace("STABILITY", str(stability))],
            env=os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)},
            capture_output=True,
            text=True,
            check=True,
        )
        return [float(word) for word in answer.stdout.split()]

    _, first, first_cpu = fresh()
    benchmark.pedantic(fresh, rounds=3)  # type: ignore[no-untyped-call]
    imported, later, later_cpu = np.min([fresh() for _ in range(3)], axis=0)
    benchmark.extra_info |= {
        "first_call_s": first,
        "first_call_cpu_s": first_cpu,
        "later_call_s": float(later),
        "later_call_cpu_s": float(later_cpu),
        "import_s": float(imported),
    }
