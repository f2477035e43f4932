"""Delivery of an answer: files whole or not at all, the same closing lines and keys for every command."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

import pytest
import typer
import xarray as xr
from matplotlib.figure import Figure
from pytest import CaptureFixture, raises

from sonolube.cli.console.delivery import deliver
from sonolube.errors import InvalidInput, UnknownName
from sonolube.report import Drawing, Page
from sonolube.report.blocks import Block, Rows
from sonolube.tasks.answer import Answer, answer, si


def figure() -> Figure:
    drawn = Figure(figsize=(2, 2))
    drawn.subplots().plot([0, 1])
    return drawn


@answer
class Pendulum(Answer):
    content: Any = "a,b\n"

    def blocks(self) -> Sequence[Block]:
        return ["pendulum", Rows([("length", "1 m")])]

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


@answer
class Fact(Answer):
    is_lookup: ClassVar[bool] = True

    def blocks(self) -> Sequence[Block]:
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
    found = json.loads(capsys.readouterr().out)
    assert found["frequency"] == {"value": 0.5, "unit": "Hz"}
    assert (found["caveats"], found["assumptions"]) == (["small angles"], {"gravity": "that of Earth"})
    assert Path(found["files"][0]).name == "pendulum.html"


def test_a_lookup_is_its_table_alone(capsys: CaptureFixture[str]) -> None:
    deliver(Fact(), as_json=True)
    assert json.loads(capsys.readouterr().out) == {"one": 1}
    deliver(Fact())
    assert capsys.readouterr().out == "one\n"


def test_nothing_is_written_or_printed_where_one_file_fails(tmp_path: Path, capsys: CaptureFixture[str]) -> None:
    @answer
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
    @answer
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


def test_lines_are_as_wide_as_columns_says_and_80_characters_by_default(
    monkeypatch: pytest.MonkeyPatch, capsys: CaptureFixture[str]
) -> None:
    @answer
    class Long(Fact):
        def blocks(self) -> Sequence[Block]:
            return ["word " * 40]

    for columns, widest in (("", 80), ("120", 120)):
        monkeypatch.setenv("COLUMNS", columns)
        deliver(Long())
        lines = capsys.readouterr().out.splitlines()
        assert widest - 5 <= max(map(len, lines)) <= widest


def test_a_table_with_results_is_not_replaced(tmp_path: Path) -> None:
    @answer
    class Filled(Pendulum):
        def keeps(self, name: str, present: str) -> bool:
            return name == "table.csv" and "result" in present

    (tmp_path / "table.csv").write_text("result,1\n")
    with raises(InvalidInput, match="holds results, which would be lost"):
        deliver(Filled(), folder=tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["table.csv"]
    (tmp_path / "table.csv").write_text("empty\n")
    deliver(Filled(), folder=tmp_path)
    assert (tmp_path / "table.csv").read_text() == "a,b\n"


@pytest.mark.parametrize(("has_result", "code"), [(True, 1), (False, 2)])
def test_refused_inputs_are_named_and_decide_the_exit_code(
    has_result: bool, code: int, capsys: CaptureFixture[str]
) -> None:
    @answer
    class Partly(Fact):
        def refusals(self) -> Mapping[str, str]:
            return {"a.csv": "a.csv: is empty"}

        @property
        def has_result(self) -> bool:
            return has_result

    with raises(typer.Exit) as end:
        deliver(Partly())
    assert end.value.exit_code == code
    assert "a.csv: is empty" in capsys.readouterr().err
