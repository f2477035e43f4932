"""A run that allows the tests of a browser alone to skip fails where another does, and names its remedy."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
TESTS = """
import pytest

@pytest.mark.browser
def test_of_a_page():
    pytest.skip("no Chromium")

def test_that_passes():
    pass
"""
SKIPS = "\ndef test_of_a_program():\n    pytest.skip('apt-get install calculix-ccx')\n"
MODULE = "import pytest\npytest.importorskip('no_such_module', reason='pip install it')\n"


@pytest.mark.parametrize("processes", [(), ("-n", "2")], ids=["one process", "two processes"])
@pytest.mark.parametrize(
    ("tests", "allowed", "code", "line"),
    [
        (TESTS, "browser", 0, "1 passed, 1 skipped"),
        (TESTS + SKIPS, "browser", 1, "test_it.py::test_of_a_program: Skipped: apt-get install calculix-ccx"),
        (TESTS + SKIPS, None, 0, "1 passed, 2 skipped"),
        (MODULE, "browser", 1, "test_it.py: Skipped: pip install it"),
    ],
    ids=["browser alone", "a program", "everything allowed", "a module"],
)
def test_a_skip_that_is_not_allowed_fails_the_run(
    tests: str, allowed: str | None, code: int, line: str, processes: tuple[str, ...], tmp_path: Path
) -> None:
    (tmp_path / "test_it.py").write_text(tests)
    (tmp_path / "pytest.ini").write_text("[pytest]\nmarkers = browser\n")
    given = {name: value for name, value in os.environ.items() if not name.startswith(("PYTEST", "SONOLUBE_ALLOWED"))}
    run = subprocess.run(
        [sys.executable, "-m", "pytest", "-p", "tests.skips", "-p", "no:cacheprovider", *processes, "test_it.py"],
        cwd=tmp_path,
        env=given | {"PYTHONPATH": str(ROOT)} | ({} if allowed is None else {"SONOLUBE_ALLOWED_SKIPS": allowed}),
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == code, run.stdout
    assert line in run.stdout
