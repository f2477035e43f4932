"""Figures of results of a rig: vibration, response, start-up, temperature, regime, and parametric studies."""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from sonolube.charts import Axis, Band, Bars, Chart, Field, Line, Panel, Part, Points, Rule, Zone
from sonolube.checks import Floats
from sonolube.models.friction import LubricationMethod
from sonolube.rig.datasets import PREDICTED_RATIO, Dataset
from sonolube.rig.operating_conditions import CommandedQuantity, quantity_of_axis
from sonolube.rig.power import FiguredPower

if TYPE_CHECKING:
    import xarray as xr

    from sonolube.rig.contact_temperature import TemperaturePoint
    from sonolube.rig.datasets import LabelledArrays
    from sonolube.rig.lubrication import LubricationMap, LubricationPoint
    from sonolube.rig.record import Rig
    from sonolube.rig.responses import FrequencyResponse, StartUp

_CONTACT_LOSS_FORCE = 0.01  # force over load below which contact counts as lost
_LAST_PERIODS = 4  # periods of the drive shown enlarged at the end of a start-up
_LAST_POINTS = 801  # points drawn of those periods


def simulation_chart(result: "xr.Dataset | LabelledArrays") -> Chart:
    """Displacement of the tip and contact force over one repetition of the steady vibration.

    Two panels over time; intervals without contact are shaded.
    """
    time = 1e6 * result["time"].to_numpy()
    displacement, normal_force = result["displacement"].to_numpy(), result["normal_force"].to_numpy()
    attributes = result.attrs
    rest, load, rise = (attributes[name] for name in ("separation_at_rest_m", "normal_load_N", "mean_displacement_m"))
    lost = _zones(time, normal_force < _CONTACT_LOSS_FORCE * load, label="contact lost")
    within = [
        Line(x=time, y=1e6 * result[name].to_numpy(), label=label, colour=colour)
        for name, label, colour in (
            ("displacement_along", "along the sliding", 2),
            ("displacement_across", "across the sliding", 4),
        )
        if name in result
    ]
    gap: tuple[Part, ...] = (
        *lost,
        Line(x=time, y=1e6 * displacement, label="along the normal" if within else ""),
        *within,
        Rule(along="y", value=1e6 * rise, label=f"mean gap, {1e6 * (rest + rise):.2f} µm", colour=1, dash=1),
        Rule(along="y", value=0.0, label=f"gap at rest, {1e6 * rest:.2f} µm"),
    )
    force: tuple[Part, ...] = (
        *lost,
        Line(x=time, y=normal_force),
        Rule(along="y", value=load, label=f"load, {load:.4g} N"),
    )
    x = Axis(label="Time", unit="µs", lowest=0.0, highest=float(time[-1]))
    return Chart(
        panels=(
            Panel(x=x, y=Axis(label="Displacement of the tip\nfrom rest", unit="µm"), parts=gap),
            Panel(x=x, y=Axis(label="Contact force", unit="N", lowest=0.0), parts=force),
        ),
        size=(5.2, 4.8),
        title=f"{attributes['rig']}\n{attributes['interval']}",
        legend="top",
        shares_x=True,
    )


