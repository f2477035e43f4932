"""Arithmetic on lanes: many points side by side in a row, so that the processor's vector units serve all at once.

Each function here works on rows, one entry to a point, and writes its result where it is told. Rows of a kernel never
overlap, and no operation mixes lanes.
"""

from typing import Any

import numba

from sonolube.checks import Floats

LANES = 128
# Products and sums do not fuse: which do would depend on what was inlined, so that a kernel compiled just now and the
# same kernel from the cache would differ in the last bit. Whoever calls a kernel holds its arrays, so that it need not
# count references to them (numba's `_nrt`), a third of the code to compile; then it can't make any arrays, either.
KERNEL: dict[str, Any] = {
    "cache": True,
    "nogil": True,
    "fastmath": {"nsz"},
    "error_model": "numpy",
    "no_cfunc_wrapper": True,
    "_nrt": False,
}
ALLOCATING: dict[str, Any] = KERNEL | {"_nrt": True}
INSIDE: dict[str, Any] = {  # for what only kernels call, which spares it everything that Python would need
    "fastmath": KERNEL["fastmath"],
    "error_model": "numpy",
    "no_cfunc_wrapper": True,
    "no_cpython_wrapper": True,
    "_nrt": False,
}
# For large functions called in one place: what is compiled within its caller is compiled once, and not twice.
ONCE: dict[str, Any] = INSIDE | {"inline": "always"}

_HALVINGS = 10
_LARGEST = 700.0


@numba.njit(**INSIDE)
def exponentials(argument: Floats, result: Floats) -> None:
    """Write exp(argument), held between -700 and 700, to within 4e-13 for arguments below 100.

    The argument is halved ten times, and the series squared as often.
    """
    for lane in range(LANES):
        r = min(max(argument[lane], -_LARGEST), _LARGEST) / 2**_HALVINGS
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


@numba.njit(**INSIDE)
def combine(target: Floats, coefficients: Floats, sources: Floats, last: int) -> None:
    """Write the sum of coefficients[i] * sources[i] for i up to and including `last`, four at a time."""
    for lane in range(LANES):
        target[lane] = 0.0
    i = 0
    while i + 3 <= last:
        for lane in range(LANES):
            one = coefficients[i] * sources[i, lane] + coefficients[i + 1] * sources[i + 1, lane]
            two = coefficients[i + 2] * sources[i + 2, lane] + coefficients[i + 3] * sources[i + 3, lane]
            target[lane] += one + two
        i += 4
    while i <= last:
        for lane in range(LANES):
            target[lane] += coefficients[i] * sources[i, lane]
        i += 1
