"""Charts: what Matplotlib draws, the object for a browser and the tables have the same numbers."""

import json

import numpy as np
import pytest
from matplotlib.patches import Rectangle
from pytest import approx

from sonolube.charts import (
    Axis,
    Band,
    Bars,
    Chart,
    Field,
    Line,
    Note,
    Panel,
    Points,
    Rule,
    Zone,
    chart_object,
    chart_tables,
    draw_chart,
)
from sonolube.figure import publication_style, render_figure
from sonolube.text.plain_text import with_micro_sign

X = np.array([1.0, 2.0, 4.0])
SPEED = Axis(label="Sliding speed", unit="mm/s", logarithmic=True)
CURVES = Panel(
    x=SPEED,
    y=Axis(label="Friction ratio", lowest=0.0, highest=1.0),
    parts=(
        Zone(first=np.array([1.5]), last=np.array([2.5]), label="not tested"),
        Band(x=X, low=X / 8, high=X / 4, label="80 % interval"),
        Line(x=X, y=np.array([0.2, np.nan, 0.8]), label="median"),
        Points(
            x=X[:1],
            y=X[:1] / 5,
            y_error=np.array([0.05]),
            label="measured",
            colour=1,
            sources=("run 1",),
            texts=("20",),
        ),
        Rule(value=2.0, label="operating point"),
        Note(x=2.0, y=0.5, text="here"),
    ),
)
GRID = np.array([[0.0, 10.0, 20.0], [30.0, 40.0, np.nan]])
CONTOURS = Panel(
    x=SPEED,
    y=Axis(label="Power", unit="W"),
    parts=(
        Field(x=X, y=X[:2], values=GRID, label="Reduction", unit="%", levels=np.arange(0, 60, 10.0)),
        Points(x=X[1:2], y=X[:1], shades=np.array([12.0]), label="runs"),
    ),
)
WORDS = Panel(
    x=SPEED,
    y=Axis(label="Load", unit="N"),
    parts=(Field(x=X, y=X[:2], values=np.array([[0.0, 1.0, 1.0], [0.0, 0.0, 1.0]]), words=("dry", "oil")),),
)
BARS = Panel(
    x=Axis(label="Score"),
    y=Axis(words=("first", "second", "third")),
    parts=(Bars(places=np.arange(3.0), lengths=X, error=np.ones((2, 3)), texts=("a", "b", "c")),),
)
CHART = Chart(panels=(CURVES, CONTOURS, WORDS, BARS), columns=2, size=(7, 5), title="A rig", legend="top")


def test_matplotlib_draws_the_values_and_labels_of_a_chart() -> None:
    figure = draw_chart(CHART)
    curves, contours, words, bars = figure.axes[:4]
    median = next(line for line in curves.lines if line.get_label() == "median")
    assert np.asarray(median.get_ydata(), float) == approx([0.2, np.nan, 0.8], nan_ok=True)
    assert (curves.get_xlabel(), curves.get_ylabel()) == ("Sliding speed [mm/s]", "Friction ratio")
    assert curves.get_xscale() == "log"
    assert curves.get_ylim() == (0.0, 1.0)
    assert [patch.get_width() for patch in bars.patches if isinstance(patch, Rectangle)] == approx(X)
    assert [text.get_text() for text in bars.get_yticklabels()] == ["first", "second", "third"]
    (legend,) = figure.legends
    labels = [text.get_text() for text in legend.get_texts()]
    assert {"median", "80 % interval", "measured", "operating point", "not tested", "runs", "dry", "oil"} == set(labels)
    assert legend.get_title().get_text() == "A rig"
    assert contours.get_ylabel() == "Power [W]"
    assert words.get_ylabel() == "Load [N]"


@pytest.mark.parametrize("legend", ["top", "bottom", "right", "panels", "none"])
def test_every_place_of_the_legend_is_drawn(legend: str) -> None:
    chart = Chart(panels=(CURVES, CONTOURS), legend=legend, size=(5, 5), title="A rig")  # type: ignore[arg-type]
    with publication_style():
        assert render_figure(draw_chart(chart), "png").startswith(b"\x89PNG")