def _zones(time: Floats, inside: "np.ndarray[tuple[int], np.dtype[np.bool_]]", *, label: str) -> tuple[Zone, ...]:
    """Intervals of time in which something holds; none where there are none."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], inside, [False]]).astype(np.int8)))
    if not edges.size:
        return ()
    return (Zone(first=time[edges[::2]], last=time[np.minimum(edges[1::2], time.size - 1)], label=label),)


def response_chart(rig: "Rig", result: "FrequencyResponse") -> Chart:
    """Amplitude per volt, electrical impedance and phase of the linear response over frequency."""
    kilohertz = 1e-3 * result.frequency
    drive = () if rig.drive is None else (Rule(value=1e-3 * rig.drive.frequency, label="drive"),)
    x = Axis(label="Frequency", unit="kHz")
    rows = (
        (1e6 * result.amplitude_per_volt, Axis(label="Amplitude per volt", unit="µm/V", logarithmic=True)),
        (result.impedance, Axis(label="Impedance", unit="ohm", logarithmic=True)),
        (np.degrees(result.phase), Axis(label="Phase", unit="deg", ticks=(-90, -45, 0, 45, 90))),
    )
    panels = [
        Panel(x=x, y=y, parts=(Line(x=kilohertz, y=values, colour=place), *drive))
        for place, (values, y) in enumerate(rows)
    ]
    return Chart(panels=tuple(panels), size=(5.2, 5.4), title=rig.title, legend="top", shares_x=True)


def start_up_chart(rig: "Rig", result: "StartUp") -> Chart:
    """Displacement of the tip from rest over the whole start-up and over its last four periods.

    Between steps of the time integration the last periods are drawn by cubic Hermite interpolation of displacement
    and velocity.
    """
    from scipy.interpolate import CubicHermiteSpline

    assert rig.drive is not None
    time, contact = result.trajectory.time, result.trajectory.contact
    micrometres = 1e6 * contact.displacement
    end = int(np.searchsorted(time, time[-1] - _LAST_PERIODS / rig.drive.frequency))
    interpolated = CubicHermiteSpline(time[end:], micrometres[end:], 1e6 * contact.velocity[end:])
    dense = np.linspace(time[end], time[-1], _LAST_POINTS)
    x, y = Axis(label="Time", unit="ms"), Axis(label="Displacement\nof the tip", unit="µm")
    return Chart(
        panels=(
            Panel(x=x, y=y, parts=(Line(x=1e3 * time, y=micrometres, weight=0.5),)),
            Panel(x=x, y=y, parts=(Line(x=1e3 * dense, y=interpolated(dense)),), title="the last four periods"),
        ),
        size=(5.2, 4.6),
        title=rig.title,
    )


def temperature_chart(rig: "Rig", result: "TemperaturePoint") -> Chart:
    """Temperature rise of the contact and of the bulk of the pin over a test, with and without vibration."""
    lines = [
        Line(x=history.time, y=rise, label=f"{body}, {label}", colour=place, dash=dash)
        for place, (label, history) in enumerate(
            (("without vibration", result.without_vibration), ("with vibration", result.with_vibration))
        )
        for dash, (body, rise) in enumerate(
            (("contact", history.temperature_rise), ("bulk of the pin", history.bulk_rise))
        )
    ]
    x = Axis(label="Time", unit="s", lowest=0.0, highest=float(result.with_vibration.time[-1]))
    y = Axis(label="Rise of the temperature", unit="K", lowest=0.0)
    panel = Panel(x=x, y=y, parts=tuple(lines))
    return Chart(panels=(panel,), title=rig.title, legend="top", legend_columns=2)


def lubrication_chart(rig: "Rig", result: "LubricationPoint", surroundings: "LubricationMap") -> Chart:
    """Map of the method of least friction over sliding speed and nominal pressure, with the rig on it."""
    names = [str(method) for method in LubricationMethod]
    places = {name: float(place) for place, name in enumerate(names)}
    best = np.array([[places[str(name)] for name in row] for row in surroundings.best])
    x, y = 1e3 * surroundings.sliding_speed, 1e-6 * surroundings.nominal_pressure
    parts = (
        Field(x=x, y=y, values=best, words=tuple(names)),
        Points(
            x=np.array([1e3 * result.sliding_speed]),
            y=np.array([1e-6 * result.nominal_pressure]),
            label="the rig",
            colour="0",
            size=1.3,
        ),
    )
    panel = Panel(
        x=Axis(label="Sliding speed", unit="mm/s", logarithmic=True),
        y=Axis(label="Nominal pressure", unit="MPa", logarithmic=True),
        parts=parts,
    )
    return Chart(panels=(panel,), size=(5.2, 4.0), title=rig.title, legend="bottom", legend_columns=5)


_PERIODS = 4  # voltages or amplitudes of which a period is drawn
_POWER_LABELS: Mapping[FiguredPower, str] = MappingProxyType(
    {"power_to_supply": "Power to supply", "charging_power": "Power of the\namplifier, D 1.9"}
)
_RATIO = Axis(label="Friction ratio", lowest=0.0)
_FREQUENCY = Axis(label="Drive frequency", unit="kHz", logarithmic=True)
_PERIOD = Axis(label="Time over the period")
_LOAD = Axis(label="Normal load", unit="N")
_TIP = Axis(label="Tip displacement", unit="µm")


def command_chart(study: Dataset) -> Chart:
    """Displacement and normal force over a period, friction ratio and amplitude over voltage or amplitude."""
    quantity, levels = _level(study)
    motions, forces = [], []
    for place, point in enumerate(np.unique(np.linspace(0, levels.size - 1, _PERIODS + 1).astype(int)[1:])):
        style: dict[str, Any] = {"dash": place, "colour": place, "label": quantity.text(float(levels[point]))}
        turns, motion = _whole_period(study["displacement"].values[point])
        motions.append(Line(x=turns, y=1e6 * motion, **style))
        forces.append(Line(x=turns, y=_whole_period(study["normal_force"].values[point])[1], **style))
    across = quantity.axis_scale * levels
    vibration = (
        Line(x=across, y=1e6 * study["vibration_amplitude"].values, label="amplitude"),
        Line(x=across, y=1e6 * study["mean_displacement"].values, dash=1, colour=1, label="rise of the mean"),
    )
    return Chart(
        panels=(
            Panel(x=_PERIOD, y=_TIP, parts=tuple(motions)),
            Panel(x=_PERIOD, y=Axis(label="Normal contact force", unit="N"), parts=tuple(forces)),
            Panel(x=quantity.axis, y=_RATIO, parts=(*predicted_parts(study, across), _model_line(study, across))),
            Panel(x=quantity.axis, y=Axis(label="Vibration of the tip", unit="µm"), parts=vibration),
        ),
        size=(7.2, 5.6),
        columns=2,
    )


def speed_chart(study: Dataset) -> Chart:
    """Friction ratio over sliding speed and over velocity ratio."""
    axes = (
        ("sliding_speed", Axis(label="Sliding speed", unit="m/s", logarithmic=True)),
        ("velocity_ratio", Axis(label="Sliding speed over peak vibration velocity", logarithmic=True)),
    )
    title, columns = _family_title(study), _legend_columns(study)
    panels = tuple(Panel(x=axis, y=_RATIO, parts=_ratio_family(study, name), title=title) for name, axis in axes)
    return Chart(panels=panels, size=(7.2, 3.4), columns=2, legend="top", legend_columns=columns, shares_y=True)


def frequency_chart(study: Dataset, *, power: FiguredPower = "power_to_supply") -> Chart:
    """Amplitude and friction ratio over frequency, and friction ratio over power."""
    tips = [
        (float(curve[power][best]), float(curve["friction_ratio"][best]))
        for curve in _curves(study)
        if (best := _best(curve["friction_ratio"].values)) is not None
    ]
    over_power = _family(study, power, "friction_ratio")  # a curve that turns back, beside which no band stands
    if len(tips) > 1:
        x, y = np.array(tips).T
        over_power = (*over_power, Points(x=x, y=y, colour="0", is_hollow=True, label="tips"))
    amplitude = Axis(label="Vibration amplitude", unit="µm", logarithmic=True)
    watts = Axis(label=_POWER_LABELS[power], unit="W", logarithmic=True)
    return Chart(
        panels=(
            Panel(x=_FREQUENCY, y=amplitude, parts=_family(study, "frequency", "vibration_amplitude", 1e-3, 1e6)),
            Panel(x=_FREQUENCY, y=_RATIO, parts=_ratio_family(study, "frequency", 1e-3), title=_family_title(study)),
            Panel(x=watts, y=_RATIO, parts=over_power),
        ),
        size=(6.85, 2.9),
        columns=3,
        legend="top",
        legend_columns=_legend_columns(study),
    )


def power_chart(study: Dataset, *, power: FiguredPower = "power_to_supply") -> Chart:
    """Voltage and power that one friction ratio takes over frequency, the power to supply with both of its parts."""
    kilohertz = 1e-3 * study["frequency"].values
    is_whole = power == "power_to_supply"
    whole = Line(x=kilohertz, y=study["power_to_supply"].values, label="to supply", colour="0.7", weight=3.0)
    of_charge = "charge of the capacitance, D 1.9" if is_whole else "amplifier, D 1.9"
    watts = (
        *((whole,) if is_whole else ()),
        Line(x=kilohertz, y=study["charging_power"].values, label=of_charge),
        Line(x=kilohertz, y=study["dissipated_power"].values, dash=1, colour=1, label="stays in rig and contact"),
    )
    x = Axis(label="Drive frequency", unit="kHz")
    volts = Axis(label="Voltage,\npeak to peak", unit="V", lowest=0.0)
    return Chart(
        panels=(
            Panel(x=x, y=volts, parts=(Line(x=kilohertz, y=study["voltage_peak_to_peak"].values),)),
            Panel(x=x, y=Axis(label="Power", unit="W", logarithmic=True), parts=watts),
        ),
        size=(5.0, 5.2),
        shares_x=True,
    )


def waveform_chart(study: Dataset) -> Chart:
    """One period of the tip under each waveform, and the friction ratio each gives."""
    names = [str(name) for name in study["waveform"].values]
    periods = []
    for place, name in enumerate(names):
        turns, motion = _whole_period(study["displacement"].values[place])
        periods.append(Line(x=turns, y=1e6 * motion, dash=place, colour=place, label=name))
    ratios = study["friction_ratio"].values
    order = np.argsort(ratios)
    bars: list[Part] = [
        Bars(
            places=np.array([float(place)]),
            lengths=ratios[[each]],
            along="y",
            colour=int(each),
            texts=(f"{ratios[each]:.3g}",),
        )
        for place, each in enumerate(order)
    ]
    if PREDICTED_RATIO[0] in study:
        low, median, high = (study[name].values[order] for name in PREDICTED_RATIO)
        predicted = Points(
            x=np.arange(order.size, dtype=np.float64),
            y=median,
            y_error=np.array([median - low, high - median]),
            colour="0",
            is_hollow=True,
            label=f"{PREDICTED_LABEL}, and median",
        )
        bars.append(predicted)
        ratios = np.concatenate([ratios, high])
    x = Axis(label="Waveform, all of the same swing", words=tuple(names[each] for each in order))
    y = Axis(label="Friction ratio", lowest=0.0, highest=1.1 * float(np.nanmax(ratios)))
    return Chart(
        panels=(Panel(x=_PERIOD, y=_TIP, parts=tuple(periods)), Panel(x=x, y=y, parts=tuple(bars))),
        size=(7.2, 3.4),
        columns=2,
    )


def load_chart(study: Dataset) -> Chart:
    """Friction reduction and, of a structure, the arm's natural frequency over normal load."""
    loads = study["normal_load"].values
    reduction = Axis(label="Friction reduction", unit="%", lowest=0.0, highest=100.0)
    line = Line(x=loads, y=100 * study["friction_reduction"].values, label=_model_label(study))
    panels = [Panel(x=_LOAD, y=reduction, parts=(*predicted_parts(study, loads, is_reduction=True), line))]
    if "natural_frequency" in study:
        arm = Axis(label="Natural frequency of the arm", unit="Hz")
        panels.append(Panel(x=_LOAD, y=arm, parts=(Line(x=loads, y=study["natural_frequency"].values, colour=1),)))
    size = (7.2, 3.3) if len(panels) > 1 else (4.0, 3.3)
    return Chart(panels=tuple(panels), size=size, columns=len(panels))


