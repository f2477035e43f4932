"""Entry of a run by loads and speeds of its steps, its facts and its texts, told by hand."""

from pathlib import Path
from typing import Any

import pytest
from pytest import approx

from sonolube.facts.protocol import protocol_from, protocol_text
from sonolube.laboratory.catalogue.entry import CatalogueEntry, catalogue_entry
from sonolube.laboratory.catalogue.index import query_from, query_runs
from sonolube.laboratory.records import new_run

WAIT = {"kind": "wait", "duration": "1 s"}


def slide(speed: str) -> dict[str, Any]:
    return {"kind": "motor_speed", "sliding_speed": speed}


def turn(speed: str) -> dict[str, Any]:
    return {"kind": "motor_speed", "rotation_speed": speed}


def hang(load: str) -> dict[str, Any]:
    return {"kind": "prompt", "task": "load", "text": "Hang it.", "normal_load": load}


def entry(
    parent: Path, *steps: dict[str, Any], metadata: dict[str, str] | None = None, text: str = "", **facts: Any
) -> CatalogueEntry:
    limits = {"voltage_maximum": "30 V", "duration_maximum": "1 h"}
    content = {"title": "Slides", "source": "s", "limits": limits, "steps": list(steps or [WAIT])}
    protocol = text or protocol_text(protocol_from(content | {"metadata": metadata or {}}))
    recorder = new_run(parent, title="Slides", protocol=protocol, facts=facts)
    recorder.note("trip", reason="too hot", value=3.0)
    return catalogue_entry(recorder.finish("stopped", reason="a limit").folder)


def test_loads_are_those_under_which_the_disc_turned(tmp_path: Path) -> None:
    steps = (hang("4 N"), WAIT, hang("9 N"), slide("20 mm/s"), WAIT, slide("0 mm/s"), hang("2 N"), turn("1 1/s"), WAIT)
    found = entry(tmp_path, *steps, metadata={"normal_load": "3 N"})
    assert found.normal_loads == (2.0, 9.0)
    assert found.normal_load is None


def test_a_load_of_the_facts_stands_for_that_of_the_protocol_and_for_a_run_that_never_turned(tmp_path: Path) -> None:
    steps = slide("20 mm/s"), WAIT, slide("0 mm/s"), hang("9 N"), slide("20 mm/s"), WAIT
    told = entry(tmp_path, *steps, metadata={"normal_load": "3 N"}, normal_load=5.0)
    assert told.normal_loads == (5.0, 9.0)
    at_rest = entry(tmp_path, hang("9 N"), WAIT, metadata={"normal_load": "3 N"})
    assert (at_rest.normal_loads, at_rest.normal_load) == ((3.0,), 3.0)
    assert entry(tmp_path, hang("9 N"), WAIT).normal_loads == ()
    assert entry(tmp_path, text="x = ", normal_load=6.0).normal_loads == (6.0,)


def test_speeds_are_those_above_zero_by_the_groove_of_the_protocol_else_of_the_facts(tmp_path: Path) -> None:
    steps = slide("50 mm/s"), WAIT, turn("2 1/s"), WAIT, slide("20 mm/s"), WAIT
    groove = {"groove_diameter": "28 mm"}
    found = entry(tmp_path, *steps, metadata=groove, groove_diameter=0.05)
    assert found.sliding_speeds == approx((0.02, 0.05, 0.1759292))  # pi 28 mm 2/s
    assert found.sliding_speed is None
    by_facts = entry(tmp_path, turn("2 1/s"), WAIT, groove_diameter=0.05)
    assert by_facts.sliding_speeds == approx((0.3141593,))
    assert by_facts.sliding_speed == approx(0.3141593)
    assert entry(tmp_path, turn("2 1/s"), WAIT).sliding_speeds == ()
    assert entry(tmp_path, slide("50 mm/s"), WAIT, sliding_speed=0.07).sliding_speeds == (0.07,)
    assert entry(tmp_path, text="x = ").sliding_speeds == ()


def test_materials_of_the_facts_go_before_those_of_the_protocol(tmp_path: Path) -> None:
    metadata = {"pin_material": "brass", "disc_material": "steel"}
    found = entry(tmp_path, metadata=metadata, disc_material="glass")
    assert (found.pin_material, found.disc_material) == ("brass", "glass")
    bare = entry(tmp_path, text="x = ", pin_material="oak")
    assert (bare.pin_material, bare.disc_material) == ("oak", "")


def test_tags_are_words_between_commas_and_the_text_has_everything_that_is_text(tmp_path: Path) -> None:
    found = entry(tmp_path, tags=" map,, second one ,", operator="Ada")
    assert found.tags == ("map", "second one")
    for word in ("Slides", "a limit", "operator Ada", "too hot", 'kind = "wait"', found.summary.folder.name):
        assert word in found.text
    assert found.summary.outcome == "stopped"


@pytest.mark.parametrize(
    ("conditions", "finds"),
    [
        ({"speed": ["176mm/s"]}, True),
        ({"speed": ["30mm/s"]}, False),
        ({"load": ["3N"], "material": ["steel"]}, True),
        ({"load": ["3N"], "material": ["oak"]}, False),
        ({"tag": ["second ONE"], "text": ["TOO hot"]}, True),
        ({"tag": ["second"]}, False),
        ({"outcome": ["stopped"]}, True),
        ({"outcome": [""]}, True),
    ],
)
def test_an_entry_comes_back_from_the_index_as_it_was(
    tmp_path: Path, conditions: dict[str, list[str]], finds: bool
) -> None:
    metadata = {"normal_load": "3 N", "groove_diameter": "28 mm", "disc_material": "Steel"}
    made = entry(tmp_path, slide("20 mm/s"), WAIT, turn("2 1/s"), WAIT, metadata=metadata, tags="map,Second one")
    found = query_runs(tmp_path, query_from(conditions))
    assert (len(found.entries), found.of, found.caveats) == (int(finds), 1, ())
    for each in found.entries:
        assert each.summary == made.summary
        assert (each.tags, each.normal_loads, each.disc_material) == (("map", "Second one"), (3.0,), "Steel")
        assert each.sliding_speeds == approx(made.sliding_speeds)
