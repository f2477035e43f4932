"""Figures of parametric studies over voltage or amplitude, speed, frequency, waveform and load."""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.checks import Floats
from sonolube.figure import COLOURS, LINES, MARKERS
from sonolube.rig.operating_conditions import CommandedQuantity, quantity_of_axis
from sonolube.units import format_si

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_PERIODS = 4  # voltages or amplitudes of which a period is drawn
_RATIO = "Friction ratio"


def command_figure(study: "xr.Dataset") -> "Figure":
    """Return displacement and normal force over a period, friction ratio and amplitude over voltage or amplitude."""
    figure, ((period, force), (ratio, response)) = _panels(2, 2, size=(7.2, 5.6))
    quantity, levels = _level(study)
    shown = np.unique(np.linspace(0, levels.size - 1, _PERIODS + 1).astype(int)[1:])
    for index, point in enumerate(shown):
        label = format_si(float(levels[point]), quantity.unit)
        turns, x = _whole_period(study["displacement"].values[point])
        _, f = _whole_period(study["normal_force"].values[point])
        period.plot(turns, 1e6 * x, linestyle=LINES[index], color=COLOURS[index])
        force.plot(turns, f, linestyle=LINES[index], color=COLOURS[index], label=label)
    period.set(xlabel="Time over the period", ylabel="Tip displacement [µm]")
    force.set(xlabel="Time over the period", ylabel="Normal contact force [N]")
    force.legend(loc="upper left", title=quantity.qualifier, title_fontsize=8)
    across = quantity.axis_scale * levels
    ratio.plot(across, study["friction_ratio"], color=COLOURS[0])
    ratio.set(xlabel=quantity.axis_label, ylabel=_RATIO)
    ratio.set_ylim(bottom=0)
    response.plot(across, 1e6 * study["vibration_amplitude"], color=COLOURS[0], label="amplitude")
    response.plot(across, 1e6 * study["mean_displacement"], LINES[1], color=COLOURS[1], label="rise of the mean")
    response.set(xlabel=quantity.axis_label, ylabel="Vibration of the tip [µm]")
    response.legend(loc="upper left")
    return figure


def speed_figure(study: "xr.Dataset") -> "Figure":
    """Return the friction ratio over sliding speed and over velocity ratio."""
    figure, ((over_speed, over_ratio),) = _panels(1, 2, size=(7.2, 3.4), sharey=True)
    for index, curve in enumerate(_curves(study)):
        style = _style(index)
        over_speed.plot(curve["sliding_speed"], curve["friction_ratio"], **style, label=_label(curve))
        over_ratio.plot(curve["velocity_ratio"], curve["friction_ratio"], **style)
    over_speed.set(xscale="log", xlabel="Sliding speed [m/s]", ylabel=_RATIO)
    over_speed.set_ylim(bottom=0)
    over_ratio.set(xscale="log", xlabel="Sliding speed over peak vibration velocity")
    quantity, _ = _level(study)
    over_speed.legend(loc="upper left", title=quantity.qualifier, title_fontsize=8)
    return figure


def frequency_figure(study: "xr.Dataset") -> "Figure":
    """Return amplitude and friction ratio over frequency, and friction ratio over the power of the amplifier."""
    figure, ((amplitude, ratio, power),) = _panels(1, 3, size=(6.85, 2.7))
    tips = []
    for index, curve in enumerate(_curves(study)):
        style = _style(index)
        kilohertz = 1e-3 * curve["frequency"]
        amplitude.plot(kilohertz, 1e6 * curve["vibration_amplitude"], **style, label=_label(curve))
        ratio.plot(kilohertz, curve["friction_ratio"], **style)
        power.plot(curve["actuator_power"], curve["friction_ratio"], **style)
        best = _best(curve["friction_ratio"].values)
        if best is not None:
            tips.append((float(curve["actuator_power"][best]), float(curve["friction_ratio"][best])))
    if len(tips) > 1:
        power.plot(*zip(*tips, strict=True), MARKERS[0], color="black", mfc="white", label="tips", zorder=3)
        power.legend(loc="lower left")
    amplitude.set(xscale="log", yscale="log", xlabel="Drive frequency [kHz]", ylabel="Vibration amplitude [µm]")
    ratio.set(xscale="log", xlabel="Drive frequency [kHz]", ylabel=_RATIO)
    power.set(xscale="log", xlabel="Power of the\namplifier, D 1.9 [W]", ylabel=_RATIO)
    ratio.set_ylim(bottom=0)
    power.set_ylim(bottom=0)
    amplitude.legend(loc="upper left", title="peak to peak", title_fontsize=8)
    return figure


