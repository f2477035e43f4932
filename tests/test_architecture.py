"""Architecture: which room may import which, the libraries of physics, lazy imports and sizes."""

import importlib.util
import pkgutil
import subprocess
import sys
from collections import Counter
from pathlib import Path
from types import ModuleType

import grimp
import pytest

ROOT = Path(__file__).parents[1]
PHYSICS = (
    *(f"models.{room}" for room in ("surfaces", "contact", "friction", "wear", "thermal", "actuator", "dynamics")),
    "facts.metrics",
)


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


def test_physics_leans_on_numpy_scipy_numba_and_jax_only(graph: grimp.ImportGraph) -> None:
    rooms = [f"sonolube.{room}" for room in PHYSICS]
    modules = {module for room in rooms for module in {room, *graph.find_descendants(room)}}
    outside = {
        name
        for module in modules
        for name in graph.find_modules_directly_imported_by(module)
        if not name.startswith("sonolube")
    }
    assert outside - set(sys.stdlib_module_names) <= {"numpy", "scipy", "numba", "jax", "lazy_loader"}


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


def test_no_file_outgrows_four_hundred_lines() -> None:
    long = [path for path in (ROOT / "src").rglob("*.py") if len(path.read_text().splitlines()) > 400]
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
    assert [path for path in (ROOT / "src").rglob("*.py") if path.name.startswith(("test_", "conftest"))] == []


def test_no_folder_holds_more_than_26_modules() -> None:
    modules = Counter(path.parent for path in (ROOT / "src").rglob("*.py") if path.name != "__init__.py")
    assert [(folder, count) for folder, count in modules.items() if count > 26] == []


def _faces() -> list[str]:
    """Rooms whose face is a stub, such as sonolube.models.contact."""
    stubs = (ROOT / "src").rglob("__init__.pyi")
    return sorted(".".join(stub.parent.relative_to(ROOT / "src").parts) for stub in stubs)


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
