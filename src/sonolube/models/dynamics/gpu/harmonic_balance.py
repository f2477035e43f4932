"""Harmonic balance of one exponential contact by Newton's method, by GPU threads.

Unknowns and equations are those of `sonolube.models.dynamics.harmonic_balance.harmonic_kernel`, one point per thread:
every array is local to the thread, and its two rows hold real and imaginary parts.
"""

import math

from sonolube.checks import Floats
from sonolube.models.dynamics.gpu.device import on_device
from sonolube.models.dynamics.gpu.receptance import contact_per_force, contact_per_volt
from sonolube.models.dynamics.harmonic_balance.harmonic_kernel import (
    CONVERGED,
    DIVERGED,
    NEEDS_HARMONICS,
    NEEDS_SAMPLES,
    TAIL,
)

MOST_HARMONICS = 12
"""Largest number of harmonics of the contact that a thread holds; the CPU solves points that require more. []"""
CAPACITY = MOST_HARMONICS + 1
"""Entries of an array of harmonics, the mean included. []"""
ORDERS = 2 * MOST_HARMONICS + 2
"""Entries of a spectrum; the last one is the highest that the samples resolve. []"""
MATRIX = (2 * MOST_HARMONICS + 1) * (2 * MOST_HARMONICS + 2)
"""Entries of Newton's matrix, right-hand side included. []"""

_LARGEST_STEP = 2.0  # norm of a Newton step, in decay lengths
_LAST_STEP = 0.01  # norm of the last step over the tolerance
_LARGEST_EXPONENT = 700.0


@on_device
def write_linear_response(
    pairs: Floats, voltage: Floats, point: int, omega: float, known: int, h: int, receptances: Floats, free: Floats
) -> None:
    """Write the receptances and the harmonics of the free motion, beyond the known ones."""
    drives = voltage.shape[0] // 2
    for k in range(known + 1, h + 1):
        receptances[0, k], receptances[1, k] = contact_per_force(pairs, k * omega)
        free[0, k], free[1, k] = 0.0, 0.0
        if k <= drives:
            re, im = contact_per_volt(pairs, k * omega)
            v_re, v_im = voltage[2 * k - 2, point], voltage[2 * k - 1, point]
            free[0, k], free[1, k] = re * v_re - im * v_im, re * v_im + im * v_re


@on_device
def write_spectrum(
    load: float, length: float, unknown: Floats, h: int, count: int, orders: int, spectrum: Floats
) -> None:
    """Write the Fourier coefficients of the force up to `orders`, and at last the highest that the samples resolve."""
    half, top = count // 2, ORDERS - 1
    for m in range(orders + 1):
        spectrum[0, m], spectrum[1, m] = 0.0, 0.0
    spectrum[0, top], spectrum[1, top] = 0.0, 0.0
    for j in range(half + 1):
        weight = load * (0.5 if j == 0 or j == half else 1.0) / count
        phase = 2 * math.pi * j / count
        cosine, sine = math.cos(phase), math.sin(phase)
        c, s, even, odd = 1.0, 0.0, unknown[0, 0], 0.0
        for k in range(1, h + 1):
            c, s = c * cosine - s * sine, c * sine + s * cosine
            even += unknown[0, k] * c
            odd += unknown[1, k] * s
        # the instant and its mirror image share their cosines
        ahead = weight * math.exp(min(max(-(even - odd) / length, -_LARGEST_EXPONENT), _LARGEST_EXPONENT))
        behind = weight * math.exp(min(max(-(even + odd) / length, -_LARGEST_EXPONENT), _LARGEST_EXPONENT))
        total, difference = ahead + behind, behind - ahead
        c, s = 1.0, 0.0
        for m in range(orders + 1):
            spectrum[0, m] += c * total
            spectrum[1, m] += s * difference
            c, s = c * cosine - s * sine, c * sine + s * cosine
        sign = 1.0 if j % 2 == 0 else -1.0  # (count/2 - 1) theta = pi j - theta
        spectrum[0, top] += sign * cosine * total
        spectrum[1, top] -= sign * sine * difference


