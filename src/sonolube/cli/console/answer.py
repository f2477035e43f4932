"""Answer of a command, and its delivery: figures and files are written whole, then text or JSON is printed."""

import json
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

import typer

from sonolube.errors import InvalidInput
from sonolube.printable_text import printable
from sonolube.targets import expect_target
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr

    from sonolube.report import Drawing, Page
    from sonolube.rig import Rig
    from sonolube.rig.labelled_arrays import LabelledArrays

    Content = str | bytes | xr.Dataset | LabelledArrays | Path

_UNLISTED = ("rig", "out", "json", "keep", "style")  # arguments that a page lists otherwise, or that change no number


class Answer(Protocol):
    """Result of a command in every form in which it is delivered; a command has one final class of it.

    `lines` and `object` are required; the others are empty unless overridden. None of them prints or writes.
    """

    is_lookup: ClassVar[bool] = False
    """Whether `object` is complete in itself: a table of facts, without caveats, assumptions or files."""

    rig: "Rig | None" = None
    """Rig that the result is of."""

    @abstractmethod
    def lines(self) -> list[str]:
        """Lines of text for people, without caveats, assumptions and files, which `deliver` adds."""

    @abstractmethod
    def object(self) -> dict[str, Any]:
        """Object for JSON, all quantities in SI, without caveats, assumptions and files, which `deliver` adds."""

    def caveats(self) -> Sequence[str]:
        """Reasons for which the result may not hold, a line each."""
        return ()

    def leading_caveats(self) -> Sequence[str]:
        """Caveats that stand above the result, below its first line, because they question all of it."""
        return ()

    def assumptions(self) -> Mapping[str, str]:
        """Values for which there is no source, by what was assumed, each with its reason: those of the rig file."""
        return {} if self.rig is None else self.rig.assumptions

    def figures(self) -> "Mapping[str, Drawing]":
        """Figures by the name of their files, without ending."""
        return {}

    def files(self) -> "Mapping[str, Content]":
        """Content of further files by name; datasets become netCDF, a path is a file that exists already."""
        return {}

    def page(self) -> "Page | None":
        """HTML page that shows the figures with settings, facts and tables; None for commands without one."""
        return None


def deliver(
    answer: Answer, *, folder: Path = Path(), as_json: bool = False, context: typer.Context | None = None
) -> None:
    """Write the files of an answer, then print it as text or as one JSON object.

    Parameters
    ----------
    answer : Answer
    folder : Path
        For page, figures and files; made where it is missing and needed.
    as_json : bool
        Whether to print JSON rather than text.
    context : typer.Context, optional
        Of the command, whose options a page lists.

    Raises
    ------
    InvalidInput
        If a file, or standard output, cannot be written. Everything is rendered before the first file is written.
    """
    written = _write(answer, folder, context)
    if as_json:
        _print(json.dumps(_json_object(answer, written), indent=2, allow_nan=False))
    elif lines := [*_opening_lines(answer), *_closing_lines(answer), *_file_lines(written, folder)]:
        _print(printable("\n".join(lines)))


def si(values: Mapping[str, float | None], *, unit: str | None = None) -> dict[str, Any]:
    """Quantities for JSON, each as its value with its SI unit.

    Parameters
    ----------
    values : mapping of str to float or None
        By name.
    unit : str, optional
        Of all values; that of the vocabulary for each name where absent.

    Returns
    -------
    dict
        Such as {"normal_load": {"value": 3.0, "unit": "N"}}.

    Raises
    ------
    UnknownName
        If a name is not in the vocabulary and no unit is given.
    """
    return {
        name: {"value": value, "unit": quantity(name).unit if unit is None else unit} for name, value in values.items()
    }


def aligned(rows: Sequence[tuple[str, str]]) -> list[str]:
    """Names and values as lines of text, the values one under the other."""
    width = max((len(name) for name, _ in rows), default=0)
    return [f"  {name:<{width}}  {value}".rstrip() for name, value in rows]


