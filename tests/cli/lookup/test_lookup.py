"""Commands that look up facts: every fact has its source, and JSON is the table itself."""

import json
from collections.abc import Callable
from typing import Any

from sonolube.rig import rig_schema

Program = Callable[..., Any]


def test_every_material_is_listed_with_its_sources(sonolube: Program) -> None:
    listed = sonolube("materials", "--json").answer
    assert "aluminium_2024" in listed
    assert all(entry["source"] for entry in listed["m50"]["properties"].values())


def test_a_published_table_is_shown_as_printed_with_its_corrections(sonolube: Program) -> None:
    shown = sonolube("published", "2.5", "--json").answer
    assert "2.237" in json.dumps(shown)
    assert any(correction["erratum"] == "E27" for correction in shown["corrections"])


def test_actuators_are_listed_with_their_sources(sonolube: Program) -> None:
    listed = sonolube("actuators", "--json").answer
    assert listed["apa40sm"]["source"] == "Dissertation (D), section 2.2.2"
    assert "blocked_force" not in listed["apa40sm"]
    assert "not printed" in sonolube("actuators").out
    assert "did you mean sa050510?" in sonolube("actuators", "sa05051").refusal


def test_the_schema_is_the_same_with_and_without_json(sonolube: Program) -> None:
    plain = sonolube("schema").out
    assert json.loads(plain) == rig_schema()
    assert sonolube("schema", "--json").out == plain


def test_materials_are_listed_by_family_with_what_a_contact_needs(sonolube: Program) -> None:
    lines = sonolube("materials").out.splitlines()
    assert lines[0].startswith("74 materials")
    heads = [line for index, line in enumerate(lines) if index and not lines[index - 1]]
    families = [head.partition("Young's")[0].strip() for head in heads]
    assert {"brass", "stainless steel", "cast iron", "polymer", "piezo ceramic"} <= set(families)
    assert families == sorted(families)
    row = next(line for line in lines if line.startswith("  brass_c36000"))
    assert "97 GPa" in row
    assert "310 MPa" in row
    assert lines.index(row) > lines.index(heads[families.index("brass")])


def test_a_material_is_shown_by_any_of_its_names(sonolube: Program) -> None:
    shown = sonolube("materials", "AISI 304").out
    assert shown.startswith("stainless_steel_304: Stainless steel AISI 304")
    assert "ss304" in shown.splitlines()[1]
    assert sonolube("materials", "brass", "--json").answer["family"] == "brass"
