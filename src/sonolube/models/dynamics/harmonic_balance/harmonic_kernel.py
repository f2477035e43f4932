r"""Harmonic balance of a batch by Newton's method, with alternating frequency-time transforms of the contact force.

Displacement and force of the contact are Fourier series, :math:`x = \bar x + \mathrm{Re}\sum_k X_k e^{ik\theta}` and
:math:`F_n = \bar F_n + \mathrm{Re}\sum_k \Phi_k e^{ik\theta}` with :math:`\theta = \omega t`. The unknowns are the mean
and the harmonics 1 to H of the displacement; the equations are

.. math::
    S_0\,(\bar x - \bar x_0) = \bar F_n - F_N, \qquad X_k = H(k\omega)\,V_k + G(k\omega)\,\Phi_k,

with the static stiffness S_0, the static displacement :math:`\bar x_0` and the receptances G and H of the structure.
Newton's method couples the mean and the first n harmonics; the harmonics n + 1 to H follow by substitution, since the
contact hardly couples them. In the transforms between time and frequency (AFT), the samples at :math:`\theta` and
:math:`-\theta` share their cosines and sines.
"""

from typing import NamedTuple

import numpy as np

from sonolube.checks import Floats, Integers
from sonolube.execution.compilation import kernel
from sonolube.models.dynamics.harmonic_balance.equations import contact_receptances
from sonolube.models.dynamics.harmonic_balance.newton_kernel import newton_step
from sonolube.models.dynamics.kernels.contact_kernel import (
    EXPONENTIAL,
    KernelLaw,
    contact_force_rows,
    velocity_over_omega,
)
from sonolube.models.dynamics.kernels.simd import (
    INNER,
    KERNEL,
    LANES,
    add_absolute,
    gather,
    linear_combination,
    subtract_product,
    weighted_row_sum,
)

# Rows of a block: angular frequency, dead load, decay length of the force, equilibrium coordinate and static
# displacement of each point (the columns of `Iterates.settings`); then the norms of the last step and of the motion.
OMEGA, LOAD, DECAY_LENGTH, EQUILIBRIUM, STATIC_DISPLACEMENT, STEP_NORM, MOTION_NORM = range(7)
CONVERGED, DIVERGED, NEEDS_HARMONICS, NEEDS_SAMPLES = 0, 1, 2, 3
"""Outcomes of a point. []"""
# Over the tolerance, relative to the amplitude: the truncated harmonics, the step of Newton's method at which a point
# is left as it is, and the last step of a point that ran out of iterations.
TAIL, FINAL_STEP, LAST_STEP = 0.3, 0.001, 0.01
LARGEST_STEP = 2.0  # norm of a Newton step, in decay lengths


class Iterates(NamedTuple):
    """Iterates of a batch, one row per point; of harmonics, real and imaginary parts alternate."""

    settings: Floats  # (p, 5): columns OMEGA to STATIC_DISPLACEMENT
    free_harmonics: Floats  # (p, 2 K), in m: displacement harmonics without contact force
    mean: Floats  # (p, 1), in m: initial guess, then the solution
    harmonics: Floats  # (p, 2 capacity), in m: initial guess, then the solution
    force_harmonics: Floats  # (p, 2 K), in N: written


class Truncation(NamedTuple):
    """Numbers of harmonics and time samples of each point."""

    harmonics: Integers  # (p,): H, of the displacement
    coupled: Integers  # (p,): n, of them in Newton's matrix
    samples: Integers  # (p,): of the contact force per period


