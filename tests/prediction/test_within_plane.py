"""Predictions of vibration within the plane: published points left out, limits, symmetries, own runs, refusals."""

from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from pytest import approx, mark, raises
from scipy.integrate import quad
from scipy.special import ellipk

import sonolube as sl
from sonolube.charts import Points
from sonolube.errors import InvalidInput
from sonolube.prediction import LivePrediction, prediction_chart
from sonolube.prediction.applicability import friction_interval
from sonolube.prediction.hierarchy import central_interval
from sonolube.prediction.predictive import rig_prediction
from sonolube.prediction.within_plane import (
    MINDLIN_SLIP_LENGTH,
    coulomb_ratio,
    plane_posterior,
    plane_rigs,
    within_plane,
)
from sonolube.rig import Rig, friction_point, read_rig
from sonolube.rig.datasets import LabelledArrays
from sonolube.rig.vibration_direction import VibrationDirection

RIGS = Path(__file__).parents[2] / "examples" / "rigs"
PRINTED = 0.62 / 6.64  # sliding speed over that of the vibration, D 1.3.1
FLAT, LAGGING = "vibration.second_fraction=1e-4", "vibration.second_phase=90deg"
QUIET = "vibration.vibration_amplitude=0.1nm"


def base(*changes: str) -> Rig:
    return read_rig(RIGS / "vibrating_base.toml", changes=list(changes))


def predicted(*changes: str, **given: Any) -> LabelledArrays:
    return LivePrediction(base(*changes), **given).first


def median(found: LabelledArrays, name: str = "friction_ratio") -> float:
    return float(np.median(found[name].to_numpy()))


def width(found: LabelledArrays) -> float:
    low, high = central_interval(found["friction_ratio"].to_numpy(), 0.8)
    return float(high - low)


@mark.parametrize("place", [0, 1, 2])
def test_the_points_of_each_rig_lie_within_the_80_percent_intervals_by_the_others(place: int) -> None:
    rig = plane_rigs()[place]
    draws = rig_prediction(plane_posterior(without=(place,)), rig.at, count=4000).ratios(rig.at.conditions)
    low, high = central_interval(draws, 0.8)
    assert np.all(low <= rig.friction_ratio + 1e-9)
    assert np.all(rig.friction_ratio <= high + 1e-9)
    assert np.all(high - low < 0.75)  # and do not hold everything


def test_the_points_of_luo_unseen_have_a_median_between_coulombs_law_and_none_and_no_draw_at_zero() -> None:
    rig = plane_rigs()[2]
    draws = rig_prediction(plane_posterior(without=(2,)), rig.at, count=4000).ratios(rig.at.conditions)
    assert np.all((np.median(draws, axis=0) > 0.03) & (np.median(draws, axis=0) < 0.4))
    assert np.all(np.mean(draws < 1e-4, axis=0) < 0.01)
    assert draws.max() <= 1


def test_the_points_shorten_the_slip_length_of_mindlin_and_narrow_it() -> None:
    mu = plane_posterior().hyperparameters[:, 0]
    assert 0.1e-6 < np.exp(np.median(mu)) < 0.5 * MINDLIN_SLIP_LENGTH
    assert mu.std() < 0.6  # 1 before
    nothing = plane_posterior(without=(0, 1, 2)).hyperparameters[:, 0]
    assert np.exp(np.median(nothing)) == approx(MINDLIN_SLIP_LENGTH, rel=0.05)
    assert nothing.std() == approx(1.0, rel=0.05)


@mark.parametrize("zeta", [0.01, 0.0934, 0.5, 0.999, 1.0, 1.5, 30.0])
def test_the_law_has_the_closed_forms_along_and_across(zeta: float) -> None:
    along, across = (
        float(coulomb_ratio(VibrationDirection(direction=word), velocity_ratio=zeta)) for word in ("along", "across")
    )
    m = 1 / (1 + zeta**2)
    assert along == approx(2 / np.pi * np.arcsin(min(zeta, 1.0)))
    assert across == approx(2 / np.pi * np.sqrt(1 - m) * ellipk(m), abs=1e-4)


def test_a_ring_is_the_mean_over_its_directions() -> None:
    angles = (np.arange(720) + 0.5) / 720 * np.pi
    mean = np.mean(
        [coulomb_ratio(VibrationDirection(vibration_direction=angle), velocity_ratio=0.5) for angle in angles]
    )
    ring = VibrationDirection(direction="torsional", torsion_radius=2e-3)
    assert float(coulomb_ratio(ring, velocity_ratio=0.5)) == approx(mean, abs=1e-4)


