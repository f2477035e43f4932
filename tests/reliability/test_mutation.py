"""Places of a module that are changed, and tests that are not there or cannot be collected."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from pytest import MonkeyPatch
from reliability.mutation import Mutant, mutants_of

from reliability import mutation

TEXT = """\
def pairs(first, second):
    whole = first.resolve(strict=True)
    return list(zip(first, sorted(second), strict=True)), whole
"""


def changes(tmp_path: Path, monkeypatch: MonkeyPatch) -> list[Mutant]:
    monkeypatch.setattr(mutation, "SOURCE", tmp_path)
    (tmp_path / "pairs.py").write_text(TEXT)
    return mutants_of(tmp_path / "pairs.py")


def test_the_flag_strict_of_a_zip_is_left_alone_and_all_else_in_it_is_changed(
    tmp_path: Path, monkeypatch: MonkeyPatch
) -> None:
    found = {(each.line.split()[0], each.old, each.new) for each in changes(tmp_path, monkeypatch)}
    assert found == {
        ("whole", "True", "False"),
        ("return", "sorted(second)", "(second)"),
        ("return", "first, sorted(second)", "sorted(second), first"),
    }


@pytest.mark.parametrize(
    ("text", "failure"),
    [("def test_it(): ...", ""), ("def test_it():\n    assert 0", "test_made.py::test_it"),
     ("raise LookupError", "test_made.py"), ("", "")],
    ids=["passes", "fails", "cannot be imported", "is not there"],
)  # fmt: skip
def test_a_file_that_cannot_be_imported_fails_and_a_test_that_is_not_there_does_not(
    tmp_path: Path, monkeypatch: MonkeyPatch, text: str, failure: str
) -> None:
    monkeypatch.setattr(mutation, "ROOT", tmp_path)
    (tmp_path / "test_made.py").write_text(text)
    assert mutation._failed(["test_made.py::test_it"], dict(os.environ), 60.0) == failure


def test_tests_that_are_not_there_keep_no_other_from_failing(tmp_path: Path, monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(mutation, "ROOT", tmp_path)
    (tmp_path / "test_made.py").write_text("def test_it():\n    assert 0")
    tests = ["test_gone.py", "test_made.py::test_renamed", "test_made.py::test_it"]
    assert mutation._failed(tests, dict(os.environ), 60.0) == "test_made.py::test_it"


def test_the_copy_that_is_changed_finds_the_examples_of_the_package() -> None:
    environment = os.environ | {"PYTHONPATH": str(mutation._copy().parent)}
    code = "from sonolube import example_files; example_files.example_file('tribometer'); print(example_files.__file__)"
    run = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True, cwd="/"
    )
    assert run.stdout.startswith(str(mutation._copy()))
