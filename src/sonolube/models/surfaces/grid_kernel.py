"""Compiled sums over the measured pixels of a height map, and its local maxima; missing pixels are NaN."""

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.execution.compilation import kernel

__all__: list[str] = []  # used in this room only
_LANES = 8  # running extremes side by side, one vector register


@kernel(cache=True, nogil=True, error_model="numpy", fastmath={"reassoc", "contract", "nsz"})
def count_sum_and_extremes(height: Floats) -> tuple[int, float, float, float]:
    """Number of measured pixels, and sum, minimum and maximum of their heights."""
    rows, columns = height.shape
    lowest = np.full(_LANES, np.inf)
    highest = np.full(_LANES, -np.inf)
    count, total = 0, 0.0
    for row in range(rows):
        line = height[row]
        measured, part = 0, 0.0
        for column in range(columns):
            z = line[column]
            measured += z == z
            part += z if z == z else 0.0
        count += measured
        total += part
        whole = columns - columns % _LANES
        for column in range(0, whole, _LANES):
            for lane in range(_LANES):
                z = line[column + lane]
                lowest[lane] = z if z < lowest[lane] else lowest[lane]
                highest[lane] = z if z > highest[lane] else highest[lane]
        for column in range(whole, columns):
            z = line[column]
            lowest[0] = z if z < lowest[0] else lowest[0]
            highest[0] = z if z > highest[0] else highest[0]
    return count, total, lowest.min(), highest.max()


@kernel(cache=True, nogil=True, error_model="numpy", fastmath={"reassoc", "contract", "nsz"})
def central_moment_sums(height: Floats, mean: float) -> tuple[float, float, float, float]:
    """Sums of the absolute value, square, cube and fourth power of the deviation from `mean`."""
    first, second, third, fourth = 0.0, 0.0, 0.0, 0.0
    for row in range(height.shape[0]):
        line = height[row]
        a, b, c, d = 0.0, 0.0, 0.0, 0.0
        for column in range(height.shape[1]):
            z = line[column]
            deviation = z - mean if z == z else 0.0
            square = deviation * deviation
            a += abs(deviation)
            b += square
            c += square * deviation
            d += square * square
        first += a
        second += b
        third += c
        fourth += d
    return first, second, third, fourth


@kernel(cache=True, nogil=True, error_model="numpy", fastmath={"reassoc", "contract", "nsz"})
def gradient_and_area_sums(height: Floats, spacing_x: float, spacing_y: float) -> tuple[int, float, float]:
    """Number of cells of four measured pixels, and sums over them of squared gradient and excess area.

    Each cell is divided into triangles along either diagonal, which gives four triangles of a quarter weight each.
    """
    per_x, per_y = 1 / spacing_x**2, 1 / spacing_y**2
    cells, squares, excess = 0.0, 0.0, 0.0
    for row in range(height.shape[0] - 1):
        here, above = height[row], height[row + 1]
        count, a, b = 0.0, 0.0, 0.0
        for column in range(height.shape[1] - 1):
            sw, se, nw, ne = here[column], here[column + 1], above[column], above[column + 1]
            south, north = (se - sw) * (se - sw) * per_x, (ne - nw) * (ne - nw) * per_x
            west, east = (nw - sw) * (nw - sw) * per_y, (ne - se) * (ne - se) * per_y
            square = 0.5 * (south + north + west + east)
            # sqrt(1 + s) - 1 without cancellation
            more = (south + west) / (1 + np.sqrt(1 + south + west))
            more += (south + east) / (1 + np.sqrt(1 + south + east))
            more += (north + west) / (1 + np.sqrt(1 + north + west))
            more += (north + east) / (1 + np.sqrt(1 + north + east))
            whole = square == square
            count += 1.0 if whole else 0.0
            a += square if whole else 0.0
            b += 0.25 * more if whole else 0.0
        cells += count
        squares += a
        excess += b
    return int(cells), squares, excess


@kernel(cache=True, nogil=True, error_model="numpy", fastmath={"reassoc", "contract", "nsz"})
def row_difference_sums(height: Floats) -> tuple[float, float, float, float]:
    """Number and sum of squares of first differences along rows, then of second differences."""
    firsts, slopes, seconds, curvatures = 0.0, 0.0, 0.0, 0.0
    for row in range(height.shape[0]):
        z = height[row]
        a, b, c, d = 0.0, 0.0, 0.0, 0.0
        for column in range(height.shape[1] - 1):
            first = z[column + 1] - z[column]
            a += 1.0 if first == first else 0.0
            b += first * first if first == first else 0.0
        for column in range(height.shape[1] - 2):
            second = z[column] - 2 * z[column + 1] + z[column + 2]
            c += 1.0 if second == second else 0.0
            d += second * second if second == second else 0.0
        firsts, slopes, seconds, curvatures = firsts + a, slopes + b, seconds + c, curvatures + d
    return firsts, slopes, seconds, curvatures


@kernel(cache=True, nogil=True, error_model="numpy", fastmath={"reassoc", "contract", "nsz"})
def column_difference_sums(height: Floats) -> tuple[float, float, float, float]:
    """Number and sum of squares of first differences along columns, then of second differences."""
    firsts, slopes, seconds, curvatures = 0.0, 0.0, 0.0, 0.0
    for row in range(1, height.shape[0]):
        z0, z1 = height[row - 1], height[row]
        z2 = height[min(row + 1, height.shape[0] - 1)]
        inside = 1.0 if row + 1 < height.shape[0] else 0.0
        a, b, c, d = 0.0, 0.0, 0.0, 0.0
        for column in range(height.shape[1]):
            first = z1[column] - z0[column]
            second = z0[column] - 2 * z1[column] + z2[column]
            a += 1.0 if first == first else 0.0
            b += first * first if first == first else 0.0
            c += 1.0 if second == second else 0.0
            d += second * second if second == second else 0.0
        firsts, slopes, seconds, curvatures = firsts + a, slopes + b, seconds + inside * c, curvatures + inside * d
    return firsts, slopes, seconds, curvatures


@kernel(cache=True, nogil=True, error_model="numpy")
def local_maxima(height: Floats) -> tuple[int, NDArray[np.int64]]:
    """Number of measured pixels with eight measured neighbours, and flat indices of those higher than all eight."""
    rows, columns = height.shape
    found = np.empty(max(rows * columns // 4 + 1, 1), dtype=np.int64)  # two maxima are never neighbours
    candidates, count = 0, 0
    for row in range(1, rows - 1):
        south, here, north = height[row - 1], height[row], height[row + 1]
        whole = 0
        for column in range(1, columns - 1):
            west, east = column - 1, column + 1
            z = here[column]
            around = here[west] + here[east]
            around += south[west] + south[column] + south[east] + north[west] + north[column] + north[east]
            whole += z + around == z + around
        candidates += whole
        for column in range(1, columns - 1):
            west, east = column - 1, column + 1
            z = here[column]
            if (
                (z > here[west])
                & (z > here[east])
                & (z > south[west])
                & (z > south[column])
                & (z > south[east])
                & (z > north[west])
                & (z > north[column])
                & (z > north[east])
            ):
                found[count] = row * columns + column
                count += 1
    return candidates, found[:count].copy()
