"""Rigs of the powder-coated plates of D 4.1.3 and 4.3 against what D prints of them."""

from pathlib import Path

import numpy as np
import pytest
from pytest import approx

from sonolube.facts.published import si_value
from sonolube.rig import friction_point, read_rig
from sonolube.validation.contacts import RMS_OVER_ARITHMETIC_MEAN

RIGS = Path(__file__).parents[2] / "examples" / "rigs"
COATED = ("coated_plate", "coated_temperature")


@pytest.mark.parametrize("name", COATED)
def test_a_coated_plate_has_the_printed_roughness_hardness_and_friction(name: str) -> None:
    rig = read_rig(RIGS / f"{name}.toml")
    roughness = RMS_OVER_ARITHMETIC_MEAN * si_value("4.1.3-roughness-coated")
    assert rig.contact.roughness.rms_height == approx(roughness, rel=2e-3)
    assert rig.contact.pair.yield_strength == approx(si_value("4.1.3-hardness-coating") / 3, rel=5e-3)  # Tabor
    ends = rig.uncertainty["friction.friction_coefficient"].quantile((0.0, 1.0))
    printed = (0.1 * si_value("4.1.3-friction-coated-first"), si_value("4.1.3-friction-coated-last"))  # E18
    assert ends == approx(printed)
    assert rig.friction_coefficient == approx(np.sqrt(np.prod(ends)), rel=5e-3)


def test_a_coated_plate_rubs_half_as_much_as_the_uncoated_one_in_the_same_test() -> None:
    # D 4.1.3: the rougher, coated plate has far less friction, 0.067 to 0.1 against 0.17 to 0.2
    coated, uncoated = (friction_point(read_rig(RIGS / f"{name}.toml")) for name in ("coated_plate", "power_map"))
    assert coated.vibration_amplitude == approx(uncoated.vibration_amplitude)
    assert 0.067 / 0.2 < coated.intrinsic_friction_force / uncoated.intrinsic_friction_force < 0.1 / 0.17
