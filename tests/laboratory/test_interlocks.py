"""Interlocks hold every sample of a block to the limit and to both ends of its channel's range."""

import numpy as np
import pytest

from sonolube.laboratory.block import Block, Channel
from sonolube.laboratory.interlocks import Interlock, first_trip

FORCE = Channel(name="friction_force", quantity="friction_force", lowest=-20.0, highest=50.0)
LOCK = Interlock(FORCE, 30.0)


def trip_of(*samples: float) -> str:
    values = np.array(samples, dtype=np.float64)[:, np.newaxis]
    return first_trip(Block(first_sample=100, sample_rate=1e3, values=values), ["friction_force"], [LOCK])


@pytest.mark.parametrize("value", [0.0, 30.0, -19.999])
def test_samples_within_limit_and_range_trip_nothing(value: float) -> None:
    assert not trip_of(1.0, value, 1.0)


@pytest.mark.parametrize(
    ("value", "reason"),
    [
        (-20.0, "channel friction_force is saturated at -20 N"),  # the lower end, within the limit of 30 N
        (-25.0, "channel friction_force is saturated at -25 N"),
        (30.001, "channel friction_force is 30 N; its limit is 30 N"),
        (-31.0, "channel friction_force is -31 N; its limit is 30 N"),
        (np.nan, "channel friction_force gives no number"),
    ],
)
def test_the_first_sample_beyond_them_trips(value: float, reason: str) -> None:
    assert trip_of(1.0, 2.0, value, -40.0) == reason
