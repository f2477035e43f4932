"""The welder's motor and the flextensional actuator: hand arithmetic on their printed numbers."""

from pytest import approx
from scipy.special import i0

from sonolube.reproduce import Verdict
from sonolube.reproduce.chapter2 import flextensional as chapter2_flextensional, motor as chapter2_motor
from sonolube.reproduce.chapter2.flextensional import gain_for_the_slow_test
from sonolube.reproduce.chapter2.motor import drop_by_current, welder_motor

ROWS = {row.id: row for row in (*chapter2_motor.rows(), *chapter2_flextensional.rows())}


def test_both_tests_show_one_torque_constant() -> None:
    # Cramer's rule on 8 V = R 1.427 A + k 2 pi 54.9/min and 8 V = R 1 A + k 2 pi 76.7/min
    first, second = 5.74911, 8.03200  # rad/s
    constant = 8 * (1.427 - 1) / (1.427 * second - 1 * first)
    assert welder_motor(0).torque_constant == approx(constant, rel=1e-5)
    assert welder_motor(1).torque_constant == approx(constant, rel=0.003)
    assert welder_motor(1).resistance == approx(1.24 * welder_motor(0).resistance, rel=1e-2)


def test_the_current_gives_the_flat_tips_drop_of_friction_but_not_the_round_tips() -> None:
    assert drop_by_current(0) == approx(0.5993 * 0.427 / 0.030, rel=1e-3)
    assert drop_by_current(1) == approx(0.5980 * 0.407 / 0.03302, rel=1e-3)
    assert abs(drop_by_current(1) / (18.2 - 10.32) - 1) < 0.07
    assert drop_by_current(0) / (11.875 - 6.084) > 1.4


def test_the_jump_in_speed_follows_from_the_drop_of_friction() -> None:
    # flat: 7.88 N on 33.02 mm is 0.2602 N m, 0.4351 A at 0.598 N m/A; R from 8 V, 1.208 A and 51.2/min
    resistance = (8 - 0.59798 * 5.36165) / 1.208
    speed = (8 - resistance * (1.208 - 0.4351)) / 0.59798 / 6.283185 * 60
    assert ROWS["2.4.2-rotation-on-flat-motor"].computed == approx(speed, rel=1e-3)
    assert ROWS["2.4.4-current-drop-flat-motor"].verdict is Verdict.REPRODUCED
    assert ROWS["2.4.2-rotation-on-round-motor"].verdict is Verdict.MODEL_DISAGREES


def test_more_offset_at_the_same_voltage_peak_to_peak_changes_nothing() -> None:
    levels = {ROWS[f"2.2.6-reduction-level-{level}"].computed for level in (1, 2, 3)}
    assert len(levels) == 1


def test_the_slow_test_asks_for_a_gain_of_three_at_resonance() -> None:
    # in the limit of slow sliding the ratio is exp(-beta)/I0(beta); at 3.5 mm/s somewhat more is left
    beta = gain_for_the_slow_test() * 52e-6 * 4 / 150 / 2 / 2e-6
    plateau = float(2.718281828**-beta / i0(beta))
    assert 0.2 < plateau < 0.3
    assert ROWS["2.2.5-speed-of-no-reduction-stick-slip"].computed == approx(
        1e3 * 0.75 * 2 * 3.14159265 * 16e3 * beta * 2e-6, rel=1e-6
    )
    assert ROWS["2.2.2-pulling-force-factor"].verdict is Verdict.REPRODUCED