def test_the_object_for_a_browser_has_all_numbers_and_no_nan() -> None:
    found = json.loads(json.dumps(chart_object(CHART), allow_nan=False))
    curves, contours, words, _ = found["panels"]
    zone, band, line, points, rule, note = curves["parts"]
    kinds = [each["kind"] for each in (zone, band, line, points, rule, note)]
    assert kinds == ["zone", "band", "line", "points", "rule", "note"]
    assert line["y"] == [0.2, None, 0.8]
    assert line["colour"] == "#0072b2"
    assert points["sources"] == ["run 1"]
    assert points["y_error"] == [0.05]
    assert points["colour"] == "#d55e00"
    assert rule["value"] == 2.0
    assert rule["along"] == "x"
    assert note["text"] == "here"
    assert curves["x"]["text"] == "Sliding speed [mm/s]"
    assert curves["x"]["logarithmic"]
    assert contours["parts"][0]["values"] == [[0.0, 10.0, 20.0], [30.0, 40.0, None]]
    assert contours["parts"][0]["scale_text"] == "Reduction [%]"
    assert words["parts"][0]["words"] == ["dry", "oil"]


def test_numbers_for_a_browser_have_six_digits() -> None:
    line = Line(x=np.array([0.0123456789, 98765.4321]), y=np.array([1e-12 / 3, -2.0]))
    (part,) = chart_object(Chart(panels=(Panel(x=SPEED, y=SPEED, parts=(line,)),)))["panels"][0]["parts"]
    assert part["x"] == [0.0123457, 98765.4]
    assert part["y"] == [3.33333e-13, -2.0]


def test_a_number_of_numpy_is_a_plain_one() -> None:
    note = Note(x=np.float64(2.0), y=np.float64(0.0), text="here")
    chart = Chart(panels=(Panel(x=Axis("a", "m"), y=Axis("b", "N"), parts=(note,)),), size=(4.0, 3.0))
    (part,) = chart_object(chart)["panels"][0]["parts"]
    assert (part["x"], part["y"]) == (2.0, 0.0)


def test_the_value_nought_of_a_rule_is_kept() -> None:
    panel = Panel(x=SPEED, y=Axis(label="Gap", unit="µm"), parts=(Rule(along="y", value=0.0),))
    (part,) = chart_object(Chart(panels=(panel,)))["panels"][0]["parts"]
    assert part["value"] == 0.0


def test_tables_have_the_numbers_of_every_part_with_its_heads() -> None:
    tables = {table["title"]: table for table in chart_tables(CHART)}
    assert tables["Friction ratio, median"]["heads"] == ["Sliding speed [mm/s]", "Friction ratio"]
    assert tables["Friction ratio, median"]["rows"] == [["1", "0.2"], ["2", ""], ["4", "0.8"]]
    assert tables["Friction ratio, measured"]["rows"] == [["1", "0.2", "0.05", "run 1"]]
    assert tables["Power, Reduction"]["rows"] == [["1", "0", "10", "20"], ["2", "30", "40", ""]]
    assert tables["Load"]["rows"][1] == ["2", "dry", "dry", "oil"]
    (bars,) = (table for table in tables.values() if table["heads"][-1] == "Score")
    assert bars["rows"] == [["first", "1"], ["second", "2"], ["third", "4"]]


def test_parts_are_added_to_one_panel_of_a_copy() -> None:
    changed = CHART.with_parts(1, Rule(value=3.0))
    assert [len(panel.parts) for panel in changed.panels] == [6, 3, 1, 1]
    assert [len(panel.parts) for panel in CHART.panels] == [6, 2, 1, 1]


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("2.5 um peak", "2.5 µm peak"),
        ("3 us", "3 µs"),
        ("run 2 under load", "run 2 under load"),
        ("4 units", "4 units"),
    ],
)
def test_units_in_figures_have_a_micro_sign(text: str, shown: str) -> None:
    assert with_micro_sign(text) == shown


def test_a_number_of_an_array_is_a_number_of_the_object() -> None:
    panel = Panel(x=SPEED, y=SPEED, parts=(Rule(value=X[1], label="steady"), Rule(value=np.float64(np.float32(0.5)))))
    parts = chart_object(Chart(panels=(panel,), size=(3.0, 2.0)))["panels"][0]["parts"]
    assert [part["value"] for part in json.loads(json.dumps(parts))] == [2.0, 0.5]
