"""Arithmetic on SIMD rows: one array entry per operating point, so that loops compile to vector instructions.

A batch is solved in blocks of `LANES` points. A row holds one number of every point of the block (one point per SIMD
lane). Functions of rows work on whole rows and write their result to an output row. The rows of a kernel never
overlap, and no operation mixes lanes. Beside them, peak velocities of periodic motions, point by point.
"""

from typing import Any

import numpy as np

from sonolube.checks import Complexes, Floats, Integers
from sonolube.execution.compilation import kernel

LANES = 128
"""Points per block. []"""

# Numba options of the kernels that Python calls.
# - No fused multiply-add: whether products and sums fuse would depend on what was inlined, so that a kernel compiled
#   just now and the same kernel read from the cache would differ in the last bit.
# - No reference counting (`_nrt`): the caller holds the arrays, and a third of the compile time is saved; such a kernel
#   cannot allocate arrays.
KERNEL: dict[str, Any] = {
    "cache": True,
    "nogil": True,
    "fastmath": {"nsz"},
    "error_model": "numpy",
    "no_cfunc_wrapper": True,
    "_nrt": False,
    "plain": {"LANES": 1},  # points run one by one as plain Python
}
INNER: dict[str, Any] = {  # functions that only kernels call, compiled without any Python interface
    "fastmath": KERNEL["fastmath"],
    "error_model": "numpy",
    "no_cfunc_wrapper": True,
    "no_cpython_wrapper": True,
    "_nrt": False,
    "plain": KERNEL["plain"],
}
# Large functions with a single call site: inlined into their caller, they are compiled once instead of twice.
INLINED: dict[str, Any] = INNER | {"inline": "always"}

_HALVINGS = 10
_SCALE = 2.0**-_HALVINGS
_LARGEST_EXPONENT = 700.0


def uniform_blocks(chosen: Integers, *keys: Integers, lanes: int = LANES) -> Integers:
    """Points in blocks of `LANES`, those of a block with equal keys, so that no result depends on other points.

    Shape (c + padding,). The points, sorted by their keys; the last point of each key is repeated until its block is
    full.
    """
    own = [key[chosen] for key in keys]
    order = np.lexsort(own)
    changed = np.any([np.diff(key[order]) != 0 for key in own], axis=0)
    ends = np.r_[np.flatnonzero(changed) + 1, chosen.size][: chosen.size]
    repeats = np.ones(chosen.size, dtype=np.int64)
    repeats[ends[:-1] - 1] += -np.diff(ends, prepend=0)[:-1] % lanes
    return np.asarray(np.repeat(chosen[order], repeats))


@kernel(**INNER)
def block_maximum(values: Integers, block: Integers) -> int:
    """Largest of the values at the points of a block."""
    largest = np.int64(0)
    for point in block:
        largest = max(largest, values[point])
    return int(largest)


@kernel(**INNER)
def gather(table: Floats, block: Integers, rows: Floats) -> None:
    """Write each column of a table at the points of a block as a row; zeros beyond the table's width.

    Lanes beyond the block repeat its last point.
    """
    for lane in range(LANES):
        point = block[min(lane, block.size - 1)]
        for row in range(rows.shape[0]):
            rows[row, lane] = table[point, row] if row < table.shape[1] else 0.0


@kernel(**INNER)
def exponentials(argument: Floats, result: Floats) -> None:
    r"""Write exp(argument), the argument clipped to -700 ... 700, with relative error below 4e-13 for arguments < 100.

    Scaling and squaring of the Taylor series of degree 9:

    .. math:: e^x = \left(e^{x/2^{10}}\right)^{2^{10}}
    """
    for lane in range(LANES):
        r = min(max(argument[lane], -_LARGEST_EXPONENT), _LARGEST_EXPONENT) * _SCALE
        series = 1 / 40320 + r / 362880
        series = 1 / 5040 + r * series
        series = 1 / 720 + r * series
        series = 1 / 120 + r * series
        series = 1 / 24 + r * series
        series = 1 / 6 + r * series
        series = 0.5 + r * series
        series = 1 + r * series
        series = 1 + r * series
        for _ in range(_HALVINGS):
            series *= series
        result[lane] = series