@on_device
def write_residual(
    load: float,
    static_stiffness: float,
    static_displacement: float,
    unknown: Floats,
    receptances: Floats,
    free: Floats,
    spectrum: Floats,
    h: int,
    step: Floats,
) -> None:
    """Write the negative residual of every equation of harmonic balance."""
    step[0, 0] = spectrum[0, 0] - load - static_stiffness * (unknown[0, 0] - static_displacement)
    step[1, 0] = 0.0
    for k in range(1, h + 1):
        g_re, g_im, re, im = receptances[0, k], receptances[1, k], spectrum[0, k], spectrum[1, k]
        step[0, k] = free[0, k] - unknown[0, k] + 2 * (g_re * re - g_im * im)
        step[1, k] = free[1, k] - unknown[1, k] + 2 * (g_re * im + g_im * re)


@on_device
def coupling(receptances: Floats, spectrum: Floats, length: float, k: int, j: int) -> tuple[float, float, float, float]:
    """Return the derivatives of real and imaginary residual of harmonic k by real and imaginary part of harmonic j."""
    g_re, g_im = receptances[0, k] / length, receptances[1, k] / length
    if j == 0:
        re, im = 2 * spectrum[0, k], 2 * spectrum[1, k]
        return g_re * re - g_im * im, 0.0, g_re * im + g_im * re, 0.0
    difference, sign = abs(k - j), 1.0 if k >= j else -1.0
    own = 1.0 if k == j else 0.0
    # the force harmonic k changes by -(P X_j + Q conj(X_j))
    p_re, p_im = spectrum[0, difference], sign * spectrum[1, difference]
    q_re, q_im = spectrum[0, k + j], spectrum[1, k + j]
    return (
        own + g_re * (p_re + q_re) - g_im * (p_im + q_im),
        -g_re * (p_im - q_im) - g_im * (p_re - q_re),
        g_re * (p_im + q_im) + g_im * (p_re + q_re),
        own + g_re * (p_re - q_re) - g_im * (p_im - q_im),
    )


@on_device
def write_step(
    static_stiffness: float,
    length: float,
    receptances: Floats,
    spectrum: Floats,
    h: int,
    n: int,
    matrix: Floats,
    step: Floats,
) -> None:
    """Replace the negative residuals by the Newton step.

    The mean and n harmonics are solved for by elimination, the harmonics n + 1 to h by substitution.
    """
    rows = 2 * n + 1
    stride = rows + 1
    matrix[0], matrix[rows] = static_stiffness + spectrum[0, 0] / length, step[0, 0]
    for j in range(1, n + 1):
        matrix[2 * j - 1], matrix[2 * j] = spectrum[0, j] / length, spectrum[1, j] / length
    for k in range(1, n + 1):
        real, imaginary = (2 * k - 1) * stride, 2 * k * stride
        matrix[real], _, matrix[imaginary], _ = coupling(receptances, spectrum, length, k, 0)
        for j in range(1, n + 1):
            a, b, c, d = coupling(receptances, spectrum, length, k, j)
            matrix[real + 2 * j - 1], matrix[real + 2 * j] = a, b
            matrix[imaginary + 2 * j - 1], matrix[imaginary + 2 * j] = c, d
        matrix[real + rows], matrix[imaginary + rows] = step[0, k], step[1, k]
    eliminate(matrix, rows)
    step[0, 0] = matrix[rows]
    for k in range(1, n + 1):
        step[0, k], step[1, k] = matrix[(2 * k - 1) * stride + rows], matrix[2 * k * stride + rows]
    for k in range(n + 1, h + 1):
        for j in range(n + 1):
            a, b, c, d = coupling(receptances, spectrum, length, k, j)
            step[0, k] -= a * step[0, j] + b * step[1, j]
            step[1, k] -= c * step[0, j] + d * step[1, j]


