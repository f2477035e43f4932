"""Part of the time in which a vibrating edge cuts, against tools and surfaces that are followed in time."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from numpy.typing import NDArray
from pytest import approx, raises

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.models.friction import feed_contact_fraction, tool_contact_fraction


def cutting_phases(ratio: float, *, count: int = 200_000) -> tuple[NDArray[np.bool_], Floats]:
    """Phases of a steady period at which a tool cuts, and its velocity, by following the front of the chip."""
    phase = (np.arange(3 * count) + 0.5) * 2 * np.pi / count
    position = ratio * phase + np.cos(phase)
    cuts = position >= np.maximum.accumulate(position)
    return cuts[-count:], (ratio - np.sin(phase))[-count:]


@pytest.mark.parametrize("ratio", [1e-3, 0.01, 0.1, 0.4, 0.8, 0.95, 0.999])
def test_a_tool_cuts_for_the_fraction_found_by_following_it_in_time(ratio: float) -> None:
    cuts, velocity = cutting_phases(ratio)
    found = float(tool_contact_fraction(cutting_speed=ratio, vibration_velocity=1.0))
    assert found == approx(cuts.mean(), abs=2e-5)
    # what is cut in a period is what the tool advances, so that the work on a length of chip is that without vibration
    assert (cuts * velocity).mean() == approx(ratio, abs=2e-5)


def test_the_contact_of_a_tool_has_its_limits() -> None:
    slow = np.array([1e-8, 1e-6])
    found = tool_contact_fraction(cutting_speed=slow, vibration_velocity=1.0)
    assert found == approx(np.sqrt(slow / np.pi), rel=1e-3)
    whole = tool_contact_fraction(cutting_speed=[1.0, 1.5, 0.5], vibration_velocity=[1.0, 1.0, 0.0])
    assert whole.tolist() == [1.0, 1.0, 1.0]
    near = float(tool_contact_fraction(cutting_speed=1 - 1e-6, vibration_velocity=1.0))
    # a cubic near the critical speed: apart for 3 arccos(v/v_1) of phase
    assert 1 - near == approx(3 * np.arccos(1 - 1e-6) / (2 * np.pi), rel=1e-3)


@given(speed=st.floats(1e-6, 3), scale=st.floats(1e-3, 1e3))
def test_the_contact_of_a_tool_depends_on_the_ratio_of_the_speeds_and_grows_with_it(speed: float, scale: float) -> None:
    one, same, faster = (
        float(tool_contact_fraction(cutting_speed=speed * k * s, vibration_velocity=s))
        for k, s in ((1, 1), (1, scale), (1.05, 1))
    )
    assert same == approx(one, rel=1e-6)
    assert 0 < one <= faster <= 1


def drilled(*, feed: float, amplitude: float, waves: float, edges: int = 800) -> tuple[float, float]:
    """Part of the time that edges cut, and mean chip: they pass over a surface one by one, `waves` on each pitch."""
    x = (np.arange(3000) + 0.5) / 3000
    surface, cuts, chips = np.full(x.size, -np.inf), [], []
    for k in range(edges):
        depth = k * feed + amplitude * np.sin(2 * np.pi * waves * (x + k))
        if k > edges // 2:
            cuts.append(np.mean(depth > surface))
            chips.append(np.mean(np.maximum(depth - surface, 0)))
        surface = np.maximum(surface, depth)
    return float(np.mean(cuts)), float(np.mean(chips))


@pytest.mark.parametrize("waves", [1.5, 2.0 + 1 / 3, 3.05, 7.3117, 0.43, 2.9995])
@pytest.mark.parametrize("amplitude", [0.2, 0.51, 0.8, 3.0, 17.0])
def test_an_edge_cuts_for_the_fraction_found_by_following_the_surface(waves: float, amplitude: float) -> None:
    share, chip = drilled(feed=1.0, amplitude=amplitude, waves=waves)
    found = feed_contact_fraction(feed_per_edge=1.0, vibration_amplitude=amplitude, phase_per_edge=2 * np.pi * waves)
    assert float(found) == approx(share, abs=5e-3)
    # what is cut is what is fed: the mean chip is that without vibration
    assert chip == approx(1.0, abs=1e-3 + 1e-2 * amplitude)


def test_the_contact_of_a_drill_has_its_limits() -> None:
    amplitude = np.array([0.0, 0.3, 0.5, 0.7, 2.0, 50.0])
    opposite = feed_contact_fraction(feed_per_edge=1.0, vibration_amplitude=amplitude, phase_per_edge=np.pi)
    assert opposite == approx(1 - np.arccos(np.minimum(1 / (2 * np.maximum(amplitude, 0.1)), 1)) / np.pi)
    equal = feed_contact_fraction(feed_per_edge=1.0, vibration_amplitude=amplitude, phase_per_edge=[[0.0], [4 * np.pi]])
    assert equal == approx(np.ones((2, 6)))


@given(a=st.floats(0, 30), phase=st.floats(-50, 50), scale=st.floats(1e-6, 1e3))
def test_the_contact_of_a_drill_depends_on_amplitude_over_feed_and_falls_with_it(
    a: float, phase: float, scale: float
) -> None:
    one, same, larger, backward = (
        float(feed_contact_fraction(feed_per_edge=s, vibration_amplitude=s * a * k, phase_per_edge=p))
        for s, k, p in ((1, 1, phase), (scale, 1, phase), (1, 1.1, phase), (1, 1, -phase))
    )
    assert same == approx(one, abs=1e-5)
    assert backward == approx(one, abs=1e-9)
    assert 0 < larger <= one + 1e-12 <= 1 + 1e-9
    assert one == 1 or a > 0.5


def test_a_feed_that_cannot_be_is_refused() -> None:
    with raises(InvalidInput, match="feed_per_edge must be positive"):
        feed_contact_fraction(feed_per_edge=0.0, vibration_amplitude=1e-6, phase_per_edge=1.0)
    with raises(InvalidInput, match="at most 100000 times feed_per_edge"):
        feed_contact_fraction(feed_per_edge=1e-20, vibration_amplitude=1e-6, phase_per_edge=1.0)
