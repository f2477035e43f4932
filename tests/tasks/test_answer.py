"""Answers in every form by hand-made ones: text, JSON, dataset, figures and refusals."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import field
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import xarray as xr
from pytest import raises
from tests.same import approx

from sonolube.charts import Axis, Line, one_panel
from sonolube.errors import InvalidInput, UnknownName
from sonolube.report import Drawing
from sonolube.report.blocks import Block, Rows, Table
from sonolube.tasks.answer import Answer, Listing, answer

RIG: Any = SimpleNamespace(assumptions={"mass": "guessed", "load": "typical"})


@answer
class Own(Answer):
    content: Mapping[str, Any]
    parts: Sequence[Block] = ("Own result", Rows([("load", "3 N")]))
    tables: Mapping[str, Any] = field(default_factory=dict)
    names: Sequence[str] = ()
    refused: Mapping[str, str] = field(default_factory=dict)

    def blocks(self) -> Sequence[Block]:
        return self.parts

    def object(self) -> dict[str, Any]:
        return dict(self.content)

    def caveats(self) -> Sequence[str]:
        return ("rough",)

    def leading_caveats(self) -> Sequence[str]:
        return ("far beyond",)

    def files(self) -> Mapping[str, Any]:
        return self.tables

    def refusals(self) -> Mapping[str, str]:
        return self.refused

    def figures(self) -> Mapping[str, Drawing]:
        def drawn(name: str) -> Drawing:
            chart = one_panel(Axis(name, "s"), Axis("y", ""), [Line(x=np.arange(2.0), y=np.arange(2.0))])
            return Drawing(chart=lambda: chart)

        return {name: drawn(name) for name in self.names}


LOAD = {"normal_load": {"value": 3.0, "unit": "N"}, "title": "own"}


def with_rig(found: Own) -> Own:
    object.__setattr__(found, "rig", RIG)
    return found


def test_caveats_that_question_all_stand_below_the_first_line_and_others_below_the_result() -> None:
    found = with_rig(Own(content=LOAD, refused={"b.csv": "is empty"}))
    below = ["  caveat: far beyond", Rows([("load", "3 N")]), "  caveat: rough"]
    assumed = ["  assumed mass: guessed", "  assumed load: typical"]
    assert found.every_block() == ["Own result", *below, *assumed]
    assert Own(content=LOAD).every_block() == ["Own result", *below]
    assert Own(content=LOAD, parts=()).every_block() == ["  caveat: far beyond", "  caveat: rough"]
    assert str(found).splitlines() == [
        "Own result", "  caveat: far beyond", "  load  3 N", "  caveat: rough", *assumed, "  refused: is empty",
    ]  # fmt: skip
    assert repr(found) == str(found)
    assert found.text(line_length=None) == found.text()
    assert found._repr_html_().startswith("<p>Own result</p><p>caveat: far beyond</p><table>")


def test_the_object_for_json_has_caveats_and_assumptions_but_that_of_a_look_up() -> None:
    found = with_rig(Own(content=LOAD)).json_object()
    assert found["caveats"] == ["far beyond", "rough"]
    assert found["assumptions"] == {"mass": "guessed", "load": "typical"}
    assert json.loads(Own(content=LOAD).to_json())["normal_load"]["value"] == approx(3.0)
    assert Listing(parts=["a"], content={"b": 1}).json_object() == {"b": 1}
    with raises(ValueError, match="not JSON compliant"):
        Own(content={"a": float("nan")}).to_json()


@pytest.mark.parametrize("kind", ["none", "dataset", "path", "labelled"])
def test_the_dataset_is_that_of_the_files_or_the_quantities_of_the_object(kind: str, tmp_path: Path) -> None:
    table = xr.Dataset({"friction_force": ("time", [1.0, 2.0])})
    path = tmp_path / "a.nc"
    table.to_netcdf(path)
    labelled = SimpleNamespace(dataset=lambda: table)
    files: dict[str, dict[str, Any]] = {
        "none": {"a.csv": "1"}, "dataset": {"a.csv": "1", "a.nc": table}, "path": {"a.nc": path},
        "labelled": {"a.nc": labelled},
    }  # fmt: skip
    found = with_rig(Own(content=LOAD, tables=files[kind]))
    data = found.dataset()
    if kind == "none":
        assert (float(data["normal_load"]), data.attrs["title"]) == (approx(3.0), "own")
    else:
        assert data["friction_force"].values == approx([1.0, 2.0])
        assert found["friction_force"].sizes == {"time": 2}
    assert data.attrs["caveats"] == "far beyond\nrough"
    assert data.attrs["assumptions"] == "mass: guessed\nload: typical"
    assert xr.load_dataset(found.to_netcdf(tmp_path / "b.nc")).attrs["caveats"] == "far beyond\nrough"


def test_a_figure_is_the_first_or_the_one_whose_name_ends_so() -> None:
    found = Own(content=LOAD, names=("part-1-axial-1", "part-2-Bending-1"))
    assert found.plot().axes[0].get_xlabel() == "part-1-axial-1 [s]"
    assert found.plot("bending 1").axes[0].get_xlabel() == "part-2-Bending-1 [s]"
    with raises(UnknownName, match="unknown figure 'axial 2'"):
        found.plot("axial 2")
    with raises(InvalidInput, match=r"^Own result: this answer has nothing that could be drawn$"):
        Own(content=LOAD).plot()


def test_a_listing_has_its_own_dataset_where_it_is_given() -> None:
    own = xr.Dataset({"a": 1.0})
    assert Listing(parts=["x"], content=LOAD, labelled=lambda: own).dataset() is own
    plain = Listing(parts=["x"], content=LOAD)
    assert float(plain.dataset()["normal_load"]) == approx(3.0)
    assert (plain.blocks(), plain.object()) == (["x"], LOAD)


def test_an_answer_by_itself_has_no_files_figures_pages_or_failures() -> None:
    found = Listing(parts=["x"], content={})
    assert (found.caveats(), found.leading_caveats(), found.assumptions(), found.figures(), found.files()) == (
        (), (), {}, {}, {},
    )  # fmt: skip
    assert (found.page(), found.report(lambda *_: None), found.refusals()) == (None, None, {})
    assert (found.keeps("a", "b"), found.has_result, found.is_failure) == (False, True, False)


def test_the_printed_table_is_a_table_of_pandas() -> None:
    table = Table(("speed [m/s]", "what", "what"), [("0.1", "dry", ""), ("", "oil")])
    frame = Own(content={}, parts=("Own result", Rows([("load", "3 N")]), table)).to_pandas()
    assert list(frame.columns) == ["speed [m/s]", "what", "what"]
    assert frame.iloc[:, 0].to_numpy() == approx([0.1, np.nan], nan_ok=True)
    assert list(frame.iloc[:, 1]) == ["dry", "oil"]
    assert list(Own(content={}).to_pandas().iloc[0]) == ["load", "3 N"]


def test_an_answer_without_a_table_is_refused_as_one() -> None:
    with raises(InvalidInput, match="Own result: this answer prints no table"):
        Own(content={}, parts=("Own result",)).to_pandas()
