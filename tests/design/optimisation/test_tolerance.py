"""Manufacturing deviations: corners of the worst case, samples of a quantile."""

import numpy as np
from pytest import approx, mark, raises

from sonolube.design.optimisation import NOMINAL, Deviation, Tolerance, deviations, worst_or_quantile
from sonolube.design.optimisation.requirements import HalfWaveHorn, Limits, preload_bolt
from sonolube.errors import InvalidInput


def test_the_corners_move_stiffness_against_mass_and_a_quantile_samples_normal_deviations() -> None:
    corners = deviations(Tolerance(manufacturing_tolerance=0.05))
    assert corners[0] == NOMINAL
    assert max(each.stiffness / each.mass for each in corners) == approx(1.05 / 0.95)
    assert {each.gain for each in corners} == {1.0, 0.95, 1.05}
    sampled = deviations(Tolerance(manufacturing_tolerance=0.05, quantile=0.9))
    assert np.std([each.mass for each in sampled[1:]]) == approx(0.05, rel=0.5)
    values = np.arange(11.0)[:, np.newaxis]
    assert worst_or_quantile(values, Tolerance(manufacturing_tolerance=0.05)) == approx([10.0])
    assert worst_or_quantile(values, Tolerance(manufacturing_tolerance=0.05, quantile=0.5)) == approx([6.0])
    assert Deviation() == NOMINAL


@mark.parametrize("quantile", [0.4, 1.01, 1.5])
def test_a_quantile_outside_a_half_to_one_is_refused(quantile: float) -> None:
    with raises(InvalidInput, match="quantile must"):
        Tolerance(manufacturing_tolerance=0.1, quantile=quantile)
    assert Tolerance(manufacturing_tolerance=0.1, quantile=1.0).quantile == 1.0


@mark.parametrize("tolerance", [-0.01, 0.31])
def test_a_tolerance_outside_zero_to_thirty_percent_is_refused(tolerance: float) -> None:
    with raises(InvalidInput, match="manufacturing_tolerance"):
        Tolerance(manufacturing_tolerance=tolerance)
    assert Tolerance(manufacturing_tolerance=0.0).manufacturing_tolerance == 0.0
    assert Tolerance(manufacturing_tolerance=0.3, quantile=0.5).quantile == 0.5


def test_samples_of_a_quantile_are_thirty_two_within_three_deviations_and_leave_the_nominal_design_out() -> None:
    sampled = deviations(Tolerance(manufacturing_tolerance=0.1, quantile=0.9, seed=7))
    assert sampled[0] == NOMINAL
    assert len(sampled) == 33
    factors = np.array([(each.stiffness, each.mass, each.gain) for each in sampled[1:]])
    assert np.all(np.abs(factors - 1) <= 0.3 + 1e-12)
    assert np.abs(np.corrcoef(factors.T)[0, 1]) < 0.5  # stiffness and mass deviate by themselves
    again, other = (
        [each.mass for each in deviations(Tolerance(manufacturing_tolerance=0.1, quantile=0.9, seed=seed))]
        for seed in (7, 8)
    )
    assert again[1:] == approx(factors[:, 1])
    assert other[1:] != approx(factors[:, 1])
    assert worst_or_quantile(np.array([9.0, 1.0, 2.0]), Tolerance(manufacturing_tolerance=0.1, quantile=1.0)) == approx(
        2.0
    )
    assert worst_or_quantile(np.array([9.0, 1.0, 2.0]), None) == approx(9.0)


def test_a_bolt_is_known_by_its_thread_in_millimetres_and_the_length_that_stretches() -> None:
    bolt = preload_bolt("M2.5x40mm", preload=500.0, yield_strength=640e6, name="bolt")
    assert (bolt.thread_diameter, bolt.length) == approx((2.5e-3, 0.04))
    assert (bolt.preload, bolt.yield_strength, bolt.youngs_modulus) == approx((500.0, 640e6, 205e9))
    assert preload_bolt(" M8x5cm ", preload=500.0, yield_strength=640e6, name="bolt").length == approx(0.05)
    with raises(InvalidInput, match="bolt 6x40mm must look like M6x40mm"):
        preload_bolt("6x40mm", preload=500.0, yield_strength=640e6, name="bolt")


@mark.parametrize(
    ("limit", "message"),
    [({"voltage_maximum": 0.0}, "voltage_maximum must be positive"),
     ({"current_maximum": -1.0}, "current_maximum must be positive"),
     ({"slew_rate_maximum": 0.0}, "slew_rate_maximum must be positive"),
     ({"nominal_pressure": 0.0}, "nominal_pressure must be positive"),
     ({"thermal_conductance": 0.0}, "thermal_conductance must be positive"),
     ({"loss_tangent": -0.1}, "loss_tangent must not be negative"),
     ({"fatigue_safety": 0.0}, "fatigue_safety must be positive"),
     ({"yield_safety": 0.0}, "yield_safety must be positive"),
     ({"temperature_rise": 20.0}, "temperature_rise needs thermal_conductance"),
     ({"temperature_rise": 0.0, "thermal_conductance": 0.1}, "temperature_rise must be positive")],
)  # fmt: skip
def test_a_limit_that_is_none_is_refused_by_its_name(limit: dict[str, float], message: str) -> None:
    with raises(InvalidInput, match=message):
        Limits(**limit)  # type: ignore[arg-type]
    assert Limits(loss_tangent=0.0, temperature_rise=20.0, thermal_conductance=0.1).temperature_rise == 20.0
    with raises(InvalidInput, match="density must be positive"):
        HalfWaveHorn(density=0.0, youngs_modulus=1.0, stress_limit=1.0)
