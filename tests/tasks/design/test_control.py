"""Task `control` in Python: the numbers of the command, quantities in SI, and refusals."""

from collections.abc import Callable
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import pandas
from pytest import approx, mark, raises
from tests.same import same

from sonolube.charts import Line, Points, draw_chart
from sonolube.design.control import lookup_table
from sonolube.design.control.predicted_loop import predicted_forces
from sonolube.errors import InvalidInput, UnknownName
from sonolube.execution.compilation import few_points
from sonolube.tasks.design.control import control
from sonolube.text.units import format_si


def test_quantities_as_text_and_in_si_give_the_answer_of_the_command(
    rigs: Path, on_terminal: Callable[..., dict[str, Any]]
) -> None:
    path = rigs / "collar.toml"
    with few_points():  # as the terminal computes; compiled kernels round the last digits otherwise
        by_text = control(path, friction="1.5N", duration="40ms", warming="20 K", noise="5 mN")
    options = ("--friction", "1.5N", "--duration", "40ms", "--warming", "20K", "--noise", "5mN")
    same(by_text.json_object(), on_terminal("control", path, *options))
    coefficient = 1.5 / by_text.rig.normal_load
    with few_points():
        in_si = control(path, friction=coefficient, duration=0.04, warming=20.0, noise=0.005)
    same(in_si.object(), by_text.object())


def test_the_figures_have_the_target_the_limit_and_the_motion_of_the_slider(rigs: Path) -> None:
    found = control(rigs / "collar.toml", friction="1.5N", duration="40ms", warming="20K", stick_slip=True)
    loop, design, disturbed, motion = (drawing.chart() for drawing in found.figures().values())  # type: ignore[misc]
    histories = [part for part in loop.panels[0].parts if isinstance(part, Line)]
    assert [line.label for line in histories] == ["frequency fixed", "resonance tracked", "target"]
    assert [panel.y.unit for panel in loop.panels] == ["N", "V", "kHz"]
    (target,) = (part for part in design.panels[0].parts if isinstance(part, Points))
    assert target.y == approx([1.5])
    model, table, *_ = (part for part in design.panels[0].parts if isinstance(part, Line))
    assert np.interp(target.x, model.x, model.y) == approx(target.y, rel=1e-6)
    assert table.y == approx(np.interp(table.x, model.x, model.y), rel=0.01)
    still, vibrating = (part for part in motion.panels[0].parts if isinstance(part, Line))
    assert np.ptp(still.y) > np.ptp(vibrating.y)
    assert still.x.size <= 3000
    shown, wanted = (part for part in disturbed.panels[0].parts if isinstance(part, Line))
    assert np.interp([-0.3, 0.3], shown.x, shown.y) == approx([1.5, 1.65], rel=1e-3)  # 10 % more at the step
    assert wanted.y == approx(np.full(wanted.x.size, 1.5))
    for chart in (loop, design, disturbed, motion):
        draw_chart(chart)


def test_arguments_are_refused_by_their_names(rigs: Path) -> None:
    path = rigs / "collar.toml"
    for arguments, line in (
        ({"friction": -1.0}, "^friction -1.0 must be positive, a coefficient such as"),
        ({"rate": 0.0}, "^rate 0.0 and duration 0.2s must be positive"),
        ({"delay": "1s"}, "^delay 1s must not exceed duration 0.2s"),
        ({"efficiency": 1e-9}, "^efficiency has no meaning for feed_forward model; it is for efficiency"),
        ({"quality": 40.0}, "^quality has no meaning for a rig whose file has the table structure"),
        ({"warming_time": "1ms"}, "^warming_time has no meaning without warming"),
        ({"delay": "1mm"}, "^delay 1mm is a length"),
        ({"factor": 0.0}, "^factor must be finite and lie between 0.01 and 100, got 0.0"),
    ):
        with raises(InvalidInput, match=line):
            control(path, **arguments)
    with raises(UnknownName, match="unknown feed_forward 'modell'; did you mean model"):
        control(path, feed_forward="modell")  # type: ignore[arg-type]


def test_the_prediction_gives_reach_chance_and_margins_and_a_tuning_for_the_worst(rigs: Path) -> None:
    path = rigs / "tribometer.toml"
    usual, worst = (control(path, duration="40ms", tuned_for=each) for each in ("model", "worst"))
    found = usual.json_object()
    low, high = found["predicted_least_friction"]["interval_80"]
    assert low < found["predicted_least_friction"]["median"] < high
    assert 0 < found["target_chance"] < 1
    assert found["worst_of_80"]["gain_margin"]["value"] == approx(found["gain_margin"]["value"], rel=1e-3)
    slower = found["worst_of_80"]["closed_loop_time"]["value"]
    assert worst.settings.closed_loop_time == approx(slower)
    held = worst.json_object()["predicted_margins"]["gain_margin"]["interval_80"][0]
    assert held == approx(found["gain_margin"]["value"], rel=1e-3)
    assert worst.study.controller.gains.proportional_gain < usual.study.controller.gains.proportional_gain
    assert any("real friction may change" in line for line in usual.caveats())
    assert not any("real friction may change" in line for line in worst.caveats())
    chart = usual.figures()["tribometer-control-design"].chart()  # type: ignore[misc]
    assert "predicted, 80 %" in [getattr(part, "label", "") for part in chart.panels[0].parts]


