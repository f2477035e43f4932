"""Sections 3.1 to 3.3: rows of contact, friction and wear of the cube, and the coupling factor."""

import math
from collections.abc import Iterator
from functools import partial
from itertools import product
from typing import Final

import numpy as np

from sonolube.checks import Floats
from sonolube.facts.published import propagate_rounding, published_number, si_value, table
from sonolube.models.contact import real_contact_area, separation, sinusoidal_motion
from sonolube.models.wear import cube_wear_rate, full_period_wear_ratio, vibrating_cube_wear_rate
from sonolube.reproduction.cube import STEEL_ON_STEEL_NOTE, Horn, poisson_friction_ratio, without_yielding
from sonolube.reproduction.row import (
    Row,
    RowKind,
    formula_row,
    published_formula_row,
    published_model_row,
    undetermined_row,
)
from sonolube.validation.contacts import (
    STEEL_YIELD_STRENGTH,
    STEEL_YIELD_STRENGTHS,
    Bodies,
    poisson_contact,
    wear_contact,
)

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
