"""Amplifier limits against the definition of slew rate and current."""

import numpy as np
from pytest import approx

from sonolube.design.control import Amplifier, active_limit, swing_limit


def test_a_sine_at_the_slew_limit_has_the_slew_rate_as_its_steepest_slope() -> None:
    swing = swing_limit(Amplifier(voltage_maximum=500.0, slew_rate_maximum=1e6), admittance=0.01j, frequency=22e3)
    t = np.linspace(0, 1 / 22e3, 20_001)
    slope = np.gradient(0.5 * swing * np.sin(2 * np.pi * 22e3 * t), t)
    assert np.abs(slope).max() == approx(1e6, rel=1e-4)


def test_the_current_limit_follows_from_the_admittance() -> None:
    amplifier = Amplifier(voltage_maximum=100.0, current_maximum=0.5)
    swing = swing_limit(amplifier, admittance=0.03 + 0.04j, frequency=22e3)
    assert 0.05 * swing / 2 == approx(0.5)
    assert active_limit(amplifier, admittance=0.03 + 0.04j, frequency=22e3) == "current"
