"""The package as installed: a wheel from the sources, the same from their archive, in an environment of its own."""

import json
import os
import shutil
import subprocess
import sys
import tarfile
from pathlib import Path

import pytest
from tests.same import same

from sonolube.tasks.lookup.example import example

ROOT = Path(__file__).parents[1]
RIG = ROOT / "examples" / "rigs" / "tribometer.toml"
UV = Path(sys.executable).with_name("uv")
INDEX = "set UV_INDEX_URL to a package index that can be reached, or fill the cache once with: make test"

pytestmark = [pytest.mark.slow, pytest.mark.external]


def uv(*arguments: object) -> subprocess.CompletedProcess[str]:
    """Run of uv, from its cache where that suffices, else with the index; skipped where neither has the packages."""
    for offline in (["--offline"], []):
        command = [str(UV), *map(str, arguments), *offline]
        run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)
        if run.returncode == 0:
            return run
    if any(word in run.stderr for word in ("Failed to fetch", "client error", "error sending request")):
        pytest.skip(f"neither the cache of uv nor an index has the packages: {INDEX}")
    raise AssertionError(run.stderr)


@pytest.fixture(scope="module")
def sources(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Copy of the sources, so that a build writes nothing into them."""
    if not UV.is_file():
        pytest.skip("uv is not installed beside Python: make test")
    ignored = shutil.ignore_patterns(".*", "out", "__pycache__")
    return Path(shutil.copytree(ROOT, tmp_path_factory.mktemp("sources") / "sonolube", ignore=ignored))


@pytest.fixture(scope="module")
def archive(sources: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("archive")
    uv("build", "--quiet", "--sdist", "--out-dir", folder, sources)
    return next(folder.glob("*.tar.gz"))


@pytest.fixture(scope="module")
def wheel(sources: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    uv("build", "--quiet", "--wheel", "--out-dir", folder, sources)
    return next(folder.glob("*.whl"))


@pytest.fixture(scope="module")
def programs(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the programs of an environment that has the wheel and what it requires, and nothing else."""
    environment = tmp_path_factory.mktemp("environment") / "venv"
    uv("venv", "--quiet", "--python", sys.executable, environment)
    python = environment / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    pins = ROOT / "requirements" / "runtime.txt"
    uv("pip", "install", "--quiet", "--python", python, "--constraints", pins, wheel)
    return python.parent


def test_the_wheel_of_the_archive_is_that_of_the_sources(archive: Path, wheel: Path, tmp_path: Path) -> None:
    with tarfile.open(archive) as content:
        content.extractall(tmp_path, filter="data")
    uv("build", "--quiet", "--wheel", "--out-dir", tmp_path / "built", tmp_path / archive.name.removesuffix(".tar.gz"))
    built = tmp_path / "built" / wheel.name
    assert built.read_bytes() == wheel.read_bytes()


def test_an_installed_wheel_computes_the_friction_of_a_rig(programs: Path, tmp_path: Path) -> None:
    words = ["friction", str(RIG), "--amplitude", "per-volt", "--json"]
    answers = []
    for program in (programs / "sonolube", Path(sys.executable).with_name("sonolube")):
        run = subprocess.run([program, *words], capture_output=True, text=True, check=True, cwd=tmp_path)
        answers.append(json.loads(run.stdout))
    same(answers[0], answers[1])


def test_an_installed_wheel_has_every_example_file(programs: Path, tmp_path: Path) -> None:
    words = ["example", "all", "--json"]
    run = subprocess.run([programs / "sonolube", *words], capture_output=True, text=True, check=True, cwd=tmp_path)
    assert json.loads(run.stdout)["files"] == list(example("all").files())
    friction = [str(programs / "sonolube"), "friction", "examples/rigs/collar.toml"]
    assert "Friction force" in subprocess.run(friction, capture_output=True, text=True, check=True, cwd=tmp_path).stdout


def test_an_installed_wheel_is_imported_from_its_own_place_without_warnings(programs: Path, tmp_path: Path) -> None:
    code = f"import sonolube as sl; print(sl.__file__); print(sl.read_rig({str(RIG)!r}).title)"
    run = subprocess.run(
        [programs / "python", "-W", "error", "-c", code], capture_output=True, text=True, check=True, cwd=tmp_path
    )
    place, title = run.stdout.splitlines()
    assert Path(place).is_relative_to(programs.parent)
    assert title


def test_an_environment_without_extras_names_each_by_its_command(programs: Path, tmp_path: Path) -> None:
    code = "from sonolube.extras import EXTRAS; print(*(e.name for e in EXTRAS.values() if e.is_installed))"
    run = subprocess.run([programs / "python", "-c", code], capture_output=True, text=True, check=True, cwd=tmp_path)
    assert run.stdout.split() == []
    block = ["modes", "block", "--set", "length=20mm", "--set", "width=10mm", "--set", "thickness=5mm"]
    refused = subprocess.run([programs / "sonolube", *block], capture_output=True, text=True, check=False, cwd=tmp_path)
    assert (refused.returncode, refused.stdout, refused.stderr.count("\n")) == (2, "", 1)
    assert "pip install netgen-mesher" in refused.stderr
