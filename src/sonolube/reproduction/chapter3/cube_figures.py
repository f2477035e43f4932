"""Sections 3.1 and 3.2: figures of contact, friction and wear of the cube."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from sonolube.checks import Floats
from sonolube.facts.published import published_number, published_value, si_value, table
from sonolube.figure import COLOURS, MARKERS, ReportFigure
from sonolube.models.contact import (
    ASPERITY_LAWS,
    GaussianHeights,
    RoughContact,
    exponential_validity_range,
    normal_force,
    real_contact_area,
    separation,
)
from sonolube.models.friction import dong_2015_half_period_ratio
from sonolube.models.wear import cube_wear_rate, vibrating_cube_wear_rate
from sonolube.reproduction.cube import Horn, poisson_friction_ratio, without_yielding
from sonolube.reproduction.plots import axes_row, draw_measured, draw_printed, line_style, point_style, single_axes
from sonolube.validation.contacts import Bodies, poisson_contact, wear_contact
from sonolube.validation.published_tests import friction_tests

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_PAIRS: tuple[tuple[str, Bodies], ...] = (("aluminium on steel", "aluminium_steel"), ("steel on steel", "steel_steel"))


def cube_figures() -> Iterator[ReportFigure]:
    """Figures of sections 3.1 and 3.2."""
    yield ReportFigure(
        name="figure-3-2a-separation",
        title="Separation against load",
        caption="Yielding asperities let the surfaces come closer. Under exponential heights the difference of "
        "the models is the same at every load: 6.8 um for aluminium on steel, 9.0 um for steel on steel. "
        "Computed from Table 3.1; circles: separations stated in section 3.1.4 at 40 N.",
        draw=_separations,
    )
    yield ReportFigure(
        name="figure-3-2b-real-area",
        title="Real contact area against load",
        caption="In both models the area is proportional to the load, so that it grows sixfold from 40 to 240 N. "
        "Computed from Table 3.1.",
        draw=_areas,
    )
    yield ReportFigure(
        name="figure-3-4-friction-reduction",
        title="Friction reduction of the Poisson-effect tests",
        caption="Lines: the cube over the separating half period at the amplitude that section 2.1.2 states, and "
        "at the one that section 4.3.5 gives for the same welder. Bands: the ranges that the text states for the "
        "tests, whose single points are not available.",
        draw=_reductions,
    )
    yield ReportFigure(
        name="height-laws",
        title="Load against separation under four laws",
        caption="The surfaces of Table 3.1 under exponential and Gaussian heights, elastic and elastic-plastic. "
        "Shaded: range in which the exponential law agrees with the Gaussian one within a factor of two.",
        draw=_height_laws,
    )
    yield ReportFigure(
        name="tables-3-3-and-3-4-wear",
        title="Wear rates of test and model",
        caption="Points: Tables 3.3 and 3.4. Lines: the cube with Table 3.2 and 2.5 um, which depends on "
        "neither speed nor number of revolutions.",
        draw=_wear_rates,
    )
    yield ReportFigure(
        name="friction-ratio-against-amplitude",
        title="Friction ratio of the cube against amplitude, and of the tests",
        caption="The cube's friction ratio depends on amplitude alone; the tests at 2.5 um (Table 2.3, with "
        "the scatter stated there) depend on the sliding speed, which only a time-dependent model can reproduce.",
        draw=_ratio_against_amplitude,
    )


def _separations() -> "Figure":
    """Draw separation against load with and without yielding."""
    figure, axes = _over_load(lambda contact, loads: 1e6 * separation(contact, normal_load=loads))
    stated = [published_number(f"3.1.4-separation-{law}") for law in ("elastic", "elastic-plastic")]
    style = {"fmt": "o", "mfc": "white", "color": "black", "zorder": 3}
    draw_printed(axes, [40, 40], stated, 1e6, **style, label="stated in D 3.1.4")
    axes.set(ylabel="Separation of the mean planes [µm]", ylim=(10, 38))
    axes.legend(loc="upper right")
    return figure


def _areas() -> "Figure":
    """Draw real contact area against load with and without yielding."""

    def area(contact: RoughContact, loads: Floats) -> Floats:
        return 1e6 * real_contact_area(contact, separation=separation(contact, normal_load=loads))

    figure, axes = _over_load(area)
    axes.set(ylabel="Real contact area [mm²]", yscale="log", ylim=(4e-4, 30))
    axes.legend(loc="upper left")
    return figure


def _over_load(quantity: Callable[[RoughContact, Floats], Floats]) -> "tuple[Figure, Axes]":
    """Draw a quantity of the contacts of both pairs against load, with and without yielding."""
    figure, axes = single_axes((4.8, 3.5))
    loads = np.linspace(40, 240, 101)
    for index, (pair, bodies) in enumerate(_PAIRS):
        contact = poisson_contact(bodies=bodies)
        for law, line, variant in (("elastic", "--", without_yielding(contact)), ("elastic-plastic", "-", contact)):
            axes.plot(loads, quantity(variant, loads), line, color=COLOURS[index], label=f"{pair}, {law}")
    axes.set(xlabel="Normal load [N]")
    return figure, axes


def _reductions() -> "Figure":
    """Draw the friction reductions of the Poisson-effect tests by the cube."""
    figure, panels = axes_row(3, (8.6, 3.3), sharey=True)
    loads = np.linspace(40, 240, 101)
    tests: tuple[tuple[str, Bodies, Horn, str], ...] = (
        ("aluminium horn on steel", "aluminium_steel", "aluminium", "3.1.4-reduction-1-2"),
        ("steel horn on aluminium", "aluminium_steel", "steel", "2.1.5-reduction-steel-on-aluminium"),
        ("steel horn on steel", "steel_steel", "steel", "2.1.5-reduction-steel-on-steel"),
    )
    for axes, (title, bodies, horn, test) in zip(panels, tests, strict=True):
        stated = published_value(test)
        label = f"test, range in D {stated.source.removeprefix('Section ')}"
        axes.axhspan(100 * stated.number.low, 100 * stated.number.high, color="0.85", label=label)
        for index, name in enumerate(("2.1.2-welder-amplitude", "4.3.5-waveguide-amplitude")):
            amplitude = si_value(name)
            ratio = poisson_friction_ratio(bodies=bodies, horn=horn, normal_load=loads, axial_amplitude=amplitude)
            axes.plot(loads, 100 * (1 - ratio), **line_style(index), label=f"cube, {1e6 * amplitude:g} µm axial")
        axes.set(title=title, xlabel="Normal load [N]", ylim=(0, 80))
        axes.legend(loc="lower left")
    panels[0].set_ylabel("Friction reduction [%]")
    return figure


def _height_laws() -> "Figure":
    """Draw load against separation for exponential and Gaussian heights."""
    figure, axes = single_axes((4.8, 3.5))
    exponential = poisson_contact(bodies="aluminium_steel")
    eta = exponential.roughness.roughness_parameter
    gaussian = replace(exponential, heights=GaussianHeights.from_roughness_parameter(roughness_parameter=eta))
    Rq = exponential.roughness.rms_height  # noqa: N806
    gaps = np.linspace(0.2, 5, 200) * Rq
    for index, (label, contact) in enumerate((("exponential", exponential), ("Gaussian", gaussian))):
        for law, line in (("elastic", "--"), ("dong_2015", "-")):
            force = normal_force(replace(contact, asperity=ASPERITY_LAWS[law]), separation=gaps)
            name = "elastic-plastic" if law == "dong_2015" else law
            axes.plot(gaps / Rq, force, line, color=COLOURS[index], label=f"{label} heights, {name}")
    window = exponential_validity_range(exponential)
    if window is not None:
        axes.axvspan(*window, color="0.9", zorder=0, label="within a factor of 2")
    axes.axhspan(40, 240, color=COLOURS[4], alpha=0.25, zorder=0, label="loads of the tests")
    axes.set(xlabel="Separation over rms height d/Rq", ylabel="Normal load [N]", yscale="log", xlim=(0.2, 5))
    axes.legend(loc="lower left")
    return figure


def _wear_rates() -> "Figure":
    """Draw the wear rates of Tables 3.3 and 3.4 with those of the cube."""
    figure, panels = axes_row(2, (7.2, 3.3), sharey=True)
    contact, load, amplitude = wear_contact(), si_value("table-3.2-normal_load-1"), si_value("2.3.1-amplitude")
    rates = {
        "off": float(cube_wear_rate(contact, normal_load=load)),
        "on": float(vibrating_cube_wear_rate(contact, normal_load=load, vibration_amplitude=amplitude)),
    }
    names = {"off": "without vibration", "on": "with vibration, 2.5 µm"}
    places = (("3.3", "sliding_speed", 1e3, "Sliding speed [mm/s]"), ("3.4", "revolutions", 1, "Number of revolutions"))
    for axes, (table_id, along, factor, label) in zip(panels, places, strict=True):
        columns = table(table_id).columns
        for index, condition in enumerate(("off", "on")):
            chosen = np.array([printed == condition for printed in columns["ultrasound"].printed])
            x, measured = factor * columns[along].values[chosen], 1e9 * columns["test"].values[chosen]
            axes.plot(x, measured, **point_style(index), label=f"test {names[condition]}")
            axes.axhline(1e9 * rates[condition], **line_style(index), label=f"cube {names[condition]}")
        axes.set(xlabel=label, title=f"Table {table_id}", ylim=(0, 0.03))
    panels[0].set_ylabel("Wear rate [mm³/m]")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=2)
    return figure


def _ratio_against_amplitude() -> "Figure":
    """Draw the friction ratio of the cube against amplitude with those of Table 2.3."""
    figure, axes = single_axes((4.8, 3.5))
    contact, load = wear_contact(), si_value("table-3.2-normal_load-1")
    amplitudes = np.linspace(0, 5e-6, 201)
    ratios = dong_2015_half_period_ratio(contact, normal_load=load, vibration_amplitude=amplitudes)
    axes.plot(1e6 * amplitudes, ratios, color=COLOURS[0], label="cube over the separating half period, 3 N")
    for index, test in enumerate(friction_tests("A")):
        label = f"test at {1e3 * test.sliding_speed:g} mm/s, Table 2.3"
        style = {"fmt": MARKERS[index], "color": COLOURS[index + 1]}
        draw_measured(axes, (test,), lambda test: 1e6 * test.vibration_amplitude, label, **style)
    axes.set(xlabel="Vibration amplitude, zero to peak [µm]", ylabel="Friction ratio", xlim=(0, 5), ylim=(0, 1.05))
    axes.legend(loc="upper right")
    return figure
