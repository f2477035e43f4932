"""Arithmetic on lanes: many points side by side in a row, so that the processor's vector units serve all at once.

Each function here works on rows, one entry to a point, and writes its result where it is told. Rows of a kernel never
overlap, and no operation mixes lanes.
"""

import math
from typing import Any

import numba
import numpy as np

from sonolube.checks import Floats

LANES = 128
# Products and sums do not fuse: which do would depend on what was inlined, so that a kernel compiled just now and the
# same kernel from the cache would differ in the last bit.
KERNEL: dict[str, Any] = {"cache": True, "nogil": True, "fastmath": {"nsz"}, "error_model": "numpy"}
INSIDE: dict[str, Any] = {  # for what only kernels call, which spares it everything that Python would need
    "fastmath": KERNEL["fastmath"],
    "error_model": "numpy",
    "no_cpython_wrapper": True,
    "no_cfunc_wrapper": True,
}

_LOG2_E = math.log2(math.e)
_LN_2_HIGH, _LN_2_LOW = 0.6931471803691238, 1.9082149292705877e-10  # their sum is ln 2; the first has trailing zeros
_ROUNDER = 6755399441055744.0  # 1.5 * 2**52: adding it rounds to an integer, which then stands in the lowest bits
_LARGEST = 700.0


@numba.njit(**INSIDE)
def exponentials(argument: Floats, result: Floats, scale: Floats) -> None:
    """Write exp(argument) to within 2e-14, the argument held between -700 and 700."""
    for lane in range(LANES):
        x = min(max(argument[lane], -_LARGEST), _LARGEST)
        shifted = x * _LOG2_E + _ROUNDER
        power = shifted - _ROUNDER
        r = (x - power * _LN_2_HIGH) - power * _LN_2_LOW
        series = 1 / 3628800 + r / 39916800
        series = 1 / 362880 + r * series
        series = 1 / 40320 + r * series
        series = 1 / 5040 + r * series
        series = 1 / 720 + r * series
        series = 1 / 120 + r * series
        series = 1 / 24 + r * series
        series = 1 / 6 + r * series
        series = 0.5 + r * series
        series = 1 + r * series
        result[lane] = 1 + r * series
        scale[lane] = shifted
    bits = scale.view(np.int64)
    for lane in range(LANES):
        bits[lane] = (bits[lane] + 1023) << 52
    for lane in range(LANES):
        result[lane] *= scale[lane]


@numba.njit(**INSIDE)
def combine(target: Floats, coefficients: Floats, sources: Floats, last: int) -> None:
    """Write the sum of coefficients[i] * sources[i] for i up to and including `last`, four at a time."""
    for lane in range(LANES):
        target[lane] = 0.0
    i = 0
    while i + 3 <= last:
        a, b, c, d = coefficients[i], coefficients[i + 1], coefficients[i + 2], coefficients[i + 3]
        p, q, r, s = sources[i], sources[i + 1], sources[i + 2], sources[i + 3]
        for lane in range(LANES):
            target[lane] += (a * p[lane] + b * q[lane]) + (c * r[lane] + d * s[lane])
        i += 4
    while i <= last:
        a, p = coefficients[i], sources[i]
        for lane in range(LANES):
            target[lane] += a * p[lane]
        i += 1
