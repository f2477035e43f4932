"""Labelled arrays become the same datasets and files as xarray makes, without importing it."""

import subprocess
import sys
from collections.abc import Callable
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from sonolube.prediction import LivePrediction
from sonolube.rig import read_rig, simulate, write_netcdf
from sonolube.rig.datasets import LabelledArray, LabelledArrays
from sonolube.rig.responses import simulation_arrays

ROOT = Path(__file__).parents[2]
RIG = ROOT / "examples" / "rigs" / "tribometer.toml"
HEAVY = ("xarray", "pandas", "pint", "dask", "distributed", "matplotlib.pyplot", "scipy.optimize")

ARRAYS = LabelledArrays(
    variables={
        "ratio": LabelledArray(dims=("level", "name"), values=np.arange(6.0).reshape(2, 3), attrs={"units": "1"}),
        "missing": LabelledArray(dims=(), values=np.asarray(np.nan)),
        "runs": LabelledArray(dims=("name",), values=np.array([3, 1, 2])),
        "remedy": LabelledArray(dims=("name",), values=np.array(["measure µ", "", "weigh"])),
    },
    coordinates={
        "level": LabelledArray(dims=("level",), values=np.array([0.1, 0.9])),
        "name": LabelledArray(dims=("name",), values=np.array(["a", "bc", "d"])),
    },
    attrs={"title": "Ratios of é", "count": 3, "load": 1.5},
)


def simulated() -> LabelledArrays:
    rig = read_rig(RIG)
    return simulation_arrays(rig, simulate(rig))


def stored(content: bytes) -> xr.Dataset:
    return xr.load_dataset(BytesIO(content), engine="h5netcdf")


@pytest.mark.parametrize("arrays", [lambda: ARRAYS, simulated, lambda: LivePrediction(read_rig(RIG), draws=100).first])
def test_a_file_without_xarray_reads_as_one_that_xarray_wrote(arrays: Callable[[], LabelledArrays]) -> None:
    found = arrays()
    read, expected = stored(found.netcdf()), stored(bytes(found.dataset().to_netcdf(engine="h5netcdf")))
    xr.testing.assert_identical(read, expected)
    for name in expected.variables:
        assert read[name].dtype == expected[name].dtype
        fill, same = (each[name].encoding.get("_FillValue") for each in (read, expected))
        assert repr(fill) == repr(same), name


def test_a_dataset_and_its_labelled_arrays_are_written_alike(tmp_path: Path) -> None:
    mine = write_netcdf(ARRAYS, path=tmp_path / "mine.nc").read_bytes()
    theirs = write_netcdf(ARRAYS.dataset(), path=tmp_path / "theirs.nc").read_bytes()
    xr.testing.assert_identical(stored(mine), stored(theirs))


def test_labelled_arrays_are_found_by_name_and_know_their_sizes() -> None:
    assert ARRAYS.sizes == {"level": 2, "name": 3}
    assert "remedy" in ARRAYS
    assert "level" in ARRAYS
    assert "draw" not in ARRAYS
    assert ARRAYS["level"].to_numpy().tolist() == [0.1, 0.9]
    assert ARRAYS.assign_attrs(count=4).attrs == {"title": "Ratios of é", "count": 4, "load": 1.5}


@pytest.mark.parametrize("command", [["simulate"], ["response", "--from", "15kHz", "--to", "35kHz"], ["predict"]])
def test_commands_of_one_point_write_figures_and_netcdf_without_libraries_of_tables(
    command: list[str], tmp_path: Path
) -> None:
    code = (
        "import sys\nfrom sonolube.cli import main\n"
        f"try: main({[command[0], str(RIG), *command[1:]]!r})\nexcept SystemExit: pass\n"
        f"print([name for name in {HEAVY!r} if name in sys.modules], file=sys.stderr)"
    )
    run = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert run.stderr.splitlines()[-1] == "[]"
    assert {path.suffix for path in (tmp_path / "out").iterdir()} == {".png", ".svg", ".pdf", ".nc"}
