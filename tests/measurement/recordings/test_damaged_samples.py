"""Single samples far beyond all others are a caveat; what a signal does is none."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, strategies as st
from tests.tiers import examples

from sonolube.checks import Floats
from sonolube.measurement.recordings.dataset import damaged_sample_caveats
from sonolube.measurement.recordings.reader import read_recording

TIME: Floats = np.arange(2000, dtype=np.float64) * 0.01


def caveats(values: Floats) -> tuple[str, ...]:
    return damaged_sample_caveats("friction_force", values, unit="N", axis=TIME[: values.size], axis_label="time [s]")


def stick_slip() -> Floats:
    return 1 + 0.4 * (TIME % 1.0) + 0.02 * np.random.default_rng(2).standard_normal(TIME.size)


SIGNALS = {
    "noise": np.random.default_rng(1).standard_normal(TIME.size),
    "stick-slip": stick_slip(),
    "a break-away peak": np.where(TIME < 0.02, 5.0, stick_slip()),
    "heavy tails": np.random.default_rng(3).standard_t(3, TIME.size),
    "a step": np.where(TIME > 10, 100.0, 0.0),
    "a trigger": np.where(np.arange(TIME.size) == 700, 5.0, 0.0),
    "bursts": np.where(TIME % 2 < 0.2, 30.0, 0.1) * np.sin(40 * TIME),
    "a constant": np.ones(TIME.size),
}


@pytest.mark.parametrize("signal", SIGNALS)
def test_a_signal_has_no_damaged_sample(signal: str) -> None:
    assert caveats(SIGNALS[signal]) == ()


@pytest.mark.parametrize("value", [1e10, -1e10, 50.0])
def test_a_sample_far_beyond_all_others_is_named_with_time_and_value(value: float) -> None:
    damaged = stick_slip()
    damaged[1234] = value
    (said,) = caveats(damaged)
    assert said.startswith(f"friction_force is {value:.3g} N at time [s] = 12.34, 20 times or more as far")


def test_up_to_three_samples_are_damaged_and_more_are_a_signal() -> None:
    for count in (1, 2, 3, 4, 10):
        damaged = stick_slip()
        damaged[100 : 100 + count] = 1e6
        assert len(caveats(damaged)) == (count if count <= 3 else 0)


@examples(50)
@given(st.integers(0, 10_000), st.integers(20, 400))
def test_gaussian_noise_of_any_length_raises_no_alarm(seed: int, size: int) -> None:
    assert caveats(np.random.default_rng(seed).standard_normal(size)) == ()


def test_a_recording_says_so_and_keeps_the_sample(tmp_path: Path) -> None:
    force = stick_slip()
    force[50] = 1e10
    rows = "\n".join(f"{t:.2f},{f:.4f}" for t, f in zip(TIME, force, strict=True))
    (tmp_path / "damaged.csv").write_text(f"time [s],friction force [N]\n{rows}\n")
    recording = read_recording(tmp_path / "damaged.csv")
    assert "friction_force is 1e+10 N at time [s] = 0.5" in recording.attrs["caveats"]
    assert recording["friction_force"].values[50] == 1e10


def test_a_damaged_sample_among_many_of_noise_is_found_at_any_place() -> None:
    values = np.random.default_rng(1).normal(2.0, 0.1, 50_000)
    for place, value in ((0, 40.0), (31_250, -40.0), (49_999, 400.0)):
        damaged = values.copy()
        damaged[place] = value
        told = damaged_sample_caveats("f", damaged, unit="N", axis=np.arange(50_000.0), axis_label="time [s]")
        assert len(told) == 1
        assert f"is {value:.3g} N at time [s] = {place:.6g}," in told[0]
    assert damaged_sample_caveats("f", values, unit="N", axis=np.arange(50_000.0), axis_label="time [s]") == ()
