"""One step of Newton's method on lanes: how residuals depend on the contact's mean and harmonics, and elimination."""

import numba
import numpy as np

from sonolube.checks import Floats
from sonolube.dynamics.harmonic_balance.contact_kernel import Choice
from sonolube.dynamics.kernels.simd import INSIDE, LANES, ONCE, subtract_product


@numba.njit(**ONCE)
def newton_step(
    damped: Choice,
    static_stiffness: float,
    answers: Floats,
    spectra: Floats,
    omega: Floats,
    h: int,
    n: int,
    matrix: Floats,
    step: Floats,
) -> None:
    """Turn residuals into a step to take back: n harmonics with the mean by elimination, the rest by substitution."""
    rows = 2 * n + 1
    _mean_row(damped, static_stiffness, spectra, omega, n, matrix[0])
    for k in range(1, n + 1):
        _harmonic_rows(damped, answers[k], spectra, omega, k, n, matrix[2 * k - 1 : 2 * k + 1])
    _eliminate(matrix, rows, step)
    spare = matrix[matrix.shape[0] - 2 :]
    for k in range(n + 1, h + 1):
        _harmonic_rows(damped, answers[k], spectra, omega, k, n, spare)
        for part in range(2):
            for j in range(rows):
                subtract_product(spare[part, j], step[j], step[2 * k - 1 + part])


@numba.njit(**INSIDE)
def _mean_row(damped: Choice, static_stiffness: float, spectra: Floats, omega: Floats, n: int, row: Floats) -> None:
    slope, drag = spectra[1], spectra[2]
    for j in range(2 * n + 1):
        rest = static_stiffness if j == 0 else 0.0
        for lane in range(LANES):
            row[j, lane] = slope[j, lane] + rest
    if len(damped) == 1:
        for j in range(1, n + 1):
            for lane in range(LANES):
                row[2 * j - 1, lane] += j * omega[lane] * drag[2 * j, lane]
                row[2 * j, lane] -= j * omega[lane] * drag[2 * j - 1, lane]


@numba.njit(**INSIDE)
def _harmonic_rows(
    damped: Choice, answer: Floats, spectra: Floats, omega: Floats, k: int, n: int, rows: Floats
) -> None:
    """Write how harmonic k's residual depends on the mean and on n harmonics, itself perhaps among them."""
    slope, drag = spectra[1], spectra[2]
    for lane in range(LANES):
        re, im = 2 * slope[2 * k - 1, lane], 2 * slope[2 * k, lane]
        rows[0, 0, lane] = answer[0, lane] * re - answer[1, lane] * im
        rows[1, 0, lane] = answer[0, lane] * im + answer[1, lane] * re
    for j in range(1, n + 1):
        own, sign = 1.0 if k == j else 0.0, float(np.sign(k - j))
        p, q = 2 * abs(k - j), 2 * (k + j)  # rows of imaginary parts; the mean has none, and its sign is zero
        for lane in range(LANES):
            # the force's harmonic k falls by P X_j + Q conj(X_j)
            p_re, p_im = slope[max(p - 1, 0), lane], sign * slope[p, lane]
            q_re, q_im = slope[q - 1, lane], slope[q, lane]
            if len(damped) == 1:
                speed = j * omega[lane]
                p_re -= speed * sign * drag[p, lane]
                p_im += speed * drag[max(p - 1, 0), lane]
                q_re += speed * drag[q, lane]
                q_im -= speed * drag[q - 1, lane]
            g_re, g_im = answer[0, lane], answer[1, lane]
            rows[0, 2 * j - 1, lane] = own + g_re * (p_re + q_re) - g_im * (p_im + q_im)
            rows[1, 2 * j - 1, lane] = g_re * (p_im + q_im) + g_im * (p_re + q_re)
            rows[0, 2 * j, lane] = -g_re * (p_im - q_im) - g_im * (p_re - q_re)
            rows[1, 2 * j, lane] = own + g_re * (p_re - q_re) - g_im * (p_im - q_im)


@numba.njit(**INSIDE)
def _eliminate(matrix: Floats, rows: int, step: Floats) -> None:
    """Turn residuals into a step, without pivots: the mean's stiffness leads, others are near one."""
    for p in range(rows):
        for lane in range(LANES):
            matrix[p, p, lane] = 1 / matrix[p, p, lane]
        for i in range(p + 1, rows):
            for lane in range(LANES):
                matrix[i, p, lane] *= matrix[p, p, lane]
            for j in range(p + 1, rows):
                subtract_product(matrix[i, p], matrix[p, j], matrix[i, j])
            subtract_product(matrix[i, p], step[p], step[i])
    for i in range(rows - 1, -1, -1):
        for j in range(i + 1, rows):
            subtract_product(matrix[i, j], step[j], step[i])
        for lane in range(LANES):
            step[i, lane] *= matrix[i, i, lane]
