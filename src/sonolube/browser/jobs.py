"""Jobs: long tasks in processes of their own, with their record, progress and result on disk."""

import contextlib
import json
import os
import secrets
import shutil
import subprocess
import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from sonolube.errors import InvalidInput
from sonolube.operating_system import process_start
from sonolube.storage.files import user_state_folder, write_atomically

KEPT_DAYS: Final = 30
"""Days after which a finished job is deleted."""

_GRACE: Final = 0.5  # seconds between the request to end and the end by force
ACTIVE: Final = ("waiting", "running", "running elsewhere")
"""States of a job that has not ended."""

ENDED: Final = ("done", "refused", "failed", "cancelled", "interrupted")
"""States of a job that has."""

_REQUEST, _STATE, _RESULT = "request.json", "state.json", "result.json"


def jobs_folder() -> Path:
    """Folder in which jobs are kept: `sonolube/jobs` in the folder of states of this user."""
    return user_state_folder() / "jobs"


@dataclass(frozen=True, kw_only=True, slots=True)
class Job:
    """Record of a job.

    Parameters
    ----------
    id : str
    task : str
    label : str
        Title that its page gave it.
    created : float
        Time of day in seconds since 1970.
    state : str
        Of `ACTIVE` or `ENDED`.
    stage : str
        What is done now.
    done, total : int
        Parts done and their total, 0 where unknown.
    seconds : float
        Since it began to run.
    reason : str
        Why it was refused or failed.
    of : str
        Version, seed and command of its call; empty before it runs.
    """

    id: str
    task: str
    label: str
    created: float
    state: str
    stage: str = ""
    done: int = 0
    total: int = 0
    seconds: float = 0.0
    reason: str = ""
    of: str = ""


class Jobs:
    """Jobs of one user on this computer.

    Parameters
    ----------
    folder : Path
        With one folder a job.
    most : int
        Processes at one time.
    """

    def __init__(self, folder: Path, *, most: int) -> None:
        self.folder, self._most = folder, most
        self._running: dict[str, subprocess.Popen[bytes]] = {}
        self._waiting: list[str] = []
        self._owner = {"process": os.getpid(), "begun": process_start(os.getpid())}
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        self._settle()

    def start(self, task: str, arguments: Mapping[str, Any], *, label: str, places: Mapping[str, Any]) -> Job:
        """Start a job, or let it wait while as many run as there are processors."""
        name = f"{time.strftime('%Y%m%d-%H%M%S')}-{secrets.token_hex(4)}"
        place = self.folder / name
        place.mkdir(mode=0o700)
        request = {"task": task, "arguments": arguments, "label": label, "places": places, "created": time.time()}
        write_atomically(place / _REQUEST, json.dumps(request | {"owner": self._owner}))
        self._waiting.append(name)
        self.tend()
        return self.job(name)

    def list(self) -> "list[Job]":
        """All jobs, the latest first."""
        self.tend()
        names = sorted((path.name for path in self.folder.iterdir() if (path / _REQUEST).is_file()), reverse=True)
        return [self.job(name) for name in names]

    def job(self, name: str) -> Job:
        """Record of a job."""
        request = self._read(name, _REQUEST)
        if request is None:
            raise InvalidInput(f"there is no job {name[:60]!r}; it may have been deleted")
        state = self._read(name, _STATE) or {}
        known = {key: value for key, value in state.items() if key in Job.__slots__}
        if name in self._waiting:
            known["state"] = "waiting"
        elif name in self._running:
            known["state"] = "running"
        elif known.get("state") not in ENDED:
            known["state"] = "running elsewhere" if self._is_of_another(request.get("owner")) else "interrupted"
        about = {key: request[key] for key in ("task", "label", "created")}
        return Job(id=name, **(about | known))

    def request(self, name: str) -> dict[str, Any]:
        """Task and arguments of a job."""
        self.job(name)
        found = self._read(name, _REQUEST) or {}
        return {key: found.get(key) for key in ("task", "arguments", "label")}

    def result(self, name: str) -> bytes:
        """JSON of the answer of a job that is done."""
        job = self.job(name)
        path = self.folder / name / _RESULT
        if job.state != "done" or not path.is_file():
            raise InvalidInput(f"the job is {job.state}; it has no result")
        return path.read_bytes()

    def file(self, name: str, file: str) -> Path:
        """Path of a file of the answer of a job."""
        self.job(name)
        folder = (self.folder / name / "files").resolve()
        path = (folder / file).resolve()
        if not path.is_relative_to(folder) or not path.is_file():
            raise InvalidInput(f"the job has no file {file[:80]!r}")
        return path

    def cancel(self, name: str) -> Job:
        """Stop a job within a second; what it computed is gone."""
        if self.job(name).state == "running elsewhere":
            raise InvalidInput("another workbench of yours runs this job; stop it there")
        if name in self._waiting:
            self._waiting.remove(name)
            self._record(name, state="cancelled")
        process = self._running.pop(name, None)
        if process is not None:
            _end(process)
            self._record(name, state="cancelled")
        self.tend()
        return self.job(name)

    def delete(self, name: str) -> None:
        """Delete a job with its result."""
        self.cancel(name)
        shutil.rmtree(self.folder / name, ignore_errors=True)

    def tend(self) -> None:
        """Record processes that have ended, and start waiting jobs."""
        for name, process in list(self._running.items()):
            if process.poll() is not None:
                del self._running[name]
                self._note_end(name, process.returncode)
        while self._waiting and len(self._running) < self._most:
            name = self._waiting.pop(0)
            command = [sys.executable, "-m", "sonolube.browser.job", str(self.folder / name)]
            self._running[name] = subprocess.Popen(command, stdin=subprocess.DEVNULL, cwd=self.folder / name)

    def end(self) -> None:
        """End all processes; their jobs count as interrupted."""
        for process in self._running.values():
            _end(process)
        self._running.clear()

    def _is_of_another(self, owner: Any) -> bool:
        """Whether the owner of a job is another workbench that still runs."""
        if not isinstance(owner, dict) or owner == self._owner:
            return False
        begun = owner.get("begun")
        process = owner.get("process")
        return bool(begun) and isinstance(process, int) and process_start(process) == begun

    def _note_end(self, name: str, code: int) -> None:
        """Record the end of a process that did not record it itself."""
        state = self._read(name, _STATE) or {}
        if state.get("state") not in ENDED:
            limits = "2 GiB of memory, 10 minutes of processor time or 1 GiB of a file"
            self._record(name, state="failed", reason=f"its process ended (code {code}); a job may use {limits}")

    def _settle(self) -> None:
        """Delete finished jobs that are too old."""
        for path in self.folder.iterdir():
            with contextlib.suppress(OSError):
                if time.time() - path.stat().st_mtime > KEPT_DAYS * 86400:
                    shutil.rmtree(path, ignore_errors=True)

    def _read(self, name: str, file: str) -> dict[str, Any] | None:
        """Content of a file of a job; None where there is none."""
        if not name or not name.replace("-", "").isalnum():
            return None
        try:
            found: dict[str, Any] = json.loads((self.folder / name / file).read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None
        return found

    def _record(self, name: str, **state: Any) -> None:
        """Write the state of a job."""
        known = self._read(name, _STATE) or {}
        write_atomically(self.folder / name / _STATE, json.dumps(known | state))


def _end(process: "subprocess.Popen[bytes]") -> None:
    """End a process, by force where it does not end by itself."""
    process.terminate()
    try:
        process.wait(_GRACE)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
