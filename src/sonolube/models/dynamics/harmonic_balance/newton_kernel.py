"""One step of Newton's method for harmonic balance, on SIMD rows: Jacobian, elimination and substitution."""

import numpy as np

from sonolube.checks import Floats
from sonolube.execution.compilation import kernel
from sonolube.models.dynamics.kernels.contact_kernel import KernelLaw
from sonolube.models.dynamics.kernels.simd import INLINED, INNER, LANES, subtract_product


@kernel(**INLINED)
def newton_step(
    law: KernelLaw,
    static_stiffness: float,
    receptances: Floats,
    spectra: Floats,
    omega: Floats,
    h: int,
    n: int,
    matrix: Floats,
    step: Floats,
) -> None:
    """Replace the residuals by the Newton step, to be subtracted from the unknowns.

    The mean and n harmonics are solved for by elimination, the harmonics n + 1 to h by substitution.
    """
    rows = 2 * n + 1
    _mean_row(law, static_stiffness, spectra, omega, n, matrix[0])
    for k in range(1, n + 1):
        _harmonic_rows(law, receptances[k], spectra, omega, k, n, matrix[2 * k - 1 : 2 * k + 1])
    _eliminate(matrix, rows, step)
    spare = matrix[matrix.shape[0] - 2 :]
    for k in range(n + 1, h + 1):
        _harmonic_rows(law, receptances[k], spectra, omega, k, n, spare)
        for part in range(2):
            for j in range(rows):
                subtract_product(spare[part, j], step[j], step[2 * k - 1 + part])


@kernel(**INNER)
def _mean_row(law: KernelLaw, static_stiffness: float, spectra: Floats, omega: Floats, n: int, row: Floats) -> None:
    """Write the derivatives of the static equation's residual by the mean and n harmonics."""
    slope, drag = spectra[1], spectra[2]
    for j in range(2 * n + 1):
        static = static_stiffness if j == 0 else 0.0
        for lane in range(LANES):
            row[j, lane] = slope[j, lane] + static
    if len(law.damped) == 1:
        for j in range(1, n + 1):
            for lane in range(LANES):
                row[2 * j - 1, lane] += j * omega[lane] * drag[2 * j, lane]
                row[2 * j, lane] -= j * omega[lane] * drag[2 * j - 1, lane]


@kernel(**INNER)
def _harmonic_rows(
    law: KernelLaw, receptance: Floats, spectra: Floats, omega: Floats, k: int, n: int, rows: Floats
) -> None:
    r"""Write the derivatives of the residual of harmonic k by the mean and by n harmonics.

    Notes
    -----
    With the Fourier coefficients :math:`\hat s_m` of the stiffness and :math:`\hat d_m` of the damping, the force
    harmonic changes with the displacement harmonic j by

    .. math::
        -\Delta\Phi_k = P\,\Delta X_j + Q\,\Delta X_j^*, \quad
        P = \hat s_{k-j} + ij\omega\,\hat d_{k-j}, \quad Q = \hat s_{k+j} - ij\omega\,\hat d_{k+j}

    and the residual by :math:`\Delta X_k - G(k\omega)\,\Delta\Phi_k`.
    """
    slope, drag = spectra[1], spectra[2]
    for lane in range(LANES):
        re, im = 2 * slope[2 * k - 1, lane], 2 * slope[2 * k, lane]
        rows[0, 0, lane] = receptance[0, lane] * re - receptance[1, lane] * im
        rows[1, 0, lane] = receptance[0, lane] * im + receptance[1, lane] * re
    for j in range(1, n + 1):
        own, sign = 1.0 if k == j else 0.0, float(np.sign(k - j))
        p, q = 2 * abs(k - j), 2 * (k + j)  # rows of imaginary parts; the mean has none, and its sign is zero
        for lane in range(LANES):
            p_re, p_im = slope[max(p - 1, 0), lane], sign * slope[p, lane]
            q_re, q_im = slope[q - 1, lane], slope[q, lane]
            if len(law.damped) == 1:
                speed = j * omega[lane]
                p_re -= speed * sign * drag[p, lane]
                p_im += speed * drag[max(p - 1, 0), lane]
                q_re += speed * drag[q, lane]
                q_im -= speed * drag[q - 1, lane]
            g_re, g_im = receptance[0, lane], receptance[1, lane]
            rows[0, 2 * j - 1, lane] = own + g_re * (p_re + q_re) - g_im * (p_im + q_im)
            rows[1, 2 * j - 1, lane] = g_re * (p_im + q_im) + g_im * (p_re + q_re)
            rows[0, 2 * j, lane] = -g_re * (p_im - q_im) - g_im * (p_re - q_re)
            rows[1, 2 * j, lane] = own + g_re * (p_re - q_re) - g_im * (p_im - q_im)


@kernel(**INNER)
def _eliminate(matrix: Floats, rows: int, step: Floats) -> None:
    """Replace residuals by the Newton step by Gaussian elimination without pivoting.

    The static stiffness of the mean comes first, and the other diagonal entries are near one.
    """
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
