"""Signals of a virtual test by closed forms, conservation and the equation of motion."""

from math import atan, exp, pi, sqrt

import numpy as np
import pytest
from pytest import approx
from scipy.integrate import quad, solve_ivp

from sonolube.laboratory.virtual_tribometer.signals import (
    Approach,
    Bursts,
    ColouredNoise,
    Lagged,
    StickSlip,
    arm_resonance,
    correlated,
    hall_pulses,
    play,
    pulled,
    resonant,
)
from sonolube.models.dynamics import Structure

SPEED_UP = Approach(2.0, 5.0, 11.0, 4.0)  # from 5 at 2 s to 11 with 4 s


def test_an_approach_leaves_a_share_of_one_over_e_after_its_time_constant() -> None:
    found = SPEED_UP.at(np.array([2.0, 6.0, 1e4]))
    assert found == approx([5.0, 11.0 - 6.0 * exp(-1), 11.0])


def test_the_integral_of_an_approach_is_that_of_its_values() -> None:
    for end in (2.0, 3.0, 20.0):
        area, _ = quad(lambda time: float(SPEED_UP.at(np.asarray(time))), 2.0, end)
        assert float(SPEED_UP.integral(np.asarray(end))) == approx(area, abs=1e-9)


def test_an_approach_to_another_target_goes_on_from_where_it_is() -> None:
    turned = SPEED_UP.towards(-1.0, time=6.0)
    assert (turned.start, turned.target, turned.time_constant) == (6.0, -1.0, 4.0)
    assert turned.value == approx(11.0 - 6.0 * exp(-1))


def test_a_lagged_reading_obeys_the_law_of_first_order_from_its_own_beginning() -> None:
    lagged = Lagged(SPEED_UP, 3.0, 0.7)

    def rate(time: float, reading: np.ndarray) -> np.ndarray:
        return np.asarray((SPEED_UP.at(np.asarray(time)) - reading) / 0.7)

    times = np.array([2.0, 2.5, 4.0, 12.0])
    solved = solve_ivp(rate, (2.0, 12.0), [3.0], t_eval=times, rtol=1e-9, atol=1e-9).y[0]
    assert lagged.at(times) == approx(solved, rel=1e-6)
    assert float(lagged.at(np.asarray(1e3))) == approx(11.0)


def test_a_lagged_reading_towards_another_target_is_continuous_and_keeps_its_lag() -> None:
    lagged = Lagged(SPEED_UP, 3.0, 0.7)
    turned = lagged.towards(0.0, time=4.0)
    assert turned.reading == approx(float(lagged.at(np.asarray(4.0))))
    assert turned.source == SPEED_UP.towards(0.0, time=4.0)
    assert turned.time_constant == 0.7
    assert float(turned.at(np.asarray(4.0))) == approx(turned.reading)


def test_the_pulse_of_a_magnet_is_a_gaussian_of_height_one_midway_between_whole_turns() -> None:
    # three magnets: centres at 1/6, 1/2, 5/6 turns; standard deviation 0.06 of a third of a turn
    centres = np.array([1 / 6, 1 / 2, 5 / 6, 7 / 6])
    assert hall_pulses(revolutions=centres, magnets=3) == approx(1.0)
    beside = hall_pulses(revolutions=centres[:2] + np.array([-1, 2]) * 0.06 / 3, magnets=3)
    assert beside == approx([exp(-0.5), exp(-2.0)])


def test_an_operator_pulls_five_times_for_thirty_seconds_each_a_fifth_further() -> None:
    peaks = pulled(since=np.array([15.0, 45.0, 75.0, 105.0, 135.0, 165.0]), greatest=10.0)
    assert peaks == approx([2.0, 4.0, 6.0, 8.0, 10.0, 0.0])
    assert pulled(since=np.array([0.0, 7.5, 22.5, 30.0, 97.5]), greatest=10.0) == approx([0.0, 1.0, 1.0, 0.0, 4.0])


def test_coloured_noise_has_unit_variance_and_the_correlation_of_its_recursion() -> None:
    # of x_n = a x_(n-1) + b x_(n-2) + w_n: r_1 = a/(1-b), r_2 = a r_1 + b (Yule and Walker)
    for feedback in ((0.6, 0.0), (1.2, -0.5), (-0.4, 0.3)):
        found = ColouredNoise(np.random.default_rng(1), feedback).next(400_000)[1000:]
        first = feedback[0] / (1 - feedback[1])
        second = feedback[0] * first + feedback[1]
        assert np.var(found) == approx(1.0, abs=0.02)
        assert np.mean(found[1:] * found[:-1]) == approx(first, abs=0.02)
        assert np.mean(found[2:] * found[:-2]) == approx(second, abs=0.02)


