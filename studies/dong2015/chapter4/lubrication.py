"""Section 4.2: rows and figures of dry, ultrasonic, lubricated and combined friction, and of the best method."""

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from dong2015.chapter4.power_rows import nominal_pressure_rows, power_row
from dong2015.plots import axes_row, line_style, report_figure
from dong2015.row import Row, RowKind, default_model_row, undetermined_row
from sonolube.checks import Floats
from sonolube.facts.published import column_numbers, published_number, published_value, si_value
from sonolube.figure import ReportFigure, subplots
from sonolube.models import friction

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_DECAY_LENGTH: Final = 2e-6  # m, of the contact of Table 3.2; that of the M50 disc of Table 4.3 is not printed
_DRY: Final = 1.0  # all coefficients are over that of dry friction, which is only drawn
_SMALLEST_GAIN: Final = 0.04  # reduction of friction for which vibration is worth its power with a lubricant; assumed
_FULL_ASPERITY_PRESSURE: Final = 200e6  # Pa, assumed
_LIMIT: Final = "4.2.4-speed-ultrasonic-best"
_NO_REDUCTION: Final = "4.2.4-speed-ultrasonic-useless"
_INFERRED: Final = (
    "Load sharing: vibration acts on the asperities, whose fraction of the load grows with the stress, not on the "
    "film. Friction under vibration by asperity stick-slip; friction under Molykote is only drawn (Figs. 4.24 to "
    "4.27), and that of its film is inferred from the printed speed at the lowest stress"
)
_FILM: Final = "the friction of the film, from the same limit at the lowest stress"


def lubrication_rows() -> Iterator[Row]:
    """Yield the rows of section 4.2."""
    yield from nominal_pressure_rows("4.3")
    yield power_row("table-4.3-actuator_power-1", si_value("table-4.3-voltage_peak_to_peak-1"))
    yield undetermined_row(
        _LIMIT,
        "friction under Molykote, which is only drawn (Figs. 4.24 to 4.27); by asperity stick-slip and load sharing a "
        f"film with {float(vibrated_ratio(sliding_speed=si_value(_LIMIT))):.2f} of the dry friction would put the "
        "limit at the printed speed",
        kind=RowKind.DEFAULT_MODEL,
    )
    limit = replace(published_value(_LIMIT), number=published_number(_LIMIT))
    for pressure in _pressures()[1:]:
        note = f"{_INFERRED}; at this stress predicted, for in the text it holds at every load"
        yield default_model_row(
            limit, _limit_speed(float(pressure)), note, suffix=f"at-{1e-6 * pressure:.0f}-MPa", fitted=_FILM
        )
    highest = max(_limit_speed(float(pressure)) for pressure in _pressures())
    useless = published_value(_NO_REDUCTION)
    from_zero = replace(useless, number=replace(useless.number, low=0.0, high=useless.number.value))
    note = f"Highest speed at which vibration alone is best at any stress, which must not exceed the print. {_INFERRED}"
    yield default_model_row(from_zero, highest, note, fitted=_FILM)


def lubrication_figures() -> Iterator[ReportFigure]:
    """Figures of section 4.2."""
    yield report_figure(
        "figure-4-27-lubrication-regimes",
        _method_map,
        gain=100 * _SMALLEST_GAIN,
        pressure=1e-6 * _FULL_ASPERITY_PRESSURE,
    )


def vibrated_ratio(*, sliding_speed: ArrayLike) -> Floats:
    """Friction ratio of the dry contact under vibration in the tests of Table 4.3. []"""
    return friction.sine_stick_slip_ratio(
        decay_length=_DECAY_LENGTH,
        vibration_amplitude=si_value("table-4.3-vibration_amplitude-1"),
        frequency=si_value("table-4.3-frequency-1"),
        sliding_speed=sliding_speed,
    )


def molykote() -> friction.BoundaryLubricant:
    """Lubricant whose film has the friction of the vibrated contact at the printed speed."""
    at_limit = float(vibrated_ratio(sliding_speed=si_value(_LIMIT)))
    return friction.BoundaryLubricant(film_coefficient=at_limit * _DRY, full_asperity_pressure=_FULL_ASPERITY_PRESSURE)


