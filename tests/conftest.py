"""Shared settings and fixtures, and a copy of the package that a test may extend."""

import gc
import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

import pytest

pytest_plugins = ("tests.skips", "tests.tiers")  # skips counted, and tiers by measured times

os.environ["COLUMNS"] = "500"  # so that lines of the program are not wrapped, whatever terminal runs the tests

_OBJECTS = 20_000  # allocated between two collections of garbage; Python's 700 take a twentieth of the time


def pytest_configure() -> None:
    """Leave garbage until the tests are collected."""
    gc.disable()


def pytest_collection_finish() -> None:
    """Collect garbage seldom, and never visit the imported modules and the tests again: an eighth of the time."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(_OBJECTS, 10, 10)
    gc.enable()


@pytest.fixture(autouse=True)
def own_state(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    """Keep jobs and reservations of devices of a process of tests in a folder of its own."""
    for name in ("XDG_STATE_HOME", "SONOLUBE_DEVICE_LOCKS"):
        monkeypatch.setenv(name, str(tmp_path_factory.getbasetemp() / "state"))


@pytest.fixture(autouse=True)
def patient_supervisor(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let blocks and calls be late by an hour, so that no run ends because the machine is slow."""
    for name in ("LATE", "_SWITCHING", "_CONNECTING"):
        monkeypatch.setattr(f"sonolube.laboratory.supervision.{name}", 3600.0)


_PACKAGE = Path(__file__).parents[1] / "src" / "sonolube"


@pytest.fixture
def copied_package(tmp_path: Path) -> Path:
    """Copy of the package, with its compiled kernels, to extend and run in a subprocess with PYTHONPATH=tmp_path."""
    return Path(shutil.copytree(_PACKAGE, tmp_path / "sonolube"))


@contextmanager
def _largest_file(size: int) -> Iterator[None]:
    """Let no file of this process grow beyond a size."""
    resource = pytest.importorskip("resource")  # Windows has none
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.fixture
def largest_file() -> Callable[[int], AbstractContextManager[None]]:
    """Context in which no file of this process grows beyond a size in bytes: writing then fails as on a full disk."""
    return _largest_file


@pytest.fixture(scope="session")
def chapter_3_report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the report of chapter 3 of the dissertation, which no test changes."""
    from tests.reproduced import reproduced

    from dong2015 import write_report

    folder = tmp_path_factory.mktemp("report")
    write_report(reproduced(3), folder=folder)
    return folder