def test_noise_without_feedback_is_white_and_with_one_coefficient_only_is_not() -> None:
    white = np.random.default_rng(4).standard_normal(5)
    assert ColouredNoise(np.random.default_rng(4)).next(5) == approx(white)
    for feedback in ((0.5, 0.0), (0.0, 0.5)):
        assert ColouredNoise(np.random.default_rng(4), feedback).next(5)[2:] != approx(white[2:])


def test_coloured_noise_goes_on_from_block_to_block() -> None:
    whole = ColouredNoise(np.random.default_rng(7), (1.2, -0.5)).next(30)
    noise = ColouredNoise(np.random.default_rng(7), (1.2, -0.5))
    assert np.concatenate([noise.next(1), noise.next(12), noise.next(17)]) == approx(whole)


def test_correlated_noise_loses_a_factor_e_in_its_time_constant() -> None:
    first, second = correlated(time_constant=0.02, sample_rate=500.0)  # ten samples
    assert (first**10, second) == approx((exp(-1), 0.0))


def test_resonant_noise_has_the_poles_of_the_damped_oscillator() -> None:
    # s = omega (-zeta +- i sqrt(1 - zeta^2)), z = exp(s/fs); z^2 - a1 z - a2 = 0
    omega, zeta, rate = 2 * pi * 90.0, 0.2, 1000.0
    first, second = resonant(frequency=90.0, damping_ratio=zeta, sample_rate=rate)
    roots = np.sort_complex(np.roots([1.0, -first, -second]))
    pole = np.exp(omega * (-zeta + 1j * sqrt(1 - zeta**2)) / rate)
    assert roots == approx(np.sort_complex([pole, np.conj(pole)]))


def test_a_resonance_above_two_fifths_of_the_rate_is_white() -> None:
    assert resonant(frequency=401.0, damping_ratio=0.1, sample_rate=1000.0) == (0.0, 0.0)
    assert resonant(frequency=400.0, damping_ratio=0.1, sample_rate=1000.0) != (0.0, 0.0)


def test_play_holds_until_the_input_has_crossed_half_its_width_on_either_side() -> None:
    found = play(np.array([1.0, 0.0, 5.0, 4.0, 3.5, -2.0]), 1.5, 0.2)
    assert found == approx([0.2, 0.2, 3.5, 3.5, 3.5, -0.5])


def test_the_arm_swings_as_the_free_part_of_a_structure_whose_pin_is_held() -> None:
    # masses 2 kg (free) and 3 kg (pin, held): spring of 800 N/m to the pin and 450 N/m to ground on the free one:
    # omega = sqrt(1250/2) = 25 rad/s; damping 6 N s/m: zeta = 6/(2*2*25) = 0.06
    structure = Structure(
        mass_matrix=np.diag([2.0, 3.0]),
        damping_matrix=np.array([[6.0, -1.0], [-1.0, 4.0]]),
        stiffness_matrix=np.array([[1250.0, -800.0], [-800.0, 900.0]]),
        drive_vector=np.array([1.0, 0.0]),
        contact_vector=np.array([0.0, 1.0]),
        clamped_capacitance=1e-7,
    )
    assert arm_resonance(structure) == approx((25.0 / (2 * pi), 0.06))


STICKING = StickSlip(excess_force=0.8, stiffness=2000.0, mass=0.05, damping_ratio=0.01, sliding_speed=0.02)
OMEGA = 200.0  # sqrt(2000/0.05)


def test_sliding_is_steady_above_the_speed_at_which_one_swing_loses_the_excess() -> None:
    # 0.8 / sqrt(100 (exp(0.125664) - 1)) = 0.8 / sqrt(13.39006) = 0.218625
    assert STICKING.highest_speed == approx(0.8 / sqrt(100 * (exp(0.04 * pi) - 1)))
    assert STICKING.highest_speed == approx(0.2186, abs=1e-4)
    undamped = StickSlip(excess_force=0.8, stiffness=2e3, mass=0.05, damping_ratio=0.0, sliding_speed=1e3)
    assert (undamped.highest_speed, undamped.occurs) == (float("inf"), True)


