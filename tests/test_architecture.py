"""Architecture: which room may import which, the libraries of physics, lazy imports and sizes."""

import ast
import importlib.util
import io
import pkgutil
import subprocess
import sys
import tokenize
from collections import Counter
from pathlib import Path
from types import ModuleType

import grimp
import pytest

ROOT = Path(__file__).parents[1]
SOURCES = [path for folder in ("src", "studies") for path in (ROOT / folder).rglob("*.py")]
PHYSICS = (
    *(f"models.{room}" for room in ("surfaces", "contact", "friction", "wear", "thermal", "actuator", "dynamics")),
    "facts.metrics",
)
_NO_CODE = {
    *(tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT),
    *(tokenize.ENCODING, tokenize.ENDMARKER),
}
SEVEN_LINES = '''"""Two lines
of a docstring."""

import math  # one

# a comment
LENGTH = 2.0  # two
"""Of a bar. [m]"""


def area(
    width: float,
) -> float:  # five
    """Area. [m2]"""
    text = """not a
docstring"""  # seven
'''


@pytest.fixture(scope="module")
def graph() -> grimp.ImportGraph:
    return grimp.build_graph("sonolube", include_external_packages=True, cache_dir=None)


def test_data_flows_one_way() -> None:
    linted = subprocess.run(
        [Path(sys.executable).parent / "lint-imports", "--no-cache"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert linted.returncode == 0, linted.stdout


def test_physics_leans_on_numpy_scipy_and_numba_only(graph: grimp.ImportGraph) -> None:
    rooms = [f"sonolube.{room}" for room in PHYSICS]
    modules = {module for room in rooms for module in {room, *graph.find_descendants(room)}}
    outside = {
        name
        for module in modules
        for name in graph.find_modules_directly_imported_by(module)
        if not name.startswith("sonolube")
    }
    assert outside - set(sys.stdlib_module_names) <= {"numpy", "scipy", "numba", "lazy_loader"}


def test_help_imports_nothing_heavy() -> None:
    heavy = ("numpy", "scipy", "numba", "pandas", "xarray", "pint", "pydantic", "matplotlib", "jinja2")
    code = (
        "import sys\n"
        "from sonolube.cli import main\n"
        "try: main(['--help'])\n"
        "except SystemExit: pass\n"
        f"print([name for name in {heavy!r} if name in sys.modules], file=sys.stderr)"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stderr.strip() == "[]"


def code_lines(text: str) -> int:
    """Lines of a module that hold code: neither docstrings, nor comments, nor blank lines."""
    texts = {  # places of the texts that stand alone: docstrings, of modules to those below a name
        (node.lineno, node.col_offset)
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
    }
    lines: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type not in _NO_CODE and token.start not in texts:
            lines.update(range(token.start[0], token.end[0] + 1))
    return len(lines)


def test_code_lines_are_counted_without_docstrings_comments_and_blank_lines() -> None:
    assert code_lines(SEVEN_LINES) == 7


def test_no_file_outgrows_six_hundred_lines_of_code() -> None:
    long = [path for path in SOURCES if code_lines(path.read_text(encoding="utf-8")) > 600]
    assert long == []


def test_the_picture_of_the_rooms_is_up_to_date() -> None:
    spec = importlib.util.spec_from_file_location("architecture_picture", ROOT / "docs/_ext/architecture_picture.py")
    assert spec is not None
    assert spec.loader is not None
    drawing = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(drawing)
    expected = drawing.picture()
    assert drawing.PICTURE.read_text(encoding="utf-8") == expected, "run python docs/_ext/architecture_picture.py"


def test_no_product_file_is_named_like_a_test() -> None:
    assert [path for path in SOURCES if path.name.startswith(("test_", "conftest"))] == []


def test_no_folder_holds_more_than_26_modules() -> None:
    modules = Counter(path.parent for path in SOURCES if path.name != "__init__.py")
    assert [(folder, count) for folder, count in modules.items() if count > 26] == []


def _faces() -> list[str]:
    """Rooms whose face is a stub, such as sonolube.models.contact."""
    return sorted(
        ".".join(stub.parent.relative_to(ROOT / folder).parts)
        for folder in ("src", "studies")
        for stub in (ROOT / folder).rglob("__init__.pyi")
    )


@pytest.mark.parametrize("room", _faces())
def test_every_name_of_a_face_is_there_and_means_one_thing(room: str) -> None:
    face = importlib.import_module(room)
    submodules = {module.name for module in pkgutil.iter_modules(face.__path__)}
    assert face.__all__
    assert [name for name in face.__all__ if not hasattr(face, name)] == []
    assert [name for name in submodules & set(face.__all__) if not isinstance(getattr(face, name), ModuleType)] == []


def test_a_face_imports_nothing_before_a_name_is_used() -> None:
    heavy = ("numpy", "scipy", "numba", "xarray", "pint", "pydantic", "matplotlib")
    code = f"import sys, {', '.join(_faces())}\nprint([name for name in {heavy!r} if name in sys.modules])"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"
