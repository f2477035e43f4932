"""What all commands of `measure` share: files and folders in, one sheet a file, one bad file never the end."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from sonolube.errors import InvalidInput, SonolubeError

if TYPE_CHECKING:
    from sonolube.report.measured.sheet import Sheet

Files = Annotated[list[Path], typer.Argument(metavar="FILES...", help="Files, or folders whose files to take.")]
Report = Annotated[Path | None, typer.Option(metavar="PAGE.html", help="Self-contained page to write.")]
Test = Annotated[
    Path | None, typer.Option("--test-sheet", metavar="TEST.toml", help="How the test was made, for the page.")
]
Measure = Callable[[Path], "Sheet"]


def each_file(paths: Sequence[Path], measure: Measure, *, what: str) -> tuple[list["Sheet"], dict[str, str]]:
    """Measure every file, and every file of every folder.

    Parameters
    ----------
    paths : sequence of Path
        Files and folders; of a folder all files but hidden ones, by name.
    measure : callable
        Returns the sheet of one file.
    what : str
        Shown as progress.

    Returns
    -------
    list of Sheet
        Of the files that could be measured.
    dict of str to str
        The others, each with its reason.

    Raises
    ------
    InvalidInput
        If a folder is empty.
    """
    from sonolube.cli.progress import progress

    files = _files(paths)
    sheets, refused = [], {}
    with progress(what) as advance:
        for done, path in enumerate(files):
            advance(path.name, done, len(files))
            try:
                sheets.append(measure(path))
            except SonolubeError as failure:
                refused[str(path)] = " ".join(str(failure).split())
    return sheets, refused


def answer(
    title: str,
    sheets: Sequence["Sheet"],
    refused: Mapping[str, str],
    *,
    settings: Mapping[str, Any],
    page: Path | None,
    test: Path | None,
    as_json: bool,
) -> None:
    """Print what was measured, write the page, and exit with 1 where some files were refused and with 2 where all were.

    Parameters
    ----------
    title : str
        What was measured.
    sheets : sequence of Sheet
        Of the files that could be measured.
    refused : mapping of str to str
        The others, each with its reason.
    settings : mapping
        What the numbers depend on beside the files; None is passed over.
    page : Path or None
        Where to write the page.
    test : Path or None
        How the test was made.
    as_json : bool
        Whether to print one JSON object.

    Raises
    ------
    typer.Exit
        As said.
    """
    import json

    from sonolube.cli.progress import progress
    from sonolube.report.measurement import (
        MeasurementReport,
        measurement_lines,
        measurement_object,
        write_measurement_report,
    )
    from sonolube.report.pin_on_disc_sheet import read_test_sheet

    report = MeasurementReport(
        title=title,
        settings={name: str(value) for name, value in settings.items() if value is not None},
        sheets=tuple(sheets),
        refused=refused,
        test=None if test is None else read_test_sheet(test),
    )
    written = []
    if page is not None:
        with progress("drawing") as advance:
            written.append(write_measurement_report(report, path=page, advance=advance))
    if as_json:
        told = measurement_object(report) | ({"files": [str(path) for path in written]} if written else {})
        typer.echo(json.dumps(told, indent=2, allow_nan=False))
    elif lines := [*measurement_lines(report), *(f"report: {path}" for path in written)]:
        typer.echo("\n".join(lines))
    for reason in refused.values():
        typer.echo(f"sonolube measure: {reason}", err=True)
    if refused:
        raise typer.Exit(2 if not sheets else 1)


def quantity(text: str | None, *, unit: str, option: str) -> float | None:
    """Return an option's quantity in SI; None where it was not given."""
    from sonolube.units import to_si

    return None if text is None else to_si(text, unit=unit, name=option)


def _files(paths: Sequence[Path]) -> list[Path]:
    files: list[Path] = []
    for path in paths:
        if not path.is_dir():
            files.append(path)
            continue
        inside = sorted(each for each in path.iterdir() if each.is_file() and not each.name.startswith("."))
        if not inside:
            raise InvalidInput(f"{path}: holds no file")
        files += inside
    return files
