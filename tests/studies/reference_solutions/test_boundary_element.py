"""Boundary elements against the closed forms of Hertz and Westergaard."""

import builtins
import math
from types import ModuleType

import numpy as np
import pytest
from pytest import MonkeyPatch, approx, raises

from reference_solutions import boundary_element_contact
from sonolube.errors import InvalidInput
from sonolube.models.contact import SphereOnFlat, hertz_contact_radius, hertz_peak_pressure
from sonolube.models.surfaces import GaussianCorrelationSpectrum, HeightMap, gaussian_surface

E_STAR = 100e9


@pytest.fixture(scope="module")
def _library() -> None:
    pytest.importorskip("ContactMechanics", exc_type=ImportError)


def sphere_map(radius: float, *, points: int = 96, width: float = 1e-3) -> HeightMap:
    x = (np.arange(points) + 0.5) * width / points - width / 2
    height = -(x[:, None] ** 2 + x[None, :] ** 2) / (2 * radius)
    return HeightMap(height=height, spacing_x=width / points, spacing_y=width / points)


@pytest.mark.usefixtures("_library")
def test_the_contact_of_a_sphere_is_that_of_hertz() -> None:
    sphere = SphereOnFlat(tip_radius=10e-3, effective_modulus=E_STAR)
    load = 300.0
    contact = boundary_element_contact(sphere_map(10e-3), normal_load=load, effective_modulus=E_STAR, periodic=False)
    assert contact.reason == ("",)
    # the zero of heights is the pole, so the flat comes below it by the approach
    approach = hertz_contact_radius(sphere, normal_load=load) ** 2 / sphere.tip_radius
    assert -contact.separation[0] == approx(float(approach), rel=2e-3)
    assert contact.real_contact_area[0] == approx(
        math.pi * hertz_contact_radius(sphere, normal_load=load) ** 2, rel=0.01
    )
    assert contact.peak_pressure[0] == approx(float(hertz_peak_pressure(sphere, normal_load=load)), rel=5e-3)


@pytest.mark.usefixtures("_library")
def test_the_contact_of_a_wave_is_that_of_westergaard() -> None:
    # Westergaard (1939), Johnson 13.2: strips of half width b with p/p* = sin^2(pi b/lambda), p* = pi E* h/lambda
    points, length, amplitude = 256, 1e-3, 1e-6
    height = amplitude * np.cos(2 * np.pi * (np.arange(points) + 0.5) / points)
    wave = HeightMap(height=np.tile(height, (8, 1)), spacing_x=length / points, spacing_y=length / points)
    full = math.pi * E_STAR * amplitude / length
    fraction = np.array([0.2, 0.5, 0.8])
    area = wave.height.size * wave.spacing_x * wave.spacing_y
    contact = boundary_element_contact(wave, normal_load=fraction * full * area, effective_modulus=E_STAR)
    assert contact.real_contact_area / area == approx(2 / np.pi * np.arcsin(np.sqrt(fraction)), abs=0.012)
    # mean gap, from the same solution: h (1 - p/p* + p/p* ln(p/p*))
    assert contact.separation == approx(amplitude * (1 - fraction + fraction * np.log(fraction)), rel=5e-3)


@pytest.fixture(scope="module")
def rough() -> HeightMap:
    return gaussian_surface(
        rms_height=0.5e-6,
        spectrum=GaussianCorrelationSpectrum(correlation_length=8e-6),
        shape=(128, 128),
        spacing_x=1e-6,
        spacing_y=1e-6,
        seed=7,
    )


@pytest.mark.usefixtures("_library")
def test_the_modulus_only_scales_the_load(rough: HeightMap) -> None:
    soft, hard = (
        boundary_element_contact(rough, normal_load=factor * 0.05, effective_modulus=factor * 1e9)
        for factor in (1.0, 100.0)
    )
    assert soft.separation == approx(hard.separation, rel=1e-3)
    assert soft.real_contact_area == approx(hard.real_contact_area, rel=1e-3)


def test_missing_pixels_are_refused(rough: HeightMap) -> None:
    height = rough.height.copy()
    height[3, 4] = np.nan
    with raises(InvalidInput, match="crop the map or fill them"):
        boundary_element_contact(rough.with_height(height), normal_load=1.0, effective_modulus=E_STAR)


def test_without_the_library_the_remedy_is_named(rough: HeightMap, monkeypatch: MonkeyPatch) -> None:
    whole_import = builtins.__import__

    def without(name: str, *arguments: object) -> ModuleType:
        if name.startswith("ContactMechanics"):
            raise ImportError(name)
        return whole_import(name, *arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(builtins, "__import__", without)
    with raises(InvalidInput, match=r"pip install ContactMechanics"):
        boundary_element_contact(rough, normal_load=1.0, effective_modulus=E_STAR)