@on_device
def eliminate(matrix: Floats, rows: int) -> None:
    """Solve in place by Gaussian elimination without pivoting, the right-hand side in the last column.

    The static stiffness of the mean comes first, and the other diagonal entries are near one.
    """
    stride = rows + 1
    for p in range(rows):
        inverse = 1 / matrix[p * stride + p]
        for j in range(p + 1, rows + 1):
            matrix[p * stride + j] *= inverse
        for i in range(p + 1, rows):
            factor = matrix[i * stride + p]
            for j in range(p + 1, rows + 1):
                matrix[i * stride + j] -= factor * matrix[p * stride + j]
    for i in range(rows - 2, -1, -1):
        for j in range(i + 1, rows):
            matrix[i * stride + rows] -= matrix[i * stride + j] * matrix[j * stride + rows]


@on_device
def update(unknown: Floats, step: Floats, h: int, length: float) -> tuple[float, float]:
    """Add the Newton step, limited to a few decay lengths; return its norm and that of the motion."""
    size, scale = abs(step[0, 0]), 1e-3 * length
    for k in range(1, h + 1):
        size += abs(step[0, k]) + abs(step[1, k])
    factor = 1.0
    if size > _LARGEST_STEP * length:
        factor = _LARGEST_STEP * length / size
    unknown[0, 0] += factor * step[0, 0]
    for k in range(1, h + 1):
        unknown[0, k] += factor * step[0, k]
        unknown[1, k] += factor * step[1, k]
        scale += abs(unknown[0, k]) + abs(unknown[1, k])
    return size, scale


@on_device
def newton_solve(
    load: float,
    length: float,
    static_stiffness: float,
    static_displacement: float,
    receptances: Floats,
    free: Floats,
    h: int,
    n: int,
    count: int,
    iterations: int,
    tolerance: float,
    unknown: Floats,
    step: Floats,
    spectrum: Floats,
    matrix: Floats,
) -> tuple[float, float, int]:
    """Solve by Newton's method; return the norms of the last step and of the motion, and the number of steps."""
    size, scale, final, taken = 0.0, 1.0, False, 0
    for iteration in range(iterations):
        final = final or iteration == iterations - 1
        write_spectrum(load, length, unknown, h, count, 2 * h if final else h + n, spectrum)
        write_residual(load, static_stiffness, static_displacement, unknown, receptances, free, spectrum, h, step)
        write_step(static_stiffness, length, receptances, spectrum, h, n, matrix, step)
        size, scale = update(unknown, step, h, length)
        taken += 1
        if final or not size < math.inf:
            break
        final = size < tolerance * scale
    return size, scale, taken


@on_device
def assess(
    pairs: Floats,
    omega: float,
    load: float,
    h: int,
    count: int,
    tolerance: float,
    size: float,
    scale: float,
    spectrum: Floats,
) -> int:
    """Return the outcome of a point: convergence, then the error of aliasing, then that of truncation."""
    top = ORDERS - 1
    if not size <= _LAST_STEP * tolerance * scale:
        return DIVERGED
    highest = math.sqrt(spectrum[0, top] ** 2 + spectrum[1, top] ** 2)
    # aliasing of harmonic count - h to harmonic h, see `sonolube.models.dynamics.harmonic_balance.harmonic_kernel`
    aliased = tolerance ** ((0.5 * count - 1) / (count - h))
    if highest > aliased * max(spectrum[0, 0], 1e-3 * load):
        return NEEDS_SAMPLES
    tail = 0.0
    for k in range(h + 1, 2 * h + 1):
        g_re, g_im = contact_per_force(pairs, k * omega)
        force = spectrum[0, k] ** 2 + spectrum[1, k] ** 2
        tail = max(tail, 4 * (g_re * g_re + g_im * g_im) * force)
    if tail > (TAIL * tolerance * scale) ** 2:
        return NEEDS_HARMONICS
    return CONVERGED
