r"""Newton's method and Floquet stability of a batch by JAX, on a GPU where JAX has one.

The methods, and the truncation of each point, are those of `harmonic_kernel`, `newton_kernel` and `floquet_kernel`. A
function treats one point, and JAX maps it over the batch; iterations continue until the last point has ended, and those
that have ended keep what they have. Arrays are padded to few sizes, since JAX compiles for each. Numbers are in double
precision within these calls, whatever the program that calls has set for JAX.
"""

from collections.abc import Callable, Iterator
from functools import partial
from threading import Lock
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from sonolube.checks import Complexes, Floats, Integers
from sonolube.models.dynamics.gap_laws.closed_form import GapLaw
from sonolube.models.dynamics.gap_laws.table import kernel_law
from sonolube.models.dynamics.harmonic_balance.batch import BatchProblem
from sonolube.models.dynamics.harmonic_balance.floquet_kernel import (
    DISPLACEMENT_OUTPUT,
    INPUT,
    SQUARINGS,
    VELOCITY_OUTPUT,
)
from sonolube.models.dynamics.harmonic_balance.harmonic_kernel import (
    CONVERGED,
    DIVERGED,
    FINAL_STEP,
    LARGEST_STEP,
    LAST_STEP,
    NEEDS_HARMONICS,
    NEEDS_SAMPLES,
    TAIL,
    Iterates,
    Truncation,
)
from sonolube.models.dynamics.kernels.contact_kernel import EXPONENTIAL, HERTZ, LARGEST_LOG_FORCE, LINEAR

_HARMONICS, _SAMPLES, _COUPLED = (8, 16, 64), (32, 64, 256, 2048), 32  # sizes of the arrays of a point
_POINTS = np.array([8, 64, 512, 4096, 16384])  # sizes of a batch
_NUMBERS = 2**26  # complex numbers of all points at a time, which bounds the memory at 1 GB
_ONE_AT_A_TIME = Lock()  # of the threads that call; two programs at once can wait for each other on a CPU of two cores

Array = jax.Array


def newton_solve(
    problem: BatchProblem, iterates: Iterates, truncation: Truncation, chosen: Integers, steps: int
) -> Integers:
    """Solve the equations of harmonic balance of the chosen points, writing those that do not diverge.

    CONVERGED, DIVERGED, NEEDS_HARMONICS or NEEDS_SAMPLES.
    """
    law = kernel_law(problem.gap_law)
    shared = problem.model.contact_poles(), problem.model.static_stiffness, law[2:], problem.tolerance, steps
    sizes = np.searchsorted(_HARMONICS, truncation.harmonics), np.searchsorted(_SAMPLES, truncation.samples)
    finest = (0.5 * truncation.samples - 1) / (truncation.samples - truncation.harmonics)
    aliased = problem.tolerance ** (finest if len(law.kind) == EXPONENTIAL and not law.damped else np.ones_like(finest))
    free, found, force = (each.view(np.complex128) for each in (iterates[1], *iterates[3:]))
    outcome = np.empty(iterates.mean.size, dtype=np.int64)
    for size, samples in {*zip(*(each[chosen].tolist() for each in sizes), strict=True)}:
        width, count = _HARMONICS[size], _SAMPLES[samples]
        alike = chosen[(sizes[0][chosen] == size) & (sizes[1][chosen] == samples)]
        motions = _resized(free, width), iterates.mean[:, 0], _resized(found, width)
        given = iterates.settings, *motions, *truncation, aliased
        for own in _parts(alike, count * (2 * width + 1)):
            mean, harmonics, forces, outcome[own] = _mapped(_solved, (len(law.kind), count), shared, given, own)
            kept = outcome[own] != DIVERGED
            iterates.mean[own[kept], 0] = mean[kept]
            found[own[kept], :width] = _resized(harmonics[kept], min(width, found.shape[1]))
            force[own[kept], :width] = _resized(forces[kept], min(width, force.shape[1]))
    return outcome[chosen]


