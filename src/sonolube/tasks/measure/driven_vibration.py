"""Task `measure vibration`: amplitudes, operating shape and modal assurance of vibrometer recordings."""

from functools import partial
from typing import Annotated, Unpack

from sonolube.report.measured.vibration import VibrationSettings, has_voltage, proportion_sheet, vibration_sheet
from sonolube.tasks.files import InputFile, file_path
from sonolube.tasks.measure.measured_files import Files, MeasuredFiles, TestSheet, column_mapping, conditions, each_file
from sonolube.tasks.number_table import number_table
from sonolube.tasks.own_tables import Mapped
from sonolube.tasks.parameters import File, Number, Quantity, Watched
from sonolube.tasks.task import in_si, task


@task
def vibration(
    files: Files,
    *,
    frequency: Annotated[Number, Quantity("Of the drive, such as 22kHz.", "frequency")],
    modes: Annotated[InputFile | None, File("Computed shapes at the points, one a column.", "MODES.csv")] = None,
    mapping: Mapped = None,
    test_sheet: TestSheet = None,
    **watch: Unpack[Watched],
) -> MeasuredFiles:
    """Vibration at the drive frequency: amplitude, amplitude per volt, operating shape, likeness to computed modes.

    Example: sonolube measure vibration tip.csv --frequency 22kHz --report tip.html

    Examples
    --------
    >>> from math import pi, sin
    >>> import sonolube as sl
    >>> from sonolube.tasks.files import NamedBytes
    >>> rows = ["time (s),tip (um)", *(f"{k / 20e3},{2.5 * sin(2 * pi * k / 20)}" for k in range(2000))]
    >>> file = NamedBytes("tip.csv", chr(10).join(rows).encode())  # or the path of a file
    >>> round(1e6 * float(sl.measure.vibration(file, frequency="1kHz")["vibration_amplitude"]), 3)
    2.5
    """
    settings = VibrationSettings(
        frequency=in_si("frequency", frequency),
        mapping=column_mapping(mapping),
        modes=None if modes is None else number_table(file_path(modes)),
    )
    sheets, refused = each_file(files, partial(vibration_sheet, settings=settings), title="measuring")
    if sum(map(has_voltage, sheets)) > 1:
        sheets.append(proportion_sheet(sheets))
    return MeasuredFiles(title="vibration", sheets=sheets, refused=refused, test=conditions(test_sheet))
