"""Delivery of an answer on a terminal: figures and files are written whole, then text or JSON is printed."""

import json
import os
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from shutil import get_terminal_size
from typing import TYPE_CHECKING, Any

import typer

from sonolube.cli.console.figure_style import prepare_matplotlib
from sonolube.cli.console.options import progress
from sonolube.errors import InvalidInput
from sonolube.report.first_screen import MAX_LINES, file_lines, short_file_line
from sonolube.storage.user_files import expect_target
from sonolube.tasks.answer import Answer
from sonolube.text.plain_text import printable

if TYPE_CHECKING:
    from sonolube.tasks.answer import Content

_WIDEST = 80  # characters of a line, where COLUMNS says nothing
_FAILED, _ALL_REFUSED = 1, 2  # exit codes


def deliver(
    answer: Answer,
    *,
    folder: Path | None = Path(),
    report: Path | None = None,
    as_json: bool = False,
    full: bool = True,
    command: str = "sonolube",
) -> None:
    """Write the files of an answer, then print it as text or as one JSON object."""
    folder = answer.folder or folder
    written = [] if folder is None else _write(answer, folder, report)
    if as_json:
        content = answer.json_object()
        content = content if answer.is_lookup else content | {"files": list(map(str, written))}
        _print(json.dumps(content, indent=2, allow_nan=False))
    else:
        lines = _lines(answer, written, folder or Path(), full=full)
        if lines:
            _print(printable("\n".join(lines)))
    for reason in answer.refusals().values():
        typer.echo(printable(f"{command}: {reason}"), err=True)
    if answer.refusals():
        raise typer.Exit(_FAILED if answer.has_result else _ALL_REFUSED)
    if answer.exit_code:
        raise typer.Exit(answer.exit_code)


def line_width() -> int:
    """Characters of a line: those of COLUMNS where it is set, else those of the terminal up to 80."""
    if os.environ.get("COLUMNS", "").isdigit():
        return int(os.environ["COLUMNS"])
    return min(_WIDEST, get_terminal_size((_WIDEST, 24)).columns)


def _write(answer: Answer, folder: Path, report: Path | None) -> list[Path]:
    """Paths of all files of an answer, rendered one and all before the first is written."""
    page, drawings = answer.page(), answer.figures()
    contents: dict[Path, Any] = {}
    if page is not None or report is not None or any(drawing.forms for drawing in drawings.values()):
        from sonolube.report import rendered_files

        prepare_matplotlib()
        if page is not None and answer.call is not None:
            page = replace(page, settings=(*page.settings, *_rig_settings(answer), *answer.call.settings()))
        notes = [
            *(f"Caveat: {caveat}." for caveat in answer.every_caveat()),
            *(f"Assumed {key}: {reason}." for key, reason in answer.assumptions().items()),
        ]
        with progress("drawing") as advance:
            rendered = rendered_files(drawings, page=page, notes=notes, advance=advance)
            contents |= {folder / name: content for name, content in rendered.items()}
            if report is not None and (text := answer.report(advance)) is not None:
                contents[report] = text
    contents |= {folder / name: _with_notes(content, answer) for name, content in answer.files().items()}
    for path, content in contents.items():
        if not isinstance(content, Path):
            expect_target(path)
            _refuse_to_lose(answer, path, folder)
    return [_written(path, content) for path, content in contents.items()]


def _refuse_to_lose(answer: Answer, path: Path, folder: Path) -> None:
    """Raise for a file whose present content would be a loss."""
    if path.suffix in (".csv", ".toml") and path.is_file() and folder in path.parents:
        try:
            lost = answer.keeps(path.relative_to(folder).as_posix(), path.read_text(encoding="utf-8-sig"))
        except (OSError, ValueError):
            lost = True
        if lost:
            holds = "holds results, which" if path.suffix == ".csv" else "has other content, which"
            raise InvalidInput(f"{path}: {holds} would be lost; move it, or name another folder by --out")


def _rig_settings(answer: Answer) -> list[tuple[str, str]]:
    """Entries of the rig file that were replaced."""
    changes = () if answer.rig is None else answer.rig.changes
    return [("--set", "; ".join(changes))] if changes else []


def _with_notes(content: "Content", answer: Answer) -> "Content":
    """Content of a file; a dataset with caveats and assumptions of the answer among its attributes."""
    return content if isinstance(content, str | bytes | Path) else content.assign_attrs(**answer.notes())


def _written(path: Path, content: "Content") -> Path:
    """Path of a file with this content."""
    if isinstance(content, Path):
        return content
    if isinstance(content, str | bytes):
        from sonolube.storage.files import write_atomically

        return write_atomically(path, content)
    from sonolube.rig import write_netcdf

    return write_netcdf(content, path=path)


def _print(text: str) -> None:
    """Print text on standard output, which may be a file on a full disk."""
    try:
        typer.echo(text)
    except BrokenPipeError:
        raise  # the reader has seen enough
    except OSError as failure:
        raise InvalidInput(f"standard output: cannot be written: {failure.strerror}") from None


def _lines(answer: Answer, written: Sequence[Path], folder: Path, *, full: bool) -> list[str]:
    """Text of an answer with the files that were written; a first screen of one that is longer, unless all is asked."""
    width = line_width()
    lines = [*answer.full_lines(line_length=width), *file_lines(written, folder=folder)]
    if full or len(lines) <= MAX_LINES:
        return lines
    return answer.first_screen(short_file_line(written)).lines(line_length=width, rest="--full")
