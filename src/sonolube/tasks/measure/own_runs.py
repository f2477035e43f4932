"""Task `runs`: the table of own runs as one sees it, with rows added, changed, left out, undone and saved."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Final, TypeAlias

from sonolube.errors import InvalidInput
from sonolube.laboratory.records.run import run_folders
from sonolube.laboratory.records.run_folder import is_run_folder
from sonolube.measurement.file_kind import file_kind
from sonolube.measurement.measured_runs import read_runs
from sonolube.measurement.recordings.reader import recipes_first_in
from sonolube.measurement.run_columns import SWITCH, TEXT_NAMES
from sonolube.measurement.run_sheet import (
    RunSheet,
    joined,
    read_sheet,
    sheet_of_rows,
    usual_unit,
    with_cell,
    with_switch,
    without_row,
)
from sonolube.measurement.run_sheet_file import SheetFile, state_of_file, store_sheet, stored_sheet
from sonolube.report.measured.further_use import result_run_rows
from sonolube.report.results.compared_runs import levels_csv
from sonolube.rig.file.rig_folder import INSTRUMENTS, RIG_FILE, RUNS_FILE
from sonolube.tasks.answer import Answer, Block, Dataset, Table, answer
from sonolube.tasks.boundary import runs_argument
from sonolube.tasks.files import InputFile, NamedBytes, file_path, private_files
from sonolube.tasks.measure.recordings import friction
from sonolube.tasks.own_tables import MappedRuns, mapping_of
from sonolube.tasks.parameters import File, Number, OwnFile, Parameter, Quantity, RunsSource
from sonolube.tasks.task import given_arguments, in_si, shown, task
from sonolube.text.units import convert, to_si
from sonolube.vocabulary import quantities

_SETTINGS: Final = {
    "voltage": "voltage_peak_to_peak",
    "vibration": "vibration_amplitude",
    "frequency": "frequency",
    "speed": "sliding_speed",
    "load": "normal_load",
}
"""Arguments with the settings of recordings that are added, and the columns of each."""

_NOT_SHOWN: Final = (
    *(SWITCH, "study", "nominal_area", "note"),
    *("friction_force_uncertainty", "friction_reduction_uncertainty", "friction_ratio_uncertainty"),
)
"""Columns that lines of text have no place for; the object and the file have them."""
_LONGEST: Final = 24  # characters of a cell in a line

Added: TypeAlias = "RunsSource | OwnRunsAnswer | Answer | Mapping[str, float | str]"
"""What a table takes in: a file, DataFrame, dataset, folder of a record, answer of a measurement, or one run."""


@task
def runs(
    table: Annotated[
        RunsSource, OwnFile("Table of own runs, or the folder of their rig; by default a new table.", "RUNS.csv")
    ] = None,
    *,
    add: Annotated[
        Sequence[InputFile],
        File("Table of runs, recording of friction, or recorded run or folder of them to add; may come again.", "FILE"),
    ] = (),
    mapping: MappedRuns = None,
    voltage: Annotated[
        Number | None, Quantity("Of the recordings that are added, peak to peak.", "voltage_peak_to_peak")
    ] = None,
    vibration: Annotated[Number | None, Quantity("Amplitude of their vibration.", "vibration_amplitude")] = None,
    frequency: Annotated[Number | None, Quantity("Frequency of their vibration.", "frequency")] = None,
    speed: Annotated[Number | None, Quantity("Their sliding speed.", "sliding_speed")] = None,
    load: Annotated[Number | None, Quantity("Their normal load.", "normal_load")] = None,
    leave_out: Annotated[
        Sequence[int], Parameter("Number of a run to leave out of predictions and fits; may come again.", lowest=1)
    ] = (),
    use: Annotated[Sequence[int], Parameter("Number of a run to use again; may come again.", lowest=1)] = (),
    remove: Annotated[Sequence[int], Parameter("Number of a run to remove; may come again.", lowest=1)] = (),
) -> "OwnRunsAnswer":
    """Table of own runs of a rig: rows seen, added from tables and recordings, left out, removed.

    Example: sonolube runs examples/tribometer-runs.csv

    Examples
    --------
    >>> import sonolube as sl
    >>> table = sl.runs("examples/tribometer-runs.csv").leave_out(2)
    >>> len(table.sheet.rows), table.dataset().sizes["run"]
    (4, 3)
    """
    found = _table(table, mapping if not add else None)
    given = given_arguments(_SETTINGS)
    if given and not add:
        name = next(iter(given))
        raise InvalidInput(f"{shown(name)} is for what {shown('add')} names; give both", key=name)
    conditions = {_SETTINGS[name]: in_si(name, value) for name, value in given.items()}
    for source in add:
        found = found._with_rows(source, mapping, conditions)
    for change, numbers in (("leave_out", leave_out), ("use", use), ("remove", remove)):
        found = getattr(found, change)(*numbers) if numbers else found
    return found


@answer
class OwnRunsAnswer(Answer):
    """Table of own runs, of which every change is a new table; rows are numbered from 1.

    Parameters
    ----------
    sheet : RunSheet
    file : SheetFile or None
        File that it was read from, to which `save` writes; None for a new table.
    folder_of_rig : Path or None
        Folder of the rig that it is of, whose recipes are looked for first.
    before : OwnRunsAnswer or None
        Table before the last change.
    told : tuple of str
        What became of the rows that were added last.
    """

    sheet: RunSheet
    file: SheetFile | None = None
    folder_of_rig: Path | None = None
    before: "OwnRunsAnswer | None" = None
    told: tuple[str, ...] = ()

    def add(
        self,
        *sources: Added,
        mapping: InputFile | None = None,
        voltage: Number | None = None,
        vibration: Number | None = None,
        frequency: Number | None = None,
        speed: Number | None = None,
        load: Number | None = None,
    ) -> "OwnRunsAnswer":
        """Table with the runs of files, recordings, records, answers, DataFrames or rows that it lacks.

        Parameters
        ----------
        *sources : path, bytes, DataFrame, dataset, answer or mapping
            Tables of runs; recordings of friction or answers of their measurement; folders of recorded runs; mappings
            of one run, such as ``{"friction_force": 0.5, "sliding_speed": "30 mm/s"}``, numbers in SI.
        mapping : path or bytes, optional
            Assignment of the columns.
        voltage, vibration, frequency, speed, load : float or str, optional
            Settings of recordings, which do not state them.

        Returns
        -------
        OwnRunsAnswer

        Raises
        ------
        InvalidInput
            If a source holds no runs.
        """
        given = {"voltage": voltage, "vibration": vibration, "frequency": frequency, "speed": speed, "load": load}
        conditions = {
            _SETTINGS[name]: _number(_SETTINGS[name], each) for name, each in given.items() if each is not None
        }
        with private_files():
            found = self
            for source in sources:
                found = found._with_rows(source, mapping, conditions)
        return replace(found, before=self)

    def edit(self, number: int, **cells: float | str) -> "OwnRunsAnswer":
        """Table with other cells in a run: numbers in SI, or texts in the unit of the column or with their own."""
        sheet = self.sheet
        for name, cell in cells.items():
            sheet = with_cell(sheet, row=self._row(number), name=name, text=_cell(name, cell))
        return self._changed(sheet)

    def leave_out(self, *numbers: int) -> "OwnRunsAnswer":
        """Table in which runs are left out of predictions and fits, without being removed."""
        return self._switched(numbers, is_used=False)

    def use(self, *numbers: int) -> "OwnRunsAnswer":
        """Table in which runs that were left out are used again."""
        return self._switched(numbers, is_used=True)

    def remove(self, *numbers: int) -> "OwnRunsAnswer":
        """Table without some runs."""
        sheet = self.sheet
        for row in sorted({self._row(number) for number in numbers}, reverse=True):
            sheet = without_row(sheet, row=row)
        return self._changed(sheet)

    def undo(self) -> "OwnRunsAnswer":
        """Table before the last change.

        Raises
        ------
        InvalidInput
            If nothing was changed.
        """
        if self.before is None:
            raise InvalidInput("undo: nothing was changed in this table")
        return replace(self.before, file=self.file)

    def save(self, path: str | Path | None = None) -> "OwnRunsAnswer":
        """Write the table to its file or to another, whole or not at all, and return it as one of that file.

        Parameters
        ----------
        path : str or Path, optional
            Of a file, or of the folder of a rig; by default the file that the table was read from.

        Returns
        -------
        OwnRunsAnswer

        Raises
        ------
        InvalidInput
            If another program changed the file since it was read, a column of it would be lost, or there is no file.
        """
        file = self.file
        if path is not None:
            place = _file_of(Path(path))
            file = state_of_file(place) if file is None or file.path != place else file
        if file is None:
            raise InvalidInput("save: this table has no file yet; name one")
        return replace(self, file=store_sheet(self.sheet, file))

    def blocks(self) -> Sequence[Block]:
        """Number of runs, and the table with a number for each."""
        used = [self.sheet.is_used(row) for row in range(len(self.sheet.rows))]
        off = used.count(False)
        place = "" if self.file is None else f" in {self.file.path}"
        head = (
            f"{len(used)} own {'run' if len(used) == 1 else 'runs'}{place}{f', {off} of them left out' if off else ''}"
        )
        names = [name for name in self.sheet.names if name not in _NOT_SHOWN]
        headings = dict(zip(self.sheet.names, self.sheet.headings, strict=True))
        heads = [headings[name].replace("_", " ") for name in names]
        rows = [
            [str(row + 1), "" if is_used else "left out", *(_shortened(self.sheet.cell(row, name)) for name in names)]
            for row, is_used in enumerate(used)
        ]
        return [head, *([Table(["", "", *heads], rows)] if rows else []), *(f"  {line}" for line in self.told)]

    def object(self) -> dict[str, Any]:
        """File, and the cells of each run by name, quantities in SI."""
        return {
            "file": None if self.file is None else str(self.file.path),
            "runs": [self._object(row) for row in range(len(self.sheet.rows))],
        }

    def dataset(self) -> Dataset:
        """Runs that are not left out, in SI, with a friction reduction in each, as predictions take them."""
        with private_files():
            return read_runs(file_path(NamedBytes("runs.csv", self.sheet.csv().encode()))).assign_attrs(self.notes())

    def _object(self, row: int) -> dict[str, Any]:
        """Cells of a run for JSON."""
        found: dict[str, Any] = {"is_used": self.sheet.is_used(row)}
        for name in self.sheet.names:
            cell = self.sheet.cell(row, name)
            if cell and name != SWITCH:
                found[name] = _in_si(name, cell)
        return found

    def _row(self, number: int) -> int:
        """Place of a run by its number."""
        if not 1 <= number <= len(self.sheet.rows):
            raise InvalidInput(f"there is no run {number}; the table has runs 1 to {len(self.sheet.rows)}")
        return number - 1

    def _switched(self, numbers: Sequence[int], *, is_used: bool) -> "OwnRunsAnswer":
        """Table with runs switched on or off."""
        sheet = self.sheet
        for number in numbers:
            sheet = with_switch(sheet, row=self._row(number), is_used=is_used)
        return self._changed(sheet)

    def _changed(self, sheet: RunSheet, *told: str) -> "OwnRunsAnswer":
        """Table after a change."""
        return replace(self, sheet=sheet, before=self, told=told)

    def _with_rows(self, source: Any, mapping: InputFile | None, conditions: Mapping[str, float]) -> "OwnRunsAnswer":
        """Table with the runs of a source that it lacks."""
        with recipes_first_in(None if self.folder_of_rig is None else self.folder_of_rig / INSTRUMENTS):
            more = _rows_of(source, mapping, conditions)
        sheet, added = joined(self.sheet, more)
        known = len(more.rows) - added
        said = f"{added} added{f', {known} in the table already' if known else ''}: {_name(source)}"
        return self._changed(sheet, *self.told, said)


def _table(source: Any, mapping: InputFile | None) -> OwnRunsAnswer:
    """Table of a file, of the folder of a rig, or of what else holds runs."""
    if source is None:
        return OwnRunsAnswer(sheet=RunSheet())
    if isinstance(source, str | Path) and not str(source).startswith("catalogue:"):
        path = Path(source)
        folder = path if path.is_dir() else path.parent
        place = folder if (folder / RIG_FILE).is_file() else None
        with recipes_first_in(None if place is None else place / INSTRUMENTS):
            sheet, file = stored_sheet(_file_of(path), mapping=mapping_of(mapping))
        return OwnRunsAnswer(sheet=sheet, file=file, folder_of_rig=place)
    return OwnRunsAnswer(sheet=_rows_of(source, mapping, {}))


def _file_of(path: Path) -> Path:
    """File of a table by its path or that of the folder of its rig."""
    return path / RUNS_FILE if path.is_dir() else path


def _rows_of(source: Any, mapping: InputFile | None, conditions: Mapping[str, float]) -> RunSheet:
    """Runs of anything that holds some."""
    if isinstance(source, OwnRunsAnswer):
        return source.sheet
    if isinstance(source, Answer):
        return _measured(source.json_object(), conditions)
    if isinstance(source, Mapping) and not hasattr(source, "data_vars"):
        return sheet_of_rows([{name: _value(name, cell) for name, cell in source.items()}])
    given = runs_argument("add", source)
    if not isinstance(given, str | Path | NamedBytes):
        return _of_dataset(given)
    if str(given).startswith("catalogue:"):
        from sonolube.laboratory.catalogue import catalogued_runs

        return _of_dataset(catalogued_runs(str(given)))
    path = file_path(given)
    if path.is_dir():
        return _of_folder(path)
    is_table = isinstance(given, NamedBytes) and given.name == "runs"  # given as one, without a name of its own
    kind = "runs" if is_table else file_kind(path)
    if kind == "recording":
        return _measured(friction(given, mapping=mapping).json_object(), conditions)
    if kind != "runs":
        raise InvalidInput(f"{path.name}: is a {kind}; a table takes tables of runs and recordings of friction")
    return read_sheet(path, mapping=mapping_of(mapping), source="" if is_table else path.name)


def _measured(found: Mapping[str, Any], conditions: Mapping[str, float]) -> RunSheet:
    """Runs of the results of a measurement."""
    rows = [row for result in found.get("results", []) for row in result_run_rows(result, conditions)]
    if not rows:
        raise InvalidInput("add: this measurement has no level of friction")
    return sheet_of_rows(rows)


def _of_folder(folder: Path) -> RunSheet:
    """Runs of a recorded run, of the folder of a rig, or of all recorded runs in a folder."""
    if is_run_folder(folder):
        return _recorded(folder, [folder])
    if (folder / RIG_FILE).is_file():
        return read_sheet(folder / RUNS_FILE)
    return _recorded(folder, run_folders(folder))


def _recorded(place: Path, folders: Sequence[Path]) -> RunSheet:
    """Runs of recorded runs of the laboratory, one for each level of their voltage, their source the record's name."""
    from sonolube.laboratory.catalogue import level_rows

    rows, left_out = level_rows(folders)
    if len(rows) == 1:
        raise InvalidInput(left_out[-1] if left_out else f"{place}: has no recorded run")
    return read_sheet(file_path(NamedBytes("record.csv", levels_csv(rows).encode())))


