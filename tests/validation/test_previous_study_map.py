"""Map of previous studies: published numbers and axes."""

from types import SimpleNamespace
from typing import Any

from pytest import approx

from sonolube.charts import Line, Note, Panel, Points, Zone, draw_chart
from sonolube.figure import publication_style
from sonolube.validation.previous_study_map import StudyPoint, _of_study, study_chart, study_points

OWN = StudyPoint(
    label="own rig", direction="perpendicular", friction_reduction=0.5, sliding_speed=(0.05, 0.05), nominal_pressure=1e6
)


def test_the_map_shows_the_stated_numbers_and_leaves_the_missing_ones_out() -> None:
    points = {point.label: point for point in study_points()}
    assert points["Gutowski and Leus"].nominal_pressure == 31e3
    assert points["Littmann et al."].sliding_speed == (0.0, 0.5)
    assert points["Littmann et al."].nominal_pressure is None
    assert points["Oiwa"].sliding_speed is None


def test_the_map_has_units_on_both_axes_and_a_point_of_the_users_own() -> None:
    chart = study_chart(OWN)
    with publication_style():
        figure = draw_chart(chart)
    aside, axes, bar = figure.axes
    assert axes.get_xlabel() == "Sliding speed [m/s]"
    assert axes.get_ylabel() == "Nominal pressure [Pa]"
    assert bar.get_ylabel() == "Friction reduction [%]"
    assert "own rig" in axes.get_legend_handles_labels()[1]
    assert "stated" in aside.get_xlabel()
    (own,) = (part for part in chart.panels[1].parts if isinstance(part, Points) and part.label == "own rig")
    assert own.shades is not None
    assert (own.x.item(), own.y.item(), own.shades.item()) == (0.05, 1e6, 50.0)


def test_tests_of_the_dissertation_stand_at_their_pressures_and_reductions() -> None:
    # D Tables 2.3, 3.2: 3 N on 2.25 mm2; Table 4.2: 5 N; reductions 1 - 0.379/1.024 and 95.5 % at 25.9 V
    points = {point.label: point for point in study_points()}
    slow = points["D 2.3.4, slow"]
    assert slow.friction_reduction == approx(1 - 0.379 / 1.024)
    assert slow.nominal_pressure == approx(3 / 2.25e-6)
    assert slow.sliding_speed == approx((20.3e-3, 20.3e-3))
    assert (slow.direction, slow.source) == ("perpendicular", "friction test A-1")
    assert points["D 4.1.2, 25.9 V"].friction_reduction == approx(0.955, abs=1e-3)
    assert sum(label.startswith("D ") for label in points) == 5


def placed(*others: StudyPoint) -> tuple[Panel, Panel]:
    aside, known = study_chart(others=others).panels
    return aside, known


def study(label: str, **changes: object) -> StudyPoint:
    given: dict[str, object] = {
        "direction": "transverse", "friction_reduction": 0.4, "sliding_speed": (0.05, 0.05), "nominal_pressure": 1e6
    }  # fmt: skip
    return StudyPoint(label=label, **(given | changes))  # type: ignore[arg-type]


def test_a_range_of_speeds_is_a_line_to_its_fastest_and_begins_within_the_axis() -> None:
    _, before = placed()
    _, known = placed(study("ranged", sliding_speed=(0.0, 0.3)), study("single"))
    new = [part for part in known.parts if isinstance(part, Line)][
        len([p for p in before.parts if isinstance(p, Line)]) :
    ]
    (line,) = new
    assert line.x.tolist() == approx([1e-4, 0.3])
    assert line.y.tolist() == approx([1e6, 1e6])


def test_unknown_pressures_are_in_the_band_and_studies_without_speed_beside_the_map() -> None:
    aside, known = placed(study("no pressure", nominal_pressure=None), study("neither", sliding_speed=None))
    band = next(part for part in known.parts if isinstance(part, Zone))
    notes = {part.text.split(",")[0]: part for part in known.parts if isinstance(part, Note)}
    assert band.first[0] < notes["no pressure"].y < band.last[0]
    assert notes["no pressure"].y == approx(5.5e3)  # above those of the package
    littmann = next(part for text, part in notes.items() if text.startswith("Littmann"))
    assert littmann.y == approx(2.6e3)
    assert notes["no pressure"].text == "no pressure, 40 %"
    besides = [part for part in aside.parts if isinstance(part, Note)]
    assert [part.y for part in besides] == approx([-float(row) for row in range(len(besides))])
    assert any(part.text.startswith("neither, 40 %") for part in besides)
    rings = [part for panel in (aside, known) for part in panel.parts if isinstance(part, Points) and part.is_hollow]
    assert [ring.x.size for ring in rings] == [1, 1]


def test_an_additional_point_needs_speed_and_pressure() -> None:
    for lacking in ({"sliding_speed": None}, {"nominal_pressure": None}):
        parts = study_chart(study("added", **lacking)).panels[1].parts
        assert not any(isinstance(part, Points) and part.label == "added" for part in parts)
    whole = study_chart(study("added")).panels[1].parts
    (point,) = (part for part in whole if isinstance(part, Points) and part.label == "added")
    assert point.shades is not None
    assert point.shades.tolist() == approx([40.0])
    assert point.scale_ends == (0.0, 100.0)


def test_speed_and_pressure_are_drawn_by_their_logarithms_and_what_is_not_stated_beside_them() -> None:
    aside, known = study_chart(None).panels
    assert known.x.logarithmic
    assert known.y.logarithmic
    assert (known.x.unit, known.y.unit) == ("m/s", "Pa")
    assert not aside.x.logarithmic
    assert not aside.y.logarithmic
    assert (aside.x.lowest, aside.x.highest) == (-0.1, 1.0)
    assert aside.y.highest == 0.5
    unplaced = sum(isinstance(part, Note) for part in aside.parts)
    assert aside.y.lowest == 0.5 - max(unplaced, 5)
    for axis in (known.x, known.y):
        assert axis.lowest is not None
        assert axis.highest is not None
        assert 0 < axis.lowest < axis.highest


def test_a_study_notes_the_numbers_that_are_bounds_or_about_and_takes_the_others_as_they_are() -> None:
    def number(quantity: str, relation: str, text: str) -> Any:
        return SimpleNamespace(quantity=quantity, relation=relation, number=SimpleNamespace(text=text), unit="MPa")

    numbers = (
        number("nominal_pressure", "<", "2"),
        number("nominal_pressure", "=", "3"),
        number("wear_rate", ">", "4"),
        number("normal_load", "~", "5"),
    )
    study: Any = SimpleNamespace(
        study="Own", direction="along", section="1.2", references=(3, 4), numbers=numbers, number=lambda name: None
    )
    row = _of_study(study)
    assert row == {
        "study": "Own",
        "direction": "along",
        "source": "D 1.2, its references 3, 4",
        "note": "nominal_pressure < 2 MPa; normal_load ~ 5 MPa",
    }
    study.number = {"normal_load": SimpleNamespace(value=2.5)}.get
    assert _of_study(study)["normal_load"] == 2.5
