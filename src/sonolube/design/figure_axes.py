"""Axes of charts over quantities of the vocabulary, in units that suit their values, and levels of contours."""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.charts import Axis
from sonolube.checks import Floats
from sonolube.text.units import format_quantity
from sonolube.vocabulary import quantities

_RATIO_TOLERANCE = 1e-6  # relative, within which ratios of neighbouring values count as equal
_SCALE_TOLERANCE = 1e-6  # relative, within which a scale is a power of ten
_STEPS = (1.0, 2.0, 2.5, 5.0, 10.0)  # between contour levels, times a power of ten


def scaled_axis(name: str, values: ArrayLike) -> tuple[float, Axis]:
    """Scale from SI to a unit that suits the values of a quantity, and the axis in that unit.

    `axis`: Such as "Sliding speed" in "mm/s"; logarithmic where the values are a geometric sequence.
    """
    array = np.asarray(values, dtype=np.float64)
    known = quantities().get(name)
    if known is None:
        label, unit = name.replace("_", " "), ""
        label = label[:1].upper() + label[1:]
    else:
        label, unit = known.meaning, known.unit
    largest = float(np.abs(array[np.isfinite(array)]).max(initial=0.0))
    scale = 1.0
    if unit and largest:
        number, _, unit = format_quantity(largest, name, digits=9).partition(" ")
        unit = unit.replace("u", "µ", 1) if unit.startswith("u") else unit
        scale = float(number) / largest
        power = 10.0 ** round(np.log10(scale))
        scale = power if abs(scale / power - 1) < _SCALE_TOLERANCE else scale
    return scale, Axis(label, unit, logarithmic=_is_geometric(array))


def contour_levels(values: Floats, *, steps: int = 18) -> Floats:
    """Round levels of contours about all known values, ascending by equal steps; two at least."""
    known = values[np.isfinite(values)]
    low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)
    least = max(high - low, 1e-6 * max(abs(low), abs(high)), 1e-12) / steps
    power = 10.0 ** np.floor(np.log10(least))
    step = power * next(each for each in _STEPS if each * power >= least * (1 - 1e-9))
    first, last = np.floor(low / step + 1e-9), np.ceil(high / step - 1e-9)
    levels: Floats = step * np.arange(first, max(last, first + 1) + 1)
    return levels


def _is_geometric(values: Floats) -> bool:
    """Whether values along an axis have one ratio to their neighbours."""
    if values.ndim != 1 or values.size < 3 or not values.min() > 0:
        return False
    ratios = values[1:] / values[:-1]
    return bool(ratios[0] != 1 and np.ptp(ratios) < _RATIO_TOLERANCE * ratios[0])
