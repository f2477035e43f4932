"""Chart of the published tests: each point once, by source and direction, at what its file states."""

import numpy as np
from pytest import approx

from sonolube.charts import Points
from sonolube.figure import COLOURS
from sonolube.prediction.evidence_figure import evidence_chart
from sonolube.prediction.published_source import shipped_sources


def parts(place: int) -> dict[str, Points]:
    found = evidence_chart(shipped_sources()).panels[place].parts
    return {part.label: part for part in found if isinstance(part, Points)}


def test_each_point_is_drawn_once_over_the_velocity_ratio_and_those_with_an_amplitude_over_that() -> None:
    amplitudes, ratios = parts(0), parts(1)
    assert [part.x.size for part in ratios.values()] == [20, 1, 1, 5]
    assert "Gutowski and Leus, within the plane" not in amplitudes  # whose amplitude is not quoted
    luo = "Luo et al., within the plane"
    assert amplitudes[luo].x == approx([0.35] * 5)
    assert ratios[luo].x[0] == approx(0.05e-3 / (2 * np.pi * 26e3 * 0.35e-6))
    assert ratios[luo].y == approx([0.154, 0.146, 0.140, 0.113, 0.104], abs=6e-4)


def test_an_amplitude_that_was_not_measured_is_drawn_at_its_median_with_its_spread() -> None:
    dong = parts(0)["Dong, along the normal"]
    # set H: twice 0.693 um within a factor of e^0.7; its first point is the last but four
    assert dong.sources[15].startswith("Dong, flextensional actuator")
    assert dong.x[15] == approx(2 * 0.6933, rel=1e-3)
    assert dong.x_error is not None
    assert dong.x[15] + dong.x_error[1, 15] == approx(2 * 0.6933 * np.exp(0.7), rel=1e-3)
    assert parts(1)["Dong, along the normal"].x[15] == approx(3.5e-3 / (2 * np.pi * 16e3 * 2 * 0.6933e-6), rel=1e-3)


def test_sources_differ_in_colour_and_marker_and_directions_in_filling() -> None:
    found = parts(1)
    assert len({(part.colour, part.marker) for part in found.values()}) == len(found)
    assert all(isinstance(part.colour, int) and part.colour < len(COLOURS) for part in found.values())
    assert {label.endswith("within the plane"): part.is_hollow for label, part in found.items()} == {
        True: True,
        False: False,
    }


def test_axes_carry_units() -> None:
    left, right = evidence_chart(shipped_sources()).panels
    assert (left.x.label, left.x.unit) == ("Vibration amplitude", "µm")
    assert (right.x.label, right.x.unit) == ("Sliding speed over vibration velocity", "")
    assert left.y.highest == approx(1.15)
