"""Task `map` in Python: the numbers of the command, axes in SI, runs as bytes, and refusals."""

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from pytest import approx, raises
from tests.names import names_of
from tests.same import same

import sonolube as sl
from sonolube.errors import InvalidInput, UnknownName
from sonolube.tasks.design import map as module
from sonolube.tasks.design.map import map as map_of
from sonolube.tasks.files import NamedBytes

VOLTAGE = "drive.voltage_peak_to_peak"
OVER = {"sliding.sliding_speed": "20mm/s:200mm/s:3", "contact.normal_load": "5N", VOLTAGE: "10V,20V"}
RUNS = "\n".join(
    [
        "sliding_speed [mm/s],actuator_power [W],friction_reduction [%]",
        *(f"{speed},{watt},{60 - speed / 4 + watt}" for speed in (50, 100, 150) for watt in (1, 3, 5)),
    ]
)


@pytest.fixture
def rig(rigs: Path) -> sl.Rig:
    return sl.read_rig(rigs / "power_map.toml")


def test_other_axes_as_text_and_in_si_make_the_map_of_the_command(
    rig: sl.Rig, rigs: Path, on_terminal: Callable[..., dict[str, Any]]
) -> None:
    mapped = sl.map(rig, over=OVER)
    options = [word for key, values in OVER.items() for word in ("--over", f"{key}={values}")]
    same(mapped.json_object(), on_terminal("map", rigs / "power_map.toml", *options, "--form", "png"))
    found = mapped.dataset()
    assert found["friction_reduction"].sizes == {"normal_load": 1, "voltage_peak_to_peak": 2, "sliding_speed": 3}
    assert found.attrs["assumptions"]
    assert found.attrs["caveats"]
    numbers = {"sliding.sliding_speed": np.linspace(0.02, 0.2, 3), "contact.normal_load": 5.0, VOLTAGE: (10.0, 20.0)}
    same(map_of(rig, over=numbers).dataset(), found)
    assert mapped.plot().axes


def test_the_greatest_reduction_has_the_interval_that_predict_has_there(rig: sl.Rig) -> None:
    answer = sl.map(rig, over=OVER)
    told = answer.json_object()
    at = told["most_reduction"]
    changes = [f"sliding.sliding_speed={at['sliding_speed']['value']} m/s", f"{VOLTAGE}={at[VOLTAGE[6:]]['value']} V"]
    assert rig.file is not None
    there = sl.read_rig(rig.file, changes=changes)
    expected = np.quantile(sl.predict(there)["friction_ratio"], [0.1, 0.5, 0.9])
    (low, high), median = (told["predicted_friction_ratio"][name] for name in ("interval_80", "median"))
    assert [low, median, high] == approx(expected, abs=0.015)  # of 1000 draws and of 4000
    text = f"predicted there  {1 - median:.2g}, {1 - high:.2g} to {1 - low:.2g} (80 %, `sonolube predict`)"
    assert text in " ".join(answer.text().split("\n"))
    assert ("predicted there", text.partition("there  ")[2]) in answer.page().facts


def test_a_map_of_a_rig_without_a_prediction_says_why(rigs: Path) -> None:
    answer = sl.map(rigs / "pom_on_steel.toml", over={"sliding.sliding_speed": "10mm/s,20mm/s"})
    found = answer.json_object()["predicted_friction_ratio"]
    assert (found["median"], found["interval_80"]) == (None, None)
    assert "soft or floating contact" in found["reason"]
    assert "predicted there" in answer.text()


def test_runs_may_be_bytes_and_the_map_stays_that_of_the_model(rig: sl.Rig, tmp_path: Path) -> None:
    (tmp_path / "runs.csv").write_text(RUNS, encoding="utf-8")
    by_path, by_bytes = (
        map_of(rig, over=OVER, runs=runs) for runs in (tmp_path / "runs.csv", NamedBytes("runs.csv", RUNS.encode()))
    )
    assert list(by_path.figures()) == ["power_map-velocity-power", "power_map-velocity-power-measured"]
    same(by_path.json_object(), by_bytes.json_object())
    told = "the runs state neither amplitude nor voltage, so that the prediction rests on published tests alone"
    assert told in by_bytes.caveats()
    same(*(each.dataset().assign_attrs(caveats="") for each in (by_bytes, map_of(rig, over=OVER))))


def test_arguments_are_refused_by_their_names(rig: sl.Rig) -> None:
    with raises(UnknownName, match="unknown kind 'velocity-powr'; did you mean velocity-power"):
        map_of(rig, kind="velocity-powr")  # type: ignore[arg-type]
    with raises(UnknownName, match="unknown form 'pgn'"):
        map_of(rig, form=["pgn"])  # type: ignore[list-item]
    with raises(InvalidInput, match=r"^over drive\.frequency: no axis of a velocity-power map"):
        map_of(rig, over={"drive.frequency": [1e3, 2e3]})


def test_the_map_between_runs_is_drawn_with_the_runs_on_it(monkeypatch: pytest.MonkeyPatch) -> None:
    drawn: list[tuple[Any, ...]] = []
    monkeypatch.setattr(module, "measured_map_chart", lambda *given: drawn.append(given))
    monkeypatch.setattr(module, "map_chart", lambda mapped, *, measured: drawn.append((mapped, measured)))
    monkeypatch.setattr(names_of(module).results, "caption", lambda mapped, *, has_runs: f"with runs {has_runs}")
    mapped = SimpleNamespace(attrs={"map": "velocity-power"})
    given: dict[str, Any] = {"rig": SimpleNamespace(name="own"), "mapped": mapped, "forms": ("html", "png")}
    given["predicted"] = None
    both = module.MapAnswer(**given, runs="runs", interpolated="between")  # type: ignore[arg-type]
    for figure in both.figures().values():
        assert figure.chart is not None
        assert figure.forms == ("png",)
        figure.chart()
    assert drawn == [(mapped, "runs"), ("between", "runs")]
    assert list(both.figures()) == ["own-velocity-power", "own-velocity-power-measured"]
    without = module.MapAnswer(**given, runs=None, interpolated=None)
    (figure,) = without.figures().values()
    assert figure.caption == "with runs False"
