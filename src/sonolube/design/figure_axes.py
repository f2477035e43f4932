"""Axes of figures over quantities of the vocabulary: units that suit the values, logarithmic scales."""

from typing import TYPE_CHECKING

import numpy as np

from sonolube.checks import Floats
from sonolube.units import format_quantity
from sonolube.vocabulary import quantities

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_RATIO_TOLERANCE = 1e-6  # relative, within which ratios of neighbouring values count as equal


def scaled_label(name: str, values: Floats) -> tuple[float, str]:
    """Factor from SI to a unit that suits the values of a quantity, and the axis label in that unit.

    Parameters
    ----------
    name : str
        Of a quantity of the vocabulary; another name is its own label.
    values : ndarray, any shape
        In SI.

    Returns
    -------
    factor : float
    label : str
        Such as "Sliding speed [mm/s]".
    """
    if name not in quantities():
        return 1.0, name.replace("_", " ")
    entry, largest = quantities()[name], float(np.nanmax(np.abs(values)))
    if not entry.unit or largest == 0:
        return 1.0, f"{entry.meaning} [{entry.unit}]" if entry.unit else entry.meaning
    number, _, unit = format_quantity(largest, name, digits=9).partition(" ")
    if unit.startswith("u"):
        unit = unit.replace("u", "µ", 1)
    return 10.0 ** round(np.log10(float(number) / largest)), f"{entry.meaning} [{unit}]"


def set_log_scale_if_geometric(axes: "Axes", x: Floats) -> None:
    """Make the x axis logarithmic where its values form a geometric sequence.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    x : ndarray, shape (n,)
    """
    ratios = x[1:] / x[:-1] if x.min() > 0 else np.array([])
    if x.size > 2 and ratios.size and np.ptp(ratios) < _RATIO_TOLERANCE * ratios[0]:
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter("{x:g}")
