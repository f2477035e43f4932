"""One step of Newton's method on lanes: how residuals depend on the contact's mean and harmonics, and elimination."""

import numba

from sonolube.checks import Floats
from sonolube.dynamics.lanes import INSIDE, LANES, ONCE


@numba.njit(**ONCE)
def newton_step(
    static_stiffness: float,
    answers: Floats,
    spectra: Floats,
    damped: bool,
    omega: Floats,
    h: int,
    n: int,
    matrix: Floats,
    step: Floats,
) -> None:
    """Turn minus the residuals into a step: n harmonics with the mean by elimination, the rest by substitution."""
    rows = 2 * n + 1
    _mean_row(static_stiffness, spectra, damped, omega, n, matrix[0])
    for k in range(1, n + 1):
        _harmonic_rows(answers[k], spectra, damped, omega, k, n, matrix[2 * k - 1], matrix[2 * k])
    _eliminate(matrix, rows, step)
    spare = matrix[matrix.shape[0] - 2 :]
    for k in range(n + 1, h + 1):
        _harmonic_rows(answers[k], spectra, damped, omega, k, n, spare[0], spare[1])
        for part in range(2):
            for j in range(rows):
                _subtract(step[part, k], spare[part, j], step[0 if j == 0 else (j + 1) % 2, (j + 1) // 2])


@numba.njit(**INSIDE)
def _mean_row(static_stiffness: float, spectra: Floats, damped: bool, omega: Floats, n: int, row: Floats) -> None:
    for lane in range(LANES):
        row[0, lane] = static_stiffness + spectra[1, 0, 0, lane]
    for j in range(1, n + 1):
        for lane in range(LANES):
            row[2 * j - 1, lane] = spectra[1, 0, j, lane]
            row[2 * j, lane] = spectra[1, 1, j, lane]
        if damped:
            for lane in range(LANES):
                speed = j * omega[lane]
                row[2 * j - 1, lane] += speed * spectra[2, 1, j, lane]
                row[2 * j, lane] -= speed * spectra[2, 0, j, lane]


@numba.njit(**INSIDE)
def _harmonic_rows(
    answer: Floats, spectra: Floats, damped: bool, omega: Floats, k: int, n: int, real: Floats, imaginary: Floats
) -> None:
    """Write how harmonic k's residual depends on the mean and on n harmonics, itself perhaps among them."""
    g_re, g_im = answer[0], answer[1]
    for lane in range(LANES):
        re, im = 2 * spectra[1, 0, k, lane], 2 * spectra[1, 1, k, lane]
        real[0, lane] = g_re[lane] * re - g_im[lane] * im
        imaginary[0, lane] = g_re[lane] * im + g_im[lane] * re
    for j in range(1, n + 1):
        apart, sign = abs(k - j), 1.0 if k >= j else -1.0
        own = 1.0 if k == j else 0.0
        for lane in range(LANES):
            # the force's harmonic k falls by P X_j + Q conj(X_j)
            p_re, p_im = spectra[1, 0, apart, lane], sign * spectra[1, 1, apart, lane]
            q_re, q_im = spectra[1, 0, k + j, lane], spectra[1, 1, k + j, lane]
            if damped:
                speed = j * omega[lane]
                p_re -= speed * sign * spectra[2, 1, apart, lane]
                p_im += speed * spectra[2, 0, apart, lane]
                q_re += speed * spectra[2, 1, k + j, lane]
                q_im -= speed * spectra[2, 0, k + j, lane]
            real[2 * j - 1, lane] = own + g_re[lane] * (p_re + q_re) - g_im[lane] * (p_im + q_im)
            imaginary[2 * j - 1, lane] = g_re[lane] * (p_im + q_im) + g_im[lane] * (p_re + q_re)
            real[2 * j, lane] = -g_re[lane] * (p_im - q_im) - g_im[lane] * (p_re - q_re)
            imaginary[2 * j, lane] = own + g_re[lane] * (p_re - q_re) - g_im[lane] * (p_im - q_im)


@numba.njit(**INSIDE)
def _eliminate(matrix: Floats, rows: int, step: Floats) -> None:
    """Solve for the first unknowns by elimination without pivots: the mean's stiffness leads, others are near one."""
    for i in range(rows):
        _copy(step[0 if i == 0 else (i + 1) % 2, (i + 1) // 2], matrix[i, rows])
    for p in range(rows):
        for lane in range(LANES):
            matrix[p, p, lane] = 1 / matrix[p, p, lane]
        for i in range(p + 1, rows):
            factor = matrix[i, p]
            for lane in range(LANES):
                factor[lane] *= matrix[p, p, lane]
            for j in range(p + 1, rows + 1):
                _subtract(matrix[i, j], factor, matrix[p, j])
    for i in range(rows - 1, -1, -1):
        answer = step[0 if i == 0 else (i + 1) % 2, (i + 1) // 2]
        _copy(matrix[i, rows], answer)
        for j in range(i + 1, rows):
            _subtract(answer, matrix[i, j], step[(j + 1) % 2, (j + 1) // 2])
        for lane in range(LANES):
            answer[lane] *= matrix[i, i, lane]


@numba.njit(**INSIDE)
def _copy(source: Floats, target: Floats) -> None:
    for lane in range(LANES):
        target[lane] = source[lane]


@numba.njit(**INSIDE)
def _subtract(target: Floats, factor: Floats, source: Floats) -> None:
    for lane in range(LANES):
        target[lane] -= factor[lane] * source[lane]