@mark.parametrize(("name", "lookup"), [("tribometer", "lookup_voltage"), ("welder_flat", "lookup_amplitude")])
def test_dataset_table_and_page_have_the_interval_of_the_object(name: str, lookup: str, rigs: Path) -> None:
    found = control(rigs / f"{name}.toml", duration="40ms")
    told, run = found.json_object(), found.dataset()
    assert [run[each].attrs["units"] for each in (lookup, "least_friction_force", "gain_margin", "phase_margin")] == [
        {"lookup_voltage": "V", "lookup_amplitude": "m"}[lookup], "N", "1", "rad",
    ]  # fmt: skip
    assert all(run[each].attrs["long_name"] for each in run.variables)
    assert float(run["target_chance"]) == approx(told["target_chance"], rel=1e-12)
    for variable, key in (("least_friction_force", "predicted_least_friction"), ("plant_gain", "predicted_gain")):
        assert three(told[key]) == approx(run[variable].values.tolist(), rel=1e-12)
    for margin, value in told["predicted_margins"].items():  # margins fall with the gain, the peak rises with it
        ends = three(value) if margin == "sensitivity_peak" else three(value)[::-1]
        assert [np.nan if each is None else each for each in ends] == approx(
            run[margin].values.tolist(), rel=1e-12, nan_ok=True
        )
    forces = ["lowest_predicted_force", "predicted_friction_force", "highest_predicted_force"]
    assert [float(run[each][-1]) for each in forces] == approx(three(told["predicted_least_friction"]), rel=1e-12)
    table = pandas.read_csv(StringIO(str(found.files()[f"{name}-control.csv"])))
    assert table.columns[2:].tolist() == [f"{each} [N]" for each in forces]
    for each in forces:
        assert table[f"{each} [N]"].values == approx(run[each].values, rel=1e-12)
    (page,) = found.page().tables
    assert page.heads[1:] == ("friction by the model", "predicted median", "predicted, 80 %")
    low, high = told["predicted_least_friction"]["interval_80"]
    scale = found.study.friction_force
    assert page.rows[-1][-1] == f"{format_si(low, 'N', scale=scale)} to {format_si(high, 'N', scale=scale)}"


def three(value: dict[str, Any]) -> list[float]:
    """Lower end, median and upper end of a predicted value."""
    return [value["interval_80"][0], value["median"], value["interval_80"][1]]


def test_the_table_at_other_levels_lies_between_those_of_the_model_and_is_empty_beyond_them(rigs: Path) -> None:
    found = control(rigs / "tribometer.toml", duration="40ms", feed_forward="none")
    assert not isinstance(found.posterior, str)
    plant = found.study.plant
    places = 0.5 * (plant.level[:-1] + plant.level[1:])
    forces = predicted_forces(found.study, found.posterior, level=[*places, plant.level[-1] + 1.0])
    assert forces[:, :-1] == approx(0.5 * (found.posterior.force[:, :-1] + found.posterior.force[:, 1:]))
    assert np.isnan(forces[:, -1]).all()
    head, first, last = str(found.files()["tribometer-control.csv"]).splitlines()
    assert float(last.split(",")[3]) == approx(found.posterior.reach[1])
    assert lookup_table(found.study.controller, predicted=forces[:, -2:]).splitlines()[-1].endswith(",,,")
    assert (head.count(","), first.count(",")) == (4, 4)


def test_own_runs_narrow_reach_and_gain_and_a_feed_forward_by_the_prediction_has_its_median(rigs: Path) -> None:
    path, runs = rigs / "tribometer.toml", rigs.parent / "tribometer-runs.csv"
    before, after = (control(path, duration="40ms", runs=each).json_object() for each in (None, runs))
    assert after["prediction"]["runs"] > 0
    for name in ("predicted_least_friction", "predicted_gain"):
        width = [float(np.ptp(each[name]["interval_80"])) for each in (before, after)]
        assert width[1] < 0.5 * width[0]
    fed = control(path, duration="40ms", feed_forward="prediction", runs=runs)
    assert not isinstance(fed.posterior, str)
    assert fed.study.controller.intrinsic_friction_force - fed.study.controller.force_reduction[-1] == approx(
        fed.posterior.reach[1], rel=0.03
    )
    assert fed.posterior.gain is not None
    assert fed.posterior.gain[1] == approx(1.0, abs=0.2)


def test_a_rig_without_a_prediction_has_its_controller_and_a_reason_and_no_tuning_for_the_worst(rigs: Path) -> None:
    path = rigs / "pom_on_steel.toml"
    found = control(path, duration="40ms")
    assert "soft or floating contact" in found.json_object()["prediction"]["reason"]
    assert found.json_object()["gain_margin"]["value"] == approx(3.13, abs=0.01)
    assert "soft or floating contact" in found.dataset().attrs["prediction"]
    assert "predicted_quantile" not in found.dataset().variables
    assert str(found.files()["pom_on_steel-control.csv"]).splitlines()[0].count(",") == 1
    assert len(found.page().tables[0].heads) == 2
    with raises(InvalidInput, match="soft or floating contact"):
        control(path, duration="40ms", tuned_for="worst")
    with raises(InvalidInput, match="soft or floating contact"):
        control(path, duration="40ms", feed_forward="prediction")
