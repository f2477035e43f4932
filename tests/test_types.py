"""Types of package and tests by mypy, which runs beside the other tests."""

import subprocess
import sys
from pathlib import Path

import pytest


@pytest.mark.slow
def test_types_are_consistent() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "mypy"], cwd=Path(__file__).parents[1], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
