"""Stated parts of friction recordings, by a recording of known levels."""

from typing import Any

import numpy as np
import pytest
import xarray as xr
from pytest import approx, raises

import sonolube as sl
from sonolube.errors import InvalidInput
from sonolube.measurement.friction.stated_parts import STATED_STEP, StatedParts, with_stated_parts
from sonolube.tasks.files import NamedBytes

ZERO, INTRINSIC, REDUCTION = 0.05, 1.0, 0.4
T = np.arange(0, 63, 0.01)
DRIVEN = (T > 23) & (T <= 43)
FORCE = np.where(T < 3, ZERO, ZERO + INTRINSIC * (1 - REDUCTION * DRIVEN)) + 0.03 * np.random.default_rng(
    3
).standard_normal(T.size)
DISTURBED = FORCE + 5.0 * ((T >= 22) & (T <= 23))  # between two steps
STEPS = {"3s:21.9s": "0 V", "23.1s:43s": "28 V", "43.1s:60s": "0V"}


def recording(force: np.ndarray = FORCE, **channels: np.ndarray) -> NamedBytes:
    """Text of a recording of the force, with further channels."""
    columns = {"time (s)": T, "friction_force (N)": force, **channels}
    rows = zip(*columns.values(), strict=True)
    lines = [",".join(columns), *(",".join(f"{each:.9g}" for each in row) for row in rows)]
    return NamedBytes("test.csv", "\n".join(lines).encode())


def steps_of(answer: Any) -> list[dict[str, float]]:
    """Rows of the steps of an answer."""
    rows: list[dict[str, float]] = answer.object()["results"][0]["tables"]["steps"]["rows"]
    return rows


def test_stated_steps_and_rest_give_levels_and_reduction() -> None:
    answer = sl.measure.friction(recording(DISTURBED), step=STEPS, rest=["0s:2.9s"])
    first, driven, last = steps_of(answer)
    for step, level in ((first, INTRINSIC), (driven, INTRINSIC * (1 - REDUCTION)), (last, INTRINSIC)):
        assert step["friction_force"] == approx(level, abs=4 * step["friction_force_uncertainty"])
    assert driven["friction_reduction"] == approx(REDUCTION, abs=4 * driven["friction_reduction_uncertainty"])
    assert [step["voltage_peak_to_peak"] for step in (first, driven, last)] == [0.0, 28.0, 0.0]
    assert (driven["start_time"], driven["end_time"]) == approx((23.1, 43.0), abs=0.02)
    assert any("at rest as stated, and left out: 0 s to 2.9 s" in caveat for caveat in answer.caveats())
    assert any("taken off as its zero" in caveat for caveat in answer.caveats())


def test_a_stated_voltage_is_as_good_as_a_recorded_one() -> None:
    quiet = {"voltage_peak_to_peak (V)": 28.0 * DRIVEN, "sliding_speed (m/s)": 0.02 * (T >= 3)}
    kept = {"3.01s:22s": "0V", "23.01s:43s": "28V", "43.01s:62.99s": "0V"}
    recorded = steps_of(sl.measure.friction(recording(**quiet), part="0s:62.99s"))
    stated = steps_of(sl.measure.friction(recording(**{"sliding_speed (m/s)": 0.02 * (T >= 3)}), step=kept))
    for one, other in zip(recorded, stated, strict=True):
        assert one["friction_force"] == approx(other["friction_force"], abs=3e-3)
        assert one["voltage_peak_to_peak"] == approx(other["voltage_peak_to_peak"])


def test_a_part_leaves_out_the_rest() -> None:
    answer = sl.measure.friction(recording(), part="44s:60s")
    assert float(answer["mean_force"]) == approx(ZERO + INTRINSIC, abs=3e-3)
    inside = FORCE[(T >= 44) & (T <= 60)]
    assert float(answer["mean_force"]) == approx(inside.mean(), rel=1e-9)


@pytest.mark.parametrize(
    ("given", "reason"),
    [
        ({"step": {"3s": "0V"}}, "needs a begin and an end, such as 5s:55s"),
        ({"step": {"3s:1s": "0V"}}, "must end after it begins"),
        ({"step": {"0s:9s": "0V", "8s:12s": "5V"}}, "must not overlap"),
        ({"step": {"0s:9s": "5N"}}, "is a force; expected a voltage"),
        ({"step": {"0s:9s": "-5V"}}, "must not be negative"),
        ({"rest": ["0s:0.1s"]}, "longer than 0.2 s"),
        ({"part": "70s:80s"}, "70 s to 80 s holds no sample"),
        ({"part": "0s:3s", "step": {"10s:20s": "0V"}}, "holds none of the stated steps"),
        ({"part": "0s:3s", "join": True}, "are of one recording"),
    ],
)
def test_what_cannot_be_is_refused(given: dict[str, Any], reason: str) -> None:
    with raises(InvalidInput, match=reason):
        sl.measure.friction(recording(), **given)


