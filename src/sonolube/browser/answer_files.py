"""Files of an answer as a page saves them: one by the ending of its name, or all in an archive.

What every file says of itself: version of sonolube, call with rig and changes, and seed.
"""

import base64
import io
import re
import shlex
import tempfile
import zipfile
from collections.abc import Callable, Mapping
from inspect import signature
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final
from xml.sax.saxutils import escape

from sonolube import __version__
from sonolube.browser.answers import called, given_arguments, offered_task, positional
from sonolube.browser.requests import Places
from sonolube.errors import InvalidInput
from sonolube.operating_system import quoted
from sonolube.tasks.answer import Answer
from sonolube.tasks.parameters import RigParameter
from sonolube.tasks.table import Task
from sonolube.tasks.task import marks_of

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


def _about(answer: Answer, line: str) -> str:
    """Version, rig and command that give the files again."""
    rig = (
        [] if answer.rig is None else [f"rig: {answer.rig.title}", *(f"changed: {each}" for each in answer.rig.changes)]
    )
    call = [] if answer.call is None else [f"{name}: {value}" for name, value in answer.call.settings()]
    return "\n".join([f"sonolube {__version__}", *rig, *call, f"command: {line}", *answer.every_caveat(), ""])


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


def command(task: Task, arguments: Mapping[str, Any]) -> str:
    """Command of a terminal that gives the same numbers; it names the files that have to lie beside it."""
    words = ["sonolube", *task.name.split()]
    marks, by_place = marks_of(task.function), positional(task)
    for name, value in arguments.items():
        if isinstance(marks[name], RigParameter):
            words.append(rig_file(value))
            words += [word for key, text in (value.get("changes") or {}).items() for word in ("--set", f"{key}={text}")]
            continue
        option = (marks[name].option or f"--{name.replace('_', '-')}").split()[0]  # type: ignore[union-attr]
        if value is True:
            words.append(option)
        elif isinstance(value, Mapping) and not is_file(value):
            words += [word for key, each in value.items() for word in (option, f"{key}={each}")]
        elif value is not None and value is not False:
            given = named(value)
            several = given if isinstance(given, list) else [given]
            flag = [] if name in by_place else [option]
            words += [word for each in several for word in (*flag, str(each))]
    return " ".join(map(quoted, words))


def made_by(task: Task, arguments: Mapping[str, Any]) -> str:
    """Line that names version, call and seed."""
    return f"Made by {version_and_seed(task, arguments)}: {' '.join(command(task, arguments).split())}"


def version_and_seed(task: Task, arguments: Mapping[str, Any]) -> str:
    """Version of sonolube, and the seed of a task that draws."""
    default = signature(task.function).parameters.get("seed")
    seed = "" if default is None else f", seed {arguments.get('seed', default.default)}"
    return f"sonolube {__version__}{seed}"


def marked(name: str, content: str | bytes, line: str) -> str | bytes:
    """Content of a file with the line, as its kind holds remarks; as it is where its kind holds none."""
    mark = _MARKS.get(name.rpartition(".")[2].lower())
    if mark is None:
        return content
    return mark(content if isinstance(content, str) else content.decode(), line)


def rig_file(source: Mapping[str, Any]) -> str:
    """Name of the file of a rig."""
    return f"{source.get('name') or 'rig'}.toml"


def is_file(value: Any) -> bool:
    """Whether a value of a request is a file."""
    return isinstance(value, Mapping) and "name" in value and ("upload" in value or "content" in value)


def named(value: Any) -> Any:
    """Value of an argument with the names of files in place of their content."""
    if isinstance(value, list):
        return [named(each) for each in value]
    return value["name"] if is_file(value) else value


def _commented(text: str, line: str) -> str:
    """Text with a first line after a hash, below that for an editor."""
    first = re.match(r"#:.*\n", text)
    at = first.end() if first else 0
    return f"{text[:at]}# {line}\n{text[at:]}"


def _after(pattern: str, remark: str) -> Callable[[str, str], str]:
    """Mark that puts a remark behind the first place of a pattern."""

    def mark(text: str, line: str) -> str:
        found = re.search(pattern, text)
        at = found.end() if found else 0
        return text[:at] + remark.format(escape(line, _QUOTES)) + text[at:]

    return mark


_QUOTES: Final = {'"': "&quot;"}
_STEP: Final = "ISO-10303-21;"  # with which a file of STEP begins
_MARKS: Final[Mapping[str, Callable[[str, str], str]]] = MappingProxyType(
    {
        "toml": _commented,
        "csv": _commented,
        "svg": _after(r"<svg\b[^>]*>", "\n <desc>{}</desc>"),
        "vtu": _after(r"<VTKFile\b[^>]*>", "\n<?made-by {}?>"),
        "html": _after(r"<head\b[^>]*>", '\n<meta name="generator" content="{}">'),
        "step": lambda text, line: text.replace(_STEP, f"{_STEP}\n/* {line.replace('*/', '* /')} */", 1),
        "dxf": lambda text, line: f"999\n{line}\n{text}",
    }
)
"""How each kind of file holds a remark, by the ending of its name."""
