"""Progress of tasks: to who called them, under the cell of a notebook, and cancellation; and arguments as typed."""

import sys
from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any, Literal

import numpy as np
import pytest
import xarray as xr
from pytest import MonkeyPatch, approx, raises
from tests.names import names_of
from tests.tasks.running import running

from sonolube.errors import InvalidInput
from sonolube.example_files import example_file
from sonolube.rig import read_rig
from sonolube.tasks import own_tables, progress
from sonolube.tasks.compare.compare import compare
from sonolube.tasks.files import NamedBytes, with_names_only
from sonolube.tasks.parameters import (
    Call,
    DoorParameter,
    Parameter,
    Quantity,
    file_stem,
    item_of,
    kept,
    members_of,
    optional_rig,
    rig_of,
)
from sonolube.tasks.progress import TaskCancelled, cell_progress, is_in_notebook, stage, watched


def test_a_stage_without_a_watcher_is_silent_and_a_cancelled_one_ends_also_without_a_report() -> None:
    with stage("solving") as advance:
        advance("parts", 1, 2)

    def unreported() -> None:
        with watched(None, lambda: True), stage("solving"):
            pass

    with raises(TaskCancelled, match=r"^solving: cancelled$"):
        unreported()


def test_progress_has_the_stage_and_what_is_done_in_it() -> None:
    seen: list[tuple[str, int, int]] = []
    with watched(lambda *each: seen.append(each), None), stage("solving") as advance:
        advance("mesh", 1, 3)
        advance("", 2, 3)
    assert seen == [("solving: mesh", 1, 3), ("solving", 2, 3)]


@pytest.mark.parametrize(
    ("shell", "found"), [(None, False), (SimpleNamespace(), False), (SimpleNamespace(kernel=1), True)]
)
def test_a_notebook_is_known_by_the_kernel_of_its_shell(shell: Any, found: bool, monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell))
    assert is_in_notebook() is found
    monkeypatch.delitem(sys.modules, "IPython")
    assert not is_in_notebook()


class Shown:
    """Output of a cell."""

    def __init__(self) -> None:
        self.lines: list[str] = []

    def HTML(self, text: str) -> str:
        return text

    def display(self, line: str, *, display_id: bool) -> "Shown":
        assert display_id is True
        self.lines.append(line)
        return self

    def update(self, line: str) -> None:
        self.lines.append(line)


def test_a_cell_shows_work_of_more_than_a_second_five_times_a_second_and_nothing_after_it(
    monkeypatch: MonkeyPatch,
) -> None:
    now, cell = [50.0], Shown()
    monkeypatch.setitem(sys.modules, "IPython.display", cell)
    monkeypatch.setattr(names_of(progress).time, "monotonic", lambda: now[0])
    with cell_progress("solving <a>") as advance:
        for at, done in ((50.99, 1), (51.0, 2), (51.19, 3), (51.21, 4)):
            now[0] = at
            advance("mesh", done, 9 if done < 4 else 0)
    assert cell.lines == [
        "<small>solving &lt;a&gt; mesh: 2 of 9</small>", "<small>solving &lt;a&gt; mesh</small>", "",
    ]  # fmt: skip
    quick = Shown()
    monkeypatch.setitem(sys.modules, "IPython.display", quick)
    with cell_progress("solving") as advance:
        advance("mesh", 1, 2)
    assert quick.lines == []


def test_arguments_are_listed_as_they_are_typed_with_their_defaults_marked() -> None:
    rig = SimpleNamespace(name="own")
    arguments = {
        "load": "3 N", "flag": True, "off": False, "none": None, "empty": (), "nothing": {}, "several": ["a", 2],
        "keys": {"a": 1, "b": "2"}, "file": NamedBytes("a.csv", b""), "door": "x", "own": rig, "count": 4,
    }  # fmt: skip
    marks = {name: Parameter("") for name in arguments} | {"door": DoorParameter()}
    call = Call("t", arguments, frozenset({"load", "keys", "own"}), marks, lambda name: f"--{name}")
    assert call.settings() == [
        ("--load", "3 N"), ("--flag", "yes (default)"), ("--off", "no (default)"), ("--several", "a; 2 (default)"),
        ("--keys", "a=1; b=2"), ("--file", "a.csv (default)"), ("--own", "own"), ("--count", "4 (default)"),
    ]  # fmt: skip