def _of_dataset(dataset: Dataset) -> RunSheet:
    """Runs of a dataset, in SI."""
    names = [str(name) for name in dataset.data_vars if name in TEXT_NAMES or name in quantities()]
    columns = {name: dataset[name].to_numpy().tolist() for name in names}
    count = dataset.sizes.get("run", 0)
    return sheet_of_rows([{name: cells[row] for name, cells in columns.items()} for row in range(count)])


def _value(name: str, cell: float | str) -> float | str:
    """Cell of a run as a text, or as a number in SI."""
    if name in TEXT_NAMES:
        return str(cell)
    if name not in quantities():
        raise InvalidInput(f"{name[:60]!r} is no column of a table of runs", key=name)
    return _number(name, cell)


def _number(name: str, value: float | str) -> float:
    """Quantity in SI of a number in SI, or of a text with its unit."""
    return (
        to_si(value, unit=quantities()[name].unit, name=name.replace("_", " "))
        if isinstance(value, str)
        else float(value)
    )


def _cell(name: str, cell: float | str) -> str:
    """Text of a cell."""
    if isinstance(cell, str) or name in TEXT_NAMES or name not in quantities():
        return str(cell)
    return sheet_of_rows([{name: float(cell)}]).cell(0, name)


def _in_si(name: str, cell: str) -> Any:
    """Cell for JSON: a text, or a quantity in SI."""
    try:
        number = float(cell)
    except ValueError:
        return cell
    if name in TEXT_NAMES:
        return cell
    unit = quantities()[name].unit
    return {"value": convert(number, from_unit=usual_unit(name), to_unit=unit) if unit else number, "unit": unit}


def _shortened(cell: str) -> str:
    """Text of a cell for a line."""
    return cell if len(cell) <= _LONGEST else f"{cell[: _LONGEST - 4]} ..."


def _name(source: Any) -> str:
    """Source in a line."""
    if isinstance(source, str | Path):
        return Path(source).name
    return str(source.name) if isinstance(source, NamedBytes) else type(source).__name__
