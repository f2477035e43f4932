"""Fits of wobble against least squares with all columns, and their residuals by hand."""

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.measurement.friction.wobble import (
    _coherent,
    _explained_power,
    _left,
    _misfit,
    _residuals,
    find_rotation_speed,
    harmonic_columns,
    refined_speed,
    remove_wobble,
    scaled_waves,
)

STEP = 0.02  # s
PARTS = [np.arange(start, end, STEP) for start, end in ((1.0, 9.0), (10.0, 14.0), (15.0, 21.0))]


def test_the_columns_are_cosines_and_then_sines_of_each_harmonic() -> None:
    columns = harmonic_columns(revolutions=np.array([0.0, 1 / 12]), harmonics=3)  # 0 and 30 degrees
    half, root = 0.5, np.sqrt(3) / 2
    assert columns == approx(np.array([[1, 1, 1, 0, 0, 0], [root, half, 0, half, root, 1]]), abs=1e-15)


def test_the_power_at_each_frequency_is_that_of_a_fit_beside_the_means_of_the_parts() -> None:
    rng = np.random.default_rng(1)
    parts = [part[rng.random(part.size) < 0.8] for part in PARTS]  # samples are missing
    parts = [np.unique(np.append(part, [whole[0], whole[-1]])) for part, whole in zip(parts, PARTS, strict=True)]
    forces = [j + rng.standard_normal(t.size) for j, t in enumerate(parts)]
    frequency, power = _explained_power(parts, forces)
    size = 2 * (power.size - 1) * 2  # a power of two, at least eight times the samples from first to last
    assert size == 8192
    assert frequency[1] == approx(1 / (size * STEP))
    t, y = np.concatenate(parts), np.concatenate([force - force.mean() for force in forces])
    means = np.concatenate([np.full((part.size, 3), np.eye(3)[j]) for j, part in enumerate(parts)])
    for index in (7, 41, 100, 777, 1500):
        angle = 2 * np.pi * frequency[index] * t
        design = np.column_stack([means, np.cos(angle), np.sin(angle)])
        left = y - design @ np.linalg.lstsq(design, y)[0]
        assert power[index] == approx(float(y @ y - left @ left), rel=1e-6)
    assert power[0] == 0.0  # a constant explains nothing beside the means


def test_waves_in_proportion_to_the_level_are_one_at_the_highest() -> None:
    waves = [np.array([[1.0, 2.0]]), np.array([[3.0, 4.0]])]
    scaled = scaled_waves(waves, [np.array([1.0, 3.0]), np.array([8.0])])
    assert scaled is not None
    assert scaled[0] == approx(np.array([[0.25, 0.5]]))
    assert scaled[1] == approx(np.array([[3.0, 4.0]]))
    assert scaled_waves(waves, [np.array([1.0]), np.array([0.0])]) is None


def test_levels_and_columns_leave_the_residual_of_a_fit_with_a_level_for_each_part() -> None:
    rng = np.random.default_rng(2)
    forces = [rng.standard_normal(t.size) + j for j, t in enumerate(PARTS)]
    waves = [harmonic_columns(revolutions=0.7 * t, harmonics=2) for t in PARTS]
    levels = np.concatenate([np.tile(np.eye(3)[j], (t.size, 1)) for j, t in enumerate(PARTS)])
    design, y = np.hstack([levels, np.concatenate(waves)]), np.concatenate(forces)
    left = y - design @ np.linalg.lstsq(design, y)[0]
    found = _left(waves, forces)
    assert [each.size for each in found] == [t.size for t in PARTS]
    assert np.concatenate(found) == approx(left, abs=1e-9)


@pytest.mark.parametrize("in_proportion", [True, False])
def test_of_two_kinds_of_wobble_the_one_that_leaves_less_is_taken(in_proportion: bool) -> None:
    levels = (1.0, 0.2, 0.5)
    forces = [
        level + 0.1 * (level if in_proportion else 1.0) * np.cos(2 * np.pi * 0.7 * t + 1)
        for level, t in zip(levels, PARTS, strict=True)
    ]
    assert np.max(np.abs(np.concatenate(_residuals(PARTS, forces, 0.7, 1)))) < 2e-3
    assert _misfit(PARTS, forces, 0.7, 1) < 1e-3 < 0.05 < _misfit(PARTS, forces, 0.5, 1)
    assert refined_speed(PARTS, forces, rotation_speed=0.71, harmonics=1) == approx(0.7, abs=1e-4)
    assert refined_speed(PARTS, forces, rotation_speed=0.75, harmonics=1) != approx(
        0.7, abs=0.02
    )  # half a turn of 20 s


