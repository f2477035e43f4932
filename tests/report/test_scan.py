"""Height maps as shown: form, radii, slopes and sections of surfaces of known shape."""

import numpy as np
import pytest
from pytest import approx

from sonolube.charts import Field, Line
from sonolube.models.surfaces import HeightMap
from sonolube.report.measured.scan import cells_text, form_facts, scan_chart, section_chart, shown_heights, size_of

X, Y = np.meshgrid(1e-6 * np.arange(60), 2e-6 * np.arange(41))


def surface(height: np.ndarray) -> HeightMap:
    return HeightMap(height=height, spacing_x=1e-6, spacing_y=2e-6)


def test_a_bowl_has_its_range_slopes_and_radii() -> None:
    bowl = surface(X**2 / (2 * 3e-3) - Y**2 / (2 * 5e-3) + 0.002 * X)
    facts = dict(form_facts(bowl, degree=2))
    # the mean slope along x is that of the chord: 0.002 + 59 um/(2 * 3 mm); along y -80 um/(2 * 5 mm)
    assert facts["Mean slope along x"] == f"{0.002 + 59e-6 / 6e-3:.3g}"
    assert facts["Mean slope along y"] == f"{-80e-6 / 10e-3:.3g}"
    assert facts["Radius along x"] == "3 mm"
    assert facts["Radius along y"] == "5 mm"
    lowest_to_highest = float(np.ptp(bowl.height))
    assert facts["Form, lowest to highest"] == f"{lowest_to_highest * 1e6:.4g} um"
    plane = dict(form_facts(bowl, degree=1))
    assert "Radius along x" not in plane
    assert list(dict(form_facts(bowl, degree=0))) == ["Form, lowest to highest"]


def test_a_radius_beyond_ten_thousand_fields_is_straight() -> None:
    side = 60e-6
    for radius, text in ((0.9e4 * side, "540 mm"), (1.1e4 * side, "straight")):
        assert dict(form_facts(surface(X**2 / (2 * radius)), degree=2))["Radius along x"] == text
    line = HeightMap(height=np.arange(5.0)[np.newaxis] * 1e-6, spacing_x=1e-3, spacing_y=1e-3)
    assert dict(form_facts(line, degree=2)) == {
        "Form, lowest to highest": "4 um",
        "Mean slope along x": "0.001",
        "Radius along x": "straight",
    }


@pytest.mark.parametrize("shown", ["levelled", "measured", "form"])
def test_heights_are_shown_less_their_form_as_measured_or_as_the_form(shown: str) -> None:
    rough = 1e-8 * np.random.default_rng(1).standard_normal(X.shape)
    tilted = surface(0.01 * X + rough)
    found, facts = shown_heights(tilted, shown=shown, degree=1, robust=False)  # type: ignore[arg-type]
    if shown == "measured":
        assert found is tilted
        assert facts == []
        return
    assert float(dict(facts)["Mean slope along x"]) == approx(0.01, rel=0.01)
    expected = 0.01 * (X - X.mean()) if shown == "form" else rough
    assert found.height - found.height.mean() == approx(expected - expected.mean(), abs=2e-9)


def test_a_map_is_a_field_and_a_row_or_column_a_curve_of_its_heights() -> None:
    (panel,) = scan_chart(surface(1e-6 * X / 60e-6)).panels
    assert isinstance(panel.parts[0], Field)
    line = 1e-6 * np.array([1.0, 3.0, 2.0])
    for height, name, step in ((line[np.newaxis], "x", 1.0), (line[:, np.newaxis], "y", 2.0)):
        (panel,) = scan_chart(surface(height)).panels
        (curve,) = panel.parts
        assert isinstance(curve, Line)
        assert panel.x.label == name
        assert curve.x * size_of(panel.x.unit) == approx(1e-6 * step * np.arange(3))
        assert curve.y * size_of(panel.y.unit) == approx(line)
        assert panel.x.lowest == 0.0
        assert panel.x.highest is not None
        assert panel.x.highest * size_of(panel.x.unit) == approx(2e-6 * step)


def test_cells_are_said_to_be_pixels_or_means() -> None:
    assert cells_text(surface(X)) == "single pixels"
    wide = HeightMap(height=np.zeros((40, 1000)), spacing_x=1e-6, spacing_y=1e-6)
    assert cells_text(wide) == "means of 3 x 3 pixels"
    tall = HeightMap(height=np.zeros((500, 30)), spacing_x=1e-6, spacing_y=2e-6)
    assert cells_text(tall) == "means of 3 x 2 pixels"  # 2.5 um


def test_a_section_along_a_ramp_has_its_length_points_and_range() -> None:
    ramp = surface(0.01 * X)
    chart, facts = section_chart(ramp, start=(10e-6, 8e-6), end=(50e-6, 8e-6))
    found = dict(facts)
    assert found["Length"] == "40 um"
    assert found["Points"] == "41"
    assert found["Lowest to highest"] == "400 nm"
    assert found["From end to end"] == "400 nm"
    # an even ramp of 41 values of 10 nm: sqrt((41^2 - 1)/12)
    assert found["Root mean square about their mean"] == f"{10 * np.sqrt(140):.4g} nm"
    assert "Of them missing" not in found
    assert chart.panels[0].x.label == "Distance"
    _, back = section_chart(ramp, start=(50e-6, 8e-6), end=(10e-6, 8e-6))
    assert dict(back)["From end to end"] == "-400 nm"


def test_missing_heights_of_a_section_are_counted() -> None:
    height = 0.01 * X
    height[:, 20:25] = np.nan
    _, facts = section_chart(surface(height), start=(10.5e-6, 8e-6), end=(50.5e-6, 8e-6))
    assert dict(facts)["Of them missing"] == "6"  # beside five pixels
    _, none = section_chart(surface(height), start=(21e-6, 8e-6), end=(23e-6, 8e-6))
    assert [name for name, _ in none] == ["Length", "Points", "Of them missing"]


def test_units_of_a_chart_are_lengths() -> None:
    assert [size_of(unit) for unit in ("nm", "µm", "mm")] == [1e-9, 1e-6, 1e-3]
