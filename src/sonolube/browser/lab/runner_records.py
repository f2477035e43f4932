"""Records of runners in the user's folder of states: how one is reached, whether it lives, has ended or was killed.

A folder a run: `request.json`, then `runner.json` while it is at work, `end.json` after its orderly end. All are
private, for they hold the token of the runner.
"""

import json
import secrets
import shutil
import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from sonolube.browser.access import Access
from sonolube.errors import InvalidInput
from sonolube.operating_system import process_start
from sonolube.storage.files import user_state_folder, write_atomically

REQUEST, RUNNER, END = "request.json", "runner.json", "end.json"
"""Names of the files of a runner."""

SAFETY: Final = (
    "Software is no safety function: a rig needs its own emergency stop, within reach, that takes the power from motor"
    " and amplifier."
)
"""What a page of the laboratory always says."""

CONTROL_HEADER: Final = "x-sonolube-control"
"""Header with the word that the workbench alone knows."""

_KEPT: Final = 50  # runners whose records are kept


def laboratory_folder() -> Path:
    """Folder of the records: `sonolube/lab` in the folder of states of this user."""
    return user_state_folder() / "lab"


@dataclass(frozen=True, kw_only=True, slots=True)
class RunnerRecord:
    """Runner of one run, by its record.

    Parameters
    ----------
    id : str
    folder : Path
        Of the record.
    about : mapping of str to object
        What the run is of, as its request says.
    process : int or None
        None before it listens.
    started : str
        Time at which the process has started, as the system writes it.
    port : int
    token : str
        Of its page.
    control : str
        Word without which nobody steers it, as the workbench alone knows it.
    run_folder : str
        Folder of the record of the run; empty until it is made.
    end : mapping of str to object, or None
        State in which it has ended; None where it has not, or was killed.
    """

    id: str
    folder: Path
    about: Mapping[str, Any]
    process: int | None = None
    started: str = ""
    port: int = 0
    token: str = ""
    control: str = ""
    run_folder: str = ""
    end: Mapping[str, Any] | None = None

    @property
    def is_alive(self) -> bool:
        """Whether the very process lives, and not a later one of the same number."""
        return self.process is not None and bool(self.started) and process_start(self.process) == self.started

    @property
    def is_lost(self) -> bool:
        """Whether it was at work and has died without an orderly end."""
        if self.process is None or self.end is not None or self.is_alive:
            return False
        return _read(self.folder / END) is None  # it may have ended since this record was read

    @property
    def access(self) -> Access:
        """Conditions under which its page is shown."""
        return Access(token=self.token, port=self.port)

    def link(self, host: str = "127.0.0.1") -> str:
        """Link of its page."""
        return f"http://{host}:{self.port}/?token={self.token}"


def new_record(parent: Path, request: Mapping[str, Any]) -> RunnerRecord:
    """Record of a runner that is to start, the request written; the oldest ones beyond fifty are deleted.

    Parameters
    ----------
    parent : Path
        Folder of all records.
    request : mapping of str to object

    Returns
    -------
    RunnerRecord
    """
    parent.mkdir(parents=True, exist_ok=True, mode=0o700)
    for old in record_names(parent)[_KEPT:]:
        shutil.rmtree(parent / old, ignore_errors=True)
    name = f"{time.strftime('%Y%m%d-%H%M%S', time.gmtime())}-{secrets.token_hex(4)}"
    (parent / name).mkdir(mode=0o700)
    write_private(parent / name / REQUEST, request)
    return read_record(parent, name)


def read_record(parent: Path, name: str) -> RunnerRecord:
    """Record of a runner by its name.

    Raises
    ------
    InvalidInput
        If there is none.
    """
    folder = parent / name
    request = _read(folder / REQUEST)
    if request is None:
        raise InvalidInput(f"the laboratory has no runner {name[:60]!r}")
    known, about = _read(folder / RUNNER) or {}, request.get("about")
    return RunnerRecord(
        id=name,
        folder=folder,
        about=about if isinstance(about, dict) else {},
        process=known.get("process"),
        **{key: known[key] for key in ("started", "port", "token", "control", "run_folder") if key in known},
        end=_read(folder / END),
    )


def record_names(parent: Path) -> list[str]:
    """Names of all records, the latest first."""
    with suppress(OSError):
        return sorted((path.parent.name for path in parent.glob(f"*/{REQUEST}")), reverse=True)
    return []


def write_private(path: Path, content: Mapping[str, Any]) -> None:
    """Write a file of a record, which its owner alone can read."""
    write_atomically(path, json.dumps(content), is_private=True)


def _read(path: Path) -> dict[str, Any] | None:
    """Content of a file of a record; None where there is none."""
    with suppress(OSError, ValueError, RecursionError):
        found = json.loads(path.read_text(encoding="utf-8"))
        if isinstance(found, dict):
            return found
    return None
