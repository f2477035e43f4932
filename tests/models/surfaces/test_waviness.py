"""Dominant wavelengths of surfaces made of known waves."""

from typing import Literal

import numpy as np
from hypothesis import given, settings, strategies as st
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.models.surfaces import HeightMap, dominant_wavelengths

X, Y = np.meshgrid(8e-6 * np.arange(300), 10e-6 * np.arange(240))  # 2.4 mm by 2.4 mm


def surface(height: np.ndarray) -> HeightMap:
    return HeightMap(height=height, spacing_x=8e-6, spacing_y=10e-6)


@settings(deadline=None)
@given(length=st.floats(60e-6, 600e-6), phase=st.floats(0, 6))
def test_the_wavelength_of_one_wave_is_found(length: float, phase: float) -> None:
    wave = 1e-6 * np.sin(2 * np.pi * X / length + phase) + 2e-5 * X + 1e-5 * Y
    assert dominant_wavelengths(surface(wave), most=1)[0] == approx(length, rel=0.002 + 0.05 * length / 2.4e-3)


def test_two_scales_of_waviness_are_resolved_in_both_directions() -> None:
    # D 4.1.3: 0.18 mm both ways, 1.25 mm along x and 0.95 mm along y.
    rng = np.random.default_rng(0)
    along: Literal["rows", "columns"]
    z = np.sin(2 * np.pi * X / 0.18e-3) * np.cos(2 * np.pi * Y / 0.18e-3 + 1)
    z += 1.5 * np.sin(2 * np.pi * X / 1.25e-3) + 1.5 * np.cos(2 * np.pi * Y / 0.95e-3)
    z += 0.3 * rng.normal(size=z.shape)
    z[rng.random(z.shape) < 0.02] = np.nan
    for along, coarse in (("rows", 1.25e-3), ("columns", 0.95e-3)):
        found = dominant_wavelengths(surface(1e-6 * z), along=along, most=2)
        assert found[0] == approx(coarse, abs=coarse**2 / 2.4e-3 / 3)  # hardly two waves in the map
        assert found[1] == approx(0.18e-3, rel=0.002)


def test_a_plane_has_no_waviness() -> None:
    assert dominant_wavelengths(surface(np.ones_like(X))).size == 0


def test_too_few_pixels_are_refused() -> None:
    with raises(InvalidInput, match="waviness requires at least 16 pixels along columns, got 3"):
        dominant_wavelengths(surface(X[:3]), along="columns")
