"""Measured runs on maps: those of a panel as measured, others moved to the nearest panel by the model, or left out."""

from pathlib import Path

import numpy as np
import xarray as xr
from pytest import approx

from sonolube.design import map_chart, velocity_power_map
from sonolube.design.runs_map import runs_on_map
from sonolube.rig import read_rig

RIG = read_rig(Path(__file__).parents[2] / "examples" / "rigs" / "power_map.toml")


def computed() -> xr.Dataset:
    found = velocity_power_map(
        RIG, sliding_speed=[0.02, 0.1], normal_load=[2.0, 4.0, 6.0], voltage_peak_to_peak=[10.0, 20.0]
    )
    slope = (found["normal_load"] - 2.0) / 20  # a reduction that grows by 5 points a newton
    return found.assign(friction_reduction=0.1 + slope + 0 * found["friction_reduction"])


def runs(**columns: list[float]) -> xr.Dataset:
    return xr.Dataset({name: ("run", values) for name, values in columns.items()})


def test_runs_are_moved_to_the_nearest_load_or_left_out() -> None:
    own = runs(
        sliding_speed=[0.05] * 3,
        voltage_peak_to_peak=[15.0] * 3,
        normal_load=[4.0, 4.8, 9.0],
        friction_reduction=[0.3, 0.3, 0.3],
    )
    placed, caveats = runs_on_map(own, RIG, computed())
    assert placed["panel"].values.tolist() == [1, 1, -1]
    assert placed["is_moved"].values.tolist() == [False, True, False]
    assert placed["shown_friction_reduction"].values[:2] == approx([0.3, 0.3 - 0.8 / 20])
    assert any("1 of 3 runs are drawn at the normal load of the nearest panel" in line for line in caveats)
    assert any("1 of 3 runs are not drawn" in line for line in caveats)


def test_a_run_without_a_load_has_that_of_the_rig() -> None:
    own = runs(sliding_speed=[0.05], voltage_peak_to_peak=[15.0], friction_reduction=[0.3])
    placed, _ = runs_on_map(own, RIG, computed())
    loads = np.array([2.0, 4.0, 6.0])
    assert placed["panel"].values[0] == np.argmin(np.abs(loads - RIG.normal_load))


def test_moved_runs_have_a_marker_and_a_label_of_their_own() -> None:
    own = runs(
        sliding_speed=[0.05, 0.05],
        voltage_peak_to_peak=[15.0, 15.0],
        normal_load=[4.0, 4.8],
        friction_reduction=[0.3, 0.3],
    )
    mapped = computed()
    placed, _ = runs_on_map(own, RIG, mapped)
    panel = map_chart(mapped, measured=placed).panels[1]
    as_measured, moved = panel.parts[-2:]
    assert "moved" in getattr(moved, "label", "")
    assert "moved" not in getattr(as_measured, "label", "")
    assert getattr(moved, "texts", ()) == ("26",)
    assert getattr(moved, "sources", ()) == ("measured 30 %",)
