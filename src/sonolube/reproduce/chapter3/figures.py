"""Figures of chapter 3: the contact, the friction and the wear of the cube."""

from dataclasses import replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from sonolube.contact import (
    ASPERITY_LAWS,
    GaussianHeights,
    exponential_validity_range,
    normal_force,
    real_contact_area,
    separation,
)
from sonolube.figure import COLOURS, LINES, MARKERS, ReportFigure
from sonolube.friction import dong_2015_half_period_ratio
from sonolube.published import statement, table
from sonolube.validation.contacts import Bodies, elastic, poisson_contact, poisson_friction_ratio, wear_contact

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_PAIRS: tuple[tuple[str, Bodies], ...] = (
    ("aluminium on steel", "aluminium_steel"),
    ("steel on steel", "steel_steel"),
)


def cube_figures() -> tuple[ReportFigure, ...]:
    """Return the figures of sections 3.1 and 3.2."""
    return (
        ReportFigure(
            name="figure-3-2a-separation",
            chapter=3,
            title="Separation against load",
            caption="Yielding asperities let the surfaces come closer. Under exponential heights the gap between "
            "the models is the same at every load: 6.8 um for aluminium on steel, 9.0 um for steel on steel. "
            "Computed from Table 3.1; circles: what section 3.1.4 states at 40 N.",
            draw=_separations,
        ),
        ReportFigure(
            name="figure-3-2b-real-area",
            chapter=3,
            title="Real contact area against load",
            caption="In both models the area is proportional to the load, so that it grows sixfold from 40 to 240 N. "
            "Computed from Table 3.1.",
            draw=_areas,
        ),
        ReportFigure(
            name="figure-3-4-friction-reduction",
            chapter=3,
            title="Friction reduction of the Poisson-effect tests",
            caption="Lines: the cube over the separating half period at the amplitude that section 2.1.2 states, and "
            "at the one that section 4.3.5 gives for the same welder. Bands: the ranges that the text states for the "
            "tests, whose single points came along in no form.",
            draw=_reductions,
        ),
        ReportFigure(
            name="height-laws",
            chapter=3,
            title="Load against separation under four laws",
            caption="The surfaces of Table 3.1 under exponential and Gaussian heights, elastic and elastic-plastic. "
            "Shaded: where the exponential law stands within a factor of two for the Gaussian one.",
            draw=_height_laws,
        ),
        ReportFigure(
            name="tables-3-3-and-3-4-wear",
            chapter=3,
            title="Wear rates of test and model",
            caption="Points: Tables 3.3 and 3.4. Lines: the cube with Table 3.2 and 2.5 um, which knows neither "
            "speed nor number of revolutions.",
            draw=_wear_rates,
        ),
        ReportFigure(
            name="friction-ratio-against-amplitude",
            chapter=3,
            title="What the cube makes of amplitude, and the tests of speed",
            caption="The cube's friction ratio depends on amplitude alone; the tests at 2.5 um (Table 2.3, with "
            "the scatter stated there) depend on the sliding speed, which only a model with time in it can tell apart.",
            draw=_ratio_against_amplitude,
        ),
    )


def _separations() -> "Figure":
    figure, axes = _axes()
    loads = np.linspace(40, 240, 101)
    for index, (label, bodies) in enumerate(_PAIRS):
        contact = poisson_contact(bodies=bodies)
        for law, line, variant in (("elastic", "--", elastic(contact)), ("elastic-plastic", "-", contact)):
            axes.plot(
                loads, 1e6 * separation(variant, normal_load=loads), line, color=COLOURS[index], label=f"{label}, {law}"
            )
    for name in ("3.1.4-separation-elastic", "3.1.4-separation-elastic-plastic"):
        number = statement(name).number
        axes.errorbar(
            40,
            1e6 * number.value,
            yerr=1e6 * number.half_digit,
            fmt="o",
            mfc="white",
            color="black",
            capsize=3,
            zorder=3,
        )
    axes.plot([], [], "o", mfc="white", color="black", label="stated in D 3.1.4")
    axes.set(xlabel="Normal load [N]", ylabel="Separation of the mean planes [µm]", ylim=(10, 38))
    axes.legend(loc="upper right")
    return figure


def _areas() -> "Figure":
    figure, axes = _axes()
    loads = np.linspace(40, 240, 101)
    for index, (label, bodies) in enumerate(_PAIRS):
        contact = poisson_contact(bodies=bodies)
        for law, line, variant in (("elastic", "--", elastic(contact)), ("elastic-plastic", "-", contact)):
            area = real_contact_area(variant, separation=separation(variant, normal_load=loads))
            axes.plot(loads, 1e6 * area, line, color=COLOURS[index], label=f"{label}, {law}")
    axes.set(xlabel="Normal load [N]", ylabel="Real contact area [mm²]", yscale="log", ylim=(4e-4, 30))
    axes.legend(loc="upper left")
    return figure


