"""Sensitivity of the collar against ring theory, and the documented fit."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx, raises

pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")

from dong2015.hardware.collar import ASSUMED_RANGES, FINAL_COLLAR, NOMINAL_COLLAR
from dong2015.hardware.collar_analysis import reduced_collar_model
from dong2015.hardware.collar_tuning import main_resonance, tuned_collar
from sonolube.errors import InvalidInput


def test_a_wider_bore_lowers_the_resonance_by_the_thinner_wall() -> None:
    # Thin rings turn oval in proportion to wall over squared mean radius: d ln f/d ln bore = -3 - 0.86 = -3.9 here, of
    # which stack and frame, which share the mode, leave a part.
    narrow, wide = (
        main_resonance(reduced_collar_model(replace(FINAL_COLLAR, bore_diameter=factor * FINAL_COLLAR.bore_diameter)))
        for factor in (0.96, 1.04)
    )
    assert -3.9 < np.log(wide.series_frequency / narrow.series_frequency) / np.log(1.04 / 0.96) < -1


@pytest.mark.slow
def test_the_fit_finds_the_documented_dimensions() -> None:
    found = tuned_collar(NOMINAL_COLLAR, closed_frequency=25e3, open_frequency=24.4e3, bounds=ASSUMED_RANGES)
    for name in ASSUMED_RANGES:
        assert getattr(found, name) == approx(getattr(FINAL_COLLAR, name), rel=0.015)


def test_a_fit_without_dimensions_is_refused() -> None:
    with raises(InvalidInput, match="bounds name no dimension"):
        tuned_collar(FINAL_COLLAR, closed_frequency=25e3, open_frequency=24e3, bounds={})
