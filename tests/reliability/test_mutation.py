"""Places of a module that are changed."""

from pathlib import Path

from pytest import MonkeyPatch
from reliability import mutation
from reliability.mutation import Mutant, mutants_of

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
