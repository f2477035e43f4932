"""Task `measure temperature`: final rise and time constants of a recorded temperature."""

from functools import partial
from typing import Annotated, Unpack

from sonolube.errors import InvalidInput
from sonolube.report.measured.temperature import TemperatureSettings, temperature_sheet
from sonolube.tasks.files import InputFile, file_path
from sonolube.tasks.measure.measured_files import Files, MeasuredFiles, TestSheet, column_mapping, measured
from sonolube.tasks.own_tables import Mapped
from sonolube.tasks.parameters import File, Number, Parameter, Quantity, Watched
from sonolube.tasks.task import in_si, shown, task


@task
def temperature(
    files: Files,
    *,
    start_time: Annotated[
        Number | None, Quantity("Of the step of the heat; else the first sample.", "start_time")
    ] = None,
    end_time: Annotated[Number | None, Quantity("Of the response; else the last sample.", "end_time")] = None,
    exponentials: Annotated[
        int | None, Parameter("In the response; else as many as the samples tell apart.", lowest=1, highest=2)
    ] = None,
    without_vibration: Annotated[InputFile | None, File("The test without vibration, to compare with.", "FILE")] = None,
    mapping: Mapped = None,
    test_sheet: TestSheet = None,
    **watch: Unpack[Watched],
) -> MeasuredFiles:
    """Temperature after a step of the heat: final rise, time constants, and rise over a test without vibration.

    Example: sonolube measure temperature heated.csv --start-time 2s --report heated.html
    """
    start, end = in_si("start_time", start_time), in_si("end_time", end_time)
    if start is not None and end is not None and end <= start:
        raise InvalidInput(f"{shown('end_time')} {end:g} s must be later than {shown('start_time')} {start:g} s")
    settings = TemperatureSettings(
        start_time=start,
        end_time=end,
        exponentials=exponentials,
        without_vibration=None if without_vibration is None else file_path(without_vibration),
        mapping=column_mapping(mapping),
    )
    return measured("temperature", files, partial(temperature_sheet, settings=settings), test_sheet)
