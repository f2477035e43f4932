"""The workbench as a process, for tests in a browser: its link, and its end."""

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlsplit


@dataclass(frozen=True)
class Served:
    """A running workbench: its link with the token, its address without, and its process."""

    link: str
    process: subprocess.Popen[str]

    @property
    def address(self) -> str:
        return self.link.partition("?")[0]

    @property
    def port(self) -> int:
        return urlsplit(self.link).port or 0

    @property
    def token(self) -> str:
        return self.link.rpartition("=")[2]


@contextmanager
def served(folder: Path, *arguments: str) -> Iterator[Served]:
    """Run `sonolube app` without a browser, its jobs below a folder; the token appears once in its output."""
    command = [sys.executable, "-m", "sonolube", "app", "--no-browser", *arguments]
    if "--port" not in arguments:
        command += ["--port", "0"]
    process = subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env=os.environ | dict.fromkeys(("XDG_STATE_HOME", "SONOLUBE_DEVICE_LOCKS"), str(folder)),
        cwd=folder,
    )
    assert process.stdout is not None
    try:
        line = process.stdout.readline()
        found = re.search(r"http://\S+", line)
        assert found is not None, line + process.stdout.read()
        yield Served(found[0], process)
    finally:
        process.terminate()
        rest, _ = process.communicate(timeout=60)
        assert "Traceback" not in rest
        assert found is None or found[0].rpartition("=")[2] not in rest
