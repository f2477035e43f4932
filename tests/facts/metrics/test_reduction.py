"""Reductions and wear rate against numbers of the dissertation."""

from pytest import approx

from sonolube.facts.metrics import friction_reduction, wear_rate, wear_reduction


def test_reductions_are_relative_to_the_intrinsic_value() -> None:
    # D 2.5.5: from 0.769 N by 80.1 % to 0.153 N
    assert friction_reduction(intrinsic_friction_force=0.769, reduced_friction_force=0.153) == approx(0.801, abs=5e-4)
    # D Table 3.4: model wear rates, a reduction of 47 %
    assert wear_reduction(intrinsic_wear_rate=2.566e-11, reduced_wear_rate=1.355e-11) == approx(0.472, abs=5e-4)


def test_a_driving_vibration_reduces_friction_by_more_than_one_hundred_percent() -> None:
    assert friction_reduction(intrinsic_friction_force=1.0, reduced_friction_force=-0.1) == approx(1.1)


def test_wear_rate_is_volume_over_distance() -> None:
    # D Table 2.10: 0.013 mm3 over 2.2814 m, 0.0057 mm3/m
    assert wear_rate(wear_volume=0.013e-9, sliding_distance=2.2814) == approx(0.0057e-9, abs=5e-14)
