"""Examples of docstrings: each gives what it prints, beside the example files, and many exported names have one."""

import ast
import doctest
import importlib
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SOURCES = (ROOT / "src", ROOT / "studies")
FEWEST = 80
OPTIONS = doctest.REPORT_ONLY_FIRST_FAILURE


def modules_with_examples() -> Iterator[str]:
    for source in SOURCES:
        for path in sorted(source.rglob("*.py")):
            if ">>> " in path.read_text(encoding="utf-8"):
                yield ".".join(path.relative_to(source).with_suffix("").parts).removesuffix(".__init__")


def doctests() -> Iterator[doctest.DocTest]:
    finder = doctest.DocTestFinder(exclude_empty=True)
    for name in modules_with_examples():
        yield from finder.find(importlib.import_module(name), name)


def exported_names() -> Iterator[str]:
    """Dotted names, in the modules that define them, of what the faces export."""
    for source in SOURCES:
        for stub in source.rglob("__init__.pyi"):
            package = ".".join(stub.parent.relative_to(source).parts)
            for statement in ast.parse(stub.read_text(encoding="utf-8")).body:
                if isinstance(statement, ast.ImportFrom):
                    yield from (f"{package}.{statement.module}.{each.name}" for each in statement.names)


EXAMPLES = [test for test in doctests() if test.examples]


@pytest.mark.parametrize("test", EXAMPLES, ids=lambda test: test.name)
def test_an_example_gives_what_it_prints(
    test: doctest.DocTest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "examples").symlink_to(ROOT / "examples", target_is_directory=True)
    monkeypatch.chdir(tmp_path)  # the repository as examples see it, and what they would write lies elsewhere
    said: list[str] = []
    test.globs.clear()  # an example has all its imports
    doctest.DocTestRunner(optionflags=OPTIONS).run(test, out=said.append)
    assert not said, "".join(said)


def test_eighty_exported_names_have_an_example() -> None:
    assert len({test.name for test in EXAMPLES} & set(exported_names())) >= FEWEST
