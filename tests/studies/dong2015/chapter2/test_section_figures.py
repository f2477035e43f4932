"""Figures of sections 2.2 and 2.4: flextensional actuator, metal forming, and the force gauge of the welder rig."""

import numpy as np
import pytest
from pytest import approx
from scipy.special import i0

from dong2015.chapter2.flextensional import flextensional_figures, gain_of_slow_test, reduction
from dong2015.chapter2.welder_figures import (
    calibration,
    metal_forming_figures,
    readings,
    tip_record,
    waveguide,
    welder_figures,
    zinc_intensity,
)
from sonolube.measurement.gauge.calibration import fit_branches, force_from_branches, force_from_preisach

ROUND, FLAT = 1, 2


def test_the_sections_have_the_figures_of_the_dissertation() -> None:
    names = [figure.name for of in (flextensional_figures, metal_forming_figures, welder_figures) for figure in of()]
    assert names == [
        "figure-2-13-voltage",
        "figure-2-14-speed",
        "figures-2-28-2-29-metal-forming",
        "figure-2-32-calibration",
        "figure-2-33-welder-friction",
    ]


def test_the_reduction_over_speed_passes_the_printed_seventy_percent_and_falls_to_about_none() -> None:
    found = reduction(gain=gain_of_slow_test(), sliding_speed=np.array([3.5e-3, 10e-3, 50e-3, 100e-3]))
    assert found[0] == approx(0.70, abs=1e-4)
    assert np.all(np.diff(found) < 0)
    assert found[-1] < 0.1


def test_the_slowest_sliding_has_the_closed_form_of_stick_slip() -> None:
    # 52 um at 150 V, half the stroke at 4 V, gain 2, R_q/3 = 2 um: exp(-beta)/I0(beta)
    beta = 2 * 52e-6 * 4 / 150 / 2 / 2e-6
    assert reduction(gain=2.0, sliding_speed=1e-9) == approx(1 - np.exp(-beta) / i0(beta), abs=1e-4)


def test_the_forty_percent_on_zinc_take_a_sixth_of_the_intensity_of_flow_without_load() -> None:
    assert zinc_intensity() == approx(0.4**2)


def test_the_assumed_waveguide_returns_to_no_force_and_softens_by_its_hysteresis() -> None:
    # 0.45 N/um over 80 um is 36 N, less 35 % of it; unloading from there ends at the origin
    force = force_from_preisach(waveguide(), displacement=[0.0, 80e-6, 0.0]).applied_force
    assert force == approx([0.0, 36 * 0.65, 0.0], abs=1e-9)


def test_the_calibration_recovers_the_waveguide_where_one_curve_each_way_does_not() -> None:
    found = readings()
    true = force_from_preisach(waveguide(), displacement=found.deflection).applied_force
    by_history = force_from_preisach(calibration(), displacement=found.deflection).applied_force
    branches = fit_branches(displacement=found.deflection, applied_force=found.applied_force)
    by_direction = force_from_branches(branches, displacement=found.deflection).applied_force
    assert np.std(by_history - true) < 0.15  # N, the scatter of one reading
    assert np.std(by_direction - true) > 4 * np.std(by_history - true)


@pytest.mark.parametrize(
    ("tip", "off", "on", "duration"),
    [
        # 5 s at 76.7 and 76.9 rpm, the rest of 11 turns at 54.9 and 51.2 rpm
        (ROUND, (10.73, 13.02), (5.323, 6.845), 5 + (11 - 5 * 76.7 / 60) * 60 / 54.9),
        (FLAT, (16.88, 19.52), (9.93, 10.71), 5 + (11 - 5 * 76.9 / 60) * 60 / 51.2),
    ],
)
def test_friction_by_the_gauge_swings_through_the_printed_ranges(
    tip: int, off: tuple[float, float], on: tuple[float, float], duration: float
) -> None:
    record = tip_record(tip)
    assert record.time[-1] == approx(duration)
    for start, end, (low, high) in ((0.5, 3.0, off), (3.5, 8.0, on)):
        force = record.friction_force[(record.time > start) & (record.time < end)]
        assert (force.min(), force.max()) == approx((low, high), abs=0.3)
