"""Temperature tests of D 4.3: settings, assumptions, computed histories, and figures of section 4.3."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Final

import numpy as np

from dong2015.chapter4.power_map import actuator_power, vibration_amplitude
from dong2015.plots import axes_row, curve_style, line_style, point_style, report_figure, single_axes
from sonolube.checks import Floats
from sonolube.facts.metrics import peak_vibration_velocity, superimposed_speed
from sonolube.facts.published import column_numbers, si_value, table
from sonolube.figure import COLOURS, LINES, ReportFigure
from sonolube.models import thermal
from sonolube.models.contact import ExponentialHeights
from sonolube.models.friction import sine_stick_slip_ratio
from sonolube.models.thermal import superimposed_heat_rate
from sonolube.rig import thermal_solid
from sonolube.validation.contacts import RMS_OVER_ARITHMETIC_MEAN

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ROOM_TEMPERATURE: Final = 294.15
"""Room temperature, that of the other tests of D, 21 degC. [K]"""

EXAMPLE_FRICTION_RATIO: Final = 0.9
"""Friction with vibration over friction without in the example: 10 % less at 5.1 and 10.3 V, beyond which it falls
further by an unprinted amount. Kept at 10 % at every voltage, the case of the least cooling. []"""

POWDER_COATING: Final = thermal_solid("powder_coating")
"""Coating of the disc, assumed: a filled thermoset, of which D prints only thickness and hardness."""

_NUT: Final = thermal.ThermalNetwork(heat_capacity=(1.5,), links=(), losses=(0.05,))  # 3 g of steel on a thread

ASSUMED: Final = (
    "Assumed, for D prints none of it: room at 21 degC, coating with 0.25 W/(m K), a coefficient of friction of 0.1 "
    "(E18), a thermocouple that conducts like the nut's stainless steel, the nut 3 g and 0.05 W/K"
)
"""Assumptions of the computed histories, in words."""


@dataclass(frozen=True, kw_only=True, slots=True)
class TemperatureTest:
    """One temperature test: load, speed, and whether the five voltages were applied.

    Parameters
    ----------
    normal_load : float
        Force pressing the bodies together. [N]
    sliding_speed : float
        Sliding speed. [m/s]
    vibrated : bool
        Whether the voltages were applied.
    """

    normal_load: float
    sliding_speed: float
    vibrated: bool = True


def voltages() -> Floats:
    """Five voltages, peak to peak. [V]"""
    return _column("voltage_peak_to_peak")


def speeds() -> Floats:
    """Six sliding speeds. [m/s]"""
    return _column("sliding_speed")


def loads() -> Floats:
    """Both loads. [N]"""
    return _column("normal_load")


def dry_heat(*, normal_load: float, sliding_speed: float) -> float:
    """Heat of friction without vibration. [W]"""
    friction = si_value("4.1.3-friction-coated-last") * normal_load  # a coefficient: erratum E18
    return float(thermal.frictional_heat_rate(friction_force=friction, sliding_speed=sliding_speed))


def example_heat() -> float:
    """Heat of friction of the example, 3 N and 220 mm/s, without vibration. [W]"""
    return dry_heat(normal_load=float(loads()[0]), sliding_speed=si_value("4.3.4-example-speed"))


def vibration_heat_window() -> tuple[float, float]:
    """Limits of the fraction of the actuator's power at which the example cools and warms as in D. []

    At 10.3 V the heat of vibration must be less than the loss of frictional heat, at 20.7 V more.
    """
    power = actuator_power(voltage_peak_to_peak=voltages())
    lost = (1 - EXAMPLE_FRICTION_RATIO) * example_heat()
    return lost / float(power[3]), lost / float(power[1])


def vibration_heat_fraction() -> float:
    """Fraction of the actuator's power that heats the contact: the geometric mean of its limits. []"""
    low, high = vibration_heat_window()
    return float(np.sqrt(low * high))


def vibration_heat(fraction: float | None = None) -> Floats:
    """Heat of vibration at the five voltages, by default at the geometric mean of the limits. [W]"""
    share = vibration_heat_fraction() if fraction is None else fraction
    return share * actuator_power(voltage_peak_to_peak=voltages())


def slow_friction_ratio() -> Floats:
    """Friction ratio at the lowest speed and the five voltages by asperity stick-slip. []"""
    return sine_stick_slip_ratio(
        decay_length=RMS_OVER_ARITHMETIC_MEAN * si_value("4.1.3-roughness-coated") / ExponentialHeights().decay,
        vibration_amplitude=_column("vibration_amplitude"),
        frequency=si_value("table-4.4-frequency-1"),
        sliding_speed=float(speeds()[0]),
    )


def heated_contact(*, disc: thermal.ThermalSolid = POWDER_COATING) -> thermal.HeatedContact:
    """Contact of the thermocouple's tip with the disc."""
    pin = thermal_solid("stainless_steel_304")
    radius = float(np.sqrt(si_value("table-4.4-nominal_area-1") / np.pi))
    return thermal.HeatedContact(
        pin=pin, disc=disc, source=thermal.EllipticSource(half_length=radius, half_width=radius), network=_NUT
    )