def _reductions() -> "Figure":
    from matplotlib import pyplot as plt

    figure, panels = plt.subplots(1, 3, figsize=(8.6, 3.3), sharey=True)
    loads = np.linspace(40, 240, 101)
    tests: tuple[tuple[str, Bodies, Literal["aluminium", "steel"], str], ...] = (
        ("aluminium horn on steel", "aluminium_steel", "aluminium", "3.1.4-reduction-1-2"),
        ("steel horn on aluminium", "aluminium_steel", "steel", "2.1.5-reduction-steel-on-aluminium"),
        ("steel horn on steel", "steel_steel", "steel", "2.1.5-reduction-steel-on-steel"),
    )
    for axes, (title, bodies, horn, test) in zip(panels, tests, strict=True):
        stated = statement(test)
        axes.axhspan(
            100 * stated.number.low, 100 * stated.number.high, color="0.85", label=f"test, range in D {stated.section}"
        )
        for index, name in enumerate(("2.1.2-welder-amplitude", "4.3.5-waveguide-amplitude")):
            amplitude = statement(name).number.value
            ratio = poisson_friction_ratio(bodies=bodies, horn=horn, normal_load=loads, axial_amplitude=amplitude)
            axes.plot(
                loads,
                100 * (1 - ratio),
                linestyle=LINES[index],
                color=COLOURS[index],
                label=f"cube, {1e6 * amplitude:g} µm axial",
            )
        axes.set(title=title, xlabel="Normal load [N]", ylim=(0, 80))
        axes.legend(loc="lower left")
    panels[0].set_ylabel("Friction reduction [%]")
    return figure


def _height_laws() -> "Figure":
    figure, axes = _axes()
    exponential = poisson_contact(bodies="aluminium_steel")
    gaussian = replace(
        exponential,
        heights=GaussianHeights.from_roughness_parameter(roughness_parameter=exponential.roughness.roughness_parameter),
    )
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
    from matplotlib import pyplot as plt

    from sonolube.wear import cube_wear_rate, vibrating_cube_wear_rate

    figure, panels = plt.subplots(1, 2, figsize=(7.2, 3.3), sharey=True)
    contact, load = wear_contact(), float(table("3.2").columns["normal_load"].values[0])
    amplitude = statement("2.3.1-amplitude").number.value
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
            axes.plot(
                factor * columns[along].values[chosen],
                1e9 * columns["test"].values[chosen],
                MARKERS[index],
                color=COLOURS[index],
                label=f"test {names[condition]}",
            )
            axes.axhline(
                1e9 * rates[condition], linestyle=LINES[index], color=COLOURS[index], label=f"cube {names[condition]}"
            )
        axes.set(xlabel=label, title=f"Table {table_id}", ylim=(0, 0.03))
    panels[0].set_ylabel("Wear rate [mm³/m]")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=2)
    return figure


def _ratio_against_amplitude() -> "Figure":
    figure, axes = _axes()
    contact, load = wear_contact(), float(table("3.2").columns["normal_load"].values[0])
    amplitudes = np.linspace(0, 5e-6, 201)
    ratios = dong_2015_half_period_ratio(contact, normal_load=load, vibration_amplitude=amplitudes)
    axes.plot(1e6 * amplitudes, ratios, color=COLOURS[0], label="cube over the separating half period, 3 N")
    columns = table("2.3").columns
    off, on = (
        [
            cells
            for cells, printed in zip(columns["friction_force"].cells, columns["ultrasound"].printed, strict=True)
            if printed == state
        ]
        for state in ("off", "on")
    )
    speeds = sorted(set(columns["sliding_speed"].values))
    for index, (speed, without, with_) in enumerate(zip(speeds, off, on, strict=True)):
        assert without is not None
        assert with_ is not None
        ratio = with_.value / without.value
        scatter = ratio * np.hypot(with_.high / with_.value - 1, without.high / without.value - 1)
        axes.errorbar(
            1e6 * statement("2.3.1-amplitude").number.value,
            ratio,
            yerr=scatter,
            fmt=MARKERS[index],
            color=COLOURS[index + 1],
            capsize=3,
            label=f"test at {1e3 * speed:g} mm/s, Table 2.3",
        )
    axes.set(xlabel="Vibration amplitude, zero to peak [µm]", ylabel="Friction ratio", xlim=(0, 5), ylim=(0, 1.05))
    axes.legend(loc="upper right")
    return figure


def _axes() -> "tuple[Figure, Axes]":
    from matplotlib import pyplot as plt

    return plt.subplots(figsize=(4.8, 3.5))
