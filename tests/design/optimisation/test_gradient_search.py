"""Derivatives that the search for designs goes by, beside differences of the friction of single points."""

from pathlib import Path

from pytest import approx

from sonolube.design.optimisation.gradient_search import _friction_derivatives
from sonolube.rig import read_rig
from sonolube.rig.friction_and_wear import friction_ratios, prescribed_sine
from sonolube.rig.resolved_rig import resolved_rig

RIGS = Path(__file__).parents[3] / "examples" / "rigs"


def test_the_friction_ratio_changes_with_amplitude_and_frequency_by_its_derivatives() -> None:
    rig = resolved_rig(read_rig(RIGS / "tribometer.toml")).moved
    amplitude, frequency = 2e-6, rig.drive.frequency

    def ratio(a: float, f: float) -> float:
        sine = prescribed_sine(rig, vibration_amplitude=a, frequency=f)
        return float(friction_ratios(rig, sine, sliding_speed=rig.sliding_speed).friction_ratio)

    by_amplitude, by_frequency = _friction_derivatives(rig, amplitude)
    for step in (0.01, -0.01):
        changed = ratio(amplitude * (1 + step), frequency) - ratio(amplitude, frequency)
        assert changed == approx(by_amplitude * amplitude * step, rel=0.05)
        changed = ratio(amplitude, frequency * (1 + step)) - ratio(amplitude, frequency)
        assert changed == approx(by_frequency * frequency * step, rel=0.05)