def monodromy_power_norms(
    gap_law: GapLaw, pairs: Floats, settings: Floats, drift: Floats, harmonics: Complexes, kicks: Integers
) -> tuple[Floats, Floats]:
    """Norms of the monodromy matrices to the power 2^22, in two parts, as `floquet_kernel` writes them; shape (p,)."""
    law = kernel_law(gap_law)
    powers, norms = np.empty((2, kicks.size))
    wide = _resized(harmonics, next(size for size in _HARMONICS if harmonics.shape[1] <= size))
    given = settings, drift, wide, kicks
    for own in _parts(np.argsort(kicks, kind="stable"), drift.shape[1] ** 2):
        powers[own], norms[own] = _mapped(_power_norms, (len(law.kind),), (pairs, law[2:]), given, own)
    return powers, norms


def _parts(points: Integers, numbers: int) -> Iterator[Integers]:
    """Parts of a batch to treat together, given the numbers that one point takes."""
    most = max(int(_POINTS[_POINTS * numbers <= _NUMBERS].max(initial=0)), int(_POINTS[0]))
    return (points[start : start + most] for start in range(0, points.size, most))


def _resized(table: Complexes, width: int) -> Complexes:
    """Columns of a table up to a width, zero where it has fewer."""
    return np.pad(table[:, :width], ((0, 0), (0, max(width - table.shape[1], 0))))


def _mapped(function: Callable[..., Any], static: Any, shared: Any, given: Any, own: Integers) -> list[Any]:
    """Results of a function for points of a batch; the first point is repeated up to a size that is compiled."""
    padding = next(size for size in _POINTS if own.size <= size) - own.size
    padded = np.concatenate([own, np.repeat(own[:1], padding)])
    with _ONE_AT_A_TIME, jax.enable_x64(True):
        found = _batch(function, static, shared, tuple(values[padded] for values in given))
        return [np.array(values[: own.size]) for values in found]


@partial(jax.jit, static_argnums=(0, 1))
def _batch(function: Callable[..., Any], static: Any, shared: Any, given: Any) -> Any:
    """Results of a function of one point for a batch, compiled."""
    return jax.vmap(lambda own: function(*static, shared, own))(given)


def _force(kind: int, law: Any, load: Array, equilibrium: Array, x: Array, v: Array) -> Array:
    """Contact force of a law, given the numbers of its `KernelLaw`, in N."""
    parameter, damping, cells = law
    if kind == EXPONENTIAL:
        elastic = load * jnp.exp(jnp.clip(-x / parameter, -LARGEST_LOG_FORCE, LARGEST_LOG_FORCE))
    elif kind == HERTZ:
        elastic = parameter * jnp.maximum(equilibrium - x, 0.0) ** 1.5
    elif kind == LINEAR:
        elastic = jnp.maximum(load - parameter * x, 0.0)
    else:
        position = equilibrium + parameter * x
        row = jnp.clip(jnp.floor(position) + 1, 0, len(cells) - 1)
        cubic = jnp.moveaxis(cells[row.astype(int)], -1, 0)
        log_force = jnp.polyval(cubic[::-1], position - (row - 1))
        elastic = jnp.exp(jnp.clip(log_force, -LARGEST_LOG_FORCE, LARGEST_LOG_FORCE))
    return elastic * jnp.maximum(1 - damping * v, 0.0)


def _force_and_slopes(
    kind: int, law: Any, load: Array, equilibrium: Array, x: Array, v: Array
) -> tuple[Array, Array, Array]:
    """Contact force, stiffness -dF/dx and damping -dF/dv."""
    force, pull = jax.vjp(partial(_force, kind, law, load, equilibrium), x, v)
    by_x, by_v = pull(jnp.ones_like(force))
    return force, -by_x, -by_v


