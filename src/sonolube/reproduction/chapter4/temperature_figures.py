"""Section 4.3: figures of contact temperature over time, heat over voltage, and superimposed speed over voltage."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.checks import Floats
from sonolube.facts.metrics import peak_vibration_velocity, superimposed_speed
from sonolube.facts.published import si_value, table
from sonolube.figure import ReportFigure
from sonolube.models.thermal import superimposed_heat_rate
from sonolube.reproduction.chapter4 import temperature_tests as tests
from sonolube.reproduction.chapter4.power_map import actuator_power, vibration_amplitude
from sonolube.reproduction.plots import axes_row, curve_style, line_style, point_style, single_axes

if TYPE_CHECKING:
    from matplotlib.figure import Figure


_VOLTAGE: Final = "Drive voltage, peak to peak [V]"


def temperature_figures() -> Iterator[ReportFigure]:
    """Figures of section 4.3."""
    yield ReportFigure(
        name="figure-4-30-contact-temperature",
        title="Computed temperature of the contact in time",
        caption=f"Tests of Table 4.4: sliding from 2 s, five voltages from 12 s on, rest from 32 s. {tests.ASSUMED}; "
        f"friction {100 * (1 - tests.EXAMPLE_FRICTION_RATIO):.0f} % lower under vibration at every speed, which is "
        f"printed for 220 mm/s only; {100 * tests.vibration_heat_fraction():.2f} % of the actuator's power in the "
        "contact. D measured up to 53 degC.",
        draw=_temperature_over_time,
    )
    yield ReportFigure(
        name="figure-4-34-two-factors",
        title="Heat of the example with vibration over heat without",
        caption="220 mm/s and 26 MPa; friction 10 % lower at every voltage, while in the text it falls further. "
        "Friction times superimposed speed, the explanation of D, stays below one at every voltage of the tests. "
        "With a fraction of the actuator's power, taken from these very statements, the contact cools and warms as "
        "in D. Triangles point to the temperature in D: below or above that without vibration.",
        draw=_heat_over_voltage,
    )
    yield ReportFigure(
        name="figure-4-32-superimposed-speed",
        title="Sliding speed with the vibration superimposed",
        caption="Curves: the resultant of sliding speed and half-wave mean of the vibration velocity, the "
        "amplitude in proportion to the voltage. Points: Table 4.5, with one misprinted cell, 110 for 112 mm/s.",
        draw=_superimposed_speeds,
    )


def _temperature_over_time() -> "Figure":
    """Draw the computed temperature of the contact over time at both loads."""
    figure, panels = axes_row(2, (7.8, 3.6), sharey=True)
    for axes, load in zip(panels, tests.loads(), strict=True):
        for index, speed in enumerate(tests.speeds()):
            record = tests.history(tests.TemperatureTest(normal_load=float(load), sliding_speed=float(speed)))
            celsius = tests.ROOM_TEMPERATURE - 273.15 + record.temperature_rise
            axes.plot(record.time, celsius, **line_style(index), label=f"{1e3 * speed:.0f} mm/s")
        pressure = load / si_value("table-4.4-nominal_area-1")
        axes.set(xlabel="Time [s]", ylabel="Temperature of the contact [°C]", xlim=(0, 50))
        axes.text(0.97, 0.93, f"{1e-6 * pressure:.0f} MPa", transform=axes.transAxes, ha="right")
        axes.axvline(si_value("4.3.3-vibration-start"), color="0.5", linestyle=":", linewidth=1)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=6)
    return figure


def _heat_over_voltage() -> "Figure":
    """Draw the heat of the example with vibration over heat without, over voltage."""
    figure, axes = single_axes()
    swing = np.linspace(0.0, 28.0, 141)
    speed = si_value("4.3.4-example-speed")
    ratio, fraction = tests.EXAMPLE_FRICTION_RATIO, tests.vibration_heat_fraction()
    peaks = _peak_velocity(swing)
    published = superimposed_heat_rate(friction_force=ratio, sliding_speed=speed, vibration_velocity=peaks)
    axes.plot(swing, published / speed, **line_style(1), label="friction × superimposed speed (D)")
    supplied = actuator_power(voltage_peak_to_peak=swing) / tests.example_heat()
    low, high = (ratio + limit * supplied for limit in tests.vibration_heat_window())
    axes.fill_between(swing, low, high, color="0.85", label="limits of the fraction")
    label = f"friction + {100 * fraction:.2f} % of the power"
    axes.plot(swing, ratio + fraction * supplied, **line_style(0), label=label)
    for sense, marker, places, height in (
        ("below one", "v", tests.voltages()[:2], 0.985),
        ("above one", "^", tests.voltages()[3:], 1.015),
    ):
        axes.plot(places, np.full(places.size, height), marker, color="black", label=f"{sense}, section 4.3.4")
    axes.axhline(1.0, color="0.4", linewidth=0.8)
    axes.set(xlabel=_VOLTAGE, ylabel="Heat over heat without vibration [1]", ylim=(0.85, 1.35))
    axes.legend(loc="upper left")
    return figure


def _superimposed_speeds() -> "Figure":
    """Draw the superimposed speed over voltage with the points of Table 4.5."""
    figure, axes = single_axes((6.2, 3.6))
    columns = table("4.5").columns
    slides, voltages, speeds = (
        columns[name].values for name in ("sliding_speed", "voltage_peak_to_peak", "superimposed_speed")
    )
    swing = np.linspace(0, 26.5, 107)
    for index, slide in enumerate(sorted(set(slides), reverse=True)):
        curve = superimposed_speed(sliding_speed=slide, vibration_velocity=_peak_velocity(swing))
        axes.plot(swing, 1e3 * curve, **line_style(index))
        of_slide = slides == slide
        axes.plot(voltages[of_slide], 1e3 * speeds[of_slide], **point_style(index))
        axes.plot([], [], **curve_style(index), label=f"{1e3 * slide:g} mm/s")
    for correction in table("4.5").corrections:
        at = voltages[correction.row], 1e3 * speeds[correction.row]
        axes.plot(*at, "o", ms=12, mfc="none", color="black", ls="none", label="misprinted cell")
    axes.set(xlabel=_VOLTAGE, ylabel="Superimposed speed [mm/s]", xlim=(-0.6, 26.8), ylim=(0, 260))
    figure.legend(loc="outside right center", title="Sliding speed:\ncurve computed,\npoints Table 4.5")
    return figure


def _peak_velocity(voltage: Floats) -> Floats:
    """Peak vibration velocity at voltages peak to peak in V. [m/s]"""
    return peak_vibration_velocity(
        frequency=si_value("table-4.4-frequency-1"),
        vibration_amplitude=vibration_amplitude(voltage_peak_to_peak=voltage),
    )
