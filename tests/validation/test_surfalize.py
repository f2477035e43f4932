"""surfalize 0.19.2 (GPL, run as another program): ISO 25178 parameters of one surface by both."""

import json
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
from pytest import approx

from sonolube.models.surfaces import (
    SelfAffineSpectrum,
    feature_parameters,
    functional_parameters,
    gaussian_surface,
    height_parameters,
    hybrid_parameters,
    spatial_parameters,
)

THEIRS = """
import json, sys
import numpy as np
from surfalize import Surface

surface = Surface(np.load(sys.argv[1]), 1.0, 1.0)
print(json.dumps({name: float(getattr(surface, name)()) for name in sys.argv[2:]}))
"""
HEIGHTS = ["Sa", "Sq", "Sp", "Sv", "Sz", "Ssk", "Sku"]
SHAPE = ["Sdq", "Sdr", "Sal", "Str", "Spd", "Spc"]
MATERIAL = ["Sk", "Spk", "Svk", "Smr1", "Smr2", "Vmp", "Vmc", "Vvc", "Vvv"]
NAMES = HEIGHTS + SHAPE + MATERIAL  # in um and per cent

SURFACE = gaussian_surface(
    rms_height=1e-6,
    spectrum=SelfAffineSpectrum(
        hurst_exponent=0.8, longest_wavelength=128e-6, rolloff_wavelength=64e-6, shortest_wavelength=6e-6
    ),
    shape=(600, 512),
    spacing_x=1e-6,
    spacing_y=1e-6,
    seed=1,
)


@pytest.fixture(scope="module")
def theirs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, float]:
    python = os.environ.get("SURFALIZE_PYTHON")
    if not python:
        pytest.skip("surfalize is not installed beside sonolube: make surfalize")
    path: Path = tmp_path_factory.mktemp("surfalize") / "height.npy"
    np.save(path, 1e6 * SURFACE.height)
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    run = subprocess.run(
        [python, "-c", THEIRS, path, *NAMES], capture_output=True, text=True, check=True, env=environment
    )
    return dict(json.loads(run.stdout))


@pytest.mark.external
def test_heights_agree_to_rounding(theirs: dict[str, float]) -> None:
    found = height_parameters(SURFACE)
    assert 1e6 * found.arithmetic_mean_height == approx(theirs["Sa"])
    assert 1e6 * found.rms_height == approx(theirs["Sq"])
    assert 1e6 * found.maximum_peak_height == approx(theirs["Sp"])
    assert 1e6 * found.maximum_pit_depth == approx(theirs["Sv"])
    assert 1e6 * found.total_height == approx(theirs["Sz"])
    assert (found.skewness, found.kurtosis) == approx((theirs["Ssk"], theirs["Sku"]))


@pytest.mark.external
def test_slope_area_and_reach_agree(theirs: dict[str, float]) -> None:
    hybrid, spatial = hybrid_parameters(SURFACE), spatial_parameters(SURFACE)
    assert 100 * hybrid.developed_interfacial_area_ratio == approx(theirs["Sdr"])
    assert hybrid.rms_gradient == approx(theirs["Sdq"], rel=1e-4)
    assert 1e6 * spatial.autocorrelation_length == approx(theirs["Sal"], rel=2e-3)
    assert spatial.texture_aspect_ratio == approx(theirs["Str"], rel=2e-3)


@pytest.mark.external
def test_the_material_ratio_agrees(theirs: dict[str, float]) -> None:
    found = functional_parameters(SURFACE)
    assert 1e6 * found.core_height == approx(theirs["Sk"], rel=1e-3)
    assert 1e6 * found.reduced_peak_height == approx(theirs["Spk"], rel=2e-3)
    assert 1e6 * found.reduced_valley_depth == approx(theirs["Svk"], rel=2e-3)
    assert 100 * found.peak_material_ratio == approx(theirs["Smr1"], rel=1e-3)
    assert 100 * found.valley_material_ratio == approx(theirs["Smr2"], rel=1e-3)
    assert 1e6 * found.peak_material_volume == approx(theirs["Vmp"], rel=2e-3)
    assert 1e6 * found.core_material_volume == approx(theirs["Vmc"], rel=1e-3)
    assert 1e6 * found.core_void_volume == approx(theirs["Vvc"], rel=1e-3)
    assert 1e6 * found.valley_void_volume == approx(theirs["Vvv"], rel=1e-3)


@pytest.mark.external
def test_hills_agree_but_for_those_at_the_edge(theirs: dict[str, float]) -> None:
    # it leaves out hills that the edge cuts: about as many as hills of the mean width fit along it
    found = feature_parameters(SURFACE)
    cut = 2 * (512e-6 + 600e-6) * found.peak_density**0.5 / (512e-6 * 600e-6)
    assert 1e-12 * (found.peak_density - cut) == approx(theirs["Spd"], rel=0.05)
    assert 1e-6 * found.mean_peak_curvature == approx(theirs["Spc"], rel=0.02)
