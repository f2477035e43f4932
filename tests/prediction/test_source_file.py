"""Files of published tests: what is read of a point, the shipped numbers against the facts, and refusals."""

import json
from math import hypot, pi
from pathlib import Path
from typing import Any

import numpy as np
from pytest import approx, mark, raises

from sonolube.errors import InvalidInput
from sonolube.facts.published import published_number, si_value
from sonolube.prediction.evidence import published_rigs
from sonolube.prediction.published_source import in_order, read_source, shipped_sources, source_from
from sonolube.prediction.source_file import PublishedPoint, evidence_schema
from sonolube.validation.published_tests import friction_tests, in_plane_tests

EXAMPLE = Path(__file__).parents[2] / "examples" / "evidence" / "own_tests.toml"


def content(**changes: Any) -> dict[str, Any]:
    """A file with one point along the normal; changes of the rig, or of the point by `point`."""
    point = {"label": "1", "sliding_speed": "30 mm/s", "vibration_amplitude": "1 um", "friction_ratio": 0.7}
    point |= changes.pop("point", {})
    rig = {
        "set": "1",
        "title": "pin on disc",
        "amplitude_known": "measured with a vibrometer",
        "frequency": "20 kHz",
        "points": [{key: value for key, value in point.items() if value is not None}],
    } | changes
    source = {"title": "N. N.", "citation": "N. N. 2026", "opened": "full text"}
    return source | {"rigs": [{key: value for key, value in rig.items() if value is not None}]}


def point_of(**changes: Any) -> PublishedPoint:
    return source_from(content(**changes), file="own.toml").rigs[0].points[0]


def test_the_shipped_points_along_the_normal_are_the_facts_of_the_dissertation() -> None:
    tests = friction_tests()
    points = {
        point.label: (rig, point)
        for source in shipped_sources()
        for rig in source.rigs
        if rig.is_normal
        for point in rig.points
    }
    assert list(points) == [*(test.label for test in tests), "P-1", "P-2", "P-3"]
    for test in tests:
        rig, point = points[test.label]
        assert rig.section.set == test.set_name
        assert point.normal_load is not None
        numbers = (point.sliding_speed, point.vibration_amplitude, point.frequency, point.normal_load.value)
        assert numbers == approx((test.sliding_speed, test.vibration_amplitude, test.frequency, test.normal_load))
        assert point.friction_ratio == approx(test.friction_ratio, abs=1e-12)
        assert (point.uncertainty is None) == (test.uncertainty is None)
        assert point.uncertainty == (test.uncertainty and approx(test.uncertainty))


def test_the_poisson_pairs_are_the_facts_of_chapter_2_1_on_one_rig() -> None:
    (rig,) = (rig for source in shipped_sources() for rig in source.rigs if rig.section.set == "P")
    reductions = [
        published_number(f"2.1.5-reduction-{pair}")
        for pair in ("aluminium-horn", "steel-on-aluminium", "steel-on-steel")
    ]
    assert [point.friction_ratio for point in rig.points] == approx(
        [1 - (number.low + number.high) / 2 for number in reductions], abs=1e-9
    )
    for point, number in zip(rig.points[1:], reductions[1:], strict=True):
        assert point.uncertainty == approx((number.high - number.low) / 2)
    for point in rig.points:
        assert point.sliding_speed == approx(si_value("2.1.2-sliding-speed"))
        assert point.frequency == approx(si_value("2.1.2-welder-frequency"))
        assert point.normal_load is not None
        assert point.normal_load.ends == approx((60.0, 240.0))  # D 2.1.2
    assert any("plane" in caveat for caveat in rig.section.caveats)
    (tested,) = (each for each in published_rigs() if each.name == "P")
    assert tested.at.conditions.vibration_amplitude == approx([0.88e-6] * 3)


def test_the_shipped_points_within_the_plane_that_the_dissertation_quotes_are_its_facts() -> None:
    points = {point.label: point for source in shipped_sources() for rig in source.rigs for point in rig.points}
    for test in in_plane_tests():
        point = points[test.label]
        assert point.sliding_speed == approx(test.sliding_speed)
        assert point.vibration_velocity == approx(test.vibration_velocity)
        assert point.friction_ratio == approx(test.friction_ratio)


def test_two_scatters_are_independent_and_the_ends_of_two_ranges_belong_together() -> None:
    scattered = point_of(
        point={
            "friction_ratio": None,
            "intrinsic_friction_force": "2 N +- 0.2 N",
            "reduced_friction_force": "1 N ± 0.05 N",
        }
    )
    assert scattered.friction_ratio == approx(0.5)
    assert scattered.uncertainty == approx(0.5 * hypot(0.1, 0.05))
    ranges = point_of(
        point={"friction_ratio": None, "intrinsic_friction_force": "2 N to 4 N", "reduced_friction_force": "1 N to 3 N"}
    )
    assert (ranges.friction_ratio, ranges.uncertainty) == approx(((0.5 + 0.75) / 2, 0.125))
    reduction = point_of(point={"friction_ratio": None, "friction_reduction": "0.2 to 0.4"})
    assert (reduction.friction_ratio, reduction.uncertainty) == approx((0.7, 0.1))
    plain = point_of(
        point={"friction_ratio": None}, intrinsic_friction_coefficient=0.5, reduced_friction_coefficient=0.4
    )
    assert plain.friction_ratio == approx(0.8)
    assert plain.uncertainty is None


