"""Procedure, question and caveats of a plan by hand."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import xarray as xr
from pytest import approx, raises

from sonolube.design.test_plan.comparison import (
    BLOCKINGS,
    COMPARISONS,
    Scatter,
    assumed_scatter,
    randomised_runs,
    scatter_of_runs,
)
from sonolube.design.test_plan.plan import (
    Procedure,
    Question,
    TestPlan,
    _allowed,
    _caveats,
    _listed,
    _require_effect,
    _scatter,
    published_distances,
)
from sonolube.errors import InvalidInput


def test_a_question_asks_for_a_share_of_the_friction() -> None:
    for difference in (0.0, 1.0, -0.1):
        with raises(InvalidInput, match="difference must lie between 0 and 1 of the friction"):
            Question(difference=difference)
    for scatter in (0.0, 1.0):
        with raises(InvalidInput, match="scatter must lie between 0 and 1 of the friction"):
            Question(scatter=scatter)
    assert Question(difference=0.999, scatter=0.001).comparison is COMPARISONS["paired"]


def test_states_of_a_run_settle_by_distance_and_share_the_time_of_measuring() -> None:
    procedure = Procedure(intrinsic_distance=1.0, vibrated_distance=0.45, measuring_time=12.0)
    states = procedure.states(0.1, (False, True, False))
    assert [(each.vibrated, each.settling, each.measuring) for each in states] == [
        (False, 10.0, 6.0),
        (True, 5.0, 12.0),
        (False, 5.0, 6.0),
    ]
    assert [each.duration for each in states] == [16.0, 17.0, 11.0]
    (alone,) = procedure.states(0.1, (True,))
    assert (alone.settling, alone.measuring) == (5.0, 12.0)
    for intrinsic, vibrated, measuring in ((-1.0, 1.0, 1.0), (1.0, -1.0, 1.0), (1.0, 1.0, 0.0)):
        with raises(InvalidInput):
            Procedure(intrinsic_distance=intrinsic, vibrated_distance=vibrated, measuring_time=measuring)


def test_the_published_distances_are_the_longest_of_table_2_3() -> None:
    without, within = published_distances()
    assert without > within > 0


def test_entropy_and_duration_are_sums_over_models_and_runs() -> None:
    plan: Any = SimpleNamespace(weights={"one": 0.5, "two": 0.25, "three": 0.25, "none": 0.0})
    assert TestPlan.entropy.fget(plan) == approx(1.5)  # type: ignore[attr-defined]
    runs = randomised_runs(2, 3, blocking=BLOCKINGS["day"], specimens=1, seed=0)
    timed: Any = SimpleNamespace(runs=runs, states=lambda run, part: Procedure(
        intrinsic_distance=1.0, vibrated_distance=0.5).states(0.1 * (run.point + 1), part.vibrated))  # fmt: skip
    # at 0.1 m/s 10 + 5 + 5 s, at 0.2 m/s 5 + 3 + 3 s, and 24 s of measuring each, three times
    assert TestPlan.duration.fget(timed) == approx(3 * (20 + 24) + 3 * (11 + 24))  # type: ignore[attr-defined]


def test_numbers_are_listed_in_words() -> None:
    assert [_listed(each) for each in ([3], [1, 3], [1, 2, 4])] == ["3", "1 and 3", "1, 2 and 4"]


def test_fewer_possible_candidates_than_points_are_refused_with_a_reason() -> None:
    known: Any = SimpleNamespace(refused=("", "too loud", "", "too fast"))
    assert _allowed(known, 2).tolist() == [0, 2]
    with raises(InvalidInput, match="3 points to choose among 2 that the rig can make; of the others: too loud; give"):
        _allowed(known, 3)
    free: Any = SimpleNamespace(refused=("", ""))
    with raises(InvalidInput, match="3 points to choose among 2 that the rig can make; give more values or fewer"):
        _allowed(free, 3)


def test_a_difference_beyond_every_prediction_is_refused() -> None:
    _require_effect(np.array([0.1, 0.3]), 0.3)
    with raises(InvalidInput, match=r"--difference 0\.31 is larger than the effect: .* at most 0\.3 \(median\)"):
        _require_effect(np.array([0.1, 0.3]), 0.31)


def test_scatter_is_as_given_or_of_own_repeats_or_of_the_dissertation() -> None:
    given = _scatter(Question(scatter=0.06), None)
    assert (given.intrinsic, given.vibrated, given.reduction) == approx((0.06, 0.06, 0.06 * np.sqrt(2)))
    assert given == assumed_scatter(0.06)
    assert _scatter(Question(), None).source.startswith("D Table 2.3")
    repeats = xr.Dataset({"friction_reduction": ("run", [0.3, 0.4, 0.5, 0.4])})
    assert _scatter(Question(), repeats).source == "repeats of the own runs, 3 degrees of freedom"
    assert _scatter(Question(), repeats.isel(run=slice(0, 3))).source.startswith("D Table 2.3")


def test_scatter_of_runs_is_that_about_the_means_of_equal_conditions() -> None:
    # two speeds: reductions 0.3, 0.5, 0.4 and 0.7, 0.9, with 3 degrees of freedom: 0.02 + 0.02 over 3
    runs = xr.Dataset(
        {
            "friction_reduction": ("run", [0.3, 0.5, 0.7, 0.4, 0.9]),
            "sliding_speed": ("run", [0.1, 0.1, 0.2, 0.1001, 0.2]),
        }
    )
    found = scatter_of_runs(runs)
    assert found is not None
    assert found.reduction == approx(np.sqrt(0.04 / 3))
    assert (found.intrinsic, found.vibrated) == approx((found.reduction / np.sqrt(2),) * 2)
    # forces without 1.0, 1.2, 2.0, 1.1, 2.0, over their means 1.1 and 2: -0.1/1.1, 0.1/1.1
    forces = runs.assign(
        intrinsic_friction_force=("run", [1.0, 1.2, 2.0, 1.1, 2.0]), friction_force=("run", [0.5, 0.5, 0.6, 0.5, 1.0])
    )
    known = scatter_of_runs(forces)
    assert known is not None
    assert known.intrinsic == approx(np.sqrt(2 * (0.1 / 1.1) ** 2 / 3))
    assert known.vibrated == approx(np.sqrt(2 * 0.1**2 / 3))
    coarse = scatter_of_runs(runs.assign(friction_reduction_resolution=("run", [0.3] * 5)))
    assert coarse is not None
    assert (coarse.intrinsic, coarse.vibrated, coarse.reduction) == approx((0.3, 0.3, 0.3))
    assert "scatter by less than the last digit that is written" in coarse.caveat
    assert scatter_of_runs(xr.Dataset({"friction_reduction": ("run", [0.5] * 6)})) is None  # nothing tells it
    other_speed = runs.assign(sliding_speed=("run", [0.1, 0.12, 0.2, 0.1, 0.2]))
    assert scatter_of_runs(other_speed) is None  # two degrees of freedom


def caveats(**changes: Any) -> list[str]:
    """Caveats of a plan of two points among three without any."""
    candidates = SimpleNamespace(
        refused=("", "", ""), vibration_amplitude=np.array([1e-6, 2e-6, 3e-6]), sliding_speed=np.array([0.1, 0.2, 0.3]),
        normal_load=np.array([3.0, 3.0, 3.0]), own=0,
    )  # fmt: skip
    options = {"contradicted": changes.pop("contradicted", False)}
    amplitude = changes.pop("amplitude", 3e-6)
    for name in ("refused", "normal_load", "own"):
        if name in changes:
            setattr(candidates, name, changes.pop(name))
    plan: Any = SimpleNamespace(
        scatter=Scatter(intrinsic=0.1, vibrated=0.1, reduction=0.1, source="", caveat=changes.pop("scatter", "")),
        candidates=candidates, batch=SimpleNamespace(points=(2, 0)), chance=np.array([0.5, 0.2, 0.9]),
        question=Question(difference=0.25),
    )  # fmt: skip
    for name, value in changes.items():
        setattr(plan, name, value)
    inputs: Any = SimpleNamespace(amplitude=SimpleNamespace(value=amplitude))
    return list(_caveats(plan, inputs, **options))


def test_a_plan_within_all_bounds_has_no_caveat_and_each_doubt_has_its_own() -> None:
    assert caveats() == []
    assert caveats(scatter="own repeats are better") == ["own repeats are better"]
    (left_out,) = caveats(refused=("", "too loud", "too fast"))
    assert left_out == "2 of 3 points exceed a limit and are left out, such as 200 mm/s and 2 um: too loud"
    assert caveats(refused=("too loud", "", ""))[1] == "the rig's own operating point is none of the plan: too loud"
    (above,) = caveats(amplitude=2.9e-6)
    assert above.startswith("some amplitudes are above that of the rig file")
    (unlikely,) = caveats(chance=np.array([0.4, 0.2, 0.9]))
    assert unlikely.startswith("at point 2 a reduction of 25 % is less likely than not")
    (both,) = caveats(chance=np.array([0.4, 0.2, 0.3]))
    assert both.startswith("at point 1 and 2 a reduction")
    (doubt,) = caveats(contradicted=True)
    assert doubt.startswith("the measured runs contradict every friction model")
    (load,) = caveats(normal_load=np.array([3.0, 4.0, 3.0]))
    assert load.startswith("friction models depend on the load by the separation only")
