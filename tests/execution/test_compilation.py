"""Kernels give the same numbers compiled and as plain Python, and commands of one point load no compiler."""

import math
import os
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numba
import numpy as np
import pytest
from numba.core import caching
from pytest import approx
from scipy.special import i0e, wrightomega

from sonolube.design import grid_plan, sweep
from sonolube.execution.compilation import few_points, kernel
from sonolube.execution.threads import map_chunks
from sonolube.models.contact import GaussianHeights, normal_force
from sonolube.models.contact.greenwood_williamson import log_normal_force_function
from sonolube.models.dynamics.harmonic_balance.initial_guess import wright_omega
from sonolube.models.friction import sine_stick_slip_ratio
from sonolube.models.friction.scaled_bessel import scaled_bessel_i0
from sonolube.rig import read_rig, simulate
from sonolube.rig.datasets import result_quantities

RIGS = Path(__file__).parents[2] / "examples" / "rigs"


@kernel(error_model="numpy")
def halved(value: float) -> float:
    """Return half of a value."""
    return value / 2


@kernel(error_model="numpy", plain={"DIVISOR": 4.0})
def divided(value: float) -> float:
    """Return a half over a divisor."""
    return halved(value) / DIVISOR


DIVISOR = 8.0


def test_a_kernel_calls_other_kernels_in_both_ways() -> None:
    assert divided(16.0) == 1.0
    assert divided.interpreted(16.0) == 2.0  # by the divisor of plain Python


def test_a_division_by_zero_is_left_to_the_compiled_kernel() -> None:
    @kernel(error_model="numpy")
    def inverse(value: float) -> float:
        return 1.0 / value

    with few_points():
        assert inverse.for_points(1)(0.0) == math.inf


def test_a_kernel_runs_as_plain_python_until_that_took_as_much_work_as_compiling_it() -> None:
    @kernel()
    def tripled(value: float) -> float:
        return 3 * value

    def is_plain(count: int) -> bool:
        return tripled.for_points(count, most=1, at_first=100) != tripled.compiled

    assert not is_plain(1)  # outside a command
    with few_points():
        assert [is_plain(count) for count in (60, 30, 30, 10)] == [True, True, False, True]
        tripled(1.0)  # that it is compiled changes nothing, lest the last digits depend on it
        assert [is_plain(count) for count in (2, 1)] == [False, False]


@pytest.mark.parametrize(("points", "plain"), [(1, [True]), (4, [False] * 4)])
def test_threads_that_share_work_run_compiled_kernels_lest_their_order_decide(points: int, plain: list[bool]) -> None:
    @kernel()
    def quartered(value: float) -> float:
        return value / 4

    with few_points():
        assert map_chunks(lambda chunk: quartered.for_points(1) != quartered.compiled, points, workers=4) == plain


def test_a_sweep_is_the_same_compiled_and_as_plain_python_and_compiles_nothing_at_first(tmp_path: Path) -> None:
    rig = read_rig(RIGS / "tribometer.toml")
    volts = np.linspace(2.0, 28.0, 5)

    def numbers() -> list[np.ndarray]:
        swept = sweep(grid_plan(rig, over={"drive.voltage_peak_to_peak": volts}))
        return [each.to_numpy() for each in swept.data_vars.values() if each.dtype.kind == "f"]

    compiled = numbers()
    with few_points():
        plain = numbers()
    for each, other in zip(compiled, plain, strict=True):
        np.testing.assert_allclose(each, other, rtol=1e-9)
    program = Path(sys.executable).with_name("sonolube")
    over = ("--over", "drive.voltage_peak_to_peak=2V:28V:27")
    cache = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    subprocess.run([program, "sweep", RIGS / "tribometer.toml", *over], cwd=tmp_path, env=cache, check=True)
    assert not list((tmp_path / "cache").rglob("*.nbi"))


def test_kernels_are_kept_among_temporary_files_where_no_other_folder_can_be_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    @kernel(cache=True)
    def doubled(value: float) -> float:
        return 2 * value

    own = [each for each in caching.CacheImpl._locator_classes if "UserProvided" in each.__name__]
    monkeypatch.setattr(caching.CacheImpl, "_locator_classes", own)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    assert doubled(4.0) == 8.0
    assert list(tmp_path.glob("sonolube-kernels-*/*/*.nbi"))


@pytest.mark.parametrize("rig", ["tribometer", "welder_flat", "poisson_al_steel", "collar"])
def test_one_operating_point_is_the_same_compiled_and_as_plain_python(rig: str) -> None:
    def numbers() -> dict[str, float | None]:
        return result_quantities(simulate(read_rig(RIGS / f"{rig}.toml")))

    compiled = numbers()
    with few_points():
        plain = numbers()
    assert plain.keys() == compiled.keys()
    for name, value in compiled.items():
        assert plain[name] == (value if value is None else approx(value, rel=1e-9, nan_ok=True)), name


def test_one_friction_ratio_is_the_same_compiled_and_as_plain_python() -> None:
    def ratio() -> float:
        return float(
            sine_stick_slip_ratio(
                decay_length=1.2e-6,
                vibration_amplitude=2.5e-6,
                frequency=22e3,
                sliding_speed=0.02,
                memory_length=1.5e-6,
            )
        )

    compiled = ratio()
    with few_points():
        assert ratio() == approx(compiled, rel=1e-12)


@pytest.mark.parametrize("command", ["contact", "friction --no-interval", "wear", "simulate"])
def test_a_command_of_one_point_loads_neither_a_compiler_nor_special_functions(command: str, tmp_path: Path) -> None:
    name, *options = command.split()
    code = (
        "import sys; sys.modules['dask'] = None\n"  # which xarray loads where it is installed, with scipy.special
        "from sonolube.cli.app import run\n"
        f"try: run([{name!r}, {str(RIGS / 'tribometer.toml')!r}, *{options!r}])\n"
        "except SystemExit as ended: assert not ended.code\n"
        "loaded = {'numba', 'scipy.special', 'scipy.optimize', 'scipy.linalg'} & sys.modules.keys()\n"
        "assert not loaded, loaded"
    )
    subprocess.run([sys.executable, "-c", code], cwd=tmp_path, check=True, capture_output=True)


def test_wright_omega_and_the_scaled_bessel_function_are_those_of_scipy() -> None:
    z = np.linspace(-690, 900, 20011)
    assert wright_omega(z) == approx(wrightomega(z), rel=1e-13)
    assert wright_omega(np.array([-800.0])) == 0.0
    x = np.geomspace(1e-6, 690, 4)
    with few_points():
        assert scaled_bessel_i0(x) == approx(i0e(x), rel=1e-12)


def test_the_force_without_a_table_is_that_of_the_table() -> None:
    contact = read_rig(RIGS / "poisson_al_steel.toml").contact
    gaussian = replace(contact, heights=GaussianHeights.from_roughness_parameter(roughness_parameter=0.05))
    h = np.linspace(-3, 12, 40)
    by_table = np.log(normal_force(gaussian, separation=h * contact.roughness.rms_height))
    assert log_normal_force_function(gaussian)(h) == approx(by_table, abs=1e-10)
