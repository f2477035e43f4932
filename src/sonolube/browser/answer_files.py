"""Files of an answer as a page saves them: one by the ending of its name, or all in an archive."""

import base64
import io
import shlex
import tempfile
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sonolube import __version__
from sonolube.browser.answers import called, given_arguments, offered_task
from sonolube.browser.made_by import command, made_by, marked
from sonolube.browser.places import Places
from sonolube.errors import InvalidInput
from sonolube.tasks.answer import Answer

if TYPE_CHECKING:
    from sonolube.tasks.answer import Content

_KINDS = {".c": "text/x-csrc", ".csv": "text/csv", ".toml": "application/toml", ".zip": "application/zip"}
_BEGINNING = (1980, 1, 1, 0, 0, 0)  # time of every file in an archive, so that equal answers give equal archives


def answer_files(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """File of the answer of a task to save.

    That whose name ends as `ending` of the request; without one an archive of all, with a text of what made them.
    """
    task, arguments = offered_task(str(payload.get("task", ""))), payload.get("arguments") or {}
    with given_arguments(task, arguments, places) as given:
        answer = called(task, given)
        line = made_by(task, arguments)
        files = {name: _bytes_of(_marked(name, content, line)) for name, content in answer.files().items()}
    ending = str(payload.get("ending", ""))
    if ending:
        name = next((name for name in files if name.endswith(ending)), None)
        if name is None:
            raise InvalidInput(f"{task.name} has no file of the ending {ending[:40]!r}; it has {', '.join(files)}")
        return _file(name, files[name])
    if not files:
        raise InvalidInput(f"{task.name} has no files to take away")
    call = command(task, arguments)
    name = f"{shlex.split(call)[-1] if answer.rig is None else answer.rig.name}-{task.name.replace(' ', '-')}.zip"
    return _file(name, _archive({"about.txt": _about(answer, call).encode(), **files}))


def _about(answer: Answer, command: str) -> str:
    """Version, rig and command that give the files again."""
    rig = (
        [] if answer.rig is None else [f"rig: {answer.rig.title}", *(f"changed: {each}" for each in answer.rig.changes)]
    )
    call = [] if answer.call is None else [f"{name}: {value}" for name, value in answer.call.settings()]
    return "\n".join([f"sonolube {__version__}", *rig, *call, f"command: {command}", *answer.every_caveat(), ""])


def _marked(name: str, content: "Content", line: str) -> "Content":
    """Content that says what made it, where its kind holds remarks."""
    return marked(name, content, line) if isinstance(content, str | bytes) else content


def _bytes_of(content: "Content") -> bytes:
    """Content of a file as bytes."""
    from sonolube.rig import write_netcdf

    if isinstance(content, Path):
        return content.read_bytes()
    if isinstance(content, str | bytes):
        return content.encode() if isinstance(content, str) else content
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "content.nc")
        write_netcdf(content, path=path)
        return path.read_bytes()


def _archive(files: Mapping[str, bytes]) -> bytes:
    """ZIP archive of files by name."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name, _BEGINNING), content, zipfile.ZIP_DEFLATED)
    return out.getvalue()


def _file(name: str, content: bytes) -> dict[str, Any]:
    """File to save, its content as base64."""
    kind = _KINDS.get(Path(name).suffix, "application/octet-stream")
    return {"name": Path(name).name, "kind": kind, "base64": base64.b64encode(content).decode()}
