"""Scripts of the pages, by tools of node: their form by prettier, their types by the compiler of TypeScript."""

import shutil
import subprocess
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SCRIPTS = "src/sonolube/browser/static/{link,scripts/**/*}.js"
PINS = (ROOT / "requirements" / "node.txt").read_text(encoding="utf-8").split()
REGISTRY = "set npm_config_registry to a registry that can be reached, or fill the cache of npm once with: make lint"

pytestmark = pytest.mark.node


@cache
def tool(package: str) -> tuple[str, ...]:
    """Words that begin a command of a package at its pinned version; skipped where it cannot be had."""
    npx = shutil.which("npx")
    if npx is None:
        pytest.skip("npx is missing: apt-get install nodejs npm")
    (pin,) = (each for each in PINS if each.startswith(f"{package}@"))
    words = (npx, "--yes", "--prefer-offline", "--fetch-retries=0", "--package", pin)
    if subprocess.run([*words, "-c", "true"], cwd=ROOT, capture_output=True, check=False).returncode:
        pytest.skip(f"neither the cache of npm nor a registry has {pin}: {REGISTRY}")
    return (*words, "--")


def findings(package: str, *command: str) -> str:
    """What a command of a package prints, where it finds something."""
    run = subprocess.run([*tool(package), *command], cwd=ROOT, capture_output=True, text=True, check=False)
    return "" if run.returncode == 0 else run.stdout + run.stderr


def test_scripts_have_the_form_that_prettier_gives_them() -> None:
    assert findings("prettier", "prettier", "--check", SCRIPTS) == "", "run make lint"


def test_types_of_scripts_agree() -> None:
    assert findings("typescript", "tsc", "--project", ".") == ""
