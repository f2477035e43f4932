"""Parameters of a map of 2048 by 2048 pixels, beside SurfaceTopography and, in a process of its own, surfalize.

surfalize is licensed under the GPL and is only ever run as another program: name a Python that has it in the
environment variable SURFALIZE_PYTHON. It times itself and answers with its medians; its lines in the table are a sleep
of that length.
"""

import json
import os
import subprocess
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from sonolube.models.surfaces import (
    SelfAffineSpectrum,
    areal_spectrum,
    autocorrelation,
    feature_parameters,
    functional_parameters,
    gaussian_surface,
    height_parameters,
    hybrid_parameters,
    low_pass,
    profile_spectrum,
    radial_spectrum,
    spatial_parameters,
    summit_statistics,
)

SURFACE = gaussian_surface(
    rms_height=1e-6,
    spectrum=SelfAffineSpectrum(
        hurst_exponent=0.8, longest_wavelength=1e-3, rolloff_wavelength=250e-6, shortest_wavelength=10e-6
    ),
    shape=(2048, 2048),
    spacing_x=1e-6,
    spacing_y=1e-6,
    seed=1,
)

OURS: dict[str, Callable[[], object]] = {
    "heights": lambda: height_parameters(SURFACE),
    "slope and area": lambda: hybrid_parameters(SURFACE),
    "areal spectrum": lambda: radial_spectrum(areal_spectrum(SURFACE)),
    "profile spectrum": lambda: profile_spectrum(SURFACE),
    "autocorrelation": lambda: autocorrelation(SURFACE),
    "decay and texture": lambda: spatial_parameters(SURFACE),
    "material ratio": lambda: functional_parameters(SURFACE),
    "summits": lambda: summit_statistics(SURFACE),
    "hills": lambda: feature_parameters(SURFACE),
    "Gaussian filter": lambda: low_pass(SURFACE, cutoff_length=80e-6),
}

# surfalize keeps what it has computed, so that each round needs a surface of its own. It has no plain count of summits,
# and takes its spectrum only on the way to the texture direction.
SURFALIZE = """
import json, statistics, sys, time
import numpy as np
from surfalize import Surface

height = np.load(sys.argv[1])

def of(*names):
    return lambda surface: [getattr(surface, name)() for name in names]

tasks = {
    "heights": of("Sa", "Sq", "Sp", "Sv", "Sz", "Ssk", "Sku"),
    "slope and area": of("Sdq", "Sdr"),
    "autocorrelation": lambda surface: surface.get_autocorrelation_function().data,
    "decay and texture": of("Sal", "Str", "Std"),
    "material ratio": of("Sk", "Spk", "Svk", "Smr1", "Smr2", "Vmp", "Vmc", "Vvc", "Vvv"),
    "hills": of("Spd", "Spc"),
    "Gaussian filter": lambda surface: surface.filter("lowpass", 80.0),
}
medians = {}
for name, task in tasks.items():
    taken = []
    for _ in range(1 if name == "hills" else 3):
        surface = Surface(height.copy(), 1.0, 1.0)
        start = time.perf_counter()
        task(surface)
        taken.append(time.perf_counter() - start)
    medians[name] = statistics.median(taken)
print(json.dumps(medians))
"""


@cache
def surfalize_medians() -> dict[str, float]:
    python = os.environ.get("SURFALIZE_PYTHON")
    if not python:
        pytest.skip("surfalize is not installed beside sonolube: make surfalize")
    with TemporaryDirectory() as folder:
        path = Path(folder) / "height.npy"
        np.save(path, SURFACE.height * 1e6)
        environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        run = subprocess.run(
            [python, "-c", SURFALIZE, path], capture_output=True, text=True, check=False, env=environment
        )
    if run.returncode != 0:
        pytest.skip(f"{python} does not run surfalize: {run.stderr.strip().splitlines()[-1]}")
    return {name: float(median) for name, median in json.loads(run.stdout).items()}


@pytest.mark.parametrize("task", OURS)
def test_a_map_of_four_million_pixels(benchmark: BenchmarkFixture, task: str) -> None:
    benchmark.group = f"surface, {task}"
    benchmark.pedantic(OURS[task], rounds=5, warmup_rounds=1)  # type: ignore[no-untyped-call]


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("task", ["heights", "slope and area", "areal spectrum", "profile spectrum", "autocorrelation"])
def test_rival_surface_topography(benchmark: BenchmarkFixture, task: str) -> None:
    rival = pytest.importorskip("SurfaceTopography")
    length = 2048e-6
    topography = rival.Topography(SURFACE.height, (length, length), periodic=False)
    tasks: dict[str, Callable[[], object]] = {
        "heights": topography.rms_height_from_area,
        "slope and area": topography.rms_gradient,
        "areal spectrum": topography.power_spectrum_from_area,
        "profile spectrum": topography.power_spectrum_from_profile,
        "autocorrelation": topography.autocorrelation_from_area,
    }
    benchmark.group = f"surface, {task}"
    benchmark.pedantic(tasks[task], rounds=2)  # type: ignore[no-untyped-call]


@pytest.mark.parametrize(
    "task",
    ["heights", "slope and area", "autocorrelation", "decay and texture", "material ratio", "hills", "Gaussian filter"],
)
def test_rival_surfalize(benchmark: BenchmarkFixture, task: str) -> None:
    median = surfalize_medians()[task]
    benchmark.group = f"surface, {task}"
    benchmark.extra_info["seconds_as_it_timed_itself"] = median
    benchmark.pedantic(time.sleep, args=(median,), rounds=1)  # type: ignore[no-untyped-call]