def grid(rows: Sequence[Sequence[str]]) -> list[str]:
    """Rows of cells as lines of text, columns aligned to the left."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return ["  ".join(f"{cell:<{width}}" for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]


def _write(answer: Answer, folder: Path, context: typer.Context | None) -> list[Path]:
    """Paths of all files of an answer, rendered one and all before the first is written."""
    page, drawings = answer.page(), answer.figures()
    contents: dict[str, Any] = {}
    if page is not None or drawings:
        from sonolube.cli.console.figure_style import prepare_matplotlib
        from sonolube.cli.console.progress import progress
        from sonolube.report import rendered_files

        prepare_matplotlib()

        if page is not None and context is not None:
            page = replace(page, settings=(*page.settings, *_options(context)))
        notes = [
            *(f"Caveat: {caveat}." for caveat in _every_caveat(answer)),
            *(f"Assumed {key}: {reason}." for key, reason in answer.assumptions().items()),
        ]
        with progress("drawing") as advance:
            contents |= rendered_files(drawings, page=page, notes=notes, advance=advance)
    contents |= {name: _with_notes(content, answer) for name, content in answer.files().items()}
    for name, content in contents.items():
        if not isinstance(content, Path):
            expect_target(folder / name)
    return [_written(folder / name, content) for name, content in contents.items()]


def _with_notes(content: "Content", answer: Answer) -> "Content":
    """Content of a file; a dataset with caveats and assumptions of the answer among its attributes."""
    if isinstance(content, str | bytes | Path):
        return content
    assumed = "\n".join(f"{key}: {reason}" for key, reason in answer.assumptions().items())
    return content.assign_attrs(caveats="\n".join(_every_caveat(answer)), assumptions=assumed)


def _written(path: Path, content: "Content") -> Path:
    """Path of a file with this content."""
    if isinstance(content, Path):
        return content
    if isinstance(content, str | bytes):
        from sonolube.files import write_atomically

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


def _json_object(answer: Answer, written: Sequence[Path]) -> dict[str, Any]:
    """Object of an answer with its caveats, assumptions and files."""
    if answer.is_lookup:
        return answer.object()
    closing = {"caveats": _every_caveat(answer), "assumptions": dict(answer.assumptions())}
    return answer.object() | closing | {"files": [str(path) for path in written]}


def _every_caveat(answer: Answer) -> list[str]:
    """Caveats of an answer, those first that stand above the result."""
    return [*answer.leading_caveats(), *answer.caveats()]


def _opening_lines(answer: Answer) -> list[str]:
    """Lines of an answer with the leading caveats below the first."""
    lines = answer.lines()
    return [*lines[:1], *(f"  caveat: {caveat}" for caveat in answer.leading_caveats()), *lines[1:]]


def _closing_lines(answer: Answer) -> list[str]:
    """Caveats and assumptions of an answer as lines of text."""
    return [
        *[f"  caveat: {caveat}" for caveat in answer.caveats()],
        *[f"  assumed {key}: {reason}" for key, reason in answer.assumptions().items()],
    ]


def _file_lines(written: Sequence[Path], folder: Path) -> list[str]:
    """Files as lines of text: those below a folder of the answer's own by their number."""
    counts: dict[Path, int] = {}
    for path in written:
        place = path if path.parent == folder or folder not in path.parents else path.parent
        counts[place] = counts.get(place, 0) + 1
    return [f"  {place}" + (f": {count} files" if place not in written else "") for place, count in counts.items()]


def _options(context: typer.Context) -> list[tuple[str, str]]:
    """Arguments and options of a running command with their values, those left to their defaults marked so."""
    rows = []
    for option in context.command.params:
        value = context.params.get(option.name or "")
        if option.name in _UNLISTED or value is None or value in ([], ()):
            continue
        given = getattr(context.get_parameter_source(option.name or ""), "name", "") != "DEFAULT"
        text = _as_typed(value)
        rows.append((option.opts[0], text if given else f"{text} (default)"))
    return rows


def _as_typed(value: Any) -> str:
    """Value of an option as a user types it."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list | tuple):
        return "; ".join(map(str, value))
    return str(value)
