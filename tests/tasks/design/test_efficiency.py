"""Task `efficiency` in Python: the numbers of the command, runs as bytes or dataset, and refusals."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from pytest import approx, raises
from tests.same import same

import sonolube as sl
from sonolube.charts import Line, Points
from sonolube.design.efficiency import efficiency_chart
from sonolube.errors import InvalidInput
from sonolube.tasks.design.efficiency import efficiency
from sonolube.tasks.files import NamedBytes


def test_runs_as_path_bytes_and_dataset_give_the_answer_of_the_command(
    examples: Path, rigs: Path, on_terminal: Callable[..., dict[str, Any]]
) -> None:
    runs, rig = examples / "efficiency-runs.csv", rigs / "power_map.toml"
    options = ("--rig", rig, "--target-friction", "0.4N", "--speed", "65.5mm/s")
    expected = on_terminal("efficiency", runs, *options)
    by_path = efficiency(runs, rig=rig, target_friction="0.4N", speed="65.5 mm/s")
    same(by_path.json_object(), expected)
    content = NamedBytes("efficiency-runs.csv", runs.read_bytes())
    for given in (content, sl.read_runs(runs)):
        found = efficiency(given, rig=sl.read_rig(rig), target_friction=0.08, speed=0.0655)
        assert found.object()["actuator_power"]["value"] == approx(expected["actuator_power"]["value"])
        same(found.object()["slope"], expected["slope"])


def test_the_figure_has_every_run_and_the_line_of_the_answer(examples: Path, rigs: Path) -> None:
    found = efficiency(examples / "efficiency-runs.csv", rig=rigs / "power_map.toml")
    (panel,) = efficiency_chart(found.calibration).panels
    (runs,) = (part for part in panel.parts if isinstance(part, Points))
    (line,) = (part for part in panel.parts if isinstance(part, Line))
    fitted = np.polynomial.Polynomial.fit(runs.x, runs.y, 1)
    assert panel.y.text == "Efficiency coefficient [mW mm²/(N W)]"
    assert runs.x.size == found.calibration.fit.runs
    assert line.y == approx(fitted(line.x))


def test_arguments_are_refused_by_their_names(examples: Path, rigs: Path) -> None:
    runs, rig = examples / "efficiency-runs.csv", rigs / "power_map.toml"
    with raises(InvalidInput, match=r"^speed has no meaning without target_friction"):
        efficiency(runs, rig=rig, speed=0.1)
    with raises(InvalidInput, match=r"^target_friction 3mm is a length"):
        efficiency(runs, rig=rig, target_friction="3mm", speed=0.1)
    with raises(InvalidInput, match=r"^level must be finite and lie between 0.5 and 0.9999, got 1"):
        efficiency(runs, rig=rig, level=1)
