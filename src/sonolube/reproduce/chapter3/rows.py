"""Chapter 3: contact, friction and wear of the cube, and the multi-scale model of the tribometer."""

import math
from collections.abc import Iterator
from typing import Literal

import numpy as np

from sonolube.checks import Floats
from sonolube.contact import cube_tangential_stiffness, decay_length, normal_force, real_contact_area, separation
from sonolube.figure import ReportFigure
from sonolube.published import statement, table
from sonolube.published.values import cell, over_rounding, stated
from sonolube.reproduce.chapter3 import study as chapter3_study
from sonolube.reproduce.chapter3.figures import cube_figures
from sonolube.reproduce.chapter3.study_figures import study_figures
from sonolube.reproduce.row import Row, compare, undetermined
from sonolube.validation.contacts import (
    STEEL_ON_STEEL_NOTE,
    Bodies,
    elastic,
    poisson_contact,
    poisson_friction_ratio,
    wear_contact,
)
from sonolube.wear import cube_wear_rate, vibrating_cube_wear_rate

__all__ = ["figures", "rows"]

_LOST_CONTACT = 0.01  # share of the load below which a contact that falls exponentially counts as lost
_POISSON_TESTS: tuple[tuple[Bodies, Literal["aluminium", "steel"]], ...] = (
    ("aluminium_steel", "aluminium"),
    ("steel_steel", "steel"),
)


def figures() -> tuple[ReportFigure, ...]:
    """Return the figures of chapter 3."""
    return (*cube_figures(), *study_figures())


def rows() -> Iterator[Row]:
    """Return the rows of chapter 3."""
    yield from _contact_rows()
    yield from _friction_rows()
    yield from _wear_rows()
    yield from _multi_scale_rows()
    yield from chapter3_study.rows()


def _contact_rows() -> Iterator[Row]:
    loads = _loads()
    aluminium, steel = poisson_contact(bodies="aluminium_steel"), poisson_contact(bodies="steel_steel")
    plastic_gap, elastic_gap = (separation(contact, normal_load=loads) for contact in (aluminium, elastic(aluminium)))
    steel_gain = separation(elastic(steel), normal_load=loads) - separation(steel, normal_load=loads)
    yield compare(
        stated("3.1.4-separation-elastic-plastic"), float(plastic_gap[0]), "D 3.3 to 3.5 times An E*, at 40 N."
    )
    yield compare(stated("3.1.4-separation-elastic"), float(elastic_gap[0]), "Without yielding, at 40 N.")
    yield compare(
        stated("3.1.4-separation-difference"),
        float(np.mean(elastic_gap - plastic_gap)),
        "The same at every load: both laws fall as exp(-lambda d/Rq).",
    )
    yield compare(stated("3.1.4-separation-difference-steel"), float(np.mean(steel_gain)), f"{STEEL_ON_STEEL_NOTE}.")

    areas = real_contact_area(aluminium, separation=plastic_gap)
    elastic_areas = real_contact_area(elastic(aluminium), separation=elastic_gap)
    gap = np.abs(areas - elastic_areas)
    yield compare(stated("3.1.4-area-factor"), float(areas[-1] / areas[0]), "Real area at 240 N over that at 40 N.")
    yield compare(
        stated("3.1.4-area-difference"),
        float(gap[0]),
        f"At 40 N; {gap[-1] * 1e12:.2g} um2 at 240 N.",
    )
    step = statement("3.1.4-load-step").number
    low, high = loads[0], loads[-1]
    yield compare(
        stated("3.1.4-load-count-1"), float((high - low) / step.value + 1), "From 40 to 240 N in steps of 20 N."
    )
    moduli = [table("3.1").columns[f"youngs_modulus_{body}"].cells[0] for body in ("aluminium", "steel")]
    ratios = [table("3.1").columns[f"poisson_ratio_{body}"].cells[0] for body in ("aluminium", "steel")]
    inputs = [number for number in (*moduli, *ratios) if number is not None]
    yield compare(
        cell("3.2", "effective_modulus", 0),
        over_rounding(lambda e1, e2, n1, n2: 1 / ((1 - n1**2) / e1 + (1 - n2**2) / e2), *inputs),
        "1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2 with Table 3.1.",
    )


def _friction_rows() -> Iterator[Row]:
    own, later = (statement(name).number.value for name in ("2.1.2-welder-amplitude", "4.3.5-waveguide-amplitude"))
    on_aluminium, on_steel = (
        [
            1 - poisson_friction_ratio(bodies=bodies, horn=horn, normal_load=_loads(), axial_amplitude=amplitude)
            for amplitude in (own, later)
        ]
        for bodies, horn in _POISSON_TESTS
    )
    yield compare(stated("3.1.4-reduction-1-2"), float(np.mean(on_aluminium[0])), _reduction_note(*on_aluminium))
    yield compare(
        stated("3.1.4-reduction-3"),
        float(np.mean(on_steel[0])),
        f"{_reduction_note(*on_steel)} {STEEL_ON_STEEL_NOTE}.",
    )
    yield undetermined(stated("3.1.4-error"), "the measured points of figure 3.4, of which no data came along.")


