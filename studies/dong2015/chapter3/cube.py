"""Sections 3.1 to 3.3: rows and figures of contact, friction and wear of the cube."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from itertools import product
from typing import TYPE_CHECKING, Final

import numpy as np

from dong2015.plots import axes_row, draw_measured, draw_printed, line_style, point_style, report_figure, single_axes
from dong2015.published_rigs import STEEL_ON_STEEL_NOTE, Horn, poisson_friction_ratio, without_yielding
from dong2015.row import Row, RowKind, formula_row, published_formula_row, published_model_row, undetermined_row
from sonolube.checks import Floats
from sonolube.facts.published import propagate_rounding, published_number, published_value, si_value, table
from sonolube.figure import COLOURS, MARKERS, ReportFigure
from sonolube.models.contact import (
    ASPERITY_LAWS,
    GaussianHeights,
    RoughContact,
    exponential_validity_range,
    normal_force,
    real_contact_area,
    separation,
    sinusoidal_motion,
)
from sonolube.models.friction import dong_2015_half_period_ratio
from sonolube.models.wear import cube_wear_rate, full_period_wear_ratio, vibrating_cube_wear_rate
from sonolube.validation.contacts import (
    STEEL_YIELD_STRENGTH,
    STEEL_YIELD_STRENGTHS,
    Bodies,
    poisson_contact,
    wear_contact,
)
from sonolube.validation.published_tests import friction_tests

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_REDUCTIONS: Final[tuple[tuple[str, Bodies, Horn, str], ...]] = (
    ("3.1.4-reduction-1-2", "aluminium_steel", "aluminium", ""),
    ("3.1.4-reduction-3", "steel_steel", "steel", f" {STEEL_ON_STEEL_NOTE}."),
)


def cube_rows() -> Iterator[Row]:
    """Yield the rows of sections 3.1 and 3.2, and of the stack and the contact in section 3.3."""
    yield from _contact()
    yield from _friction()
    yield from _wear()
    yield _coupling_factor()


def _contact() -> Iterator[Row]:
    """Yield separations and real contact areas of section 3.1.4, and the effective modulus."""
    loads = _loads()
    aluminium, steel = poisson_contact(bodies="aluminium_steel"), poisson_contact(bodies="steel_steel")
    gap, elastic_gap = (separation(contact, normal_load=loads) for contact in (aluminium, without_yielding(aluminium)))
    steel_difference = separation(without_yielding(steel), normal_load=loads) - separation(steel, normal_load=loads)
    area = real_contact_area(aluminium, separation=gap)
    elastic_area = real_contact_area(without_yielding(aluminium), separation=elastic_gap)
    area_difference = np.abs(area - elastic_area)
    low, high, step = loads[0], loads[-1], si_value("3.1.4-load-step")
    for published, computed, note in (
        ("3.1.4-separation-elastic-plastic", gap[0], "D 3.3 to 3.5 times An E*, at 40 N."),
        ("3.1.4-separation-elastic", elastic_gap[0], "Without yielding, at 40 N."),
        (
            "3.1.4-separation-difference",
            np.mean(elastic_gap - gap),
            "The same at every load: both laws fall as exp(-lambda d/Rq).",
        ),
        ("3.1.4-separation-difference-steel", np.mean(steel_difference), f"{STEEL_ON_STEEL_NOTE}."),
        ("3.1.4-area-factor", area[-1] / area[0], "Real area at 240 N over that at 40 N."),
        ("3.1.4-area-difference", area_difference[0], f"At 40 N; {area_difference[-1] * 1e12:.2g} um2 at 240 N."),
        ("3.1.4-load-count-1", (high - low) / step + 1, "From 40 to 240 N in steps of 20 N."),
    ):
        yield published_formula_row(published, float(computed), note)
    yield published_formula_row(
        "3.1.4-load-step", (high - low) / (si_value("3.1.4-load-count-1") - 1), "From 40 to 240 N in 11 loads."
    )
    for name in ("load-count-2", "load-count-3"):
        yield undetermined_row(f"3.1.4-{name}", "the loads, unevenly spaced and only drawn (Fig. 3.3).")
    yield formula_row("3.1.4-coefficient-1", "The same test in section 2.1.5.", float, "2.1.5-coefficient-off")
    yield undetermined_row("3.1.4-coefficient-2", "the friction forces, which are only drawn (Fig. 3.3).")
    constants = product(("youngs_modulus", "poisson_ratio"), ("aluminium", "steel"))
    yield formula_row(
        "table-3.2-effective_modulus-1",
        "1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2 with Table 3.1.",
        lambda e1, e2, n1, n2: 1 / ((1 - n1**2) / e1 + (1 - n2**2) / e2),
        *(f"table-3.1-{name}_{metal}-1" for name, metal in constants),
    )


def _friction() -> Iterator[Row]:
    """Yield the friction reductions of section 3.1.4 by the cube, and its mean errors over the loads."""
    for published, bodies, horn, remark in _REDUCTIONS:
        reductions = partial(_reductions, bodies=bodies, horn=horn)
        at_welder_amplitude = reductions("2.1.2-welder-amplitude")
        at_waveguide_amplitude = reductions("4.3.5-waveguide-amplitude")
        possible = [reductions("2.1.2-welder-amplitude", yield_strength=strength) for strength in STEEL_YIELD_STRENGTHS]
        is_open = bodies == "steel_steel"
        note = (
            "Cube over the separating half period (D 3.15), mean over the loads at the 8.5 um of D 2.1.2, "
            f"{_percent_range(at_welder_amplitude)}; at the 11.24 um of D 4.3.5 "
            f"{_percent_range(at_waveguide_amplitude)}. The test falls with load, the cube rises slightly.{remark}"
        )
        weakest, strongest = (float(np.mean(reduction)) for reduction in possible)
        yield published_model_row(
            published, float(np.mean(at_welder_amplitude)), note, possible=(weakest, strongest) if is_open else None
        )
        weakest, strongest = (_mean_error(reduction, published) for reduction in possible)
        note = (
            "Mean error of friction over the loads (D 3.16), of the cube at {} against a reduction that falls in "
            f"proportion to the load over the printed range, {published_number(published).text} %: the measured "
            "points are only drawn (Fig. 3.4)"
        )
        yield published_model_row(
            "3.1.5-error",
            _mean_error(at_welder_amplitude, published),
            note.format("8.5 um (D 2.1.2)"),
            suffix=published.removeprefix("3.1.4-reduction-"),
            possible=(weakest, strongest) if is_open else None,
            alternatives={
                "11.24 um of D 4.3.5": (
                    _mean_error(at_waveguide_amplitude, published),
                    note.format("11.24 um (D 4.3.5)"),
                )
            },
        )
    missing = "the measured points of figure 3.4, which are not available as data."
    yield undetermined_row("3.1.4-error", missing, kind=RowKind.PUBLISHED_MODEL)


def _mean_error(reduction: Floats, published: str) -> float:
    """Mean error of friction over the loads against a test whose reduction falls over a printed range. []"""
    measured = published_number(published)
    test = 1 - np.linspace(measured.high, measured.low, reduction.size)
    return float(np.mean(np.abs(1 - reduction - test) / test))


def _reductions(amplitude: str, *, bodies: Bodies, horn: Horn, yield_strength: float = STEEL_YIELD_STRENGTH) -> Floats:
    """Friction reduction by the cube at each load, at a published axial amplitude, given by its id. []"""
    return 1 - poisson_friction_ratio(
        bodies=bodies,
        horn=horn,
        normal_load=_loads(),
        axial_amplitude=si_value(amplitude),
        yield_strength=yield_strength,
    )


def _wear() -> Iterator[Row]:
    """Yield the wear rates and errors of Tables 3.3 and 3.4 by the cube."""
    contact, load = wear_contact(), si_value("table-3.2-normal_load-1")
    frequency, amplitude = si_value("2.3.1-frequency"), si_value("2.3.1-amplitude")
    off = float(cube_wear_rate(contact, normal_load=load))
    on = propagate_rounding(
        lambda a: float(vibrating_cube_wear_rate(contact, normal_load=load, vibration_amplitude=a)), "2.3.1-amplitude"
    )
    printed_diameter = off * math.pi / 4  # sqrt(An) over 4 sqrt(An)/pi
    motion = sinusoidal_motion(contact, normal_load=load, vibration_amplitude=amplitude, frequency=frequency)
    whole_period = float(full_period_wear_ratio(contact, motion))
    notes = {
        "off": f"D 3.26 over D = sqrt(An); with the printed 4 sqrt(An)/pi it is {printed_diameter * 1e9:.4g} mm3/m.",
        "on": f"D 3.26 averaged over the separating half period, {on.value * 1e9:.5g} mm3/m at 2.5 um; over the "
        f"whole period, as D 3.28 prints, vibration would multiply wear by {whole_period:.3g}.",
    }
    largest = 0.0
    for table_id in ("3.3", "3.4"):
        for row, condition in enumerate(table(table_id).columns["ultrasound"].printed, start=1):
            yield published_formula_row(
                f"table-{table_id}-model-{row}", on if condition == "on" else off, notes[condition]
            )
            rate = on.value if condition == "on" else off
            error = propagate_rounding(
                lambda measured, rate=rate: abs(measured - rate) / measured, f"table-{table_id}-test-{row}"
            )
            largest = max(largest, error.value)
            yield published_model_row(f"table-{table_id}-error-{row}", error, "D 3.16 with the computed rate.")
    for published in ("3.2.2-error", "3.2.3-error"):
        yield published_model_row(published, largest, "Largest error of Tables 3.3 and 3.4.")


def _coupling_factor() -> Row:
    """Coupling factor of Table 3.5 from its other constants."""
    return formula_row(
        "table-3.5-coupling_factor-1",
        "k^2 = (N d33)^2 k_p/C with C free.",
        lambda n, d33, k, c: n * d33 * math.sqrt(k / c),
        *(f"table-3.5-{name}-1" for name in ("stack_layers", "charge_constant_33", "stack_stiffness", "capacitance")),
    )


def _loads() -> Floats:
    """Loads of section 3.1.4. [N]"""
    loads, step = published_number("3.1.4-normal-load"), si_value("3.1.4-load-step")
    return np.arange(loads.low, loads.high + step / 2, step)


def _percent_range(values: Floats) -> str:
    """Range of values as text in per cent."""
    return f"{100 * values.min():.1f} to {100 * values.max():.1f} %"


_PAIRS: tuple[tuple[str, Bodies], ...] = (("aluminium on steel", "aluminium_steel"), ("steel on steel", "steel_steel"))


def cube_figures() -> Iterator[ReportFigure]:
    """Figures of sections 3.1 and 3.2."""
    yield report_figure("figure-3-2a-separation", _separations)
    yield report_figure("figure-3-2b-real-area", _areas)
    yield report_figure("figure-3-3-friction-without-vibration", _friction_without_vibration)
    yield report_figure("figure-3-4-friction-reduction", _draw_reductions)
    yield report_figure("height-laws", _height_laws)
    yield report_figure("tables-3-3-and-3-4-wear", _wear_rates)
    yield report_figure("friction-ratio-against-amplitude", _ratio_against_amplitude)


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


def _draw_reductions() -> "Figure":
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


def _friction_without_vibration() -> "Figure":
    """Draw the friction over load by the mean coefficients of the tests."""
    figure, axes = single_axes((4.8, 3.4))
    loads = published_number("3.1.4-normal-load")
    for index, title in enumerate(("aluminium horn on steel, test 1", "steel horn on aluminium, test 2")):
        coefficient = published_number(f"3.1.4-coefficient-{index + 1}")
        x = np.array([loads.low, loads.high])
        axes.plot(x, coefficient.value * x, **line_style(index), label=f"{title}: {coefficient.text}")
        axes.fill_between(x, coefficient.low * x, coefficient.high * x, color=COLOURS[index], alpha=0.3)
    axes.set(xlabel="Normal load [N]", ylabel="Friction force [N]", xlim=(0, loads.high), ylim=(0, None))
    axes.legend(loc="upper left")
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
