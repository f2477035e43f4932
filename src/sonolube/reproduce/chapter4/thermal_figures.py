"""Figures of section 4.3: temperature of the contact in time, and the two factors over voltage."""

from typing import TYPE_CHECKING

import numpy as np

from sonolube.figure import COLOURS, LINES, ReportFigure
from sonolube.metrics import peak_vibration_velocity
from sonolube.reproduce.chapter4.temperature_tests import (
    ASSUMED,
    FRICTION_KEPT,
    ROOM_TEMPERATURE,
    TemperatureTest,
    example_heat,
    history,
    loads,
    speeds,
    vibration_heat_fraction,
    vibration_heat_window,
    voltages,
)
from sonolube.thermal import superimposed_heat_rate
from sonolube.validation.inputs import said
from sonolube.validation.power_map import actuator_power, printed, vibration_amplitude

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def thermal_figures() -> tuple[ReportFigure, ...]:
    """Return the figures of section 4.3."""
    return (
        ReportFigure(
            name="figure-4-30-contact-temperature",
            chapter=4,
            title="Computed temperature of the contact in time",
            caption=f"Tests of Table 4.4: sliding from 2 s, five voltages from 12 s on, rest from 32 s. {ASSUMED}; "
            f"friction {100 * (1 - FRICTION_KEPT):.0f} % lower under vibration at every speed, which is printed for "
            f"220 mm/s only; {100 * vibration_heat_fraction():.2f} % of the actuator's power in the contact. D "
            "measured up to 53 degC.",
            draw=_in_time,
        ),
        ReportFigure(
            name="figure-4-34-two-factors",
            chapter=4,
            title="Heat of the example with vibration over heat without",
            caption="220 mm/s and 26 MPa; friction 10 % lower at every voltage, where the text has it fall further. "
            "Friction times superimposed speed, D's own picture, stays below one at every voltage of the tests. With "
            "a share of the "
            "actuator's power, taken from these very statements, the contact cools and warms as D says. Triangles "
            "point "
            "to where D has the temperature: below or above that without vibration.",
            draw=_two_factors,
        ),
    )


def _in_time() -> "Figure":
    from matplotlib import pyplot as plt

    figure, panels = plt.subplots(1, 2, figsize=(7.8, 3.6), sharey=True)
    for axes, load in zip(panels, loads(), strict=True):
        for index, speed in enumerate(speeds()):
            record = history(TemperatureTest(normal_load=float(load), sliding_speed=float(speed)))
            axes.plot(
                record.time,
                ROOM_TEMPERATURE - 273.15 + record.temperature_rise,
                linestyle=LINES[index],
                color=COLOURS[index],
                label=f"{1e3 * speed:.0f} mm/s",
            )
        pressure = load / printed("4.4", "nominal_area")[0].value
        axes.set(xlabel="Time [s]", ylabel="Temperature of the contact [°C]", xlim=(0, 50))
        axes.text(0.97, 0.93, f"{1e-6 * pressure:.0f} MPa", transform=axes.transAxes, ha="right")
        axes.axvline(said("4.3.3-vibration-start").value, color="0.5", linestyle=":", linewidth=1)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=6)
    return figure


def _two_factors() -> "Figure":
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(figsize=(4.8, 3.6))
    swing = np.linspace(0.0, 28.0, 141)
    speed = said("4.3.4-example-speed").value
    velocity = peak_vibration_velocity(
        frequency=printed("4.4", "frequency")[0].value,
        vibration_amplitude=vibration_amplitude(voltage_peak_to_peak=swing),
    )
    published = superimposed_heat_rate(friction_force=FRICTION_KEPT, sliding_speed=speed, vibration_velocity=velocity)
    axes.plot(swing, published / speed, LINES[1], color=COLOURS[1], label="friction × superimposed speed (D)")
    supplied = actuator_power(voltage_peak_to_peak=swing) / example_heat()
    low, high = vibration_heat_window()
    axes.fill_between(
        swing,
        FRICTION_KEPT + low * supplied,
        FRICTION_KEPT + high * supplied,
        color="0.85",
        label="window of the share",
    )
    axes.plot(
        swing,
        FRICTION_KEPT + vibration_heat_fraction() * supplied,
        LINES[0],
        color=COLOURS[0],
        label=f"friction + {100 * vibration_heat_fraction():.2f} % of the power",
    )
    for sense, marker, places, height in (
        ("below one", "v", voltages()[:2], 0.985),
        ("above one", "^", voltages()[3:], 1.015),
    ):
        axes.plot(places, np.full(places.size, height), marker, color="black", label=f"{sense}, section 4.3.4")
    axes.axhline(1.0, color="0.4", linewidth=0.8)
    axes.set(xlabel="Drive voltage, peak to peak [V]", ylabel="Heat over heat without vibration [1]", ylim=(0.85, 1.35))
    axes.legend(loc="upper left")
    return figure
