"""Materials, actuators and published tables in rows and JSON: values with sources, corrections, units as printed."""

from dataclasses import dataclass
from math import log
from types import SimpleNamespace
from typing import Any

from pytest import approx

from sonolube.facts.materials import material_families
from sonolube.models.actuator import CatalogueActuator
from sonolube.report.blocks import Rows, Table
from sonolube.report.results import looked_up as results

FAMILY = material_families()[0]


@dataclass
class Sourced:
    value: float
    unit: str
    source: str = "handbook"
    deviation: float = 0.0
    condition: str = ""
    note: str = ""


@dataclass
class Structure:
    text: str = "face-centred cubic"
    source: str = "textbook"


def brass(*, aliases: tuple[str, ...] = ("ms58",), structure: Any = None) -> Any:
    return SimpleNamespace(
        name="brass", title="Brass CuZn39", family=FAMILY, is_class=False, aliases=aliases,
        crystal_structure=structure, properties={
            "youngs_modulus": Sourced(97.123456e9, "Pa"),
            "hardness": Sourced(1.2e9, "Pa", deviation=log(1.5), condition="drawn", note="Vickers"),
        },
    )  # fmt: skip


def test_a_material_has_every_property_with_source_spread_condition_and_note() -> None:
    assert results.material_blocks(brass(structure=Structure())) == [
        "brass: Brass CuZn39",
        "  also ms58",
        Table(
            ("property", "value", "source"),
            [
                ("youngs_modulus", "97.12 GPa", "handbook"),
                ("hardness", "1.2 GPa", "within a factor of 1.5; handbook; drawn; Vickers"),
                ("crystal_structure", "face-centred cubic", "textbook"),
            ],
        ),
    ]
    plain = results.material_blocks(brass(aliases=()))
    assert len(plain) == 2
    assert isinstance(plain[1], Table)
    assert len(plain[1].rows) == 2


def test_materials_are_listed_by_family_with_a_dash_for_what_is_not_known() -> None:
    oak: Any = SimpleNamespace(name="oak", title="Oak", family="elsewhere", properties={})
    blocks = results.material_list([brass(), oak])
    assert blocks[0] == "2 materials, piezo ceramics and classes of materials, by family"
    tables = [block for block in blocks if isinstance(block, Table)]
    (filled,) = [table for table in tables if table.rows]
    assert list(filled.heads) == [FAMILY.replace("_", " "), "Young's modulus", "hardness", "yield strength", "title"]
    assert filled.rows == [["brass", "97.1 GPa", "1.2 GPa", "-", "Brass CuZn39"]]


def test_a_material_in_json_has_its_structure_where_it_is_known() -> None:
    found = results.material_object(brass(structure=Structure()))
    assert found["crystal_structure"] == {"text": "face-centred cubic", "source": "textbook"}
    assert found["properties"]["hardness"]["note"] == "Vickers"
    assert (found["title"], found["family"], found["is_class"], found["aliases"]) == (
        "Brass CuZn39", FAMILY, False, ["ms58"],
    )  # fmt: skip
    assert results.material_object(brass())["crystal_structure"] is None


STACK = CatalogueActuator(
    name="s1", title="Small stack", kind="stack", source="sheet", stroke=14.12345e-6, stroke_voltage=150.0,
    free_capacitance=1.5e-6, resonance_frequency=50e3, blocked_force=None, note="sold out",
)  # fmt: skip


def test_an_actuator_has_what_its_sheet_prints_with_four_digits() -> None:
    head, rows, source, note = results.actuator_blocks(STACK)
    assert head == "s1: Small stack, stack"
    assert isinstance(rows, Rows)
    texts = [text for _, text in rows.rows]
    assert texts[0] == "14.12 um"
    assert "150 V" in texts
    assert (source, note) == ("  source: sheet", "  note: sold out")
    assert set(results.printed_quantities(STACK)) == {
        "stroke", "stroke_voltage", "free_capacitance", "resonance_frequency",
    }  # fmt: skip
    title, table, gap, titles = results.actuator_list([STACK])
    assert (title, gap) == ("1 actuators on the market, by their data sheets", "")
    assert isinstance(table, Table)
    assert table.rows == [["s1", "14.1 um", "150 V", "not printed", "1.5 uF", "50 kHz"]]
    assert titles == Rows([("s1", "Small stack")])
    found = results.actuator_object(STACK)
    assert list(found)[:2] == ["title", "kind"]
    assert found["stroke"] == {"value": approx(14.12345e-6), "unit": "m"}
    assert found["note"] == "sold out"


@dataclass
class Correction:
    column: str
    row: int | None
    printed: str
    corrected: str
    evidence: str
    erratum: str


def test_a_published_table_is_shown_as_printed_with_its_corrections() -> None:
    columns = {
        "speed": SimpleNamespace(
            name="speed", unit="m/s", scale=1e-3, printed=("20", "40"), quantity="sliding_speed", role="given",
            meaning="of the disc",
        ),
        "ratio": SimpleNamespace(
            name="ratio", unit="", scale=1, printed=("0.5", "0.6"), quantity="friction_ratio", role="measured",
            meaning="",
        ),
        "load": SimpleNamespace(
            name="load", unit="N", scale=1, printed=("3", "5"), quantity="normal_load", role="given", meaning=""
        ),
    }  # fmt: skip
    shown: Any = SimpleNamespace(
        id="2.5", title="Wear", section="2.3", columns=columns,
        corrections=[Correction("ratio", 0, "0.5", "0.55", "its text", "E7"),
                     Correction("speed", None, "mm", "m", "its axis", "")],
    )  # fmt: skip
    head, table, first, second = results.table_blocks(shown)
    assert head == "Table 2.5: Wear"
    assert table == Table(["speed [0.001 m/s]", "ratio", "load [N]"], [("20", "0.5", "3"), ("40", "0.6", "5")])
    assert first == "  correction (E7): ratio, row 1: 0.5, corrected: 0.55; its text"
    assert second == "  correction: speed: mm, corrected: m; its axis"
    found = results.table_object(shown)
    assert (found["id"], found["title"], found["section"]) == ("2.5", "Wear", "2.3")
    assert found["columns"]["speed"] == {
        "quantity": "sliding_speed", "unit": "0.001 m/s", "role": "given", "meaning": "of the disc",
        "printed": ["20", "40"],
    }  # fmt: skip
    assert found["corrections"][0]["erratum"] == "E7"