class HarmonicWorkspace(NamedTuple):
    """Rows in which a block of points is solved.

    A motion of H harmonics has 2 H + 1 rows: its mean, then from row 2 k - 1 on real and imaginary part of harmonic k;
    likewise spectra, and the sums and differences of mirrored samples.
    """

    lanes: Floats  # (7, lanes): rows OMEGA to MOTION_NORM
    receptances: Floats  # (H + 1, 2, lanes): of the contact at each harmonic
    motions: Floats  # (4, 2 H + 1, lanes): motion, Newton step, free motion, velocity over omega
    waves: Floats  # (2, instants, instants): cosine and sine of j k 2 pi / samples
    tabulated: Integers  # (1,): number of samples whose waves these are
    sums: Floats  # (3, 2 instants - 1, lanes): weighted sums and differences of force, stiffness and damping
    spectra: Floats  # (3, 4 H + 1, lanes): of force, stiffness and damping
    matrix: Floats  # (rows + 2, rows, lanes): Newton's matrix and two spare rows
    scratch: Floats  # (12, lanes)


def harmonic_workspace(harmonics: int, coupled: int, samples: int) -> HarmonicWorkspace:
    """Allocate the workspace of `newton_solve`."""
    rows, instants = 2 * coupled + 1, samples // 2 + 1
    return HarmonicWorkspace(
        lanes=np.empty((7, LANES)),
        receptances=np.empty((harmonics + 1, 2, LANES)),
        motions=np.zeros((4, 2 * harmonics + 1, LANES)),
        waves=np.empty((2, instants, instants)),
        tabulated=np.zeros(1, dtype=np.int64),
        sums=np.empty((3, 2 * instants - 1, LANES)),
        spectra=np.empty((3, 4 * harmonics + 1, LANES)),
        matrix=np.empty((rows + 2, rows, LANES)),
        scratch=np.empty((12, LANES)),
    )


