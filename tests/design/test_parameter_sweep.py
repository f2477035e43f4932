"""Sweeps against single computations, whatever the order, the chunks, the threads and the interruptions."""

import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from pytest import MonkeyPatch, approx, raises

from sonolube.design import SweepPlan, grid_plan, latin_hypercube_plan, list_plan, sweep
from sonolube.errors import InvalidInput
from sonolube.rig import operating_points, read_rig

RIG_FILE = Path(__file__).parents[2] / "examples" / "rigs" / "tribometer.toml"
VOLTS, SPEEDS = "drive.voltage_peak_to_peak", "sliding.sliding_speed"


def small_plan() -> SweepPlan:
    return grid_plan(
        RIG_FILE,
        over={
            SPEEDS: np.geomspace(5e-3, 0.3, 7),
            "contact.roughness.rms_height": [5e-6, 6e-6],
            VOLTS: np.linspace(2, 28, 5),
        },
    )


def test_a_grid_holds_the_single_operating_points() -> None:
    found = sweep(small_plan())
    assert dict(found.sizes) == {
        "rms_height": 2,
        "voltage_peak_to_peak": 5,
        "sliding_speed": 7,
        "reasons": found.sizes["reasons"],
    }
    volts, speeds = found["voltage_peak_to_peak"].values, found["sliding_speed"].values
    for height in (5e-6, 6e-6):
        rig = read_rig(RIG_FILE, changes=[f"contact.roughness.rms_height={height} m"])
        known = operating_points(rig, voltage_peak_to_peak=volts[:, np.newaxis], sliding_speed=speeds)
        rows = found.sel(rms_height=height)
        for name in ("vibration_amplitude", "vibration_velocity", "power_to_supply", "dissipated_power"):
            assert rows[name].values == approx(getattr(known, name), rel=1e-4), name
        assert rows["friction_ratio"].values == approx(known.friction_ratio, abs=1e-4)


def test_a_friction_model_without_a_batched_form_can_be_swept() -> None:
    plan = grid_plan(RIG_FILE, over={"friction.model": ["asperity_stick_slip", "kinematic"], SPEEDS: [0.02, 0.2]})
    found = sweep(plan)["friction_ratio"]
    for name in ("asperity_stick_slip", "kinematic"):
        rig = read_rig(RIG_FILE, changes=[f"friction.model={name}"])
        known = operating_points(rig, sliding_speed=[0.02, 0.2]).friction_ratio
        assert found.sel(model=name).values == approx(known, abs=1e-4)


def test_a_refused_point_keeps_its_reason_and_affects_no_other() -> None:
    plan = list_plan(
        RIG_FILE,
        over={
            "contact.roughness.rms_height": [6e-6, -1.0, 6e-6, 6e-6],
            "contact.normal_load": [3.0, 3.0, 1e9, 3.0],
            SPEEDS: [0.02, 0.02, 0.02, 0.0],
        },
    )
    found = sweep(plan)
    names = found["status"].attrs["flag_meanings"].split()
    assert [names[code] for code in found["status"].values] == ["periodic", "refused", "refused", "refused"]
    reasons = found["reason_text"].values[found["reason"].values]
    assert "rms_height must be positive" in reasons[1]
    assert "leaves no separation" in reasons[2]
    assert "sliding_speed must be positive" in reasons[3]
    assert np.isnan(found["friction_ratio"].values).tolist() == [False, True, True, True]


def test_a_latin_hypercube_has_one_point_in_each_interval_of_each_range() -> None:
    over = {VOLTS: (2.0, 28.0), SPEEDS: (0.01, 0.2)}
    drawn = latin_hypercube_plan(RIG_FILE, over=over, points=20, seed=3)
    for key, (low, high) in over.items():
        parts = np.floor(20 * (drawn.values[key] - low) / (high - low)).astype(int)
        assert sorted(parts) == list(range(20))
    assert drawn.digest == latin_hypercube_plan(RIG_FILE, over=over, points=20, seed=3).digest
    assert drawn.digest != latin_hypercube_plan(RIG_FILE, over=over, points=20, seed=4).digest


@pytest.mark.parametrize("workers", [1, 3])
def test_threads_and_files_change_no_bit(workers: int, tmp_path: Path) -> None:
    in_memory = sweep(small_plan(), chunk_points=11)
    in_file = sweep(small_plan(), folder=tmp_path, chunk_points=11, workers=workers)
    codes = ["reason", "reason_text"]
    assert in_file.drop_vars(codes).identical(in_memory.drop_vars(codes))
    texts = (found["reason_text"].values[found["reason"].values] for found in (in_memory, in_file))
    assert np.array_equal(*texts)


def test_the_chunk_size_does_not_change_the_results() -> None:
    for name, known in sweep(small_plan()).drop_vars(["status", "reason", "reason_text"]).items():
        assert sweep(small_plan(), chunk_points=11)[name].values == approx(known.values, rel=1e-6, abs=1e-9), name


