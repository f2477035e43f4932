"""Structure of the tribometer rig against the identification from published facts."""

import pytest
from pytest import approx
from tests.identified import identified_tribometer

from sonolube.validation.tribometer import IDENTIFIED


@pytest.mark.slow
def test_the_parameters_of_the_structure_are_those_identified() -> None:
    found = identified_tribometer().estimates
    for name, value in IDENTIFIED.items():
        assert value == approx(found[name].value, rel=5e-3), name