def _reduction_note(own: Floats, later: Floats) -> str:
    return (
        f"Cube over the separating half period (D 3.15), mean over the loads at the 8.5 um of D 2.1.2, "
        f"{_percent(own)}; at the 11.24 um of D 4.3.5 {_percent(later)}. The test falls with load, the cube "
        "rises slightly."
    )


def _wear_rows() -> Iterator[Row]:
    contact = wear_contact()
    load = float(table("3.2").columns["normal_load"].values[0])
    amplitude = statement("2.3.1-amplitude").number
    still = float(cube_wear_rate(contact, normal_load=load))
    vibrating = over_rounding(
        lambda a: float(vibrating_cube_wear_rate(contact, normal_load=load, vibration_amplitude=a)), amplitude
    )
    printed_distance = still * math.pi / 4  # sqrt(An) over 4 sqrt(An)/pi
    whole_period = _full_period_ratio(load, amplitude.value)
    notes = {
        "off": f"D 3.26 over D = sqrt(An); with the printed 4 sqrt(An)/pi it is {printed_distance * 1e9:.4g} mm3/m.",
        "on": f"D 3.26 averaged over the separating half period, {vibrating.value * 1e9:.5g} mm3/m at 2.5 um; over the "
        f"whole period, as D 3.28 prints, vibration would multiply wear by {whole_period:.3g}.",
    }
    worst = 0.0
    for table_id in ("3.3", "3.4"):
        tests = table(table_id).columns["test"].cells
        for row, condition in enumerate(table(table_id).columns["ultrasound"].printed):
            computed = vibrating if condition == "on" else still
            yield compare(cell(table_id, "model", row), computed, notes[condition])
            value, test = vibrating.value if condition == "on" else still, tests[row]
            assert test is not None
            error = over_rounding(lambda measured, rate=value: abs(measured - rate) / measured, test)
            worst = max(worst, error.value)
            yield compare(cell(table_id, "error", row), error, "D 3.16 with the computed rate.")
    for name in ("3.2.2-error", "3.2.3-error"):
        yield compare(stated(name), worst, "Largest error of Tables 3.3 and 3.4.")


def _full_period_ratio(load: float, amplitude: float) -> float:
    contact = wear_contact()
    d = separation(contact, normal_load=load)
    gap = d + amplitude * np.sin(np.linspace(0, 2 * np.pi, 400, endpoint=False))
    volume = real_contact_area(contact, separation=gap) * gap
    return float(np.mean(volume) / (real_contact_area(contact, separation=d) * d))


def _multi_scale_rows() -> Iterator[Row]:
    stack = {name: column.cells[0] for name, column in table("3.5").columns.items()}
    inputs = [stack[name] for name in ("stack_layers", "charge_constant_33", "stack_stiffness", "capacitance")]
    coupling = over_rounding(
        lambda n, d33, k, c: n * d33 * math.sqrt(k / c), *[number for number in inputs if number is not None]
    )
    yield compare(cell("3.5", "coupling_factor", 0), coupling, "k^2 = (N d33)^2 k_p/C with C free.")
    yield _hopping_row()


def _hopping_row() -> Row:
    contact = wear_contact()
    load = float(table("3.2").columns["normal_load"].values[0])
    d = separation(contact, normal_load=load)
    lost = float(decay_length(contact)) * math.log(1 / _LOST_CONTACT)
    printed = stated("3.3.5-hopping-displacement")
    gap = d + printed.number.value
    force = float(normal_force(contact, separation=gap) / load)
    stiffness = float(
        cube_tangential_stiffness(contact, separation=gap) / cube_tangential_stiffness(contact, separation=d)
    )
    return compare(
        printed,
        lost,
        f"Where F_n falls to {_LOST_CONTACT:.0%} of the load; an exponential height law never parts the surfaces. At "
        f"3.8 um F_n/F_N = {force:.2f}, k_t/k_t0 = {stiffness:.3f}.",
    )


def _loads() -> Floats:
    loads, step = statement("3.1.4-normal-load").number, statement("3.1.4-load-step").number
    return np.arange(loads.low, loads.high + step.value / 2, step.value)


def _percent(values: Floats) -> str:
    return f"{100 * values.min():.1f} to {100 * values.max():.1f} %"
