"""The workbench asks nothing of another host: used where there is none, or where none may be asked."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from tests.browser.isolated import visited
from tests.chromium import CHROMIUM

ROOT = Path(__file__).parents[2]

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine; Debian's package is called chromium"),
]


def _namespace() -> list[str]:
    """Command that starts a program without a route to another host; empty where this machine does not allow it."""
    for options in (["-n"], ["-r", "-n"]):
        command = ["unshare", *options]
        if (
            shutil.which("unshare")
            and subprocess.run([*command, "true"], capture_output=True, check=False).returncode == 0
        ):
            return command
    return []


NAMESPACE = _namespace()


@pytest.mark.parametrize("command", [NAMESPACE], ids=["namespace without a route" if NAMESPACE else "refused route"])
def test_all_pages_are_used_without_another_host(command: list[str], tmp_path: Path) -> None:
    if not command:
        assert len(visited(tmp_path)["numbers"]) >= 6
        return
    words = [*command, sys.executable, "-m", "tests.browser.isolated", str(tmp_path)]
    done = subprocess.run(words, capture_output=True, text=True, cwd=ROOT, check=False)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert len(found["numbers"]) >= 6
    assert found["has_route"] is False