def power_figure(study: "xr.Dataset") -> "Figure":
    """Return the voltage and the power that one friction ratio takes over frequency."""
    figure, ((volts,), (watts,)) = _panels(2, 1, size=(5.0, 5.2), sharex=True)
    kilohertz = 1e-3 * study["frequency"]
    volts.plot(kilohertz, study["voltage_peak_to_peak"], color=COLOURS[0])
    watts.plot(kilohertz, study["actuator_power"], color=COLOURS[0], label="amplifier, D 1.9")
    watts.plot(kilohertz, study["dissipated_power"], LINES[1], color=COLOURS[1], label="stays in rig and contact")
    volts.set(ylabel="Voltage,\npeak to peak [V]")
    volts.set_ylim(bottom=0)
    watts.set(yscale="log", ylabel="Power [W]", xlabel="Drive frequency [kHz]")
    watts.legend(loc="best")
    return figure


def waveform_figure(study: "xr.Dataset") -> "Figure":
    """Return one period of the tip under each waveform, and the friction ratio each gives."""
    figure, ((period, ratio),) = _panels(1, 2, size=(7.2, 3.4))
    names = [str(name) for name in study["waveform"].values]
    for index, name in enumerate(names):
        turns, x = _whole_period(study["displacement"].values[index])
        period.plot(turns, 1e6 * x, linestyle=LINES[index], color=COLOURS[index], label=name)
    ratios = study["friction_ratio"].values
    for index in np.argsort(ratios):
        ratio.bar(names[index], ratios[index], color=COLOURS[index], width=0.6)
        ratio.annotate(f"{ratios[index]:.3g}", (names[index], ratios[index]), ha="center", va="bottom", fontsize=8)
    period.set(xlabel="Time over the period", ylabel="Tip displacement [µm]")
    period.legend(loc="upper center")
    ratio.set(xlabel="Waveform, all of the same swing", ylabel=_RATIO)
    ratio.grid(visible=False, axis="x")
    ratio.margins(y=0.1)
    return figure


def load_figure(study: "xr.Dataset") -> "Figure":
    """Return friction reduction and, of a structure, the arm's natural frequency over normal load."""
    has_arm = "natural_frequency" in study
    figure, (panels,) = _panels(1, 2 if has_arm else 1, size=(7.2, 3.3) if has_arm else (4.0, 3.3))
    loads = study["normal_load"].values
    panels[0].plot(loads, 100 * study["friction_reduction"], color=COLOURS[0])
    panels[0].set(xlabel="Normal load [N]", ylabel="Friction reduction [%]", ylim=(0, 100))
    if not has_arm:
        return figure
    arm = panels[1]
    arm.plot(loads, study["natural_frequency"], color=COLOURS[1])
    arm.set(xlabel="Normal load [N]", ylabel="Natural frequency of the arm [Hz]")
    return figure


STUDY_FIGURES: Mapping[str, Callable[["xr.Dataset"], "Figure"]] = MappingProxyType(
    {
        "voltage": command_figure,
        "amplitude": command_figure,
        "speed": speed_figure,
        "frequency": frequency_figure,
        "power": power_figure,
        "waveform": waveform_figure,
        "load": load_figure,
    }
)
"""Function that draws the dataset of each study."""


def _panels(rows: int, columns: int, *, size: tuple[float, float], **shared: bool) -> "tuple[Figure, list[list[Axes]]]":
    from matplotlib.figure import Figure

    figure = Figure(figsize=size)
    return figure, figure.subplots(rows, columns, squeeze=False, **shared).tolist()  # type: ignore[call-overload]


def _level(study: "xr.Dataset") -> tuple[CommandedQuantity, Floats]:
    """Quantity that sets the vibration of a study, with its values."""
    quantity = quantity_of_axis(study.dims)
    return quantity, study[quantity.name].values


def _curves(study: "xr.Dataset") -> "list[xr.Dataset]":
    quantity, levels = _level(study)
    return [study.isel({quantity.name: index}) for index in range(levels.size)]


def _style(index: int) -> dict[str, Any]:
    return {"linestyle": LINES[index % len(LINES)], "color": COLOURS[index % len(COLOURS)]}


def _label(curve: "xr.Dataset") -> str:
    quantity = quantity_of_axis(curve.coords)
    return format_si(float(curve[quantity.name]), quantity.unit)


def _whole_period(values: Floats) -> tuple[Floats, Floats]:
    """Return time over the period, and the values with the first one again at its end."""
    return np.linspace(0, 1, values.size + 1), np.append(values, values[0])


def _best(ratios: Floats) -> int | None:
    return None if np.all(np.isnan(ratios)) else int(np.nanargmin(ratios))
