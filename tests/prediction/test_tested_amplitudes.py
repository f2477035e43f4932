"""Amplitudes beyond the published tests, in decay lengths."""

from pathlib import Path

import pytest
from pytest import approx

from sonolube.prediction.evidence import amplitude_ratios_of_tests, large_amplitude_caveats
from sonolube.rig import read_rig
from sonolube.rig.resolved_rig import resolved_rig

RIG = Path(__file__).parents[2] / "examples" / "rigs" / "tribometer.toml"


def test_the_tested_amplitudes_are_those_of_the_dissertation_over_a_third_of_the_roughness() -> None:
    # R_q 6 um: the welder has 11.46 um, the most, and the flextensional actuator 0.693 um, the least
    low, high = amplitude_ratios_of_tests()
    assert high == approx(3 * 11.46 / 6, rel=2e-3)
    assert low == approx(3 * 0.693 / 6, rel=2e-3)


@pytest.mark.parametrize(("amplitude", "said"), [(2.5e-6, False), (11e-6, False), (18e-6, True)])
def test_an_amplitude_of_more_decay_lengths_than_any_test_is_said(amplitude: float, said: bool) -> None:
    # R_q 6 um: a decay length of 2 um, so that 18 um are 9 of them
    found = large_amplitude_caveats(resolved_rig(read_rig(RIG)), vibration_amplitude=amplitude)
    assert bool(found) == said
    assert not said or "9 decay lengths" in found[0]
