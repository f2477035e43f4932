"""Axes of figures over any quantity of the vocabulary: a unit that suits the values, and logarithms where they ask."""

from typing import TYPE_CHECKING

import numpy as np

from sonolube.checks import Floats
from sonolube.units import format_si
from sonolube.vocabulary import quantities

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def scaled_label(name: str, values: Floats) -> tuple[float, str]:
    """Return the factor to a unit that suits values in SI, and the label of their axis."""
    if name not in quantities():
        return 1.0, name.replace("_", " ")
    known, largest = quantities()[name], float(np.nanmax(np.abs(values)))
    if not known.unit or largest == 0:
        return 1.0, f"{known.meaning} [{known.unit}]" if known.unit else known.meaning
    number, _, unit = format_si(largest, known.unit, digits=9).partition(" ")
    if unit.startswith("u"):
        unit = unit.replace("u", "µ", 1)
    return 10.0 ** round(np.log10(float(number) / largest)), f"{known.meaning} [{unit}]"


def even_ratios_as_logarithms(axes: "Axes", x: Floats) -> None:
    """Make the axis logarithmic where values rise by even ratios."""
    ratios = x[1:] / x[:-1] if x.min() > 0 else np.array([])
    if x.size > 2 and ratios.size and np.ptp(ratios) < 1e-6 * ratios[0]:
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter("{x:g}")
