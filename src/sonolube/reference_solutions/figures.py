"""Table and figure of contact laws compared on one surface, in dimensionless quantities."""

from typing import TYPE_CHECKING

import numpy as np

from sonolube.checks import Floats
from sonolube.figure import COLOURS, LINES, MARKERS, subplots
from sonolube.reference_solutions.law_comparison import REFERENCE_SOLUTION, LawComparison, LawCurve

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_TITLES = {
    "exponential": "exponential heights",
    "gaussian": "Gaussian heights",
    "persson": "Persson",
    REFERENCE_SOLUTION: "boundary elements",
}


def comparison_table(comparison: LawComparison) -> list[str]:
    """Contact laws side by side as lines of text: gap over rms height, area fraction, and dimensionless stiffness.

    Parameters
    ----------
    comparison : LawComparison

    Returns
    -------
    list of str
        A heading of two lines, then one line per load.
    """
    laws = comparison.laws
    columns = [dimensionless_curve(comparison, curve) for curve in laws.values()]
    width = 8 * len(laws)
    heading = f"{'p/(E* h)':>10}  {'gap/Rq':^{width}}  {'area fraction':^{width}}  {'k Rq/F':^{width}}"
    names = "".join(f"{name[:7]:>8}" for name in laws)
    return [
        heading,
        f"{'':>10}  {names}  {names}  {names}",
        *[
            f"{pressure:>10.2g}  "
            + "  ".join("".join(f"{column[quantity][index]:>8.3g}" for column in columns) for quantity in range(3))
            for index, pressure in enumerate(comparison.reduced_pressure)
        ],
    ]


def comparison_figure(comparison: LawComparison) -> "Figure":
    """Figure of gap, real contact area and stiffness over the nominal pressure by every contact law.

    Parameters
    ----------
    comparison : LawComparison

    Returns
    -------
    Figure
    """
    figure, axes = subplots(1, 3, figsize=(9.6, 3.4))
    for index, (name, curve) in enumerate(comparison.laws.items()):
        style = (
            {"marker": MARKERS[0], "ls": "", "color": "black", "zorder": 3}
            if name == REFERENCE_SOLUTION
            else {"ls": LINES[index], "color": COLOURS[index]}
        )
        for panel, values in zip(axes, dimensionless_curve(comparison, curve), strict=True):
            panel.plot(comparison.reduced_pressure, values, label=_TITLES[name], **style)
    labels = ("Mean gap / rms height", "Real / nominal contact area", "Stiffness × rms height / load")
    for panel, label in zip(axes, labels, strict=True):
        panel.set(xscale="log", xlabel="Nominal pressure p / (E* h')", ylabel=label)
    axes[0].axhline(0, color="0.6", lw=0.8)
    axes[1].set_yscale("log")
    axes[2].set_ylim(0, 5)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=4)
    return figure


def dimensionless_curve(comparison: LawComparison, curve: LawCurve) -> tuple[Floats, Floats, Floats]:
    r"""Dimensionless gap, area and stiffness of one law.

    Parameters
    ----------
    comparison : LawComparison
    curve : LawCurve

    Returns
    -------
    tuple of three ndarray, shape (n,)
        Gap over rms height, real over nominal contact area, and stiffness times rms height over load,
        :math:`\bar u/R_q`, :math:`A_r/A_n` and :math:`k_n R_q/F_N`.
    """
    return (
        curve.separation / comparison.rms_height,
        curve.real_contact_area / comparison.nominal_area,
        np.asarray(curve.normal_stiffness * comparison.rms_height / comparison.normal_load),
    )