def history(test: TemperatureTest, *, step: float = 0.25) -> thermal.ContactTemperatureHistory:
    """Computed temperature history of a test."""
    start, dry = si_value("4.3.3-motor-start"), si_value("4.3.3-vibration-start")
    level, rest = si_value("4.3.3-level-duration"), si_value("4.3.3-cooling-duration")
    end = dry + level * voltages().size
    moments = np.arange(0.0, end + rest + step / 2, step)
    middle = (moments[1:] + moments[:-1]) / 2
    turning = (middle > start) & (middle < end)
    shaken = turning & (middle > dry) & test.vibrated
    at_level = np.clip((middle - dry) // level, 0, voltages().size - 1).astype(int)
    friction = si_value("4.1.3-friction-coated-last") * test.normal_load * np.where(shaken, EXAMPLE_FRICTION_RATIO, 1.0)
    return thermal.contact_temperature_history(
        heated_contact(),
        time=moments,
        friction_force=np.where(turning, friction, 0.0),
        sliding_speed=np.where(turning, test.sliding_speed, 0.0),
        vibration_heat_rate=np.where(shaken, vibration_heat()[at_level], 0.0),
    )


@cache
def dry_rises() -> Floats:
    """Temperature rises without vibration at the moment when it starts, by load and speed. [K]"""
    start = si_value("4.3.3-vibration-start")

    def rise(load: float, speed: float) -> float:
        record = history(TemperatureTest(normal_load=load, sliding_speed=speed, vibrated=False))
        return float(np.interp(start, record.time, record.temperature_rise))

    return np.array([[rise(float(load), float(speed)) for speed in speeds()] for load in loads()])


def _column(name: str) -> Floats:
    """Numbers of a column of Table 4.4, in SI."""
    return np.array([number.value for number in column_numbers("4.4", name).values()])


_MIN_COEFFICIENT: Final = 0.067  # on coated steel; D 4.1.3 prints 0.67 N (E18)
_CELSIUS: Final = ROOM_TEMPERATURE - 273.15


def dry_temperature_figures() -> Iterator[ReportFigure]:
    """Figure of the temperature before the vibration."""
    last = si_value("4.1.3-friction-coated-last")
    yield report_figure(
        "figure-4-31-temperature-over-speed", _over_speed, assumed=ASSUMED, least=_MIN_COEFFICIENT, last=last
    )


def _over_speed() -> "Figure":
    """Draw the temperatures of both stresses over speed with their lines."""
    figure, axes = single_axes()
    along, area = speeds(), si_value("table-4.4-nominal_area-1")
    least = _MIN_COEFFICIENT / si_value("4.1.3-friction-coated-last")
    for index, (load, rise) in enumerate(zip(loads(), dry_rises(), strict=True)):
        low = _CELSIUS + rise * least  # heat, and so the rise, is proportional to friction
        axes.fill_between(1e3 * along, low, _CELSIUS + rise, color=COLOURS[index], alpha=0.2, linewidth=0)
        label = f"{1e-6 * load / area:.0f} MPa"
        axes.plot(1e3 * along, _CELSIUS + rise, **point_style(index), label=label)
        slope, intercept = np.polyfit(along, rise, 1)
        line = np.array([0.0, 0.24])
        label = f"{1e-3 * slope:.2g} K/(mm/s)"
        axes.plot(
            1e3 * line, _CELSIUS + intercept + slope * line, **line_style(index) | {"linestyle": LINES[1]}, label=label
        )
    axes.set(xlabel="Sliding speed [mm/s]", ylabel="Temperature of the contact at 12 s [°C]", xlim=(0, 240))
    axes.locator_params(axis="y", nbins=6)
    axes.legend(loc="upper left")
    return figure


_VOLTAGE: Final = "Drive voltage, peak to peak [V]"


def temperature_figures() -> Iterator[ReportFigure]:
    """Figures of section 4.3."""
    yield report_figure(
        "figure-4-30-contact-temperature",
        _temperature_over_time,
        assumed=ASSUMED,
        less=100 * (1 - EXAMPLE_FRICTION_RATIO),
        fraction=100 * vibration_heat_fraction(),
    )
    yield report_figure("figure-4-34-two-factors", _heat_over_voltage)
    yield report_figure("figure-4-32-superimposed-speed", _superimposed_speeds)


def _temperature_over_time() -> "Figure":
    """Draw the computed temperature of the contact over time at both loads."""
    figure, panels = axes_row(2, (7.8, 3.6), sharey=True)
    for axes, load in zip(panels, loads(), strict=True):
        for index, speed in enumerate(speeds()):
            record = history(TemperatureTest(normal_load=float(load), sliding_speed=float(speed)))
            celsius = ROOM_TEMPERATURE - 273.15 + record.temperature_rise
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
    ratio, fraction = EXAMPLE_FRICTION_RATIO, vibration_heat_fraction()
    peaks = _peak_velocity(swing)
    published = superimposed_heat_rate(friction_force=ratio, sliding_speed=speed, vibration_velocity=peaks)
    axes.plot(swing, published / speed, **line_style(1), label="friction × superimposed speed (D)")
    supplied = actuator_power(voltage_peak_to_peak=swing) / example_heat()
    low, high = (ratio + limit * supplied for limit in vibration_heat_window())
    axes.fill_between(swing, low, high, color="0.85", label="limits of the fraction")
    label = f"friction + {100 * fraction:.2f} % of the power"
    axes.plot(swing, ratio + fraction * supplied, **line_style(0), label=label)
    for sense, marker, places, height in (
        ("below one", "v", voltages()[:2], 0.985),
        ("above one", "^", voltages()[3:], 1.015),
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
