"""Dimensions of collars that do not fit."""

from dataclasses import replace

import pytest
from pytest import raises

pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")

from dong2015.hardware.collar import FINAL_COLLAR
from sonolube.errors import InvalidInput


def test_dimensions_that_do_not_fit_are_refused() -> None:
    with raises(InvalidInput, match=r"bore_diameter must not exceed ring_width, 0\.02549 m, got 0\.03 m"):
        replace(FINAL_COLLAR, bore_diameter=0.03)
    with raises(InvalidInput, match=r"pillar_width must be positive, got 0\.0 m"):
        replace(FINAL_COLLAR, pillar_width=0.0)
    with raises(InvalidInput, match="do not fit into the outer ring's length"):
        replace(FINAL_COLLAR, base_thickness=0.06)
    with raises(InvalidInput, match="does not fit between the pillars"):
        replace(FINAL_COLLAR, pillar_width=0.04)
    with raises(InvalidInput, match="one or two stacks, got 3"):
        replace(FINAL_COLLAR, stacks=3)
