"""Command `horn face`: transition and motor regions of the Poisson horns."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from pytest import approx

from dong2015.chapter2.poisson_horn import friction_on_face
from sonolube.design.horns.face import transition_region

Program = Callable[..., Any]


def test_the_regions_are_those_of_the_reproduction_beside_the_measured_ones(sonolube: Program, tmp_path: Path) -> None:
    answer = sonolube("horn", "face", "steel", "--json", "--out", tmp_path).answer
    low, high = transition_region(friction_on_face("steel", frequency=20e3))
    assert answer["transition_region"]["start"]["value"] == approx(low)
    assert answer["transition_region"]["end"]["value"] == approx(high)
    measured = [answer["measured_transition_region"][side]["value"] for side in ("start", "end")]
    assert measured == approx([0.0, 0.3 * 0.0254], abs=0.4 * 0.0254)
    assert low < answer["node_position"]["value"] < high
    assert answer["least_friction_ratio"]["value"] < 0  # the face drives the block


def test_a_block_faster_than_the_face_is_driven_nowhere_and_that_is_a_caveat(sonolube: Program, tmp_path: Path) -> None:
    answer = sonolube("horn", "face", "steel", "--sliding-speed", "5m/s", "--json", "--out", tmp_path).answer
    assert answer["least_friction_ratio"]["value"] >= 0
    assert answer["transition_region"]["start"]["value"] is None
    assert any("does not drive the block" in caveat for caveat in answer["caveats"])


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (["brass"], "unknown horn 'brass'; known: aluminium, steel"),
        (["steel", "--amplitude", "0um"], "--amplitude must be positive"),
    ],
)
def test_bad_input_is_one_line(arguments: list[str], line: str, sonolube: Program, tmp_path: Path) -> None:
    assert line in sonolube("horn", "face", *arguments, "--out", tmp_path).refusal