def test_quantities_of_the_vocabulary_bring_their_unit_and_others_are_units() -> None:
    known, unit = Quantity("Of it.", "sliding_speed"), Quantity("Of it.", "m2/N", kind="K")
    assert (known.unit, known.quantity) == ("m/s", "sliding_speed")
    assert (unit.unit, unit.quantity, unit.kind) == ("m2/N", "", "K")


def test_types_of_unions_and_items_of_sequences_are_known() -> None:
    assert members_of(int | str | None) == (int, str)
    assert members_of(float) == (float,)
    assert item_of(Sequence[str] | None) is str
    assert item_of(list[int]) is int
    assert item_of(str) is None
    assert item_of(Literal["a"]) is None


def test_rigs_folders_and_stems_are_taken_from_what_was_given(tmp_path: Path) -> None:
    path = example_file("tribometer").source
    known = read_rig(path)
    assert rig_of(known) is known
    assert rig_of(SimpleNamespace(rig=known)) is known
    assert rig_of(str(path)).title == known.title
    assert optional_rig(None) is None
    assert optional_rig(known) is known
    assert kept(None, "x") is None
    assert kept("a", "x") == Path("a")
    assert kept(lambda name: tmp_path / name, "x") == tmp_path / "x"
    assert [file_stem(each) for each in ("a/b.csv", NamedBytes("c.d.csv", b""), Path("e"), xr.Dataset(), [path])] == [
        "b", "c.d", "e", "own", "own",
    ]  # fmt: skip


def test_private_folders_are_left_out_of_texts(tmp_path: Path) -> None:
    assert with_names_only(f"{tmp_path}/sonolube-bytes-ab1_/a.csv: bad") == "a.csv: bad"
    assert with_names_only("/home/x/a.csv: bad") == "/home/x/a.csv: bad"


def test_runs_are_a_dataset_a_query_or_a_table_and_a_mapping_is_for_tables(
    monkeypatch: MonkeyPatch, tmp_path: Path
) -> None:
    data = xr.Dataset()
    assert own_tables.runs_of(data) is data
    monkeypatch.setattr("sonolube.laboratory.catalogue.catalogued_runs", lambda query: query)
    assert own_tables.runs_of("catalogue:material=brass") == "catalogue:material=brass"
    for given in (data, "catalogue:x"):
        with raises(InvalidInput, match="mapping has no meaning here; it is for files of runs"):
            own_tables.runs_of(given, "m.toml")
    with running(compare, mapping="m.toml"), raises(InvalidInput, match="mapping has no meaning without a table of"):
        own_tables.runs_of(None, "m.toml")
    (tmp_path / "runs.csv").write_text("sliding_speed [mm/s],friction_ratio\n20,0.5\n40,0.75\n")
    found = own_tables.required_runs(tmp_path / "runs.csv")
    assert found["sliding_speed"].values == approx([0.02, 0.04])
    assert own_tables.mapping_of(None) is None


def test_tables_of_numbers_have_commas_and_comments_and_replaced_keys_are_given_once(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("# x\n1,2\n3,4.5 # y\n")
    assert own_tables.number_table(path) == approx(np.array([[1.0, 2.0], [3.0, 4.5]]))
    path.write_text("7\n")
    assert own_tables.number_table(path).shape == (1, 1)
    path.write_text("1;2\n")
    with raises(InvalidInput, match="is no table of numbers with commas between"):
        own_tables.number_table(path)
    rig: Any = SimpleNamespace(changes=("a.b = 3 N", "c=1"))
    own_tables.refuse_replaced(rig, {"a.c": 1})
    with raises(InvalidInput, match=r"^--set a\.b: takes the values of over a\.b; give it once$"):
        own_tables.refuse_replaced(rig, {"a.b": 1})
