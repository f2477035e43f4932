"""Largest swing of a drive within the limits of stack and amplifier, by hand."""

from dataclasses import replace
from pathlib import Path

import pytest
from pytest import approx

from sonolube.design.optimisation import Limits
from sonolube.design.optimisation.evaluation import maximum_swing
from sonolube.rig import read_rig

RIG = read_rig(Path(__file__).parents[3] / "examples" / "rigs" / "tribometer.toml")


@pytest.mark.parametrize("limit", [5.0, 12.0, 20.0])
def test_half_a_swing_and_its_offset_reach_the_limit_of_the_amplifier_and_never_exceed_it(limit: float) -> None:
    assert RIG.drive is not None
    ratio = RIG.drive.offset_ratio
    swing = maximum_swing(RIG, replace(Limits(), voltage_maximum=limit))
    reached = (0.5 + abs(ratio)) * swing
    assert reached == approx(limit, rel=1e-6)
    assert reached <= limit