def test_a_wobble_that_improves_seven_tenths_of_the_time_is_coherent() -> None:
    rng = np.random.default_rng(3)

    def coherent(shares: list[bool]) -> bool:
        """Whether a wave in some of ten equal pieces, the others holding its opposite by a quarter, is one wobble."""
        t = np.arange(1000.0) * STEP  # 20 s, 14 turns
        sign = np.repeat(np.where(shares, 1.0, -0.25), 100)
        parts = [t[:100], t[100:]]  # the shorter one sets the size of a piece
        force = sign * np.cos(2 * np.pi * 0.7 * t) + 1e-6 * rng.standard_normal(1000)
        return _coherent(parts, [force[:100], force[100:]], 0.7, 1)

    assert coherent([True] * 10)
    assert coherent([True] * 7 + [False] * 3)
    assert not coherent([True] * 6 + [False] * 4)


@pytest.mark.parametrize(("speed", "found"), [(4.9, True), (5.3, False), (0.16, True), (0.06, False)])
def test_rotation_is_sought_from_two_turns_a_recording_to_five_a_second(speed: float, found: bool) -> None:
    rng = np.random.default_rng(4)
    forces = [1 + 0.5 * np.cos(2 * np.pi * speed * t + 1) + 0.05 * rng.standard_normal(t.size) for t in PARTS]
    sought = find_rotation_speed(PARTS, forces, harmonics=1)
    if found:
        assert sought == approx(speed, abs=0.005)
    else:
        assert sought is None or abs(sought - speed) > 0.02


def test_of_subharmonics_that_explain_as_much_the_fastest_is_the_rotation() -> None:
    rng = np.random.default_rng(5)
    forces = [1 + 0.2 * np.cos(2 * np.pi * 1.2 * t + 1) + 0.05 * rng.standard_normal(t.size) for t in PARTS]
    assert find_rotation_speed(PARTS, forces, harmonics=3) == approx(1.2, abs=0.005)  # not 0.6 or 0.4


def test_a_recording_too_short_for_two_turns_at_its_rate_has_no_rotation() -> None:
    t = np.arange(12.0) * 0.1
    assert find_rotation_speed([t], [np.cos(2 * np.pi * t)], harmonics=3) is None


def test_the_trend_stays_in_the_force_and_the_deviation_counts_the_unknowns() -> None:
    turns = np.linspace(2.0, 9.5, 400)
    trend = 1.0 + 0.3 * turns - 0.02 * turns**2
    noise = 0.01 * np.random.default_rng(6).standard_normal(turns.size)
    force = trend + 0.2 * np.cos(2 * np.pi * turns - 0.4) + 0.1 * np.cos(4 * np.pi * turns + 1.1) + noise
    clean = remove_wobble(revolutions=turns, friction_force=force, harmonics=2, trend_degree=2)
    assert clean.wobble_amplitude == approx([0.2, 0.1], abs=3e-3)
    assert clean.phase == approx([0.4, -1.1], abs=0.03)
    assert clean.friction_force == approx(trend + noise, abs=6e-3)
    powers = np.vander(turns, 3)
    columns = [f(2 * np.pi * k * turns) for k in (1, 2) for f in (np.cos, np.sin)]
    design = np.column_stack([powers, *columns])
    left = force - design @ np.linalg.lstsq(design, force)[0]
    assert clean.friction_force_deviation == approx(np.sqrt(left @ left / (400 - 7)))
    straight = remove_wobble(revolutions=turns, friction_force=force, harmonics=2)
    assert straight.friction_force_deviation > 2 * clean.friction_force_deviation  # a line leaves the bend


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"revolutions": np.arange(5.0)}, "must be one-dimensional and equal in length"),
        ({"friction_force": np.full(100, np.inf)}, "must be finite or NaN, got an infinite value"),
        ({"harmonics": 0}, "harmonics must be positive and trend_degree not negative, got 0, 1"),
        ({"trend_degree": -1}, "got 3, -1"),
        ({"friction_force": np.where(np.arange(100) < 8, 1.0, np.nan)}, "holds 8 values; 8 unknowns need more"),
        ({"friction_force": np.where(np.arange(100) < 20, 1.0, np.nan)}, "cover 0.96 of a revolution"),
    ],
)
def test_what_cannot_be_fitted_is_refused(arguments: dict[str, object], words: str) -> None:
    given = {"revolutions": np.arange(100) * 0.05050505, "friction_force": np.ones(100)} | arguments
    with raises(InvalidInput, match=words):
        remove_wobble(**given)  # type: ignore[arg-type]


def test_a_level_may_be_the_whole_trend_and_a_single_harmonic_the_wobble() -> None:
    turns = np.arange(100) * 0.03
    clean = remove_wobble(
        revolutions=turns, friction_force=2 + 0.5 * np.sin(2 * np.pi * turns), harmonics=1, trend_degree=0
    )
    assert clean.wobble_amplitude == approx([0.5])
    assert clean.phase == approx([np.pi / 2])
    assert clean.friction_force == approx(2.0)