def test_parts_need_a_time() -> None:
    cycles = NamedBytes("cycles.csv", b"revolutions,friction_coefficient\n1,0.3\n2,0.4\n3,0.3\n")
    with raises(InvalidInput, match="stated by the time"):
        sl.measure.friction(cycles, part="0s:3s")


def small(**channels: list[float]) -> xr.Dataset:
    made = {name: ("time", np.array(values), {"units": "x"}) for name, values in channels.items()}
    return xr.Dataset(made, coords={"time": np.arange(6.0)})


def test_rest_sets_every_recorded_speed_to_zero_or_stops_the_motor() -> None:
    given = small(friction_force=[1, 2, 3, 4, 5, 6], sliding_speed=[7.0] * 6, rotation_speed=[3.0] * 6)
    rested = with_stated_parts(given, StatedParts(rests=((1.0, 2.0), (4.5, 9.0))))
    assert rested["sliding_speed"].values.tolist() == [7, 0, 0, 7, 7, 0]
    assert rested["rotation_speed"].values.tolist() == [3, 0, 0, 3, 3, 0]
    assert rested["sliding_speed"].attrs == {"units": "x"}
    assert "motor_on" not in rested
    assert rested.attrs["rest"] == "as stated"
    alone = with_stated_parts(small(friction_force=[1.0] * 6), StatedParts(rests=((0.0, 1.0),)))
    assert alone["motor_on"].values.tolist() == [0, 0, 1, 1, 1, 1]


def test_steps_number_their_samples_and_hide_the_force_outside_where_no_speed_tells_rest() -> None:
    steps = (((1.0, 2.0), 0.0), ((4.0, 5.0), 12.0))
    stated = with_stated_parts(small(friction_force=[1, 2, 3, 4, 5, 6]), StatedParts(steps=steps))
    assert stated[STATED_STEP].values.tolist() == [0, 1, 1, 0, 2, 2]
    assert stated["voltage_peak_to_peak"].values == approx([np.nan, 0, 0, np.nan, 12, 12], nan_ok=True)
    assert stated["voltage_peak_to_peak"].attrs == {"units": "V"}
    assert stated["friction_force"].values == approx([np.nan, 2, 3, np.nan, 5, 6], nan_ok=True)
    assert "rest" not in stated.attrs
    rested = with_stated_parts(small(friction_force=[1, 2, 3, 4, 5, 6]), StatedParts(steps=steps, rests=((0.0, 0.5),)))
    assert rested["friction_force"].values == approx([1, 2, 3, np.nan, 5, 6], nan_ok=True)
    moving = small(friction_force=[1, 2, 3, 4, 5, 6], sliding_speed=[7.0] * 6)
    assert with_stated_parts(moving, StatedParts(steps=steps))["friction_force"].values.tolist() == [1, 2, 3, 4, 5, 6]
    part = with_stated_parts(moving, StatedParts(steps=steps, part=(1.0, 3.0)))
    assert part["time"].values.tolist() == [1, 2, 3]
    assert with_stated_parts(moving, StatedParts()) is moving


def test_neighbouring_steps_and_a_rest_just_over_the_reversal_of_a_stroke_are_accepted() -> None:
    assert StatedParts(steps=(((4.0, 5.0), 1.0), ((1.0, 4.0), 0.0))).steps[0][1] == 1.0
    assert StatedParts(rests=((1.0, 1.21),)).rests
    with raises(InvalidInput, match=r"a rest must be longer than 0\.2 s, got 1 s to 1\.2 s"):
        StatedParts(rests=((1.0, 1.2),))
    with raises(InvalidInput, match="a part must end after it begins, got 3 s to 3 s"):
        StatedParts(part=(3.0, 3.0))
    with raises(InvalidInput, match="a part must end after it begins"):
        StatedParts(rests=((3.0, 2.0),))
    with raises(InvalidInput, match=r"steps must not overlap: one ends at 4\.5 s, the next begins at 4 s"):
        StatedParts(steps=(((4.0, 5.0), 1.0), ((1.0, 4.5), 0.0)))
    with raises(InvalidInput, match="holds no sample; the recording is from 0 s to 5 s"):
        with_stated_parts(small(friction_force=[1.0] * 6), StatedParts(rests=((1.2, 1.8),)))