@kernel(**INNER)
def weighted_row_sum(target: Floats, coefficients: Floats, sources: Floats, part: int, last: int) -> None:
    """Write the sum over k = 0 ... last of coefficients[k] * sources[2 k - 1 + part], four terms at a time.

    Rows of `sources` are those of a motion or a spectrum: row 0 its mean (the source for k = 0), then real (part 0) and
    imaginary (part 1) part of each harmonic in turn.
    """
    for lane in range(LANES):
        target[lane] = 0.0
    single = 1 + last % 4
    for k in range(single):
        for lane in range(LANES):
            target[lane] += coefficients[k] * sources[2 * k - 1 + part if k > 0 else 0, lane]
    for k in range(single, last + 1, 4):
        row = 2 * k - 1 + part
        for lane in range(LANES):
            one = coefficients[k] * sources[row, lane] + coefficients[k + 1] * sources[row + 2, lane]
            two = coefficients[k + 2] * sources[row + 4, lane] + coefficients[k + 3] * sources[row + 6, lane]
            target[lane] += one + two


@kernel(**INNER)
def linear_combination(a: Floats, alpha: float, b: Floats, beta: float, target: Floats) -> None:
    """Write alpha * a + beta * b."""
    for lane in range(LANES):
        target[lane] = alpha * a[lane] + beta * b[lane]


@kernel(**INNER)
def add_absolute(source: Floats, target: Floats) -> None:
    """Add the absolute values of one row to another."""
    for lane in range(LANES):
        target[lane] += abs(source[lane])


@kernel(**INNER)
def add_products(a: Floats, b: Floats, c: Floats, d: Floats, target: Floats) -> None:
    """Add a * b + c * d to another row."""
    for lane in range(LANES):
        target[lane] += a[lane] * b[lane] + c[lane] * d[lane]


@kernel(**INNER)
def subtract_product(a: Floats, b: Floats, target: Floats) -> None:
    """Subtract a * b from another row."""
    for lane in range(LANES):
        target[lane] -= a[lane] * b[lane]


_WEAK_HARMONICS = 0.5  # sum of k^3 |X_k|, k > 1, over |X_1| up to which the velocity has one maximum and one minimum
_SAMPLES_PER_HARMONIC = 32  # for every other motion


@kernel(**KERNEL)
def peak_velocities(omega: Floats, harmonics: Complexes, peak: Floats) -> None:
    r"""Write the largest magnitude of the velocity of each motion.

    `harmonics` has shape (p, H).

    The velocity is :math:`v = \omega\,\mathrm{Re}\sum_k i k X_k e^{ik\theta}`. Where
    :math:`\sum_{k>1} k^3 |X_k| \le |X_1|/2` it has a single maximum and a single minimum, which Newton's method finds
    from those of the first harmonic. Any other motion is sampled.
    """
    for point in range(omega.size):
        size, higher = harmonics.shape[1], 0.0
        while size > 1 and harmonics[point, size - 1] == 0:  # so that the samples do not depend on other points
            size -= 1
        own = harmonics[point, :size]
        for k in range(2, own.size + 1):
            higher += k**3 * abs(own[k - 1])
        fastest = 0.0
        if np.isnan(higher) or np.isnan(own[0].real):
            fastest = np.nan
        elif higher <= _WEAK_HARMONICS * abs(own[0]):
            start = 0.5 * np.pi - np.arctan2(own[0].imag, own[0].real)
            fastest = max(_extremum(own, start), _extremum(own, start + np.pi))
        else:
            count = _SAMPLES_PER_HARMONIC * own.size
            for j in range(count):
                fastest = max(fastest, abs(_phase_derivatives(own, 2 * np.pi * j / count)[0]))
        peak[point] = omega[point] * fastest


@kernel(**INNER)
def _extremum(own: Complexes, phase: float) -> float:
    """Magnitude of dx/dtheta at its extremum near a phase, by Newton's method on the second derivative."""
    first = 0.0
    for _ in range(8):
        first, second, third = _phase_derivatives(own, phase)
        if third == 0.0 or abs(second) < 1e-7 * abs(first):
            break
        phase -= second / third
    return abs(first)


@kernel(**INNER)
def _phase_derivatives(own: Complexes, phase: float) -> tuple[float, float, float]:
    """First three derivatives of the displacement with respect to the phase."""
    cosine, sine = np.cos(phase), np.sin(phase)
    c, s, first, second, third = 1.0, 0.0, 0.0, 0.0, 0.0
    for k in range(1, own.size + 1):
        c, s = c * cosine - s * sine, c * sine + s * cosine
        real, imaginary = own[k - 1].real * c - own[k - 1].imag * s, own[k - 1].real * s + own[k - 1].imag * c
        first -= k * imaginary
        second -= k * k * real
        third += k * k * k * imaginary
    return first, second, third