def test_a_second_run_computes_only_missing_and_damaged_chunks(tmp_path: Path) -> None:
    first = sweep(small_plan(), folder=tmp_path, chunk_points=11).load()
    first.close()
    chunks = sorted(tmp_path.glob("chunk-*.npz"))
    times = {path: path.stat().st_mtime_ns for path in chunks}
    damaged, lost = chunks[2], chunks[4]
    damaged.write_bytes(damaged.read_bytes()[:-9] + b"different")
    lost.unlink()
    reports: list[tuple[int, int]] = []
    second = sweep(small_plan(), folder=tmp_path, chunk_points=11, advance=lambda *done: reports.append(done)).load()
    assert second.identical(first)
    assert reports == [(48, 70), (59, 70), (70, 70)]
    assert sorted(tmp_path.glob("chunk-*.npz")) == chunks
    assert {path for path in chunks if path.stat().st_mtime_ns != times[path]} == {damaged, lost}


def test_a_resumed_sweep_equals_an_uninterrupted_one(tmp_path: Path) -> None:
    program = (
        "import os, signal, sys, numpy as np\n"
        "from sonolube.design import grid_plan, sweep\n"
        "def die(done, of):\n"
        "    if done >= 250: os.kill(os.getpid(), signal.SIGKILL)\n"
        f"over = {{{VOLTS!r}: np.linspace(2, 28, 40), {SPEEDS!r}: np.geomspace(5e-3, 0.3, 50)}}\n"
        f"plan = grid_plan({str(RIG_FILE)!r}, over=over)\n"
        "sweep(plan, folder=sys.argv[1], chunk_points=50, advance=die)\n"
    )
    killed, whole = tmp_path / "killed", tmp_path / "whole"
    run = subprocess.run([sys.executable, "-c", program, str(killed)], check=False)
    assert run.returncode == -signal.SIGKILL
    kept = len(list(killed.glob("chunk-*.npz")))
    assert 5 <= kept < 40
    assert not (killed / "sweep.nc").exists()
    plan = grid_plan(RIG_FILE, over={VOLTS: np.linspace(2, 28, 40), SPEEDS: np.geomspace(5e-3, 0.3, 50)})
    done: list[int] = []
    again = sweep(plan, folder=killed, chunk_points=50, advance=lambda far, of: done.append(far))
    assert done[0] == 50 * kept
    assert again.identical(sweep(plan, folder=whole, chunk_points=50))


def test_the_netcdf_file_of_a_folder_has_units_and_keys(tmp_path: Path) -> None:
    made = sweep(small_plan(), folder=tmp_path)
    made.close()
    with xr.open_dataset(tmp_path / "sweep.nc") as found:
        assert found["friction_ratio"].attrs["units"] == "1"
        assert found["vibration_amplitude"].attrs["units"] == "m"
        assert found["rms_height"].attrs["key"] == "contact.roughness.rms_height"


def test_a_folder_with_another_sweep_is_refused(tmp_path: Path) -> None:
    sweep(small_plan(), folder=tmp_path).close()
    with raises(InvalidInput, match="holds another sweep"):
        sweep(grid_plan(RIG_FILE, over={VOLTS: [10.0]}), folder=tmp_path)


@pytest.mark.parametrize(
    ("over", "message"),
    [
        ({"drive.voltage": [1.0]}, "drive.voltage: unknown key"),
        ({VOLTS: [-3.0]}, r"voltage_peak_to_peak must not be negative, got -3\.0 V"),
        ({"contact.roughness.rms_height": [-1.0]}, "rms_height must be positive"),
        ({"friction.model": ["sticky"]}, "friction.model"),
        ({VOLTS: []}, "at least one"),
        ({}, "needs at least one key"),
    ],
)
def test_unusable_keys_and_values_are_refused_by_name(over: dict[str, list[float]], message: str) -> None:
    with raises(InvalidInput, match=message):
        grid_plan(RIG_FILE, over=over)


def test_a_list_of_points_needs_equal_numbers_of_values() -> None:
    with raises(InvalidInput, match=r"got 2 of drive\.voltage_peak_to_peak, 1 of sliding\.sliding_speed"):
        list_plan(RIG_FILE, over={VOLTS: [1.0, 2.0], SPEEDS: [0.1]})


def test_a_cluster_without_dask_names_the_package_to_install(monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with raises(InvalidInput, match=r"pip install dask distributed"):
        sweep(small_plan(), scheduler="local")


def test_a_local_cluster_gives_the_same_bits() -> None:
    pytest.importorskip("distributed", reason="Dask is not installed")
    assert sweep(small_plan(), scheduler="local", chunk_points=11, workers=2).identical(
        sweep(small_plan(), chunk_points=11)
    )
