"""Measurement of many files by one function, options that all its commands share, and their answer."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatch
from pathlib import Path
from typing import Annotated, Any

import typer

from sonolube.cli.console.answer import Answer, deliver
from sonolube.cli.console.options import refuse_unused
from sonolube.cli.console.outputs import OutputFile
from sonolube.cli.console.progress import progress
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.measurement.recordings.instrument_mappings import mapping_by_name
from sonolube.measurement.recordings.mapping import RecordingMapping, Selection
from sonolube.printable_text import printable
from sonolube.report import (
    MeasurementReport,
    measurement_caveats,
    measurement_lines,
    measurement_object,
    measurement_page,
    read_pin_on_disc_sheet,
)
from sonolube.report.measured.sheet import Sheet

Files = Annotated[list[Path], typer.Argument(metavar="FILES...", help="Files, or folders whose files are taken.")]
Mapped = Annotated[
    str | None,
    typer.Option(
        "--mapping",
        metavar="NAME|MAPPING.toml",
        help="Of the columns: umt, anton-paar, t-11, rtec, pin-on-disc, or a file.",
    ),
]
Group = Annotated[str | None, typer.Option(metavar="GROUP", help="Of the channels, in TDMS, HDF5 and MATLAB files.")]
Channels = Annotated[
    list[str] | None, typer.Option("--channel", metavar="LABEL", help="To read, as labelled; may come again.")
]
Sections = Annotated[
    list[str] | None, typer.Option("--section", metavar="NUMBER|NAME", help="To read, such as a step; may come again.")
]
Report = Annotated[Path | None, typer.Option(metavar="PAGE.html", help="Self-contained page to write."), OutputFile()]
Test = Annotated[
    Path | None, typer.Option("--test-sheet", metavar="TEST.toml", help="Conditions of the test, for the page.")
]
Measure = Callable[[Path], "Sheet"]

_PATTERN = re.compile(r"[*?[]")  # of a shell, where it did not replace the pattern itself
_UNLISTED = ("files", "test", "report", "json", "style")  # listed otherwise, or changing no number
_SETTINGS = {"--apply": "applied to"}  # names of settings that are not those of their options


def each_file(paths: Sequence[Path], measure: Measure, *, title: str) -> tuple[list[Sheet], dict[str, str]]:
    """Sheets of all files that can be measured, and the reasons of the others.

    Parameters
    ----------
    paths : sequence of Path
        Files, folders and patterns; of a folder all files but hidden ones, by name.
    measure : callable
        Returns the sheet of one file.
    title : str
        Of the progress bar.

    Returns
    -------
    list of Sheet
    dict of str to str
        Reason for each file that could not be measured.

    Raises
    ------
    InvalidInput
        If a folder is empty.
    """
    files = files_of(paths)
    sheets, refused = [], {}
    with progress(title) as advance:
        for done, path in enumerate(files):
            advance(path.name, done, len(files))
            try:
                sheets.append(measure(path))
            except SonolubeError as failure:
                refused[str(path)] = " ".join(str(failure).split())
    return sheets, refused


def column_mapping(
    mapping: str | None,
    *,
    group: str | None = None,
    channels: Sequence[str] | None = None,
    sections: Sequence[str] | None = None,
) -> RecordingMapping | None:
    """Meaning of the columns by the name or file of a mapping, with the parts to read; None where none was given."""
    found = None if mapping is None else mapping_by_name(mapping)
    if not (group or channels or sections):
        return found
    own = found or RecordingMapping(channels={})
    selection = Selection(
        group=group or own.selection.group,
        channels=tuple(channels or own.selection.channels),
        sections=tuple(sections or own.selection.sections),
    )
    return replace(own, selection=selection)


def deliver_sheets(
    context: typer.Context,
    title: str,
    sheets: Sequence[Sheet],
    refused: Mapping[str, str],
    *,
    page: Path | None,
    test: Path | None,
    as_json: bool,
) -> None:
    """Deliver the sheets of measured files, then exit with 1 where some files were refused, with 2 where all were.

    Parameters
    ----------
    context : typer.Context
        Of the command, whose options are the settings that the numbers depend on.
    title : str
        What was measured.
    sheets : sequence of Sheet
    refused : mapping of str to str
        Reason for each file that could not be measured.
    page : Path or None
        HTML page to write.
    test : Path or None
        File of the conditions of the test.
    as_json : bool

    Raises
    ------
    typer.Exit
        If files were refused.
    """
    if page is None and not as_json:
        refuse_unused(context, "test", because="without --report or --json, which list its conditions")
    report = MeasurementReport(
        title=title,
        settings=_settings(context),
        sheets=tuple(sheets),
        refused=refused,
        test=None if test is None else read_pin_on_disc_sheet(test),
    )
    folder = Path() if page is None else page.parent
    deliver(MeasuredFiles(report=report, page_name=None if page is None else page.name), folder=folder, as_json=as_json)
    for reason in refused.values():
        typer.echo(printable(f"sonolube measure: {reason}"), err=True)
    if refused:
        raise typer.Exit(2 if not sheets else 1)


@dataclass(frozen=True, kw_only=True)
class MeasuredFiles(Answer):
    """Values, tables and caveats of measured files, and their page."""

    report: MeasurementReport
    page_name: str | None

    def lines(self) -> list[str]:
        """Values and tables of each file."""
        return measurement_lines(self.report)

    def object(self) -> dict[str, Any]:
        """Values, tables and caveats of each file, settings, and the files that were refused."""
        return measurement_object(self.report)

    def caveats(self) -> Sequence[str]:
        """Caveats of all files."""
        return measurement_caveats(self.report)

    def files(self) -> Mapping[str, str]:
        """Page where it is wanted."""
        if self.page_name is None:
            return {}
        with progress("drawing") as advance:
            return {self.page_name: measurement_page(self.report, advance=advance)}


def _settings(context: typer.Context) -> dict[str, str]:
    """Options of a running command by name as given, those left out that were not given or change no number."""
    settings = {}
    for option in context.command.params:
        value = context.params[option.name or ""]
        if option.name not in _UNLISTED and value is not None and value is not False and value not in ((), []):
            name = _SETTINGS.get(option.opts[0]) or option.opts[0].removeprefix("--").replace("-", " ")
            settings[name] = _setting(value)
    return settings


def _setting(value: object) -> str:
    """Value of an option as text; of files their names."""
    if isinstance(value, (list, tuple)):
        return ", ".join(each.name if isinstance(each, Path) else str(each) for each in value)
    return str(value)


def files_of(paths: Sequence[Path]) -> list[Path]:
    """Files, folders and patterns replaced by their files in the order of their names, numbers by their size.

    Raises
    ------
    InvalidInput
        If a folder is empty.
    """
    files: list[Path] = []
    for path in paths:
        is_pattern = _PATTERN.search(path.name) and path.parent.is_dir() and not path.exists()
        matches = [each for each in path.parent.iterdir() if fnmatch(each.name, path.name)] if is_pattern else []
        if matches:
            files += sorted(matches, key=_by_numbers)
            continue
        if not path.is_dir():
            files.append(path)
            continue
        inside = [each for each in path.iterdir() if each.is_file() and not each.name.startswith(".")]
        if path / "documents.jsonl" in inside:  # the folder of a run of the laboratory
            inside = [each for each in inside if each.suffix == ".nc"]
        inside.sort(key=_by_numbers)
        if not inside:
            raise InvalidInput(f"{path}: holds no file")
        files += inside
    return files


def _by_numbers(path: Path) -> list[tuple[int, str]]:
    """Sort key of a name by which part-2 comes before part-10."""
    return [(int(piece), "") if piece.isdecimal() else (-1, piece) for piece in re.split(r"(\d{1,18})", path.name)]
