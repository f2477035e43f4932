"""Map of previous studies: published numbers and axes."""

from sonolube.charts import Points, draw_chart
from sonolube.figure import publication_style
from sonolube.validation.previous_study_map import StudyPoint, study_chart, study_points

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