@pytest.mark.parametrize(
    ("excess", "speed", "occurs", "bursts"),
    [
        (0.8, 0.02, True, False),
        (0.8, 0.109, True, False),
        (0.8, 0.110, True, True),
        (0.8, 0.218, True, True),
        (0.8, 0.219, False, False),
        (0.8, 0.0, False, False),
        (0.0, 0.02, False, False),
    ],
)
def test_stick_slip_needs_an_excess_and_a_speed_and_comes_in_bursts_above_half_the_highest(
    excess: float, speed: float, occurs: bool, bursts: bool
) -> None:
    found = StickSlip(excess_force=excess, stiffness=2e3, mass=0.05, damping_ratio=0.01, sliding_speed=speed)
    assert (found.occurs, found.comes_in_bursts) == (occurs, bursts)
    assert (found.fall > 0) is occurs
    assert bool(np.any(found.force(np.linspace(0.0, 0.1, 50)) != 0)) is occurs


def test_a_period_is_the_slip_and_the_rise_of_twice_the_excess_at_the_speed_of_the_spring() -> None:
    # omega dF/(k v) = 200 * 0.8/40 = 4: slip 0.01 (pi - atan 4) = 18.158 ms; rise 1.6/40 = 40 ms
    slip = 0.01 * (pi - atan(4.0))
    assert STICKING.slip_time == approx(slip)
    assert STICKING.period == approx(slip + 0.04)
    # the greatest deviation is hypot(dF, k v/omega) = hypot(0.8, 0.2)
    assert STICKING.fall == approx(2 * sqrt(0.64 + 0.04))


def test_the_force_swings_freely_while_it_slips_and_rises_evenly_while_it_sticks() -> None:
    slip = STICKING.slip_time
    assert STICKING.force(np.array([0.0, slip])) == approx([0.8, -0.8])
    time = np.array([0.3, 0.7]) * slip
    free = 0.8 * np.cos(OMEGA * time) + 40.0 / OMEGA * np.sin(OMEGA * time)
    assert STICKING.force(time) == approx(free)
    assert STICKING.force(np.array([slip + 0.01, slip + 0.03])) == approx([-0.4, 0.4])
    assert STICKING.force(time + 3 * STICKING.period) == approx(free)
    whole = STICKING.force(np.linspace(0.0, STICKING.period, 100_001))
    assert np.ptp(whole) == approx(STICKING.fall, rel=1e-6)


def drawn_ends(seed: int, mean: float, count: int) -> np.ndarray:
    """Ends of bursts and pauses by the same generator."""
    rng = np.random.default_rng(seed)
    return np.cumsum([rng.exponential(mean) for _ in range(count)])


def test_bursts_and_pauses_take_turns_at_the_ends_that_are_drawn() -> None:
    ends = drawn_ends(3, 2.0, 6)
    time = np.sort(np.concatenate([ends[:4] - 1e-6, ends[:4] + 1e-6]))
    # each end changes from burst to pause or back; the first span is a burst
    assert Bursts(np.random.default_rng(3), 2.0).are_on(time).tolist() == [True, False, False, True] * 2
    halves = Bursts(np.random.default_rng(3), 2.0)
    later = halves.are_on(time[4:])
    assert [*halves.are_on(time[:4]), *later] == [True, False, False, True] * 2


def test_a_burst_without_end_has_no_pause() -> None:
    endless = Bursts(np.random.default_rng(3), 0.0)
    assert endless.are_on(np.array([0.0, 1e6])).all()
    assert endless.share(1.0, 5.0) == 1.0
    assert Bursts(np.random.default_rng(3), 2.0).are_on(np.array([])).size == 0


def test_the_share_of_a_span_with_bursts_is_the_time_in_bursts_over_the_span() -> None:
    a, b, c, d = drawn_ends(3, 2.0, 4)
    share = Bursts(np.random.default_rng(3), 2.0).share
    assert share(0.0, a) == approx(1.0)
    assert share(0.0, b) == approx(a / b)
    assert share(a, b) == approx(0.0)
    first, last = a / 2, (c + d) / 2
    assert share(first, last) == approx((a - first + c - b) / (last - first))
    assert share(b, (b + c) / 2) == approx(1.0)
    assert share(5.0, 5.0) == 1.0
    assert share(5.0, 4.0) == 1.0
