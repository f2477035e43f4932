"""Two tables that no one mechanism gives: what each would need, and what the dynamics adds."""

from collections.abc import Iterator
from pathlib import Path

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pytest
from pytest import approx

from sonolube.contact import GapMotion
from sonolube.figure import ReportFigure, publication_style
from sonolube.friction import AsperityStickSlip, BristleWithHolder
from sonolube.reproduce.closures import (
    dynamics as closure_dynamics,
    error_figures as closure_error_figures,
    tables_in_conflict as closure_dispute,
)
from sonolube.reproduce.closures.dynamics import MODELS, MOTIONS, identified_structure, predictions, slow_arm_motion
from sonolube.reproduce.closures.tables_in_conflict import Mechanism, mechanisms, speeds_of_no_reduction
from sonolube.rig import read_rig
from sonolube.validation.fit import measured_in

FOUND: dict[str, Mechanism] = {one.fit.variant.name: one for one in mechanisms()}
DRAWN = {figure.name: figure for figure in closure_error_figures.figures()}


@pytest.fixture(autouse=True)
def screenless() -> Iterator[None]:
    with mpl.rc_context({"backend": "Agg"}), publication_style():
        yield
    plt.close("all")


def akaike(name: str) -> float:
    information = FOUND[name].information
    assert information is not None
    return information.akaike


def test_with_mindlins_stiffness_sliding_of_table_4_2_is_too_fast_for_normal_vibration() -> None:
    # v_c = mu omega a C, with C = (2 - nu)/(2 (1 - nu)) of steel and mu = 0.89/5
    expected = 0.178 * 2 * np.pi * 22e3 * np.array([0.46, 0.92, 1.38, 1.85, 2.31]) * 1e-6 * 1.71 / 1.42
    assert speeds_of_no_reduction() == approx(expected, rel=1e-3)
    for test, speed in zip(measured_in("B"), speeds_of_no_reduction(), strict=True):
        if speed < test.sliding_speed:
            assert FOUND["normal-mindlin"].fit.predict(test) == 1.0


def test_in_plane_motion_must_be_nearly_as_large_as_the_normal_one() -> None:
    values = FOUND["in-plane-unbounded"].fit.values
    assert 0.7 < values[1] < 1.0
    assert abs(values[2]) < 0.6
    assert FOUND["in-plane-unbounded"].power_map.rms < 0.045  # the scatter of one reading is 0.04 N of 0.89 N
    assert FOUND["in-plane"].power_map.rms > 0.1


def test_the_same_in_plane_motion_in_both_tables_explains_neither() -> None:
    assert FOUND["in-plane-in-both"].normal_tables.rms > 0.15
    assert FOUND["in-plane-in-both"].power_map.rms > 0.15


def test_the_zero_error_that_fits_best_exceeds_the_friction_that_was_read() -> None:
    assert FOUND["zero-error-unbounded"].fit.values[1] > 0.89
    # 0.35 N: (0.04 + 0.35)/(0.89 + 0.35) = 0.31 is then the true ratio, but Table 2.3 has to pay for it
    assert FOUND["slack-string"].normal_tables.rms > 0.2


def test_the_criteria_prefer_unbounded_in_plane_motion_then_a_zero_error() -> None:
    ranked = sorted(FOUND, key=akaike)
    assert ranked[:3] == ["in-plane-unbounded", "zero-error-unbounded", "slack-string"]


def test_a_reading_with_a_zero_error_is_the_true_force_less_it() -> None:
    mechanism = FOUND["zero-error-unbounded"]
    memory, zero = mechanism.fit.values
    test = measured_in("B")[2]
    normal = mechanism.fit.variant.predict(test, memory, 0.0)
    assert normal is not None
    assert mechanism.fit.predict(test) == approx((normal * (0.89 + zero) - zero) / 0.89, rel=1e-6)


def test_the_structure_is_that_of_the_example_rig() -> None:
    rig = read_rig(Path(__file__).parents[2] / "examples" / "rigs" / "tribometer.toml")
    assert rig.structure is not None
    for matrix in ("mass_matrix", "stiffness_matrix", "damping_matrix"):
        assert getattr(identified_structure(), matrix) == approx(getattr(rig.structure, matrix), rel=1e-6)


def test_motions_of_the_dynamics_change_no_ratio_by_a_thousandth() -> None:
    for one in predictions():
        for closure in MODELS:
            sine = one.ratios[closure, "sine"]
            assert [one.ratios[closure, name] for name in MOTIONS] == approx([sine] * len(MOTIONS), abs=1e-3)


@pytest.mark.parametrize("swing", [0.5e-6, 4e-6])
def test_a_slow_swing_of_the_arm_leaves_the_ratio_as_it_was(swing: float) -> None:
    # exponential heights have no scale of their own: a shifted gap scales normal force and friction alike
    test = measured_in("A")[1]
    phases = 2 * np.pi * np.arange(256) / 256
    x = 2.5e-6 * np.cos(phases)
    still = GapMotion(displacement=x, normal_force=np.ones(256), frequency=22e3, normal_load=3.0)
    rise = 2e-6 * np.log(np.mean(np.exp(-x / 2e-6)))
    balanced = GapMotion(
        displacement=x + rise, normal_force=3.0 * np.exp(-(x + rise) / 2e-6), frequency=22e3, normal_load=3.0
    )
    swung = slow_arm_motion(test, still, swing=swing, cycles=220)
    assert float(np.mean(swung.normal_force)) == approx(3.0, rel=1e-9)
    for model in (AsperityStickSlip(), BristleWithHolder()):
        one, other = (
            model.ratio(test.contact, moving, sliding_speed=test.sliding_speed, friction_coefficient=0.4)
            for moving in (balanced, swung)
        )
        assert float(other) == approx(float(one), abs=1e-3)


def test_rows_stand_beside_the_printed_reductions() -> None:
    disputed = {row.id: row for row in closure_dispute.rows()}
    assert len(disputed) == 5 * len(closure_dispute.REPORTED)
    assert disputed["dispute-normal-mindlin-B-1"].computed == approx(0.0, abs=1e-9)
    on_dynamics = [row.id for row in closure_dynamics.rows()]
    assert on_dynamics == [f"closure-stick-slip-on-dynamics-{test.label}" for test in measured_in("AB")]


@pytest.mark.parametrize("figure", DRAWN.values(), ids=DRAWN)
def test_error_figures_are_drawn_with_units(figure: ReportFigure) -> None:
    labels = [axes.get_xlabel() + axes.get_ylabel() for axes in figure.draw().axes]
    assert any("[" in label for label in labels)
