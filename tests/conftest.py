"""Shared settings and fixtures: hypothesis without deadlines, and a copy of the package that a test may extend."""

import shutil
from pathlib import Path

import pytest
from hypothesis import settings

settings.register_profile("patient", deadline=None)
settings.load_profile("patient")

_PACKAGE = Path(__file__).parents[1] / "src" / "sonolube"


@pytest.fixture
def copied_package(tmp_path: Path) -> Path:
    """Copy of the package, with its compiled kernels, to extend and run in a subprocess with PYTHONPATH=tmp_path."""
    return Path(shutil.copytree(_PACKAGE, tmp_path / "sonolube", ignore=shutil.ignore_patterns("*.pyc")))
