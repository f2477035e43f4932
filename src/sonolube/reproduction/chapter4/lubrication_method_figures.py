"""Section 4.2.3: figure of friction in time and over speed under three loads by four methods of lubrication."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.checks import Floats
from sonolube.facts.published import column_numbers, published_number, si_value
from sonolube.figure import ReportFigure, subplots
from sonolube.reproduction.chapter4 import lubrication
from sonolube.reproduction.plots import line_style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_DURATION: Final = 8.0  # s, in which the speed rises, assumed
_SAMPLES: Final = 321
_NAMES: Final = {"dry": "dry", "ultrasonic": "vibration", "lubricant": "Molykote", "combined": "both"}


def lubrication_method_figures() -> Iterator[ReportFigure]:
    """Figure of friction in time and over speed."""
    yield ReportFigure(
        name="figures-4-24-4-26-lubrication-methods",
        title="Friction under three loads by four methods of lubrication",
        caption="As D figures 4.24 to 4.26. None of their forces is printed. Friction ratios as in the map of methods "
        f"below. Without vibration a coefficient of {dry_coefficient():.3g}, of the same pin on steel plates (D "
        f"4.1.2), for that on M50 is not printed. {_DURATION:g} s of steadily rising speed, assumed. The plate's "
        f"wobble moves the load by the scatter of Table 4.2, {100 * load_scatter():.1f} %, once a turn on 28 mm; in "
        "the model friction fluctuates in its proportion, and so less where it is low. Bands: standard deviation.",
        draw=_methods,
    )


def dry_coefficient() -> float:
    """Assumed coefficient of friction without vibration and lubricant. []"""
    return si_value("4.1.2-friction-off") / si_value("4.1.2-normal-load")


def load_scatter() -> float:
    """Standard deviation of the load by wobble over the load, from the scatter of friction. []"""
    off = published_number("4.1.2-friction-off")
    return (off.high - off.low) / 2 / off.value


def method_coefficients(*, sliding_speed: Floats, normal_load: float) -> dict[str, Floats]:
    """Coefficients of friction by method, by the names of `LubricationCoefficients`; shape (n,). []"""
    pressure = normal_load / si_value("table-4.3-nominal_area-1")
    relative = lubrication.coefficients(sliding_speed=sliding_speed, nominal_pressure=pressure)._asdict()
    return {name: dry_coefficient() * coefficient for name, coefficient in relative.items()}


def friction_in_time(*, normal_load: float) -> tuple[Floats, Floats, dict[str, Floats]]:
    """Time, speed, and friction by method under a load and its wobble.

    `time`: From the start of the test. [s] `sliding_speed`: Rising from the lowest to the highest. [m/s]
    `friction_force`: By the names of `LubricationCoefficients`. [N]
    """
    lowest, highest = (limit.value for limit in published_number("table-4.3-sliding_speed-1").limits())
    time = np.linspace(0.0, _DURATION, _SAMPLES)
    speed = lowest + (highest - lowest) * time / _DURATION
    travelled = lowest * time + (highest - lowest) * time**2 / (2 * _DURATION)
    angle = 2 * travelled / si_value("table-4.3-rotational_diameter-1")
    load = normal_load * (1 + np.sqrt(2) * load_scatter() * np.sin(angle))
    methods = method_coefficients(sliding_speed=speed, normal_load=normal_load)
    return time, speed, {name: coefficient * load for name, coefficient in methods.items()}


def _methods() -> "Figure":
    """Draw friction in time above its coefficient over speed, a column for each load."""
    figure, panels = subplots(2, 3, figsize=(7.8, 5.4), sharex="row")
    loads = [load.value for load in column_numbers("4.3", "normal_load").values()]
    for (force, coefficient), load in zip(panels.T, loads, strict=True):
        time, speed, friction = friction_in_time(normal_load=load)
        methods = method_coefficients(sliding_speed=speed, normal_load=load)
        for index, (name, label) in enumerate(_NAMES.items()):
            style, mean = line_style(index), methods[name]
            force.plot(time, friction[name], **style | {"linewidth": 1.1}, label=label)
            spread = load_scatter() * mean
            colour = style["color"]
            coefficient.fill_between(1e3 * speed, mean - spread, mean + spread, color=colour, alpha=0.15, linewidth=0)
            coefficient.plot(1e3 * speed, mean, **style)
        force.set_title(f"{load:g} N", fontsize=9)
        force.set(xlabel="Time [s]", ylabel="Friction force [N]", ylim=(0.1 * load, 0.2 * load), xticks=(0, 4, 8))
        coefficient.set(xlabel="Sliding speed [mm/s]", ylim=(0.1, 0.2), xticks=(60, 100, 140))
        coefficient.label_outer(remove_inner_ticks=False)
        force.locator_params(axis="y", nbins=4)
        coefficient.locator_params(axis="y", nbins=4)
    panels[1, 0].set(ylabel="Coefficient of friction [1]")
    figure.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=4)
    return figure
