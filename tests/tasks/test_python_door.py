"""The Python door: names that complete without loading anything, and figures of answers and of their files."""

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from pytest import CaptureFixture, raises
from tests.same import same

import sonolube as sl
from sonolube.charts import draw_chart
from sonolube.cli import main
from sonolube.errors import InvalidInput, UnknownName
from sonolube.rig.figures import simulation_chart

EXAMPLES = Path(__file__).parents[2] / "examples"
TRIBOMETER = EXAMPLES / "rigs" / "tribometer.toml"
NAMES = ("kinematic", "asperity-stick-slip")


def test_importing_the_package_is_fast_to_complete_and_loads_nothing() -> None:
    code = (
        "import sys, sonolube as sl\n"
        "print(dir(sl))\n"
        "print([name for name in ('numpy', 'scipy', 'numba', 'xarray', 'matplotlib') if name in sys.modules])\n"
        "print(dir(sl.measure))"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    names, loaded, measure = run.stdout.splitlines()
    assert loaded == "[]"
    assert {"read_rig", "predict", "simulate", "sweep", "map", "measure", "published", "plot", "new", "fit"} <= set(
        eval(names)
    )
    assert {"friction", "surface", "groove"} <= set(eval(measure))
    assert not [name for name in (*eval(names), *eval(measure)) if name in ("np", "Path", "dataclass", "Callable")]


def test_an_answer_its_dataset_and_its_file_draw_the_figure_of_the_room(tmp_path: Path) -> None:
    found = sl.simulate(TRIBOMETER)
    stored = xr.load_dataset(found.to_netcdf(tmp_path / "simulation.nc"))
    room = draw_chart(simulation_chart(stored)).axes[0]
    for drawable in (found, found.dataset(), stored):
        drawn = sl.plot(drawable).axes[0]
        assert drawn.get_ylabel() == room.get_ylabel()
        same(np.asarray(drawn.lines[0].get_ydata()), np.asarray(room.lines[0].get_ydata()))


def test_a_comparison_has_the_rigs_ratios_of_the_command(tmp_path: Path, capsys: CaptureFixture[str]) -> None:
    options = [option for name in NAMES for option in ("--model", name)]
    with raises(SystemExit):
        main(["compare", str(TRIBOMETER), *options, "--out", str(tmp_path), "--json"])
    command = json.loads(capsys.readouterr().out)
    found = sl.compare(sl.read_rig(TRIBOMETER), model=NAMES)
    for each in command["rig"]["predictions"]:
        same(float(found["rig_friction_ratio"].sel(model=each["model"])), each["friction_ratio"])
    labels = sl.plot(found, title="models-on-the-rig").axes[0].get_yticklabels()
    assert [label.get_text() for label in labels][-1] == "asperity stick slip"
    assert sl.plot(sl.compare(model=NAMES)).axes


def test_a_fit_of_own_runs_has_its_figure() -> None:
    assert sl.plot(sl.fit(EXAMPLES / "tribometer-runs.csv", rig=TRIBOMETER, model=["kinematic"])).axes


@pytest.mark.parametrize(
    ("call", "error", "line"),
    [
        (lambda: sl.plot(xr.Dataset()), InvalidInput, "plot draws answers of tasks, and datasets of comparison, map"),
        (lambda: sl.plot(sl.simulate(TRIBOMETER), title="no such"), UnknownName, "tribometer-simulation"),
        (lambda: sl.plot(sl.wear(TRIBOMETER)), InvalidInput, "nothing that could be drawn"),
        (lambda: sl.sweep(TRIBOMETER, over={"drive.frequency": [1.0, 2.0, 3.0]}, sample="lhs", points=4), InvalidInput,
         "between two ends, got 3 numbers"),
    ],
)  # fmt: skip
def test_what_cannot_be_drawn_or_read_is_refused_by_name(
    call: Callable[[], Any], error: type[Exception], line: str
) -> None:
    with raises(error, match=line):
        call()
