"""Figure of an efficiency calibration: measured coefficients over sliding speed, line and bands."""

from typing import TYPE_CHECKING

from sonolube.design.efficiency import EfficiencyCalibration, efficiency_dataset
from sonolube.figure import COLOURS

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_PRINTED_UNIT = 1e9  # m2/N in mW mm2/(N W), the unit of D


def efficiency_figure(calibration: EfficiencyCalibration) -> "Figure":
    """Efficiency coefficients of runs over sliding speed, with the line, its band and the prediction band.

    Parameters
    ----------
    calibration : EfficiencyCalibration

    Returns
    -------
    matplotlib.figure.Figure
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.4, 3.5))
    axes = figure.subplots()
    line = efficiency_dataset(calibration)
    v = 1e3 * line["sliding_speed"].values
    level = f"{100 * calibration.confidence_level:g} %"
    for name, shade, label in (("run", 0.12, f"one more run, {level}"), ("line", 0.3, f"line, {level}")):
        low, high = (_PRINTED_UNIT * line[f"{end}_{name}"].values for end in ("lowest", "highest"))
        axes.fill_between(v, low, high, color=COLOURS[0], alpha=shade, linewidth=0, label=label)
    coefficient = _PRINTED_UNIT * line["efficiency_coefficient"].values
    axes.plot(v, coefficient, color=COLOURS[0], label="least squares")
    axes.plot(
        1e3 * calibration.sliding_speed,
        _PRINTED_UNIT * calibration.efficiency_coefficient,
        "o",
        color=COLOURS[1],
        markeredgecolor="white",
        label="runs",
    )
    axes.axhline(0, color="0.4", linewidth=0.8)
    axes.set(xlabel="Sliding speed [mm/s]", ylabel="Efficiency coefficient\n[mW mm²/(N W)]")
    axes.legend()
    return figure
