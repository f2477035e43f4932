"""Look-ups in Python: the same table as on a terminal, as JSON, text and dataset."""

import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from pytest import approx, raises
from tests.same import same

from sonolube.errors import UnknownName
from sonolube.facts.materials import material
from sonolube.tasks.answer import Answer
from sonolube.tasks.lookup.facts import actuators, materials, published
from sonolube.tasks.lookup.schema import schema

Program = Callable[..., Any]
CALLS = [
    (materials, ()),
    (materials, ("AISI 304",)),
    (actuators, ()),
    (actuators, ("sa050510",)),
    (published, ()),
    (published, ("2.5",)),
    (schema, ("tasks",)),
]


@pytest.mark.parametrize(("function", "arguments"), CALLS)
def test_the_answer_in_python_is_that_of_the_terminal(
    function: Callable[..., Answer], arguments: tuple[str, ...], sonolube: Program, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    answer = function(*arguments)
    same(answer.json_object(), sonolube(function.__name__, *arguments, "--json").answer)
    assert f"{answer}\n" == sonolube(function.__name__, *arguments).out


def test_lists_have_no_line_that_a_terminal_would_break() -> None:
    for answer in (materials(), actuators(), published(), published("2.5"), materials("brass")):
        assert max(map(len, str(answer).splitlines())) <= 80


def test_properties_of_materials_are_a_dataset_in_si() -> None:
    data = materials().dataset()
    assert data["youngs_modulus"].sel(material="aluminium_2024") == 73e9
    assert data["youngs_modulus"].attrs == {"units": "Pa", "long_name": "Young's modulus"}
    assert np.isnan(data["youngs_modulus"].sel(material="uncoated_steel"))
    assert materials("2024")["density"].item() == material("aluminium_2024").properties["density"].value


def test_actuators_and_tables_are_datasets_in_si() -> None:
    assert actuators()["stroke"].sel(actuator="sa050510").item() == approx(14e-6)
    speeds = published("2.5")["sliding_speed"]
    assert speeds.values == approx([20.3e-3, 40.6e-3, 87e-3])
    assert speeds.attrs["units"] == "m/s"


def test_an_unknown_name_is_answered_with_the_closest() -> None:
    with raises(UnknownName, match="did you mean sa050510"):
        actuators("sa05051")


def test_a_schema_is_json_as_text() -> None:
    answer = schema("devices")
    assert json.loads(str(answer)) == answer.object()
    assert "<pre>" in answer._repr_html_()


def test_one_entry_is_shown_with_its_source_and_all_as_a_list() -> None:
    one, every = str(actuators("sa050510")), str(actuators())
    assert one.startswith("sa050510: ")
    assert "source:" in one
    assert every.splitlines()[0].endswith("actuators on the market, by their data sheets")
    assert "sa050510" in every
    one, every = str(materials("aluminium_2024")), str(materials())
    assert one.startswith("aluminium_2024: ")
    assert "73 GPa" in one
    assert every.splitlines()[0].endswith("materials, piezo ceramics and classes of materials, by family")


def test_the_object_of_one_entry_is_that_in_the_list_of_all() -> None:
    same(materials().object()["aluminium_2024"], materials("aluminium_2024").object())
    same(actuators().object()["sa050510"], actuators("sa050510").object())
    assert set(published().object()) >= {"2.5", "3.4"}
    assert str(published()).splitlines()[0] == "Tables of the dissertation"


def test_every_entry_of_a_list_is_on_the_axis_of_its_dataset() -> None:
    data = actuators().dataset()
    assert set(data["actuator"].values) == set(actuators().object())
    assert actuators("sa050510").dataset()["stroke"].size == 1
    assert set(materials().dataset()["material"].values) == set(materials().object())
