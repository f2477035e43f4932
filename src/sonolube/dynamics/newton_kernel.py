"""One step of Newton's method on lanes: how residuals depend on the contact's mean and harmonics, and elimination."""

import numba

from sonolube.checks import Floats
from sonolube.dynamics.contact_lanes import Choice
from sonolube.dynamics.lanes import INSIDE, LANES, ONCE


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
    """Turn minus the residuals into a step: n harmonics with the mean by elimination, the rest by substitution."""
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
                for lane in range(LANES):
                    step[part, k, lane] -= spare[part, j, lane] * matrix[j, rows, lane]


@numba.njit(**INSIDE)
def _mean_row(damped: Choice, static_stiffness: float, spectra: Floats, omega: Floats, n: int, row: Floats) -> None:
    slope, drag = spectra[1], spectra[2]
    for lane in range(LANES):
        row[0, lane] = static_stiffness + slope[0, 0, lane]
    for j in range(1, n + 1):
        for lane in range(LANES):
            row[2 * j - 1, lane], row[2 * j, lane] = slope[0, j, lane], slope[1, j, lane]
        if len(damped) == 1:
            for lane in range(LANES):
                row[2 * j - 1, lane] += j * omega[lane] * drag[1, j, lane]
                row[2 * j, lane] -= j * omega[lane] * drag[0, j, lane]


@numba.njit(**INSIDE)
def _harmonic_rows(
    damped: Choice, answer: Floats, spectra: Floats, omega: Floats, k: int, n: int, rows: Floats
) -> None:
    """Write how harmonic k's residual depends on the mean and on n harmonics, itself perhaps among them."""
    slope, drag = spectra[1], spectra[2]
    for lane in range(LANES):
        re, im = 2 * slope[0, k, lane], 2 * slope[1, k, lane]
        rows[0, 0, lane] = answer[0, lane] * re - answer[1, lane] * im
        rows[1, 0, lane] = answer[0, lane] * im + answer[1, lane] * re
    for j in range(1, n + 1):
        apart, sign = abs(k - j), 1.0 if k >= j else -1.0
        own = 1.0 if k == j else 0.0
        for lane in range(LANES):
            # the force's harmonic k falls by P X_j + Q conj(X_j)
            p_re, p_im = slope[0, apart, lane], sign * slope[1, apart, lane]
            q_re, q_im = slope[0, k + j, lane], slope[1, k + j, lane]
            if len(damped) == 1:
                speed = j * omega[lane]
                p_re -= speed * sign * drag[1, apart, lane]
                p_im += speed * drag[0, apart, lane]
                q_re += speed * drag[1, k + j, lane]
                q_im -= speed * drag[0, k + j, lane]
            g_re, g_im = answer[0, lane], answer[1, lane]
            rows[0, 2 * j - 1, lane] = own + g_re * (p_re + q_re) - g_im * (p_im + q_im)
            rows[1, 2 * j - 1, lane] = g_re * (p_im + q_im) + g_im * (p_re + q_re)
            rows[0, 2 * j, lane] = -g_re * (p_im - q_im) - g_im * (p_re - q_re)
            rows[1, 2 * j, lane] = own + g_re * (p_re - q_re) - g_im * (p_im - q_im)


@numba.njit(**INSIDE)
def _eliminate(matrix: Floats, rows: int, step: Floats) -> None:
    """Turn residuals into a step, without pivots: the mean's stiffness leads, others are near one."""
    for i in range(rows):
        for lane in range(LANES):
            matrix[i, rows, lane] = step[(i + 1) % 2 if i > 0 else 0, (i + 1) // 2, lane]
    for p in range(rows):
        for lane in range(LANES):
            matrix[p, p, lane] = 1 / matrix[p, p, lane]
        for i in range(p + 1, rows):
            for lane in range(LANES):
                matrix[i, p, lane] *= matrix[p, p, lane]
            for j in range(p + 1, rows + 1):
                for lane in range(LANES):
                    matrix[i, j, lane] -= matrix[i, p, lane] * matrix[p, j, lane]
    for i in range(rows - 1, -1, -1):
        for j in range(i + 1, rows):
            for lane in range(LANES):
                matrix[i, rows, lane] -= matrix[i, j, lane] * matrix[j, rows, lane]
        for lane in range(LANES):
            matrix[i, rows, lane] *= matrix[i, i, lane]
            step[(i + 1) % 2 if i > 0 else 0, (i + 1) // 2, lane] = matrix[i, rows, lane]