@kernel(**KERNEL)
def newton_solve(
    law: KernelLaw,
    poles: Floats,
    static_stiffness: float,
    iterates: Iterates,
    truncation: Integers,
    chosen: Integers,
    tolerance: float,
    iterations: int,
    outcome: Integers,
    work: HarmonicWorkspace,
) -> None:
    """Solve the equations of harmonic balance of the chosen points by Newton's method.

    `poles` has shape (4, m). `truncation` has shape (3, p).
    """
    lanes, receptances, motions, waves = work.lanes, work.receptances, work.motions, work.waves
    sums, spectra, scratch = work.sums, work.spectra, work.scratch
    unknown, step, free, velocity = motions[0], motions[1], motions[2], motions[3]
    for start in range(0, chosen.size, LANES):
        block = chosen[start : start + LANES]
        h, n, count = truncation[0, block[0]], truncation[1, block[0]], truncation[2, block[0]]
        gather(iterates.settings, block, lanes)
        gather(iterates.mean, block, unknown[:1])
        gather(iterates.harmonics, block, unknown[1 : 2 * h + 1])
        gather(iterates.free_harmonics, block, free[1 : 2 * h + 1])
        for k in range(1, h + 1):
            contact_receptances(poles, lanes[OMEGA], float(k), receptances[k])
        if count != work.tabulated[0]:
            _tabulate_waves(count, waves)
            work.tabulated[0] = count
        # stiffness is proportional to an exponential force, so that one Fourier transform serves both
        quantities = 3 if len(law.damped) == 1 else (1 if len(law.kind) == EXPONENTIAL else 2)
        for _ in range(iterations):
            velocity_over_omega(law, unknown, h, velocity)
            for j in range(count // 2 + 1):
                weight = (0.5 if j == 0 or j == count // 2 else 1.0) / count
                _sample_pair(law, work, h, j, weight, quantities)
            _transform(waves, sums, count // 2, quantities, 2 * (h + n) + 1, spectra)
            if quantities == 1:
                _stiffness_from_force(law.parameter, 2 * (h + n) + 1, spectra)
            _residual(static_stiffness, work, h)
            newton_step(law, static_stiffness, receptances, spectra, lanes[OMEGA], h, n, work.matrix, step)
            if _update(unknown, step, 2 * h + 1, lanes, scratch[0], FINAL_STEP * tolerance):
                break
        # Aliasing: the samples add harmonic count - h to harmonic h. The harmonics of an exponential force decay ever
        # faster, which bounds that one by the highest that is resolved: a_(count - h) <= a_k^((count - h)/k), a_0 = 1.
        aliased = tolerance ** ((0.5 * count - 1) / (count - h)) if quantities == 1 else tolerance
        _assess(poles, block, h, count, work, tolerance, aliased, outcome)
        _scatter(iterates, block, h, unknown, spectra[0], outcome)


@kernel(**INNER)
def _tabulate_waves(count: int, waves: Floats) -> None:
    """Write cosines and sines of j k 2 pi / count."""
    for j in range(count // 2 + 1):
        for k in range(count // 2 + 1):
            phase = 2 * np.pi / count * (j * k % count)
            waves[0, j, k], waves[1, j, k] = np.cos(phase), np.sin(phase)


@kernel(**INNER)
def _sample_pair(law: KernelLaw, work: HarmonicWorkspace, h: int, j: int, weight: float, quantities: int) -> None:
    """Write weighted sums and differences of force, stiffness and damping at the j-th sample and its mirror image."""
    lanes, waves, sums, scratch = work.lanes, work.waves, work.sums, work.scratch
    unknown, velocity = work.motions[0], work.motions[3]
    for part in range(2):
        weighted_row_sum(scratch[part], waves[part, j], unknown, part, h)
        if len(law.damped) == 1:
            weighted_row_sum(scratch[2 + part], waves[part, j], velocity, part, h)
    x, v = scratch[4], scratch[5]
    for side in range(2):
        sign = 2.0 * side - 1.0
        linear_combination(scratch[0], 1.0, scratch[1], sign, x)
        if len(law.damped) == 1:
            linear_combination(scratch[2], 1.0, scratch[3], sign, v)
            for lane in range(LANES):
                v[lane] *= lanes[OMEGA, lane]
        results = scratch[6 + 3 * side : 9 + 3 * side]
        contact_force_rows(law, lanes[LOAD], lanes[EQUILIBRIUM], x, v, results)
    for quantity in range(quantities):
        here, mirrored = scratch[9 + quantity], scratch[6 + quantity]
        if j > 0:
            linear_combination(here, weight, mirrored, -weight, sums[quantity, 2 * j])
        linear_combination(here, weight, mirrored, weight, sums[quantity, max(2 * j - 1, 0)])


@kernel(**INNER)
def _transform(waves: Floats, sums: Floats, half: int, quantities: int, rows: int, spectra: Floats) -> None:
    r"""Write the Fourier coefficients of force, stiffness and damping, a number of rows of each.

    Notes
    -----
    .. math:: \hat f_m = \frac{1}{2\pi} \int_0^{2\pi} f(\theta)\,e^{-im\theta}\,d\theta
    """
    for quantity in range(quantities):
        for row in range(rows):
            part = (row + 1) % 2 if row > 0 else 0
            weighted_row_sum(spectra[quantity, row], waves[part, (row + 1) // 2], sums[quantity], part, half)


@kernel(**INNER)
def _stiffness_from_force(length: float, rows: int, spectra: Floats) -> None:
    """Write the spectrum of a stiffness that is the force over a length."""
    for row in range(rows):
        for lane in range(LANES):
            spectra[1, row, lane] = spectra[0, row, lane] / length


@kernel(**INNER)
def _residual(static_stiffness: float, work: HarmonicWorkspace, h: int) -> None:
    """Write the residual of every equation of harmonic balance in place of the Newton step."""
    lanes, receptances, force = work.lanes, work.receptances, work.spectra[0]
    unknown, residual, free = work.motions[0], work.motions[1], work.motions[2]
    for lane in range(LANES):
        static = static_stiffness * (unknown[0, lane] - lanes[STATIC_DISPLACEMENT, lane])
        residual[0, lane] = static + lanes[LOAD, lane] - force[0, lane]
    for k in range(1, h + 1):
        r = 2 * k
        for lane in range(LANES):
            g_re, g_im = receptances[k, 0, lane], receptances[k, 1, lane]
            re, im = force[r - 1, lane], force[r, lane]
            residual[r - 1, lane] = unknown[r - 1, lane] - free[r - 1, lane] - 2 * (g_re * re - g_im * im)
            residual[r, lane] = unknown[r, lane] - free[r, lane] - 2 * (g_re * im + g_im * re)


@kernel(**INNER)
def _update(unknown: Floats, step: Floats, rows: int, lanes: Floats, factor: Floats, allowed: float) -> bool:
    """Subtract the Newton step, limited to a few decay lengths; return whether all steps were within the allowed norm.

    Norms are sums of magnitudes over the rows; that of the motion excludes the mean, and a step is compared with it. A
    point whose step is within the allowed norm stays where it is, so that it has the same motion and force whether or
    not other points of its block go on.
    """
    size, scale = lanes[STEP_NORM], lanes[MOTION_NORM]
    for lane in range(LANES):
        size[lane], scale[lane] = 0.0, 1e-3 * lanes[DECAY_LENGTH, lane]
    for row in range(rows):
        add_absolute(step[row], size)
        if row > 0:
            add_absolute(unknown[row], scale)
    small = 0
    for lane in range(LANES):
        found = size[lane] <= allowed * scale[lane]  # false for NaN
        factor[lane] = 0.0 if found else min(1.0, LARGEST_STEP * lanes[DECAY_LENGTH, lane] / size[lane])
        small += found
    for row in range(rows):
        subtract_product(factor, step[row], unknown[row])
    return small == LANES


@kernel(**INNER)
def _assess(
    poles: Floats,
    block: Integers,
    h: int,
    count: int,
    work: HarmonicWorkspace,
    tolerance: float,
    aliased: float,
    outcome: Integers,
) -> None:
    """Write the outcome of each point: convergence, then the error of aliasing, then that of truncation."""
    lanes, waves, force, mean_force, scratch = work.lanes, work.waves, work.sums[0], work.spectra[0, 0], work.scratch
    real, imaginary, square, tail, receptance = scratch[0], scratch[1], scratch[2], scratch[3], scratch[4:6]
    for lane in range(LANES):
        tail[lane] = 0.0
    for order in range(h + 1, 2 * h + 2):
        m = order if order <= 2 * h else count // 2 - 1  # the last one is the highest that the samples resolve
        for part in range(2):
            weighted_row_sum(scratch[part], waves[part, m], force, part, count // 2)
        for lane in range(LANES):
            square[lane] = real[lane] * real[lane] + imaginary[lane] * imaginary[lane]
        if order <= 2 * h:
            contact_receptances(poles, lanes[OMEGA], float(m), receptance)
            for lane in range(LANES):
                g_square = receptance[0, lane] * receptance[0, lane] + receptance[1, lane] * receptance[1, lane]
                tail[lane] = max(tail[lane], 4 * square[lane] * g_square)
    for lane in range(block.size):
        result, allowed = CONVERGED, tolerance * lanes[MOTION_NORM, lane]
        if not lanes[STEP_NORM, lane] <= LAST_STEP * allowed:
            result = DIVERGED
        elif np.sqrt(square[lane]) > aliased * max(mean_force[lane], 1e-3 * lanes[LOAD, lane]):
            result = NEEDS_SAMPLES
        elif np.sqrt(tail[lane]) > TAIL * allowed:
            result = NEEDS_HARMONICS
        outcome[block[lane]] = result


@kernel(**INNER)
def _scatter(iterates: Iterates, block: Integers, h: int, unknown: Floats, spectrum: Floats, outcome: Integers) -> None:
    """Write mean, harmonics and force harmonics of the points of a block that did not diverge."""
    mean, harmonics, force = iterates.mean, iterates.harmonics, iterates.force_harmonics
    for lane in range(block.size):
        point = block[lane]
        if outcome[point] == DIVERGED:
            continue
        mean[point, 0] = unknown[0, lane]
        for part in range(2 * h):
            harmonics[point, part] = unknown[part + 1, lane]
            if part < force.shape[1]:
                force[point, part] = 2 * spectrum[part + 1, lane]
