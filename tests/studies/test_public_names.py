"""Studies use what any user can: each name that they import of sonolube is one that the reference documents."""

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SOURCES = sorted((ROOT / "studies").rglob("*.py"))


@cache
def documented_modules() -> frozenset[str]:
    pages = "\n".join(page.read_text(encoding="utf-8") for page in (ROOT / "docs" / "reference").glob("*.md"))
    return frozenset(re.findall(r"^\.\. automodule:: (sonolube\S*)$", pages, flags=re.MULTILINE)) | {"sonolube"}


@cache
def names_of(module: str) -> frozenset[str]:
    """Names that a room exports, or that a module defines."""
    place = (ROOT / "src").joinpath(*module.split("."))
    stub, own = place / "__init__.pyi", place / "__init__.py" if place.is_dir() else place.with_suffix(".py")
    exported = _imported(stub) if stub.is_file() else set()
    return frozenset(exported | {name for name in _defined(own) if not name.startswith("_") or name == "__version__"})


def _imported(path: Path) -> set[str]:
    """Names that a stub imports as names of its room."""
    statements = ast.parse(path.read_text(encoding="utf-8")).body
    imports = [each for each in statements if isinstance(each, ast.ImportFrom | ast.Import)]
    return {name.asname for each in imports for name in each.names if name.asname}


def _defined(path: Path) -> Iterator[str]:
    """Names that a module defines at its top, or lists as its own."""
    for statement in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(statement, ast.FunctionDef | ast.ClassDef):
            yield statement.name
        if isinstance(statement, ast.Assign) and ast.unparse(statement.targets[0]) == "__all__":
            yield from (str(each.value) for each in ast.walk(statement.value) if isinstance(each, ast.Constant))
        targets = statement.targets if isinstance(statement, ast.Assign) else [getattr(statement, "target", None)]
        yield from (target.id for target in targets if isinstance(target, ast.Name))


def private_imports(text: str) -> Iterator[str]:
    """Imports of sonolube that the reference does not document, each as its module and name."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            yield from (each.name for each in node.names if _is_library(each.name) and each.name != "sonolube")
        if isinstance(node, ast.ImportFrom) and _is_library(node.module or ""):
            for each in node.names:
                whole = f"{node.module}.{each.name}"
                is_name = node.module in documented_modules() and each.name in names_of(node.module or "")
                if whole not in documented_modules() and not is_name:
                    yield whole


def _is_library(module: str) -> bool:
    return module.partition(".")[0] == "sonolube"


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.relative_to(ROOT / "studies").as_posix())
def test_a_study_imports_public_names_only(path: Path) -> None:
    assert list(private_imports(path.read_text(encoding="utf-8"))) == []


def test_private_names_are_found_where_they_are_imported() -> None:
    text = (
        "from sonolube.models import fem\n"
        "from sonolube.models.fem import Model, no_such_name\n"
        "from sonolube.rig.driven_rig import DrivenRig\n"
        "from sonolube import Rig, __version__\n"
        "def late():\n    from sonolube.checks import _hidden, require_positive\n"
        "import sonolube.rig.record\n"
    )
    assert sorted(private_imports(text)) == [
        "sonolube.checks._hidden",
        "sonolube.models.fem.no_such_name",
        "sonolube.rig.driven_rig.DrivenRig",
        "sonolube.rig.record",
    ]
