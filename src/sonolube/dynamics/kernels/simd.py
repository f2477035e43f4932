"""Arithmetic on lanes: many points side by side in a row, so that the processor's vector units serve all at once.

Each function here works on rows, one entry to a point, and writes its result where it is told. Rows of a kernel never
overlap, and no operation mixes lanes.
"""

from typing import Any

import numba

from sonolube.checks import Floats, Integers

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
_SHARE = 2.0**-_HALVINGS
_LARGEST = 700.0


@numba.njit(**INSIDE)
def gather(table: Floats, block: Integers, rows: Floats) -> None:
    """Write each column of a table at a block's points as a row, zeros beyond the table's width.

    Lanes beyond the block repeat its last point.
    """
    for lane in range(LANES):
        point = block[min(lane, block.size - 1)]
        for row in range(rows.shape[0]):
            rows[row, lane] = table[point, row] if row < table.shape[1] else 0.0


@numba.njit(**INSIDE)
def exponentials(argument: Floats, result: Floats) -> None:
    """Write exp(argument), held between -700 and 700, to within 4e-13 for arguments below 100.

    The argument is halved ten times, and the series squared as often.
    """
    for lane in range(LANES):
        r = min(max(argument[lane], -_LARGEST), _LARGEST) * _SHARE
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
def combine(target: Floats, coefficients: Floats, sources: Floats, part: int, last: int) -> None:
    """Write the sum for k up to and including `last` of coefficients[k] * sources[2 k - 1 + part], four at a time.

    For k = 0 the source is row 0: a motion's or a spectrum's mean, before the two parts of its harmonics in turns.
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


@numba.njit(**INSIDE)
def blend(one: Floats, share: float, other: Floats, rest: float, target: Floats) -> None:
    """Write share * one + rest * other."""
    for lane in range(LANES):
        target[lane] = share * one[lane] + rest * other[lane]


@numba.njit(**INSIDE)
def add_size(source: Floats, target: Floats) -> None:
    """Add the absolute values of one row to another."""
    for lane in range(LANES):
        target[lane] += abs(source[lane])


@numba.njit(**INSIDE)
def add_products(one: Floats, other: Floats, third: Floats, fourth: Floats, target: Floats) -> None:
    """Add one * other + third * fourth to another row."""
    for lane in range(LANES):
        target[lane] += one[lane] * other[lane] + third[lane] * fourth[lane]


@numba.njit(**INSIDE)
def subtract_product(one: Floats, other: Floats, target: Floats) -> None:
    """Subtract the product of two rows from another."""
    for lane in range(LANES):
        target[lane] -= one[lane] * other[lane]