def test_a_velocity_with_a_frequency_is_an_amplitude_and_within_the_plane_it_is_enough() -> None:
    by_velocity = point_of(point={"vibration_amplitude": None, "vibration_velocity": "0.1 m/s"})
    assert by_velocity.vibration_amplitude == approx(0.1 / (2 * pi * 20e3))
    by_amplitude = point_of()
    assert by_amplitude.vibration_velocity == approx(2 * pi * 20e3 * 1e-6)
    along = point_of(
        point={"vibration_amplitude": None, "vibration_velocity": "0.1 m/s"}, direction="along", frequency=None
    )
    assert along.vibration_amplitude is None
    assert along.vibration_velocity == approx(0.1)


@mark.parametrize(
    ("changes", "reason"),
    [
        ({"point": {"sliding_speed": "3 N"}}, r"sliding_speed: 3 N is a force; .*speed"),
        ({"point": {"sliding_speed": "-3 mm/s"}}, r"sliding_speed must be positive, got -0\.003 m/s"),
        ({"point": {"sliding_speed": None}}, r'point "1": sliding_speed is missing'),
        ({"point": {"vibration_amplitude": None}}, r"vibration_amplitude and frequency must be given"),
        ({"frequency": None}, r"vibration_amplitude and frequency must be given|velocity"),
        ({"point": {"amplitude": "1 um"}}, r"points\.0\.amplitude: unknown key; did you mean vibration_amplitude\?"),
        ({"point": {"friction_ratio": 30}}, r"friction_ratio 30 is none that was ever measured; 40 % is 0\.4"),
        ({"point": {"friction_ratio": None}}, r"needs friction_ratio, friction_reduction, or the friction force"),
        ({"point": {"friction_reduction": 0.3}}, r"by friction_ratio and by friction_reduction; leave one out"),
        ({"point": {"friction_ratio": "0.8 to 0.6"}}, r"0\.8 to 0\.6 is no range: its second value must be the larger"),
        (
            {"point": {"friction_ratio": None, "friction_reduction": 1.2}},
            r"its friction ratio is -0\.2; expected 0 to 3",
        ),
        ({"point": {"uncertainty": 3.0}}, r"uncertainty 3 must lie between 0\.001 and 1"),
        ({"amplitude_known": None}, r"amplitude_known: missing"),
        ({"amplitude_spread": 70.0}, r"amplitude_spread 70 must lie above 0 and not above 3: 0\.7 is a factor of two"),
        ({"direction": "sideways"}, r"direction: Input should be 'normal', 'along' or 'across'"),
        ({"direction": "along", "vibration_direction": "30 deg"}, r"either direction or vibration_direction"),
        ({"points": None}, r"rigs\.0\.points: missing"),
        ({"points": []}, r"points: List should have at least 1 item"),
    ],
)
def test_a_fault_is_refused_with_key_value_and_remedy(changes: dict[str, Any], reason: str) -> None:
    with raises(InvalidInput, match=reason):
        point_of(**changes)


@mark.parametrize(
    ("name", "value", "reason"),
    [
        ("opened", "title and abstract", r'opened "title and abstract": an abstract has no points'),
        ("doi", "https://doi.org/10.1/x", r'doi "https://doi.org/10.1/x" must begin with 10\.'),
        ("opened", None, r"opened: missing"),
    ],
)
def test_a_source_that_was_not_read_or_found_is_refused(name: str, value: str | None, reason: str) -> None:
    changed = {key: each for key, each in (content() | {name: value}).items() if each is not None}
    with raises(InvalidInput, match=reason):
        source_from(changed, file="own.toml")


def test_two_sets_of_one_name_and_two_points_of_one_label_are_refused() -> None:
    one = content()
    with raises(InvalidInput, match=r'set "1" is that of 2 rigs; name each of its own'):
        source_from(one | {"rigs": [*one["rigs"], *one["rigs"]]}, file="own.toml")
    (point,) = one["rigs"][0]["points"]
    with raises(InvalidInput, match=r'label "1" is that of 2 points; name each of its own'):
        point_of(points=[point, point])


def test_a_refusal_names_the_file(tmp_path: Path) -> None:
    path = tmp_path / "kumar.toml"
    path.write_text(EXAMPLE.read_text("utf-8").replace("20 kHz", "20 km"), "utf-8")
    with raises(InvalidInput, match=rf"^{path}: rigs\.0\.frequency: 20 km is a length"):
        read_source(path)
    with raises(InvalidInput, match="no such file"):
        read_source(tmp_path / "gone.toml")


def test_the_example_has_three_points_and_follows_the_schema() -> None:
    source = read_source(EXAMPLE)
    assert [point.friction_ratio for point in source.rigs[0].points] == approx([2.7 / 3.1, 2.1 / 3.1, 1.3 / 3.1])
    schema = evidence_schema()
    points = schema["$defs"]["PointSection"]["properties"]
    assert points["sliding_speed"]["x-si-unit"] == "m/s"
    assert {"title", "citation", "opened", "rigs"} == set(schema["required"])


def test_the_schema_in_the_docs_is_that_of_the_product() -> None:
    text = (EXAMPLE.parents[2] / "docs" / "evidence.schema.json").read_text("utf-8")
    assert json.loads(text) == evidence_schema(), "run: sonolube schema evidence > docs/evidence.schema.json"


def test_the_order_of_sources_does_not_follow_their_files() -> None:
    sources = shipped_sources()
    assert in_order(tuple(reversed(sources))) == sources
    assert np.all([source.points for source in sources])