STUDY_CHARTS: Mapping[str, Callable[..., Chart]] = MappingProxyType(
    {
        "voltage": command_chart,
        "amplitude": command_chart,
        "speed": speed_chart,
        "frequency": frequency_chart,
        "power": power_chart,
        "waveform": waveform_chart,
        "load": load_chart,
    }
)
"""Function that returns the chart of the dataset of each study."""


PREDICTED_LABEL: Final = "predicted, 80 %"
"""Label of the 80 % interval of the friction ratio by `sonolube predict`."""


def predicted_parts(
    points: Dataset, places: Floats, *, colour: int = 0, of: str = "", is_reduction: bool = False
) -> tuple[Part, ...]:
    """80 % interval and median of the predicted friction ratio along one axis; none where there is no prediction.

    Parameters
    ----------
    points : xarray.Dataset
        Over one axis, with the variables of `PREDICTED_RATIO`.
    places : ndarray, shape (n,)
        Along the axis of the figure.
    colour : int
        That of the curve of the friction model.
    of : str
        What the curve is of, where there are several.
    is_reduction : bool
        Whether the axis is of the friction reduction in percent.

    Returns
    -------
    tuple of Part
    """
    if PREDICTED_RATIO[0] not in points:
        return ()
    low, median, high = (points[name].values for name in PREDICTED_RATIO)
    if is_reduction:
        low, median, high = (100 * (1 - each) for each in (high, median, low))
    label = f"{PREDICTED_LABEL}{', ' if of else ''}{of}"
    return (
        Band(x=places, low=low, high=high, label=label, colour=colour, opacity=0.2),
        Line(x=places, y=median, label="" if of else "predicted median", colour=colour, dash=3, weight=0.7),
    )