def test_the_example_has_more_friction_than_a_rigid_contact_and_its_interval_holds_what_was_measured() -> None:
    found = predicted()
    assert found["friction_ratio"].to_numpy().min() >= 2 / np.pi * np.arcsin(0.9 * PRINTED)
    assert 0.1 < median(found) < 0.35
    low, high = central_interval(found["friction_ratio"].to_numpy(), 0.95)
    assert low <= 0.10 <= high  # the printed reduction of 90 %


@mark.parametrize("direction", ["along", "across"])
def test_little_vibration_leaves_friction_as_it_is(direction: str) -> None:
    found = predicted(f"vibration.direction={direction}", "vibration.vibration_amplitude=0.1nm")
    assert median(found) == approx(1.0, abs=0.01)
    assert width(found) < 0.15


def test_across_reduces_less_and_is_less_sure_than_along() -> None:
    along, across = (predicted(f"vibration.direction={word}") for word in ("along", "across"))
    assert median(across) > median(along) + 0.1
    assert width(across) > width(along)
    oblique = predicted("vibration.vibration_direction=45deg")
    assert median(along) < median(oblique) < median(across)


ELLIPSE = ("vibration.second_direction=across", "vibration.second_fraction=0.7", "vibration.second_phase=50deg")


@mark.parametrize("zeta", [0.02, 0.3, 1.0, 2.0])
def test_an_ellipse_has_the_mean_cosine_of_its_path(zeta: float) -> None:
    ellipse = VibrationDirection(direction="across", second_direction="along", second_fraction=1.4, second_phase=0.8)

    def cosine(turn: float) -> float:
        along, across = zeta - 1.4 * np.sin(turn - 0.8), -np.sin(turn)
        return float(along / np.hypot(along, across))

    mean = quad(cosine, 0, 2 * np.pi, limit=400, epsabs=1e-9)[0] / (2 * np.pi)
    assert float(coulomb_ratio(ellipse, velocity_ratio=zeta)) == approx(mean, abs=3e-4)


@mark.parametrize("main", ["along", "across"])
def test_a_flat_ellipse_is_predicted_as_the_line_that_it_comes_from(main: str) -> None:
    second = {"along": "across", "across": "along"}[main]
    line = predicted(f"vibration.direction={main}")
    flat = predicted(f"vibration.direction={main}", f"vibration.second_direction={second}", FLAT, LAGGING)
    assert median(flat) == approx(median(line), abs=3e-3)
    assert width(flat) == approx(width(line), abs=6e-3)


def test_components_in_step_are_predicted_as_the_angle_that_they_make() -> None:
    angle = predicted("vibration.vibration_direction=45deg", f"vibration.vibration_amplitude={0.352 * 2**0.5:.9f}um")
    sides = (
        "vibration.second_direction=across",
        "vibration.second_fraction=1",
        "vibration.vibration_amplitude=0.352um",
    )
    found = predicted(*sides)
    assert median(found) == approx(median(angle), abs=2e-3)
    assert width(found) == approx(width(angle), abs=4e-3)


def test_the_sides_of_an_ellipse_may_be_given_in_either_order() -> None:
    one = predicted(*ELLIPSE, "vibration.vibration_amplitude=0.4um")
    other = predicted(
        "vibration.direction=across",
        "vibration.vibration_amplitude=0.28um",
        "vibration.second_direction=along",
        f"vibration.second_fraction={1 / 0.7:.12f}",
        "vibration.second_phase=-50deg",
    )
    assert other["friction_ratio"].to_numpy() == approx(one["friction_ratio"].to_numpy(), abs=1e-3)


def test_a_circle_is_farther_from_what_was_tested_than_the_lines_and_says_that_it_is_theory_alone() -> None:
    circle = predicted(
        "vibration.second_direction=across", "vibration.second_fraction=1", "vibration.second_phase=90deg"
    )
    still_known = plane_rigs()[0].at.conditions
    round_, line, across = (
        float(within_plane(still_known, VibrationDirection(**each)).distance()[0])
        for each in (
            {"direction": "along", "second_direction": "across", "second_fraction": 1.0, "second_phase": np.pi / 2},
            {"vibration_direction": np.pi / 4},
            {"direction": "across"},
        )
    )
    assert 0 < line < across < round_
    assert circle["friction_ratio"].to_numpy().min() > 0.45 * PRINTED  # half of it, of a rigid contact on a circle
    assert 0.1 < median(circle) < 0.35
    assert "by theory alone" in circle.attrs["statement"].split("\n")[0].split(": ")[0]
    assert circle["friction_ratio"].to_numpy().min() >= 0
    still = predicted("vibration.second_direction=across", "vibration.second_fraction=1", QUIET)
    assert median(still) == approx(1.0, abs=0.01)


