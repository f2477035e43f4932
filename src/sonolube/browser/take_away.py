"""Forms in which a page gives a call to take away: command line, Python, rig file, notebook, table, figure, report."""

import csv
import io
import json
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import replace
from types import MappingProxyType
from typing import Any, Final

from sonolube.browser.answer_files import command, made_by, marked, named, rig_file, version_and_seed
from sonolube.browser.answers import called, given_arguments, offered_task, rig_path
from sonolube.browser.requests import Places
from sonolube.charts import chart_tables
from sonolube.errors import InvalidInput, entry_named
from sonolube.report.page import Page, PageTable, rendered_files
from sonolube.tasks.answer import Answer, Rows, Table, Verbatim
from sonolube.tasks.parameters import RigParameter
from sonolube.tasks.table import Task
from sonolube.tasks.task import marks_of

_NOTEBOOK: Final = {"nbformat": 4, "nbformat_minor": 5, "metadata": {"language_info": {"name": "python"}}}


def taken(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """File to take away.

    Its name, kind of content, and text. Command line and Python name the files that have to lie beside them.
    """
    task, form = offered_task(str(payload.get("task", ""))), str(payload.get("form", ""))
    return entry_named(_FORMS, form, kind="form")(task, payload.get("arguments") or {}, places)


def _file(name: str, kind: str, text: str | bytes) -> dict[str, Any]:
    """File to take away."""
    return {"name": name, "kind": kind, "text": text}


def _command(task: Task, arguments: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """Command of a terminal that gives the same numbers."""
    del places
    text = f"{command(task, arguments)}\n# {version_and_seed(task, arguments)}"
    return _file(_name(task, arguments, "txt"), "text/plain", text)


def python(task: Task, arguments: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """Program in Python that gives the same numbers."""
    del places
    text = f"# Made by {version_and_seed(task, arguments)}\n{_python_text(task, arguments)}"
    return _file(_name(task, arguments, "py"), "text/x-python", text)


def _python_text(task: Task, arguments: Mapping[str, Any]) -> str:
    """Lines of the program."""
    marks, lines = marks_of(task.function), ["import sonolube as sl", ""]
    given: list[str] = []
    for name, value in arguments.items():
        if isinstance(marks[name], RigParameter):
            changes = [f"{key}={text}" for key, text in (value.get("changes") or {}).items()]
            lines.append(f"rig = sl.read_rig({rig_file(value)!r}, changes={changes!r})")
            given.insert(0, "rig" if name == "rig" else f"{name}=rig")
        elif value is not None:
            given.append(f"{name}={named(value)!r}")
    function = f"sl.{task.name.replace(' ', '.').replace('-', '_')}"
    return "\n".join([*lines, f"answer = {function}({', '.join(given)})", "print(answer)", ""])


def rig_toml(task: Task, arguments: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """File of the rig with its changes, comments kept."""
    source = _rig_of(task, arguments)
    with ExitStack() as stack:
        text = rig_path(source, places, stack).read_text(encoding="utf-8")
    changed = changed_text(text, source.get("changes") or {})
    return _file(rig_file(source), "application/toml", marked(".toml", changed, made_by(task, arguments)))


def changed_text(text: str, changes: Mapping[str, str]) -> str:
    """Text of a rig file with some entries replaced, its comments kept."""
    import tomlkit

    from sonolube.rig.file.entries import set_entry

    document = tomlkit.parse(text)
    for key, value in changes.items():
        set_entry(document, key, value)
    return tomlkit.dumps(document)


def notebook(task: Task, arguments: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """Notebook that gives the same numbers and draws the figure."""
    del places
    cells = [
        _cell("markdown", f"Made by {version_and_seed(task, arguments)}: `{task.name}`", number=0),
        _cell("code", _python_text(task, arguments).replace("print(answer)", "answer").rstrip(), number=1),
        *([_cell("code", "sl.plot(answer)", number=2)] if task.writes else []),
    ]
    name = _name(task, arguments, "ipynb")
    return _file(name, "application/x-ipynb+json", json.dumps(_NOTEBOOK | {"cells": cells}, indent=1))


def _cell(kind: str, source: str, *, number: int) -> dict[str, Any]:
    """Cell of a notebook."""
    more: dict[str, Any] = {"execution_count": None, "outputs": []} if kind == "code" else {}
    return {"cell_type": kind, "id": f"cell-{number}", "metadata": {}, "source": source} | more


def table(task: Task, arguments: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """Numbers of the answer and of its figures as CSV, one table below the other."""
    answer = _answer(task, arguments, places)
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    for block in answer.blocks():
        if isinstance(block, Rows | Table):
            writer.writerows([*([block.heads] if isinstance(block, Table) else []), *block.rows, []])
    charts = [drawing.chart() for drawing in answer.figures().values() if drawing.chart is not None]
    for each in (table for chart in charts for table in chart_tables(chart)):
        writer.writerows([[each["title"]], each["heads"], *each["rows"], []])
    if not out.tell():
        writer.writerows([["quantity", "value", "unit"], *_scalars(answer.object())])
    text = marked(".csv", out.getvalue(), made_by(task, arguments))
    return _file(_name(task, arguments, "csv"), "text/csv", text)


def figure(task: Task, arguments: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """First figure as SVG, as the task writes it."""
    from sonolube.figure import render_figure

    drawings = _answer(task, arguments, places).figures()
    if not drawings:
        raise InvalidInput(f"{task.name} has no figure to take away")
    name, drawing = next(iter(drawings.items()))
    text = marked(".svg", render_figure(drawing.figure(), "svg"), made_by(task, arguments))
    return _file(f"{name}.svg", "image/svg+xml", text)


def report(task: Task, arguments: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """Self-contained page with the answer's figures, numbers, caveats and assumptions."""
    answer = _answer(task, arguments, places)
    settings = [] if answer.call is None else answer.call.settings()
    rig = [] if answer.rig is None else [("rig", answer.rig.title), *(("changed", each) for each in answer.rig.changes)]
    point = [(each["label"], each["text"]) for each in answer.object().get("operating_point", ())]
    page = answer.page() or _page_of_blocks(answer)
    made = [("made by", made_by(task, arguments).removeprefix("Made by "))]
    page = replace(page, name="answer", settings=[*page.settings, *rig, *point, *settings, *made])
    notes = [*answer.every_caveat(), *(f"assumed {key}: {reason}" for key, reason in answer.assumptions().items())]
    text = rendered_files(answer.figures(), page=page, notes=notes)["answer.html"]
    return _file(_name(task, arguments, "html"), "text/html", str(text))


def _page_of_blocks(answer: Answer) -> Page:
    """Page with the text and tables of an answer that has none of its own."""
    first, *blocks = answer.blocks()
    facts: list[tuple[str, str]] = []
    tables = []
    for block in blocks:
        if isinstance(block, Rows):
            facts += [(name, value) for name, value in block.rows]
        elif isinstance(block, Table):
            tables.append(PageTable(title="", heads=tuple(block.heads), rows=tuple(map(tuple, block.rows))))
        else:
            facts.append(("", (block.text if isinstance(block, Verbatim) else block).strip()))
    return Page(name="answer", title=str(first), settings=[], facts=facts, tables=tables)


def _answer(task: Task, arguments: Mapping[str, Any], places: Places) -> Answer:
    """Answer of a task to the arguments of a request."""
    with given_arguments(task, arguments, places) as given:
        return called(task, given)


def _rig_of(task: Task, arguments: Mapping[str, Any]) -> Mapping[str, Any]:
    """Rig among the arguments of a request."""
    name = next((name for name, mark in marks_of(task.function).items() if isinstance(mark, RigParameter)), "")
    source = arguments.get(name)
    if not isinstance(source, Mapping):
        raise InvalidInput(f"{task.name} was asked without a rig")
    return source


def _name(task: Task, arguments: Mapping[str, Any], ending: str) -> str:
    """Name of a file to take away, of rig and task."""
    rigs = [name for name, mark in marks_of(task.function).items() if isinstance(mark, RigParameter)]
    source = next((arguments[name] for name in rigs if isinstance(arguments.get(name), Mapping)), None)
    words = [*([] if source is None else [rig_file(source).removesuffix(".toml")]), *task.name.split()]
    return f"{'-'.join(words)}.{ending}"


def _scalars(content: Mapping[str, Any]) -> list[list[Any]]:
    """Quantities of an object of JSON as rows."""
    quantities = [(name, each) for name, each in content.items() if isinstance(each, Mapping) and "value" in each]
    return [[name, each["value"], each.get("unit", "")] for name, each in quantities]


_FORMS: Mapping[str, Callable[[Task, Mapping[str, Any], Places], dict[str, Any]]] = MappingProxyType(
    {
        "command": _command,
        "python": python,
        "toml": rig_toml,
        "notebook": notebook,
        "csv": table,
        "svg": figure,
        "report": report,
    }
)
"""Functions that make each form."""
