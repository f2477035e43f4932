"""Sections 4.1.2 to 4.1.4 and appendix B: maps of friction reduction, the load, and coated steel: rows and figures.

D fitted its maps to measured runs that are not available; it prints a few numbers of them in the text and Table 4.2.
The maps here are computed: the identified tribometer with the contact of steel plates, their roughness that of D
4.1.3, and asperity stick-slip.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, Final

import numpy as np

from dong2015.chapter4 import power_map
from dong2015.plots import axes_row, curve_style, draw_printed, line_style, report_figure, single_axes
from dong2015.published_rigs import IDENTIFIED_NOTE, plate_rig
from dong2015.row import Row, RowKind, default_model_row, published_formula_row, undetermined_row
from sonolube.charts import Line, Zone, draw_chart
from sonolube.checks import Floats
from sonolube.design import map_chart, velocity_power_map, velocity_stress_map
from sonolube.facts.published import column_numbers, published_number, si_value
from sonolube.figure import COLOURS, LINES, MARKERS, ReportFigure
from sonolube.models.friction import EMPIRICAL_MEMORY_LENGTH
from sonolube.rig import STUDY_CHARTS, DrivenRig, load_study
from sonolube.text.units import convert
from sonolube.validation.contacts import RMS_OVER_ARITHMETIC_MEAN, STEEL_YIELD_STRENGTH

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

_TABOR: Final = 2.8  # hardness over yield strength of a non-hardening metal; Tabor, The Hardness of Metals (1951)
_POWER: Final = "charging_power"  # D 1.9, which the maps of D are over
_BY_THE_MODEL: Final = "by-the-multi-scale-model"
_MODEL: Final = f"Multi-scale model with asperity stick-slip, nothing fitted to friction. {IDENTIFIED_NOTE}"
_SCANS: Final = "scans of the plates, which are only drawn (Figs. 4.15 and 4.19)"
_COATED_FRICTION: Final = (
    "friction forces on coated plates, only drawn (Fig. 4.33); printed as forces, meant as coefficients (E18)"
)
_NOT_COMPUTABLE: Final = {
    "4.1.3-hardness-coating": "yield strength of the coating",
    "4.1.3-coating-thickness": "anything it could follow from; it was measured",
    "4.1.3-roughness-uncoated": _SCANS,
    "4.1.3-roughness-coated": _SCANS,
    "4.1.3-waviness-fine": _SCANS,
    "4.1.3-waviness-x": _SCANS,
    "4.1.3-waviness-y": _SCANS,
    "4.1.3-groove-depth": "distance slid and wear coefficient of the coating; it is within the coating, of 60 um",
    "4.1.3-friction-coated-first": _COATED_FRICTION,
    "4.1.3-friction-coated-last": _COATED_FRICTION,
}
"""Missing inputs of published numbers, by id."""


def map_rows() -> Iterator[Row]:
    """Yield the rows of the maps by the multi-scale model, and of section 4.1.3."""
    reduction = stress_maps()["friction_reduction"]
    lowest, highest = reduction.isel(voltage_peak_to_peak=0), reduction.isel(voltage_peak_to_peak=-1)
    speed = 1e3 * float(reduction["sliding_speed"][0])
    note = f"Largest at any speed and load; the model gives {float(lowest.max()):.1%}. {_MODEL}"
    yield default_model_row("4.1.2-reduction-lowest-voltage", float(lowest.max()), note, suffix=_BY_THE_MODEL)
    yield default_model_row(
        "4.1.2-reduction-highest-voltage",
        float(highest.isel(sliding_speed=0).max()),
        f"At {speed:g} mm/s, the lowest speed of the tests; {float(highest.isel(sliding_speed=-1).max()):.0%} at the"
        f" highest. {_MODEL}; friction falls too much at the lowest voltage and too little at the highest, as in Table"
        " 4.2",
        suffix=_BY_THE_MODEL,
    )
    yield from _coated_against_uncoated()
    yield _plate_count()
    yield _hardness()
    yield from (
        undetermined_row(name, missing, kind=RowKind.DEFAULT_MODEL) for name, missing in _NOT_COMPUTABLE.items()
    )


def _coated_against_uncoated() -> Iterator[Row]:
    """Yield the comparisons of coated with uncoated steel of Fig. 4.6, each as a quotient below one."""
    coated, uncoated = (maps["friction_reduction"].mean("normal_load") for maps in (coated_power_maps(), power_maps()))
    voltages = sorted(number.value for number in column_numbers("4.1", "voltage_peak_to_peak").values())
    low, high = (
        (uncoated.interp(voltage_peak_to_peak=voltage), coated.interp(voltage_peak_to_peak=voltage))
        for voltage in (voltages[1], voltages[-1])  # the first is without vibration
    )
    slow, fast = (float(high[0].isel(sliding_speed=end) / high[1].isel(sliding_speed=end)) for end in (0, -1))
    note = f"Coated steel is rougher alone, {{}} um for {{}} um, and so a little less is lost on it. {_MODEL}".format(
        *(published_number(f"4.1.3-roughness-{plate}").text for plate in ("coated", "uncoated"))
    )
    yield default_model_row("4.1.2-coated-low-voltage", float(low[0].mean() / low[1].mean()), note)
    yield default_model_row("4.1.2-coated-high-voltage-slow", 1 / slow, note)
    yield default_model_row("4.1.2-coated-high-voltage-fast", fast, note)


def map_figures() -> Iterator[ReportFigure]:
    """Figures of the maps."""
    yield report_figure("figure-4-9-stress-maps", lambda: draw_chart(map_chart(stress_maps())))
    yield report_figure("figure-4-20-power-maps", lambda: draw_chart(map_chart(power_maps())))
    yield report_figure("figure-4-21-reduction-over-speed", _reduction_over_speed)
    yield report_figure("figure-4-11-ridge", _ridge, speed=1e3 * power_map.line_end())


@cache
def stress_maps() -> "xr.Dataset":
    """Friction reduction over the speeds and loads of Table 4.1 at its voltages."""
    voltages = [point.voltage_peak_to_peak for point in power_map.example_points()]
    return velocity_stress_map(
        plate_rig(), sliding_speed=_speeds(), normal_load=_loads(), voltage_peak_to_peak=voltages, power=_POWER
    )


@cache
def power_maps() -> "xr.Dataset":
    """Friction reduction over the speeds and powers of Table 4.1 under its loads."""
    voltages = np.linspace(1.0, power_map.example_points()[-1].voltage_peak_to_peak, 26)
    return velocity_power_map(
        plate_rig(), sliding_speed=_speeds(), voltage_peak_to_peak=voltages, normal_load=_loads(), power=_POWER
    )


@cache
def extended_power_map() -> "xr.Dataset":
    """Friction reduction over speed and powers up to those of 200 V, at the load of the example test."""
    return velocity_power_map(
        plate_rig(),
        sliding_speed=_speeds(),
        voltage_peak_to_peak=np.linspace(2.0, published_number("3.3.5-voltage").high, 100),
        normal_load=[power_map.example_test()["normal_load"]],
        power=_POWER,
    )


def _speeds() -> Floats:
    """Speeds of the maps. [m/s]"""
    speed = published_number("table-4.1-sliding_speed-1")
    return np.linspace(speed.low, speed.high, 31)


def _loads() -> list[float]:
    """Loads of Table 4.1. [N]"""
    return [load.value for load in column_numbers("4.1", "normal_load").values()]


def _plate_count() -> Row:
    """Number of plates from the loads."""
    loads, step = published_number("4.1.1-normal-load"), si_value("4.1.1-load-step")
    note = f"Loads from {loads.low:g} to {loads.high:g} N by {step:g} N; as many stresses in the captions of appendix B"
    return published_formula_row("4.1.1-plate-count", (loads.high - loads.low) / step + 1, note)


def _hardness() -> Row:
    """Row of the hardness of the plates, whose yield strength is not printed."""
    implied = si_value("4.1.3-hardness-uncoated") / _TABOR
    hardness = convert(_TABOR * STEEL_YIELD_STRENGTH, from_unit="Pa", to_unit="kgf/mm2")
    missing = (
        f"yield strength of the plates; that implied by the separations of D 3.1.4, {STEEL_YIELD_STRENGTH / 1e6:g} MPa,"
        f" would give {hardness:.0f} kgf/mm2 (Tabor), and the measured hardness takes {implied / 1e6:.0f} MPa"
    )
    return undetermined_row("4.1.3-hardness-uncoated", missing, kind=RowKind.DEFAULT_MODEL)


def _reduction_over_speed() -> "Figure":
    """Draw the friction reduction over speed of the model, the efficiency line and Table 4.2."""
    figure, axes = single_axes((6.4, 4.0))
    found, test = stress_maps(), power_map.example_test()
    speeds = found["sliding_speed"].values
    fine = np.linspace(speeds[0], speeds[-1], 301)
    reductions = list(column_numbers("4.2", "friction_reduction").values())
    off = test["intrinsic_friction_force"]
    for index, (point, measured) in enumerate(zip(power_map.example_points(), reductions, strict=True)):
        colour, reduction = COLOURS[index], 100 * found["friction_reduction"].isel(voltage_peak_to_peak=index).values
        axes.fill_between(1e3 * speeds, reduction.min(axis=0), reduction.max(axis=0), color=colour, linewidth=1.6)
        power = point.actuator_power
        friction = [
            float(power_map.line_friction(test | {"sliding_speed": float(v)}, actuator_power=power)) for v in fine
        ]
        axes.plot(1e3 * fine, 100 * (1 - np.array(friction) / off), LINES[1], color=colour, linewidth=1.0)
        style = {"fmt": MARKERS[index], "color": colour, "markeredgecolor": "black", "capsize": 2, "zorder": 4}
        label = f"{point.voltage_peak_to_peak:g} V, {power:.2f} W"
        draw_printed(axes, [1e3 * test["sliding_speed"]], [measured], 100, **style, label=label)
    axes.plot([], [], color="0.3", label="multi-scale model")
    axes.plot([], [], LINES[1], color="0.3", linewidth=1.0, label="efficiency line")
    axes.set(xlabel="Sliding speed [mm/s]", xlim=(1e3 * speeds[0] - 2, 1e3 * speeds[-1]))
    axes.set(ylabel="Friction reduction [%]", ylim=(-3, 108))
    handles, labels = axes.get_legend_handles_labels()  # curves come before points
    figure.legend(
        handles[2:] + handles[:2], labels[2:] + labels[:2], loc="outside right center", title="Table 4.2, 5 N"
    )
    return figure


def _ridge() -> "Figure":
    """Draw the map of friction reduction over speed and power with its ridge and the sufficient power."""
    speeds = _speeds()
    sufficient = [power_map.sufficient_power(power_map.example_test() | {"sliding_speed": float(v)}) for v in speeds]
    highest = np.full(speeds.size, power_map.example_points()[-1].actuator_power)
    x = 1e3 * speeds
    chart = map_chart(extended_power_map()).with_parts(
        0,
        Line(x=x, y=np.array(sufficient), label="all friction, D 4.3", colour=1, dash=3, weight=1.4, has_halo=True),
        Line(x=x, y=highest, label="highest of the tests", colour="0.2", dash=2, weight=0.9, has_halo=True),
    )
    (panel,) = chart.panels
    y = replace(panel.y, logarithmic=True, lowest=0.2)
    return draw_chart(replace(chart, panels=(replace(panel, y=y),)))


_NO_EXCITATION: Final = (
    "Nothing in the model excites the arm at its own frequency: D 3.31 has neither the plate's wobble nor the motor."
)


@cache
def response_over_load() -> "xr.Dataset":
    """Response of the tribometer with steel plates over the weights of section 4.1."""
    loads = published_number("4.1.1-normal-load")
    return load_study(plate_rig(), normal_load=np.arange(loads.low, loads.high + 0.125, 0.25))


def load_rows() -> Iterator[Row]:
    """Yield the rows of the loading arm."""
    response = response_over_load()
    loads, reduction, arm = (
        response[name].values for name in ("normal_load", "friction_reduction", "natural_frequency")
    )
    middle = (si_value("4.1.2-peak-load-1") + si_value("4.1.2-peak-load-2")) / 2
    note = (
        f"Natural frequency of the arm with the weights for {middle:g} N; {arm.min():.0f} to {arm.max():.0f} Hz over "
        f"all loads. {IDENTIFIED_NOTE}, of which this is one."
    )
    yield default_model_row("4.1.2-arm-frequency", float(np.interp(middle, loads, arm)), note)
    spread = float(np.ptp(reduction))
    note = f"Largest minus smallest reduction from 3 to 9 N at 25.9 V and 65.5 mm/s. {_NO_EXCITATION}"
    yield default_model_row("4.1.2-arm-extra-reduction", spread, note)
    best = float(loads[np.argmax(reduction)])
    rig = plate_rig()
    needed = rig.sliding_speed / (2 * np.pi * si_value("4.1.2-arm-frequency") * EMPIRICAL_MEMORY_LENGTH)
    for published in ("4.1.2-peak-load-1", "4.1.2-peak-load-2"):
        note = (
            f"The computed reduction is constant to {100 * spread:.2g} %. {_NO_EXCITATION} Nor could the arm reduce "
            f"friction: at 100 Hz asperity stick-slip has no reduction at {1e3 * rig.sliding_speed:g} mm/s below an "
            f"amplitude of {needed:.0f} decay lengths of the contact, at which it would be open for nearly all the time"
        )
        yield default_model_row(published, best, note)


def load_figures() -> Iterator[ReportFigure]:
    """Figure of section 4.1.2 on load."""
    yield report_figure("figure-4-7-load", _load)


def _load() -> "Figure":
    """Draw the response over load with the loads of the maximum in the text."""
    low, high = (np.array([si_value(f"4.1.2-peak-load-{end}")]) for end in (1, 2))
    zone = Zone(first=low, last=high, label="D 4.1.2", colour="0.88")
    return draw_chart(STUDY_CHARTS["load"](response_over_load()).with_parts(0, zone).with_parts(1, zone))


def coated_plate_figures() -> Iterator[ReportFigure]:
    """Figures on coated steel, alone and beside uncoated steel."""
    yield report_figure("figures-4-5-4-8-coated-steel", _coated_reductions, identified=IDENTIFIED_NOTE)
    yield report_figure("figure-4-6-coated-against-uncoated", _both_plates)
    yield report_figure("figure-4-10-coated-stress-maps", lambda: draw_chart(map_chart(coated_stress_maps())))
    yield report_figure(
        "figures-4-12-b-coated-power-maps",
        lambda: draw_chart(map_chart(coated_power_maps())),
        identified=IDENTIFIED_NOTE,
    )


def _coated_reductions() -> "Figure":
    """Draw the reduction on coated steel over speed at five voltages, and over load at six speeds."""
    figure, (over_speed, over_load) = axes_row(2, (7.8, 3.6), sharey=True)
    found = 100 * coated_stress_maps()["friction_reduction"]
    speeds, loads = (found[name].values for name in ("sliding_speed", "normal_load"))
    for index, volts in enumerate(found["voltage_peak_to_peak"].values):
        mean = found.isel(voltage_peak_to_peak=index).mean("normal_load")
        over_speed.plot(1e3 * speeds, mean.values, **line_style(index), label=f"{volts:g} V")
    for index, place in enumerate(np.linspace(0, speeds.size - 1, 6).astype(int)):
        highest = found.isel(voltage_peak_to_peak=-1, sliding_speed=place)
        over_load.plot(loads, highest.values, **curve_style(index), label=f"{1e3 * speeds[place]:.0f} mm/s")
    over_speed.set(xlabel="Sliding speed [mm/s]", ylabel="Friction reduction [%]", ylim=(-3, 108))
    over_load.set(xlabel="Normal load [N]", title=f"at {float(found['voltage_peak_to_peak'][-1]):g} V")
    for axes in (over_speed, over_load):
        axes.legend(loc="upper right", ncols=2, fontsize=7)
    return figure


def _both_plates() -> "Figure":
    """Draw the reduction over speed on coated and uncoated steel at the lowest and the highest voltage."""
    figure, axes = single_axes((5.2, 3.6))
    for line, (name, maps) in zip(LINES, (("uncoated", stress_maps()), ("coated", coated_stress_maps())), strict=False):
        found = 100 * maps["friction_reduction"].mean("normal_load")
        for colour, end in zip(COLOURS, (0, -1), strict=False):
            volts = float(found["voltage_peak_to_peak"][end])
            label = f"{name}, {volts:g} V"
            reduction = found.isel(voltage_peak_to_peak=end).values
            axes.plot(1e3 * found["sliding_speed"].values, reduction, line, color=colour, label=label)
    axes.set(xlabel="Sliding speed [mm/s]", ylabel="Friction reduction [%]", ylim=(-3, 108))
    axes.legend(loc="upper right", ncols=2)
    return figure


def coated_plate_rig() -> DrivenRig:
    """Tribometer with the coated steel plates of section 4.1: the roughness of the coating on steel."""
    rig = plate_rig()
    height = RMS_OVER_ARITHMETIC_MEAN * si_value("4.1.3-roughness-coated")
    rough = replace(rig.contact.roughness, rms_height=height)
    return replace(
        rig,
        title="Tribometer with coated steel plates",
        contact=replace(rig.contact, roughness=rough),
        friction_coefficient=si_value("4.1.3-friction-coated-last"),  # a coefficient: erratum E18
    )


@cache
def coated_stress_maps() -> "xr.Dataset":
    """Friction reduction on coated steel over the speeds and loads of the maps on uncoated steel at its voltages."""
    uncoated = stress_maps()
    return velocity_stress_map(
        coated_plate_rig(),
        sliding_speed=uncoated["sliding_speed"].values,
        normal_load=uncoated["normal_load"].values,
        voltage_peak_to_peak=uncoated["voltage_peak_to_peak"].values,
        power=_POWER,
    )


@cache
def coated_power_maps() -> "xr.Dataset":
    """Friction reduction on coated steel over the speeds, powers and loads of the maps on uncoated steel."""
    uncoated = power_maps()
    return velocity_power_map(
        coated_plate_rig(),
        sliding_speed=uncoated["sliding_speed"].values,
        voltage_peak_to_peak=uncoated["voltage_peak_to_peak"].values,
        normal_load=uncoated["normal_load"].values,
        power=_POWER,
    )
