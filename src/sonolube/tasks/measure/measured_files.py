"""Measurement of many files by one function, arguments that its tasks share, and their answer."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

from sonolube import report as pages
from sonolube.errors import SonolubeError
from sonolube.measurement.measured_files import selected_files
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.report.measured.sheet import Sheet, sheet_blocks, sheets_dataset
from sonolube.rig import Rig
from sonolube.tasks.answer import Answer, Block, Dataset, Rows, answer
from sonolube.tasks.faults import unexpected
from sonolube.tasks.files import InputFile, NamedBytes, file_path, with_names_only
from sonolube.tasks.own_tables import mapping_of
from sonolube.tasks.parameters import File, Mark, Parameter
from sonolube.tasks.progress import Advance, stage

Files = Annotated[Sequence[InputFile] | InputFile, File("Files, or folders whose files are taken.", "FILES...")]
Group = Annotated[str | None, Parameter("Of the channels, in TDMS, HDF5 and MATLAB files.", "GROUP")]
Channels = Annotated[Sequence[str], Parameter("To read, as labelled; may come again.", "LABEL")]
Sections = Annotated[Sequence[str], Parameter("To read, such as a step; may come again.", "NUMBER|NAME")]
TestSheet = Annotated[InputFile | None, File("Conditions of the test, listed in its report.", "TEST.toml")]
Measure = Callable[[Path], Sheet]

_UNLISTED = ("files", "test_sheet", "progress", "cancelled")  # listed otherwise, or changing no number
_SETTINGS = {"apply": "applied to"}  # names of settings that are not those of their arguments


def each_file(
    files: Sequence[InputFile] | InputFile, measure: Measure, *, title: str
) -> tuple[list[Sheet], dict[str, str]]:
    """Sheets of all files that can be measured, and the reasons of the others.

    Parameters
    ----------
    files : InputFile or sequence of InputFile
        Files, folders and patterns; of a folder all files but hidden ones, by name.
    measure : callable
        Returns the sheet of one file.
    title : str
        Of the stage.

    Returns
    -------
    list of Sheet
    dict of str to str
        Reason for each file that could not be measured.

    Raises
    ------
    InvalidInput
        If a folder is empty.
    SonolubeError
        If one file was given, alone and not in a sequence, and cannot be measured.
    """
    paths = files_of(files)
    sheets, refused = [], {}
    with stage(title) as advance:
        for done, path in enumerate(paths):
            advance(path.name, done, len(paths))
            try:
                sheet = measure(path)
                sheets.append(replace(sheet, title=with_names_only(sheet.title)))
            except SonolubeError as failure:
                if isinstance(files, InputFile) and len(paths) == 1:
                    raise
                refused[with_names_only(str(path))] = reason_of(failure)
            except Exception as failure:  # a defect at one file must not lose the others
                if len(paths) == 1:
                    raise
                refused[with_names_only(str(path))] = str(unexpected(failure, title, {"file": path}))
    return sheets, refused


def measured(
    title: str,
    files: Sequence[InputFile] | InputFile,
    measure: Measure,
    test_sheet: InputFile | None,
    *,
    doing: str = "measuring",
) -> "MeasuredFiles":
    """Answer on files that are measured one by one."""
    sheets, refused = each_file(files, measure, title=doing)
    return MeasuredFiles(title=title, sheets=sheets, refused=refused, test=conditions(test_sheet))


def reason_of(failure: SonolubeError) -> str:
    """Reason for which a file could not be measured, in one line."""
    return with_names_only(" ".join(str(failure).split()))


def conditions(test_sheet: InputFile | None) -> pages.PinOnDiscSheet | None:
    """Conditions of a test by their file; None where there is none."""
    return None if test_sheet is None else pages.read_pin_on_disc_sheet(file_path(test_sheet))


def column_mapping(
    mapping: InputFile | None, *, group: str | None = None, channels: Sequence[str] = (), sections: Sequence[str] = ()
) -> RecordingMapping | None:
    """Meaning of the columns by the name or file of a mapping, with the parts to read; None where none was given."""
    found = mapping_of(mapping)
    if not (group or channels or sections):
        return found
    own = found or RecordingMapping(channels={})
    selection = replace(
        own.selection,
        group=group or own.selection.group,
        channels=tuple(channels or own.selection.channels),
        sections=tuple(sections or own.selection.sections),
    )
    return replace(own, selection=selection)


@answer
class MeasuredFiles(Answer):
    """Values, tables, caveats and figures of measured files, and their page."""

    title: str
    sheets: Sequence[Sheet]
    refused: Mapping[str, str]
    test: pages.PinOnDiscSheet | None = None

    def blocks(self) -> Sequence[Block]:
        """Values and tables of each file, and the conditions of the test."""
        blocks = [block for sheet in self.sheets for block in sheet_blocks(sheet)]
        if blocks and self.test is not None:
            for part, rows in pages.pin_on_disc_rows(self.test, self.sheets).items():
                blocks += ["", f"  {part}", Rows(rows)]
        return blocks

    def object(self) -> dict[str, Any]:
        """Values, tables and caveats of each file, settings, and the files that were refused."""
        return pages.measurement_object(self._measurement())

    def dataset(self) -> Dataset:
        """Values and tables of all files, with their settings."""
        settings = "\n".join(f"{name}: {text}" for name, text in self._settings().items())
        attributes = {"measured": self.title, "settings": settings, "refused": "\n".join(self.refused.values())}
        return sheets_dataset(self.sheets).assign_attrs(attributes | self.notes())

    def caveats(self) -> Sequence[str]:
        """Caveats of all files."""
        return pages.measurement_caveats(self._measurement())

    def figures(self) -> Mapping[str, pages.Drawing]:
        """Figures of all sheets by title, with the name of the file where there are several."""
        several = len(self.sheets) > 1
        return {
            f"{sheet.title}: {figure.title}" if several else figure.title: figure.drawing
            for sheet in self.sheets
            for figure in sheet.figures
        }

    def report(self, advance: Advance) -> str:
        """Page with the figures of all sheets."""
        return pages.measurement_page(self._measurement(), advance=advance)

    def refusals(self) -> Mapping[str, str]:
        """Reason for each file that could not be measured."""
        return self.refused

    @property
    def has_result(self) -> bool:
        """Whether any file was measured."""
        return bool(self.sheets)

    def _measurement(self) -> pages.MeasurementReport:
        """Sheets with the settings that their numbers depend on."""
        return pages.MeasurementReport(
            title=self.title, settings=self._settings(), sheets=tuple(self.sheets), refused=self.refused, test=self.test
        )

    def _settings(self) -> dict[str, str]:
        """Arguments of the call by name as given, without those that change no number."""
        if self.call is None:
            return {}
        return {
            _SETTINGS.get(name) or name.replace("_", " "): _setting(value, self.call.marks[name])
            for name, value in self.call.arguments.items()
            if name not in _UNLISTED and value is not None and value is not False and value not in ((), [])
        }


def _file_name(file: InputFile) -> str:
    """Name of a file without its folder."""
    return file.name if isinstance(file, NamedBytes) else Path(file).name


def _setting(value: object, mark: Mark) -> str:
    """Value of an argument as text: of several files their names, of a number in SI its unit too."""
    if isinstance(value, list | tuple):
        is_file = isinstance(mark, File)
        return ", ".join(_file_name(each) if is_file else str(each) for each in value)
    if isinstance(value, Mapping):
        return ", ".join(f"{key}={each}" for key, each in value.items())
    if isinstance(value, NamedBytes | Rig):
        return value.name
    unit = mark.unit if isinstance(mark, Parameter) and isinstance(value, float | int) else None
    return f"{value} {unit}" if unit else str(value)


def files_of(given: Sequence[InputFile] | InputFile) -> list[Path]:
    """Files, folders and patterns replaced by their files."""
    return selected_files(map(file_path, [given] if isinstance(given, InputFile) else given))
