"""Motor of the welder rig: hand arithmetic on its printed numbers."""

from pytest import approx

from dong2015 import Verdict
from dong2015.chapter2.welder import friction_drop_from_current, welder_motor, welder_motor_rows

ROWS = {row.id: row for row in welder_motor_rows()}
ROUND, FLAT = 1, 2


def test_both_tests_yield_one_torque_constant() -> None:
    # Cramer's rule on 8 V = R 1.427 A + k 2 pi 54.9/min and 8 V = R 1 A + k 2 pi 76.7/min
    first, second = 5.74911, 8.03200  # rad/s
    constant = 8 * (1.427 - 1) / (1.427 * second - 1 * first)
    assert welder_motor(ROUND).torque_constant == approx(constant, rel=1e-5)
    assert welder_motor(FLAT).torque_constant == approx(constant, rel=0.003)
    assert welder_motor(FLAT).resistance == approx(1.24 * welder_motor(ROUND).resistance, rel=1e-2)


def test_the_current_predicts_the_drop_of_friction_of_the_flat_tip_but_not_of_the_round_one() -> None:
    assert friction_drop_from_current(ROUND) == approx(0.5993 * 0.427 / 0.030, rel=1e-3)
    assert friction_drop_from_current(FLAT) == approx(0.5980 * 0.407 / 0.03302, rel=1e-3)
    assert abs(friction_drop_from_current(FLAT) / (18.2 - 10.32) - 1) < 0.07
    assert friction_drop_from_current(ROUND) / (11.875 - 6.084) > 1.4


def test_the_change_of_speed_follows_from_the_drop_of_friction() -> None:
    # flat: 7.88 N on 33.02 mm is 0.2602 N m, 0.4351 A at 0.598 N m/A; R from 8 V, 1.208 A and 51.2/min
    resistance = (8 - 0.59798 * 5.36165) / 1.208
    speed = (8 - resistance * (1.208 - 0.4351)) / 0.59798 / 6.283185 * 60
    assert ROWS["2.4.2-rotation-on-flat-motor"].computed == approx(speed, rel=1e-3)
    assert ROWS["2.4.4-current-drop-flat-motor"].verdict is Verdict.REPRODUCED
    assert ROWS["2.4.2-rotation-on-round-motor"].verdict is Verdict.NOT_REPRODUCED
