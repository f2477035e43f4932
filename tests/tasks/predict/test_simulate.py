"""Task `simulate` in Python: numbers, notes and figure of the command."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from pytest import approx
from tests.same import same

import sonolube as sl
from sonolube.charts import draw_chart
from sonolube.figure import publication_style
from sonolube.rig.figures import simulation_chart


@pytest.mark.parametrize("name", ["tribometer", "power_map", "poisson_al_steel", "welder_round"])
def test_a_simulation_in_python_has_the_numbers_and_notes_of_the_command(
    name: str, examples: Path, tmp_path: Path, on_terminal: Callable[..., dict[str, Any]]
) -> None:
    path = examples / "rigs" / f"{name}.toml"
    command, found = on_terminal("simulate", path), sl.simulate(sl.read_rig(path))
    same(found.json_object(), command)
    result = found.dataset()
    for quantity in ("friction_ratio", "friction_force", "vibration_amplitude"):
        same(float(result[quantity]), command[quantity]["value"])
        assert result[quantity].attrs["units"] == (command[quantity]["unit"] or "1")
    assert result.attrs["caveats"].split("\n") == (command["caveats"] or [""])
    assert result.attrs["status"] == command["status"]
    assert result.attrs["amplitude_source"] == command["amplitude_source"]
    (written,) = tmp_path.glob("out/*.nc")
    with xr.open_dataset(written) as stored:
        assert stored["displacement"].to_numpy() == approx(result["displacement"].to_numpy())


def test_an_answer_and_its_file_draw_the_figure_of_the_command(tribometer: Path, tmp_path: Path) -> None:
    found = sl.simulate(tribometer)
    with xr.open_dataset(found.to_netcdf(tmp_path / "kept.nc"), engine="h5netcdf") as kept:
        figures = [found.plot(), sl.plot(kept)]
    with publication_style():
        figures.append(draw_chart(simulation_chart(found.dataset())))
    lines = [[line.get_xydata() for axes in figure.axes for line in axes.lines] for figure in figures]
    for own, other in zip(lines[0], lines[1], strict=True):
        assert np.asarray(own) == approx(np.asarray(other))
    for own, other in zip(lines[0], lines[2], strict=True):
        same(own, other)


def test_an_entry_replaced_in_python_is_that_of_the_terminal(
    tribometer: Path, on_terminal: Callable[..., dict[str, Any]]
) -> None:
    replaced = sl.read_rig(tribometer).replace("drive.voltage_peak_to_peak", "14 V")
    same(
        sl.simulate(replaced).json_object(),
        on_terminal("simulate", tribometer, "--set", "drive.voltage_peak_to_peak=14V"),
    )
