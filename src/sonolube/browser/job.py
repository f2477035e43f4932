"""The process of one job: `python -m sonolube.browser.job FOLDER` reads its request and writes progress and result."""

import json
import sys
import time
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sonolube.browser.answer_files import made_by, marked
from sonolube.browser.answers import answer_object, called, given_arguments, offered_task
from sonolube.browser.requests import Places
from sonolube.browser.worker import encoded, limit_process
from sonolube.errors import SonolubeError, UnexpectedFault
from sonolube.storage.files import write_atomically
from sonolube.tasks.faults import unexpected
from sonolube.tasks.task import marks_of

if TYPE_CHECKING:
    from sonolube.tasks.answer import Answer, Content

_CPU_TIME = 600  # seconds
_BETWEEN = 0.2  # seconds from one record of progress to the next


class _Record:
    """State of the job, written as it changes."""

    def __init__(self, folder: Path) -> None:
        self._path = folder / "state.json"
        self._begun, self._written, self.of = time.monotonic(), 0.0, ""

    def progress(self, stage: str, done: int, total: int) -> None:
        """Write the progress, not more often than people can read."""
        if time.monotonic() - self._written > _BETWEEN:
            self.write("running", stage=stage, done=done, total=total)

    def write(self, state: str, **more: object) -> None:
        """Write the state."""
        self._written = time.monotonic()
        content = {"state": state, "of": self.of, "seconds": self._written - self._begun} | more
        write_atomically(self._path, json.dumps(content))


def main(folder: Path) -> None:
    """Run a job to its end."""
    limit_process(cpu_time=_CPU_TIME)
    request = json.loads((folder / "request.json").read_text(encoding="utf-8"))
    record = _Record(folder)
    record.write("running", stage="starting")
    try:
        task = offered_task(request["task"])
        with given_arguments(task, request["arguments"], Places(**request["places"])) as given:
            line = made_by(task, request["arguments"])
            record.of = line.removeprefix("Made by ")
            watch = {"progress": record.progress} if "progress" in marks_of(task.function) else {}
            answer = called(task, given | watch)
            files = dict(answer.files()) | dict(_page_files(answer))
            names = write_files(files, folder=folder / "files", line=line)
            more = {"files": names, "made_by": line}
            write_atomically(folder / "result.json", encoded(answer_object(answer) | more).decode())
    except UnexpectedFault as fault:
        record.write("failed", reason=str(fault))
    except (SonolubeError, OSError) as failure:  # as the terminal does
        record.write("refused", reason=str(failure))
    except MemoryError:
        record.write("failed", reason="does not fit into the 2 GiB of memory of a job; ask for fewer points")
    except (Exception, SystemExit) as failure:  # whatever a task raises
        record.write("failed", reason=str(unexpected(failure, request["task"], request["arguments"])))
    else:
        record.write("done")


def _page_files(answer: "Answer") -> "Mapping[str, Content]":
    """Files that a page shows beside those of the answer."""
    if not hasattr(answer, "surface_modes"):
        return {}
    from sonolube.browser.mode_view import mode_files

    return mode_files(answer)


def write_files(contents: "Mapping[str, Content]", *, folder: Path, line: str) -> list[str]:
    """Write the files of an answer, each with a line on what it is of, and return their names."""
    from sonolube.rig import write_netcdf

    for name, content in contents.items():
        path = folder / name
        if isinstance(content, str | bytes | Path):
            write_atomically(path, marked(name, content.read_bytes() if isinstance(content, Path) else content, line))
        else:
            write_netcdf(_with_line(content, line), path=path)
    return list(contents)


def _with_line(content: Any, line: str) -> Any:
    """Dataset with the line among its attributes."""
    from sonolube.rig.datasets import LabelledArrays

    if isinstance(content, LabelledArrays):
        return replace(content, attrs={**content.attrs, "made_by": line})
    return content.assign_attrs(made_by=line)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
