"""What every file that is taken away says of itself: version of sonolube, call with rig and changes, and seed."""

import re
from collections.abc import Callable, Mapping
from inspect import signature
from types import MappingProxyType
from typing import Any, Final
from xml.sax.saxutils import escape

from sonolube import __version__
from sonolube.browser.answers import positional
from sonolube.operating_system import quoted
from sonolube.tasks.parameters import RigParameter
from sonolube.tasks.table import Task
from sonolube.tasks.task import marks_of


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