def _model_label(study: Dataset) -> str:
    """Name of the friction model of a study beside a prediction; empty without one."""
    return str(study.attrs.get("friction_model", "")) if PREDICTED_RATIO[0] in study else ""


def _model_line(study: Dataset, places: Floats) -> Line:
    """Friction ratio by the friction model along one axis."""
    return Line(x=places, y=study["friction_ratio"].values, label=_model_label(study))


def _family_title(study: Dataset) -> str:
    """What the lines of a family of curves are beside a prediction; empty without one."""
    model = _model_label(study)
    return f"{model}; dotted: predicted median" if model else ""


def _legend_columns(study: Dataset) -> int:
    """Columns of a legend over the panels: fewer beside a prediction, whose labels are longer."""
    return 3 if PREDICTED_RATIO[0] in study else 6


def _ratio_family(study: Dataset, x: str, x_scale: float = 1.0) -> tuple[Part, ...]:
    """Friction ratio for each voltage or amplitude of a study, with the prediction of the first and the last."""
    quantity, levels = _level(study)
    curves = _curves(study)
    bands: list[Part] = []
    for place in sorted({0, len(curves) - 1}):
        of = quantity.text(float(levels[place])) if len(curves) > 1 else ""
        bands += predicted_parts(curves[place], x_scale * curves[place][x].values, colour=place, of=of)
    return (*bands, *_family(study, x, "friction_ratio", x_scale))


def _level(study: Dataset) -> tuple[CommandedQuantity, Floats]:
    """Quantity that sets the vibration of a study, with its values."""
    quantity = quantity_of_axis(study.dims)
    return quantity, study[quantity.name].values


def _curves(study: Dataset) -> list[Dataset]:
    quantity, levels = _level(study)
    return [study.isel({quantity.name: index}) for index in range(levels.size)]


def _family(study: Dataset, x: str, y: str, x_scale: float = 1.0, y_scale: float = 1.0) -> tuple[Any, ...]:
    """Curve for each voltage or amplitude of a study."""
    quantity, levels = _level(study)
    return tuple(
        Line(
            x=x_scale * curve[x].values,
            y=y_scale * curve[y].values,
            dash=place,
            colour=place,
            label=quantity.text(float(levels[place])),
        )
        for place, curve in enumerate(_curves(study))
    )


def _whole_period(values: Floats) -> tuple[Floats, Floats]:
    """Time over the period, and the values with the first one again at its end."""
    return np.linspace(0, 1, values.size + 1), np.append(values, values[0])


def _best(ratios: Floats) -> int | None:
    """Place of the least ratio; None where there is none."""
    return None if np.all(np.isnan(ratios)) else int(np.nanargmin(ratios))