def _receptance(poles: Array, omega: Array) -> Array:
    """Contact receptance at angular frequencies, in m/N: see `PoleResidueModel`."""
    determinant, trace, constant, slope = poles[:, :, jnp.newaxis]
    return jnp.sum((constant + 1j * omega * slope) / (determinant - omega**2 - 1j * omega * trace), axis=0)


def _magnitude(values: Array) -> Array:
    """Sum of the magnitudes of real and imaginary parts."""
    return jnp.sum(jnp.abs(values.real) + jnp.abs(values.imag))


def _solved(kind: int, samples: int, shared: Any, given: Any) -> tuple[Array, Array, Array, Array]:
    """Mean, harmonics, spectrum of the force and outcome of one point, by Newton's method."""
    poles, static_stiffness, law, tolerance, steps = shared
    setting, free, mean, harmonics, h, n, count, aliased = given
    omega, load, length, equilibrium, static_displacement = setting
    size = harmonics.size
    orders, instants = jnp.arange(1, 2 * size + 1), jnp.arange(samples)
    within, weight = orders[:size] <= h, jnp.where(instants < count, 1.0 / count, 0.0)
    roots = jnp.exp(2j * jnp.pi / count * instants)
    waves = roots[jnp.outer(instants, jnp.arange(2 * size + 1)) % count]
    motion_waves, receptance = waves[:, 1 : size + 1], _receptance(poles, omega * orders)
    free = jnp.where(within, free, 0.0)

    def iterate(state: Any) -> Any:
        step, mean, harmonics, *_ = state
        x = mean + (motion_waves @ harmonics).real
        v = omega * (motion_waves @ (1j * orders[:size] * harmonics)).real
        sampled = weight * jnp.stack(_force_and_slopes(kind, law, load, equilibrium, x, v))
        spectra = sampled @ waves.conj()
        of_mean = static_stiffness * (mean - static_displacement) + load - spectra[0, 0].real
        residual = jnp.where(within, harmonics - free - 2 * receptance[:size] * spectra[0, 1 : size + 1], 0.0)
        mean_step, change = _newton_step(static_stiffness, receptance[:size], omega, spectra, n, of_mean, residual)
        change = jnp.where(within, change, 0.0)
        norm, scale = jnp.abs(mean_step) + _magnitude(change), 1e-3 * length + _magnitude(harmonics)
        small = norm <= FINAL_STEP * tolerance * scale
        factor = jnp.where(small, 0.0, jnp.minimum(1.0, LARGEST_STEP * length / norm))
        moved = mean - factor * mean_step, harmonics - factor * change
        return jnp.where(small, steps, step + 1), *moved, sampled[0], spectra[0], norm, scale

    none = jnp.zeros(samples), jnp.zeros(2 * size + 1, dtype=complex), jnp.inf, 1.0
    state = (0, mean, jnp.where(within, harmonics, 0.0), *none)
    _, mean, harmonics, sampled, spectrum, norm, scale = jax.lax.while_loop(lambda now: now[0] < steps, iterate, state)
    allowed, mean_force = tolerance * scale, spectrum[0].real
    tail = jnp.where((orders > h) & (orders <= 2 * h), 2 * jnp.abs(spectrum[1:] * receptance), 0.0).max()
    alias = jnp.abs(sampled @ roots[instants * (count // 2 - 1) % count])
    outcome = jnp.where(tail > TAIL * allowed, NEEDS_HARMONICS, CONVERGED)
    outcome = jnp.where(alias > aliased * jnp.maximum(mean_force, 1e-3 * load), NEEDS_SAMPLES, outcome)
    outcome = jnp.where(norm <= LAST_STEP * allowed, outcome, DIVERGED)
    return mean, harmonics, jnp.where(within, 2 * spectrum[1 : size + 1], 0.0), outcome


def _newton_step(
    static_stiffness: Array, receptance: Array, omega: Array, spectra: Array, n: Array, of_mean: Array, residual: Array
) -> tuple[Array, Array]:
    """Newton step of mean and harmonics, n of them coupled: see `newton_kernel`, with its P and Q."""
    size = residual.size
    k, j = jnp.arange(1, size + 1)[:, jnp.newaxis], jnp.arange(1, min(size, _COUPLED) + 1)
    _, slope, drag = spectra
    coupled, speed = j <= n, j * omega
    below, above = jnp.abs(k - j), k + j
    p_slope, p_drag = (jnp.where(k < j, each[below].conj(), each[below]) for each in (slope, drag))
    p, q = p_slope + 1j * speed * p_drag, slope[above] - 1j * speed * drag[above]
    by_real = jnp.where(coupled, receptance[:, jnp.newaxis] * (p + q), 0.0)
    by_imaginary = jnp.where(coupled, 1j * receptance[:, jnp.newaxis] * (p - q), 0.0)
    by_mean = 2 * receptance * slope[1 : size + 1]
    of_coupled = jnp.where(coupled, slope[j] - 1j * speed * drag[j], 0.0)
    unit, top = jnp.eye(j.size), slice(0, j.size)
    matrix = jnp.block(
        [
            [
                jnp.atleast_2d(static_stiffness + slope[0].real),
                of_coupled.real[jnp.newaxis],
                of_coupled.imag[jnp.newaxis],
            ],
            [by_mean[top, jnp.newaxis].real, unit + by_real[top].real, by_imaginary[top].real],
            [by_mean[top, jnp.newaxis].imag, by_real[top].imag, unit + by_imaginary[top].imag],
        ]
    )
    solved = jnp.linalg.solve(matrix, jnp.concatenate([of_mean[jnp.newaxis], residual[top].real, residual[top].imag]))
    real, imaginary = solved[1 : j.size + 1], solved[j.size + 1 :]
    substituted = residual - by_mean * solved[0] - by_real @ real - by_imaginary @ imaginary
    return solved[0], substituted.at[top].set(jax.lax.complex(real, imaginary))


def _power_norms(kind: int, shared: Any, given: Any) -> tuple[Array, Array]:
    """Powers of two taken out of the monodromy matrix of one point while it is squared, and what is left."""
    (pairs, law), (setting, drift, harmonics, kicks) = shared, given
    omega, load, equilibrium, mean = setting
    into, displacement, velocity = (
        pairs[:, at : at + 2].ravel() for at in (INPUT, DISPLACEMENT_OUTPUT, VELOCITY_OUTPUT)
    )
    count, duration = len(pairs), 2 * jnp.pi / (kicks * omega)
    free = jax.scipy.linalg.block_diag(*drift.reshape(count, 2, 2))
    orders = jnp.arange(1, harmonics.size + 1)

    def kicked(instant: Array, matrix: Array) -> Array:
        phase = 2 * jnp.pi / kicks * (instant * orders % kicks)
        turned = harmonics * jax.lax.complex(jnp.cos(phase), jnp.sin(phase))
        x, v = mean + turned.real.sum(), -omega * (orders * turned.imag).sum()
        _, stiffness, damping = _force_and_slopes(kind, law, load, equilibrium, x, v)
        decay = velocity @ into * damping * duration
        share = duration * jnp.where(decay > 1e-12, -jnp.expm1(-decay) / jnp.maximum(decay, 1e-12), 1.0)
        impulse = -share * ((stiffness * displacement + damping * velocity) @ matrix)
        moved: Array = free @ (matrix + jnp.outer(into, impulse))
        return moved

    def squared(_: Array, state: tuple[Array, Array]) -> tuple[Array, Array]:
        taken, matrix = state
        power = (jnp.frexp(jnp.sum(matrix * matrix))[1] - 1) // 2
        matrix = jnp.ldexp(matrix, -power)
        return 2 * taken + power, matrix @ matrix

    monodromy = jax.lax.fori_loop(0, kicks, kicked, jnp.eye(2 * count))
    taken, matrix = jax.lax.fori_loop(0, SQUARINGS, squared, (jnp.zeros(()), monodromy))
    return taken, jnp.sum(matrix * matrix)
