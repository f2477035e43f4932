"""Springs on exponential heights: sums over single springs, springs followed through periods, limits."""

import numpy as np
from pytest import approx, mark, raises
from scipy.special import k1
from scipy.stats import gamma

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.models.friction import (
    SpringContact,
    exponential_longitudinal_ratio,
    exponential_static_ratio,
    longitudinal_oscillation_ratio,
    parallel_vibration_ratio,
)
from sonolube.prediction.within_plane import compliant_ratio
from sonolube.rig.vibration_direction import VibrationDirection

SPRINGS = 200
SHARES = (np.arange(SPRINGS) + 0.5) / SPRINGS


def slip_lengths(amplitude_ratio: float) -> Floats:
    """Slip lengths in amplitudes of springs of equal load: load times density is the density of a gamma variable."""
    return np.asarray(gamma(2, scale=1 / amplitude_ratio).ppf(SHARES))


def followed_ratio(angle: float, velocity_ratio: float, amplitude_ratio: float, *, steps: int = 600) -> float:
    """Mean force along the sliding of springs that slip on a circle about their end, over the last of some periods."""
    lengths = slip_lengths(amplitude_ratio)
    along, across = lengths.copy(), np.zeros(SPRINGS)
    phase = np.linspace(0, 2 * np.pi, steps + 1)
    dx = np.diff(np.sin(phase)) * np.cos(angle) + velocity_ratio * np.diff(phase)
    dy = np.diff(np.sin(phase)) * np.sin(angle)
    total = 0.0
    for period in range(int(max(6, 4 / velocity_ratio))):
        total = 0.0 if period else total
        for forward, sideways in zip(dx, dy, strict=True):
            along, across = along + forward, across + sideways
            slip = np.minimum(lengths / np.hypot(along, across), 1.0)
            along, across = along * slip, across * slip
            total += float(np.mean(along / lengths))
    return total / steps


@mark.parametrize("velocity_ratio", [1e-5, 0.03, 0.3, 0.8])
@mark.parametrize("amplitude_ratio", [0.05, 0.7, 4.0])
def test_along_the_sliding_it_is_the_sum_over_springs_of_one_slip_length(
    velocity_ratio: float, amplitude_ratio: float
) -> None:
    lengths = np.asarray(gamma(2, scale=1 / amplitude_ratio).ppf((np.arange(20_000) + 0.5) / 20_000))
    one = longitudinal_oscillation_ratio(
        SpringContact(friction_coefficient=1.0, mindlin_ratio=1.0),
        approach=lengths,
        in_plane_amplitude=1.0,
        frequency=0.5 / np.pi,
        sliding_speed=velocity_ratio,
    )
    found = exponential_longitudinal_ratio(velocity_ratio=velocity_ratio, amplitude_ratio=amplitude_ratio)
    assert float(found) == approx(float(np.mean(one)), abs=3e-4)


def test_slow_sliding_leaves_the_load_of_springs_that_do_not_slip() -> None:
    strokes = np.array([1e-6, 1e-3, 0.5, 2.0, 6.0])
    found = exponential_longitudinal_ratio(velocity_ratio=1e-7, amplitude_ratio=strokes)
    assert found == approx(np.exp(-strokes), abs=2e-4)


def test_large_amplitudes_are_those_of_a_rigid_contact_and_none_is_below_it() -> None:
    zeta, stroke = np.meshgrid(np.linspace(0.01, 1.5, 60), np.geomspace(1e-4, 1e5, 60))
    rigid = parallel_vibration_ratio(sliding_speed=zeta, vibration_velocity=1.0)
    found = exponential_longitudinal_ratio(velocity_ratio=zeta, amplitude_ratio=stroke)
    assert np.all(found >= rigid)
    slow = zeta[-1] < 0.9
    assert found[-1, slow] == approx(rigid[-1, slow], abs=0.02)
    assert found[zeta >= 1] == approx(1.0)
    assert np.all(np.diff(found, axis=0) < 1e-4)  # a larger amplitude never leaves more friction


def test_slow_sliding_across_has_the_bessel_function() -> None:
    strokes = np.array([1e-3, 0.1, 1.0, 3.0, 20.0])
    found = exponential_static_ratio(vibration_direction=np.pi / 2, amplitude_ratio=strokes)
    assert found == approx(strokes * k1(strokes), rel=1e-6)
    along = exponential_static_ratio(vibration_direction=[0.0, np.pi, -1e-9], amplitude_ratio=0.7)
    assert along == approx(np.full(3, np.exp(-0.7)), rel=1e-6)
    assert exponential_static_ratio(vibration_direction=0.3, amplitude_ratio=0.0) == approx(1.0)


@mark.parametrize("amplitude_ratio", [0.5, 2.0])
def test_slow_oblique_sliding_is_the_limit_of_springs_followed_through_many_periods(amplitude_ratio: float) -> None:
    # a quarter of the speed leaves 1/3.2 of the excess, as a sixteenth leaves 1/3.2 of that
    fast, slow = (followed_ratio(0.8, velocity_ratio, amplitude_ratio, steps=200) for velocity_ratio in (0.04, 0.01))
    found = exponential_static_ratio(vibration_direction=0.8, amplitude_ratio=amplitude_ratio)
    assert float(found) == approx(slow - (fast - slow) / 2.2, abs=0.005)


@mark.parametrize(("angle", "velocity_ratio"), [(np.pi / 4, 0.1), (np.pi / 4, 1.0), (np.pi / 2, 0.1), (np.pi / 2, 1.0)])
@mark.parametrize("amplitude_ratio", [0.3, 3.0])
def test_between_its_limits_another_direction_is_up_to_0_15_below_springs_followed_through_the_period(
    angle: float, velocity_ratio: float, amplitude_ratio: float
) -> None:
    direction = VibrationDirection(vibration_direction=angle)
    found = float(
        compliant_ratio(direction, velocity_ratio=np.array(velocity_ratio), amplitude_ratio=np.array(amplitude_ratio))
    )
    followed = followed_ratio(angle, velocity_ratio, amplitude_ratio)
    assert -0.15 < found - followed < 0.02


def test_ratios_out_of_range_are_refused() -> None:
    with raises(InvalidInput, match="velocity_ratio must be positive"):
        exponential_longitudinal_ratio(velocity_ratio=0.0, amplitude_ratio=1.0)
    with raises(InvalidInput, match="amplitude_ratio must not be negative"):
        exponential_static_ratio(vibration_direction=0.1, amplitude_ratio=-1.0)