def test_a_part_along_the_normal_would_be_decided_by_its_phase() -> None:
    # why no prediction is made of it: Coulomb's law with the force of the contact, at four phases
    ratios = [
        friction_point(
            base(
                "vibration.second_direction=normal",
                "vibration.second_fraction=0.2",
                f"vibration.second_phase={phase}deg",
            )
        ).friction_ratio
        for phase in (0, 90, 180, 270)
    ]
    assert ratios == approx([0.061, 0.245, 0.061, -0.128], abs=2e-3)


@mark.parametrize(("one", "other"), [("30deg", "-30deg"), ("30deg", "150deg"), ("0deg", "180deg")])
def test_a_direction_and_its_mirror_image_are_predicted_alike(one: str, other: str) -> None:
    first, second = (predicted(f"vibration.vibration_direction={each}") for each in (one, other))
    assert first["friction_ratio"].to_numpy() == approx(second["friction_ratio"].to_numpy(), abs=1e-6)


def test_no_draw_is_negative_and_the_answer_has_no_wear_and_no_heat() -> None:
    found = predicted()
    assert found["friction_ratio"].to_numpy().min() >= 0
    assert not any("wear" in name or "temperature" in name for name in found.variables)
    assert found["input"].to_numpy().tolist() == ["friction_coefficient", "vibration_amplitude"]
    assert [label for label in found["measure_label"].to_numpy() if "stiffness" in label] == []


def test_slower_sliding_than_tested_is_said_and_widens() -> None:
    slow = predicted("sliding.sliding_speed=0.0004mm/s")
    assert "v_r/(omega a) 6e-05, tested down to 0.00087" in slow.attrs["caveats"]
    assert (
        central_interval(slow["friction_ratio"].to_numpy(), 0.95)[1]
        > (central_interval(predicted()["friction_ratio"].to_numpy(), 0.95)[1])
    )


@mark.parametrize(
    ("changes", "sentence", "caveat"),
    [
        ((), "tested with 7 published points", "L-2 of Gutowski and Leus (0.10 where the law has 0.2"),
        (("vibration.direction=across",), "theory alone", "compared with no experiment"),
        (("vibration.direction=torsional", "vibration.torsion_radius=2mm"), "theory alone", "no experiment"),
        (("vibration.vibration_direction=20deg",), "theory alone", "no experiment"),
    ],
)
def test_how_far_it_was_tested_is_said_first(changes: tuple[str, ...], sentence: str, caveat: str) -> None:
    found = predicted(*changes)
    assert sentence in found.attrs["statement"].split("\n")[0].split(". ")[0]
    first, second, *_ = found.attrs["caveats"].split("\n")
    assert caveat in first
    assert "one run of your own tells it better" in second


def test_the_interval_beside_friction_is_that_of_predict() -> None:
    low, high = central_interval(predicted()["friction_ratio"].to_numpy(), 0.8)
    found = friction_interval(base())
    assert (found.low, found.high) == approx((low, high))


def test_own_runs_move_and_narrow_it_and_other_directions_are_refused() -> None:
    runs = xr.Dataset(
        {"friction_reduction": ("run", [0.7, 0.71, 0.69]), "friction_reduction_uncertainty": ("run", [0.02] * 3)}
    )
    before, after = predicted(), predicted(runs=runs)
    assert median(after) == approx(0.3, abs=0.03)
    assert width(after) < 0.5 * width(before)
    across = runs.assign(vibration_direction=("run", [np.pi / 2] * 3))
    with raises(InvalidInput, match="the rig vibrates along the sliding; leave out runs in other directions"):
        predicted(runs=across)
    along = runs.assign(vibration_direction=("run", [np.pi] * 3))
    assert median(predicted(runs=along)) == approx(median(after))


def test_a_direction_that_changes_is_followed() -> None:
    live = LivePrediction(base())
    turned = live.at(base("vibration.direction=across"))
    assert turned["friction_ratio"].to_numpy() == approx(
        predicted("vibration.direction=across")["friction_ratio"].to_numpy()
    )


def test_what_cannot_be_carried_is_refused_in_one_line() -> None:
    ellipse = base("vibration.second_direction=normal", "vibration.second_fraction=0.2")
    with raises(InvalidInput, match="no prediction of a vibration along the normal and within the plane") as refusal:
        sl.predict(ellipse)
    assert "\n" not in str(refusal.value)
    assert "whose phase decides" in friction_interval(ellipse).reason
    other = read_rig(RIGS / "tribometer.toml")
    runs = xr.Dataset({"friction_reduction": ("run", [0.6])})
    with raises(InvalidInput, match="other rigs tell of the decay length alone"):
        LivePrediction(base(), laboratory_runs=[(other, runs)])
    with raises(InvalidInput, match="rests on tests of vibration along the normal"):
        sl.plan(base())


def test_the_figure_shows_no_tests_along_the_normal() -> None:
    chart = prediction_chart(predicted())
    assert not any(isinstance(part, Points) for panel in chart.panels for part in panel.parts)
