"""Delivery of an answer: files whole or not at all, the same closing lines and keys for every command."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import pytest
import xarray as xr
from matplotlib.figure import Figure
from pytest import CaptureFixture, raises

from sonolube.cli.console.answer import Answer, aligned, deliver, grid, si
from sonolube.errors import InvalidInput, UnknownName
from sonolube.report import Drawing, Page


def figure() -> Figure:
    drawn = Figure(figsize=(2, 2))
    drawn.subplots().plot([0, 1])
    return drawn


@dataclass(frozen=True)
class Pendulum(Answer):
    content: Any = "a,b\n"

    def lines(self) -> list[str]:
        return ["pendulum", *aligned([("length", "1 m")])]

    def object(self) -> dict[str, Any]:
        return si({"frequency": 0.5})

    def caveats(self) -> Sequence[str]:
        return ("small angles",)

    def assumptions(self) -> Mapping[str, str]:
        return {"gravity": "that of Earth"}

    def figures(self) -> Mapping[str, Drawing]:
        return {"swing": Drawing(draw=figure, caption="The swing <b>.")}

    def files(self) -> Mapping[str, Any]:
        return {"table.csv": self.content, "data.nc": xr.Dataset({"angle": ("time", [0.1, 0.2])})}

    def page(self) -> Page:
        return Page(name="pendulum", title="Pendulum", settings=[("rig", "a rod")], facts=[("length", "1 m")])


@dataclass(frozen=True)
class Fact(Answer):
    is_lookup: ClassVar[bool] = True

    def lines(self) -> list[str]:
        return ["one"]

    def object(self) -> dict[str, Any]:
        return {"one": 1}


def test_page_figures_and_files_are_written_and_listed_after_caveats_and_assumptions(
    tmp_path: Path, capsys: CaptureFixture[str]
) -> None:
    deliver(Pendulum(), folder=tmp_path)
    names = ["pendulum.html", "swing.png", "swing.svg", "swing.pdf", "table.csv", "data.nc"]
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(names)
    assert capsys.readouterr().out.splitlines() == [
        "pendulum",
        "  length  1 m",
        "  caveat: small angles",
        "  assumed gravity: that of Earth",
        *[f"  {tmp_path / name}" for name in names],
    ]


def test_the_page_shows_what_the_answer_holds_and_escapes_it(tmp_path: Path) -> None:
    deliver(Pendulum(), folder=tmp_path)
    page = (tmp_path / "pendulum.html").read_text(encoding="utf-8")
    for text in ("a rod", "1 m", "Caveat: small angles.", "Assumed gravity: that of Earth.", "The swing &lt;b&gt;."):
        assert text in page
    assert "data:image/png;base64," in page


def test_json_is_one_object_in_si_with_the_same_closing_keys(tmp_path: Path, capsys: CaptureFixture[str]) -> None:
    deliver(Pendulum(), folder=tmp_path, as_json=True)
    answer = json.loads(capsys.readouterr().out)
    assert answer["frequency"] == {"value": 0.5, "unit": "Hz"}
    assert (answer["caveats"], answer["assumptions"]) == (["small angles"], {"gravity": "that of Earth"})
    assert Path(answer["files"][0]).name == "pendulum.html"


def test_a_lookup_is_its_table_alone(capsys: CaptureFixture[str]) -> None:
    deliver(Fact(), as_json=True)
    assert json.loads(capsys.readouterr().out) == {"one": 1}
    deliver(Fact())
    assert capsys.readouterr().out == "one\n"


def test_nothing_is_written_or_printed_where_one_file_fails(tmp_path: Path, capsys: CaptureFixture[str]) -> None:
    @dataclass(frozen=True)
    class Broken(Pendulum):
        def files(self) -> Mapping[str, Any]:
            raise InvalidInput("the table has no rows")

    with raises(InvalidInput, match="no rows"):
        deliver(Broken(), folder=tmp_path)
    assert list(tmp_path.iterdir()) == []
    assert capsys.readouterr().out == ""


def test_a_file_that_the_computation_has_written_is_listed_only(tmp_path: Path, capsys: CaptureFixture[str]) -> None:
    kept = tmp_path / "kept.nc"
    deliver(Pendulum(content=kept), folder=tmp_path)
    assert f"  {kept}" in capsys.readouterr().out
    assert not kept.exists()


def test_files_of_a_subfolder_are_counted(tmp_path: Path, capsys: CaptureFixture[str]) -> None:
    @dataclass(frozen=True)
    class Many(Fact):
        def files(self) -> Mapping[str, Any]:
            return {"report.html": "", **{f"figures/{number}.txt": "" for number in range(3)}}

    deliver(Many(), folder=tmp_path)
    assert capsys.readouterr().out.splitlines()[1:] == [
        f"  {tmp_path / 'report.html'}",
        f"  {tmp_path / 'figures'}: 3 files",
    ]


def test_a_quantity_that_the_vocabulary_lacks_needs_a_unit() -> None:
    with raises(UnknownName, match="unknown quantity"):
        si({"wobbliness": 1.0})
    assert si({"wobbliness": 1.0}, unit="N") == {"wobbliness": {"value": 1.0, "unit": "N"}}


@pytest.mark.parametrize("rows", [[("a", "1"), ("long", "2")], [("x", "")]])
def test_values_stand_one_under_the_other(rows: list[tuple[str, str]]) -> None:
    width = 2 + max(len(name) for name, _ in rows) + 2
    assert [line[width:] for line in aligned(rows)] == [value for _, value in rows]


def test_columns_of_a_grid_begin_one_under_the_other() -> None:
    assert grid([("a", "bb", "c"), ("aaa", "b", "cc")]) == ["a    bb  c", "aaa  b   cc"]