def coefficients(*, sliding_speed: ArrayLike, nominal_pressure: ArrayLike) -> friction.LubricationCoefficients:
    """Coefficients of friction of the four methods over that of the dry contact."""
    return friction.lubrication_coefficients(
        molykote(),
        friction_coefficient=_DRY,
        friction_ratio=vibrated_ratio(sliding_speed=sliding_speed),
        nominal_pressure=nominal_pressure,
    )


def _pressures() -> Floats:
    """Nominal pressures of Table 4.3. [Pa]"""
    area = si_value("table-4.3-nominal_area-1")
    return np.array([load.value / area for load in column_numbers("4.3", "normal_load").values()])


def _limit_speed(pressure: float) -> float:
    """Speed up to which vibration alone is best. [m/s]"""

    def excess(speed: float) -> float:
        of = coefficients(sliding_speed=speed, nominal_pressure=pressure)
        return float(of.ultrasonic - np.minimum(of.combined, of.lubricant))

    low, high = published_number("table-4.3-sliding_speed-1").limits()
    return float(brentq(excess, low.value, high.value, xtol=1e-9))


def _method_map() -> "Figure":
    """Draw the friction of the methods over speed, and the best method over speed and stress."""
    from matplotlib.colors import ListedColormap

    figure, (left, right) = axes_row(2, (7.8, 3.6))
    low, high = (limit.value for limit in published_number("table-4.3-sliding_speed-1").limits())
    speeds = np.linspace(low, high, 161)
    curves = coefficients(sliding_speed=speeds, nominal_pressure=_pressures()[1])._asdict()
    for index, (name, curve) in enumerate(curves.items()):
        left.plot(1e3 * speeds, curve, **line_style(index), label=name)
    left.set(xlabel="Sliding speed [mm/s]", ylabel="Friction over dry friction [1]", ylim=(0.4, 1.05))
    left.legend(loc="lower right")
    stresses = np.linspace(5e6, 80e6, 151)
    best = friction.best_lubrication_method(
        coefficients(sliding_speed=speeds[np.newaxis, :], nominal_pressure=stresses[:, np.newaxis]),
        smallest_gain=_SMALLEST_GAIN,
    )
    names = [str(method) for method in friction.LubricationMethod]
    numbers = np.vectorize(names.index)(best)
    colours = ListedColormap(["0.6", "#9ecae1", "#fdd0a2", "#c7e9c0"])
    right.pcolormesh(1e3 * speeds, 1e-6 * stresses, numbers, cmap=colours, vmin=-0.5, vmax=3.5, rasterized=True)
    for name in np.unique(best):
        rows, columns = np.nonzero(best == name)
        speed, stress = float(speeds[int(np.median(columns))]), float(stresses[int(np.median(rows))])
        box = {"facecolor": "white", "linewidth": 0, "pad": 2}
        right.text(1e3 * speed, 1e-6 * stress, name, ha="center", va="center", bbox=box)
    for name in (_LIMIT, _NO_REDUCTION):
        right.axvline(1e3 * si_value(name), color="black", linestyle=":", linewidth=1.2)
    right.plot([], [], ":k", label="90 and 110 mm/s of D 4.2.4")
    right.plot(np.full(3, 61.0), 1e-6 * _pressures(), "k>", label="stresses of Table 4.3", clip_on=False)
    right.set(xlabel="Sliding speed [mm/s]", ylabel="Nominal stress [MPa]")
    right.grid(visible=False)
    figure.legend(*right.get_legend_handles_labels(), loc="outside upper center", ncols=2)
    return figure


_DURATION: Final = 8.0  # s, in which the speed rises, assumed
_SAMPLES: Final = 321
_NAMES: Final = {"dry": "dry", "ultrasonic": "vibration", "lubricant": "Molykote", "combined": "both"}


def lubrication_method_figures() -> Iterator[ReportFigure]:
    """Figure of friction in time and over speed."""
    yield report_figure(
        "figures-4-24-4-26-lubrication-methods",
        _methods,
        coefficient=dry_coefficient(),
        duration=_DURATION,
        scatter=100 * load_scatter(),
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
    relative = coefficients(sliding_speed=sliding_speed, nominal_pressure=pressure)._asdict()
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
