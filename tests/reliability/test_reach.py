"""The map from lines to tests: made anew, or with tests that join it."""

from pathlib import Path

import pytest
from coverage import CoverageData
from pytest import MonkeyPatch, approx
from reliability.mutant_list import stages_of
from reliability.mutation import Mutant

from reliability import mutant_list, reach


@pytest.fixture
def source(tmp_path: Path, monkeypatch: MonkeyPatch) -> Path:
    monkeypatch.setattr(reach, "MAP", tmp_path / "reach.sqlite")
    monkeypatch.setattr(reach, "SOURCE", tmp_path / "package")
    return tmp_path / "package"


def measured(tmp_path: Path, lines: dict[str, dict[str, list[int]]]) -> CoverageData:
    """Lines of files by the test that reaches them."""
    data = CoverageData(basename=str(tmp_path / f"data-{len(list(tmp_path.iterdir()))}"))
    for test, files in lines.items():
        data.set_context(test)
        data.add_lines({str(tmp_path / "package" / file): found for file, found in files.items()})
    return data


def test_tests_that_are_added_stand_beside_the_others_and_in_place_of_what_they_reached(
    source: Path, tmp_path: Path
) -> None:
    first = measured(tmp_path, {"a": {"rig.py": [1, 2]}, "b": {"rig.py": [2]}})
    reach._write(first, {"a": 2.0, "b": 1.0})
    later = measured(tmp_path, {"a": {"rig.py": [3]}, "c": {"rig.py": [2], "wear.py": [5]}, "d": {"rig.py": [2]}})
    reach._write(later, {"a": 0.5, "c": 0.25, "d": 3.0}, add=True)
    assert dict(reach.reaching("rig.py", 2)) == approx({"c": 0.25, "d": 3.0, "b": 1.0})
    assert [name for name, _ in reach.reaching("rig.py", 2)] == ["c", "b", "d"]
    assert dict(reach.reaching("rig.py", 3)) == approx({"a": 0.5})
    assert [name for name, _ in reach.reaching("rig.py", 1)] == ["c", "a", "b", "d"]  # of the whole file
    assert dict(reach.reaching("wear.py", 5)) == approx({"c": 0.25})


def test_a_map_that_is_made_anew_has_nothing_of_the_former(source: Path, tmp_path: Path) -> None:
    reach._write(measured(tmp_path, {"a": {"rig.py": [1]}}), {"a": 2.0})
    reach._write(measured(tmp_path, {"b": {"wear.py": [1]}}), {"b": 1.0})
    assert reach.reaching("rig.py", 1) == []
    assert dict(reach.reaching("wear.py", 1)) == approx({"b": 1.0})


def test_tests_are_picked_in_their_order_up_to_a_minute_and_one_at_least() -> None:
    assert reach.picked([("a", 30.0), ("b", 30.0), ("c", 0.1)]) == ["a", "b"]
    assert reach.picked([("long", 61.0), ("b", 1.0)]) == ["long"]
    assert reach.picked([]) == []


def test_the_others_of_a_file_follow_the_tests_that_reach_a_line(source: Path, tmp_path: Path) -> None:
    names = ("a.py::slow", "a.py::quick", "a.py::first", "b.py::other")
    reach._write(
        measured(tmp_path, {"a.py::first": {"rig.py": [1]}}), dict(zip(names, (3.0, 1.0, 2.0, 0.5), strict=True))
    )
    followed = reach.with_their_files(reach.reaching("rig.py", 1))
    assert [name for name, _ in followed] == ["a.py::first", "a.py::quick", "a.py::slow"]
    assert reach.with_their_files([]) == []


def test_of_a_room_none_of_whose_tests_reach_a_line_those_of_its_file_are_taken(
    source: Path, tmp_path: Path, monkeypatch: MonkeyPatch
) -> None:
    monkeypatch.setattr(mutant_list, "MAP", reach.MAP)
    monkeypatch.setattr(mutant_list, "SOURCE", source)
    (source / "rig").mkdir(parents=True)
    (source / "rig" / "speed.py").write_text("LIMIT = 5\n\n\ndef highest():\n    return LIMIT\n")
    seen = {"tests/cli/a.py::starts": [1, 5], "tests/rig/b.py::asks": [5], "tests/rig/c.py::other": [4]}
    data = measured(tmp_path, {test: {"rig/speed.py": lines} for test, lines in seen.items()})
    reach._write(data, dict.fromkeys(seen, 1.0) | {"tests/rig/c.py::other": 2.0})
    limit, call = (
        Mutant(file="rig/speed.py", line=line, occurrence=0, column=0, old="", new="")
        for line in ("LIMIT = 5", "return LIMIT")
    )
    assert stages_of(limit) == (["tests/rig/b.py::asks", "tests/rig/c.py::other"], [["tests/cli/a.py::starts"]])
    assert stages_of(call) == (["tests/rig/b.py::asks", "tests/rig/c.py::other"], [["tests/cli/a.py::starts"]])
