"""Task `optimise` in Python: entries that make each design, by which the rig itself gives its friction and power."""

from pathlib import Path
from typing import Any

import pytest
from pytest import approx, raises
from tests.same import same

import sonolube as sl
from sonolube.charts import Points, chart_object
from sonolube.errors import InvalidInput
from sonolube.rig import read_rig
from sonolube.tasks.design.optimise import OptimisationAnswer, optimise


@pytest.fixture(scope="module")
def front(rigs: Path) -> OptimisationAnswer:
    """Front of power and heat over frequency and tip mass."""
    varied = {"drive.frequency": "20kHz:24kHz", "structure.tip_mass": "90g:130g"}
    return optimise(rigs / "tribometer.toml", target_friction="0.45N", pareto="voltage", over=varied, samples=2)


def simulated(rig: Path, design: dict[str, Any]) -> Any:
    """Rig with the entries of a design, simulated with every cycle."""
    return sl.simulate(read_rig(rig, changes=[f"{key}={text}" for key, text in design["changes"].items()]))


def test_the_entries_of_a_design_of_the_front_make_the_rig_that_reaches_the_target(
    front: OptimisationAnswer, rigs: Path
) -> None:
    designs = front.object()["front"]
    assert len(designs) > 2
    for design in (designs[0], designs[-1]):
        assert set(design["changes"]) >= {"drive.frequency", "drive.voltage_peak_to_peak", "structure.tip_mass"}
        found = simulated(rigs / "tribometer.toml", design)
        assert float(found["friction_force"]) == approx(0.45, rel=2e-4)
        assert float(found["power_to_supply"]) == approx(design["objectives"]["power"], rel=2e-4)
        assert float(found["vibration_amplitude"]) == approx(design["vibration_amplitude"]["value"], rel=1e-4)


def test_a_bolted_actuator_of_the_catalogue_is_among_the_entries(rigs: Path) -> None:
    chosen = {"actuator": ("nac2023",), "bolt": "M10x60mm", "preload": "12kN"}
    found = optimise(rigs / "tribometer.toml", target_reduction="40 %", **chosen)  # type: ignore[arg-type]
    (design,) = found.object()["designs"]
    assert {"stack.free_capacitance", "stack.preload", "actuator.capacitance"} <= set(design["changes"])
    again = simulated(rigs / "tribometer.toml", design)
    assert float(again["friction_ratio"]) == approx(0.6, rel=2e-4)
    for name in ("power_to_supply", "charging_power"):
        assert float(again[name]) == approx(design[name]["value"], rel=2e-4)


def test_the_figure_of_the_front_for_a_browser_has_a_point_of_each_design(front: OptimisationAnswer) -> None:
    drawing = front.figures()["tribometer-optimum-front"]
    assert drawing.chart is not None
    chart = drawing.chart()
    drawn = [part for part in chart.panels[0].parts if isinstance(part, Points) and not part.is_faint]
    places = sorted((x, y) for part in drawn for x, y in zip(part.x, part.y, strict=True))
    objectives = [design["objectives"] for design in front.object()["front"]]
    same(places, sorted((each["power"], each["voltage"]) for each in objectives))
    notes = [part for part in chart_object(chart)["panels"][0]["parts"] if part["kind"] == "note"]
    assert [type(note["x"]) for note in notes] == [float, float]


def test_a_reduction_is_the_friction_that_it_leaves(rigs: Path) -> None:
    by_friction, by_reduction = (
        optimise(rigs / "tribometer.toml", over={"drive.frequency": "21kHz:23kHz"}, **target)
        for target in ({"target_friction": 0.341 * 0.5}, {"target_reduction": "50 %"})
    )
    one, other = (found.object()["designs"][0] for found in (by_reduction, by_friction))
    same(one, other, relative=1e-6, absolute=1e-12)


@pytest.mark.parametrize(
    ("target", "line"),
    [
        ({}, "^give target_friction, or target_reduction in its place"),
        ({"target_friction": 0.1, "target_reduction": 0.5}, "^give target_friction, or target_reduction in its place"),
        ({"target_reduction": "140 %"}, "^target_reduction must lie between 0 and 100 %, got 140 %"),
        ({"target_reduction": 0.0}, "^target_reduction must lie between 0 and 100 %, got 0 %"),
        ({"target_reduction": "1 mm"}, "^target_reduction 1 mm is a length"),
    ],
)
def test_a_target_is_given_once_and_lies_below_friction(target: dict[str, Any], line: str, rigs: Path) -> None:
    with raises(InvalidInput, match=line):
        optimise(rigs / "tribometer.toml", **target)
