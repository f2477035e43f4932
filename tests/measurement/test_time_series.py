"""Validation of sampled signals."""

import numpy as np
import pytest
from pytest import raises

from sonolube.errors import InvalidInput
from sonolube.measurement.friction.loops import friction_work
from sonolube.measurement.friction.windows import window_statistics


@pytest.mark.parametrize(
    ("force", "match"),
    [
        (np.full(10, np.nan), "holds no value among 10"),
        (np.full(10, np.inf), "infinite"),
        (np.ones(9), "must hold 10 numbers"),
    ],
)
def test_signals_of_wrong_length_infinite_or_without_values_are_refused(force: np.ndarray, match: str) -> None:
    with raises(InvalidInput, match=match):
        friction_work(time=np.arange(10.0), friction_force=force, relative_velocity=np.ones(10))


def test_decreasing_time_is_refused() -> None:
    with raises(InvalidInput, match="time must increase, got 1 s"):
        window_statistics(np.ones(3), time=np.array([0.0, 2.0, 1.0]))
