"""Designs of the collar: bounds and sources of the dimensions."""

import pytest

pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")

from dong2015.hardware.collar import (
    ASSUMED_RANGES,
    COLLAR_DIMENSION_SOURCES,
    FINAL_COLLAR,
    NOMINAL_COLLAR,
    dimension_names,
)


def test_assumed_dimensions_are_within_their_ranges_and_each_has_a_source() -> None:
    assert set(COLLAR_DIMENSION_SOURCES) == set(dimension_names())
    assert all(origin.startswith(("printed", "assumed")) for origin in COLLAR_DIMENSION_SOURCES.values())
    for name, (low, high) in ASSUMED_RANGES.items():
        assert "assumed" in COLLAR_DIMENSION_SOURCES[name]
        assert low < getattr(FINAL_COLLAR, name) < high
    kept = set(dimension_names()) - set(ASSUMED_RANGES)
    assert all(getattr(FINAL_COLLAR, name) == getattr(NOMINAL_COLLAR, name) for name in kept)
