"""Task `measure calibration`: a displacement sensor as a force gauge with hysteresis."""

from collections.abc import Sequence
from functools import partial
from typing import Annotated, Unpack

from sonolube.errors import InvalidInput
from sonolube.report.measured.calibration import (
    CalibrationSettings,
    calibrated_hysteresis,
    calibration_sheet,
    force_sheet,
)
from sonolube.tasks.files import InputFile
from sonolube.tasks.measure.measured_files import (
    Files,
    MeasuredFiles,
    TestSheet,
    column_mapping,
    conditions,
    each_file,
    files_of,
)
from sonolube.tasks.own_tables import Mapped
from sonolube.tasks.parameters import File, Number, Parameter, Quantity, Watched
from sonolube.tasks.task import in_si, refuse_unused, shown, task


@task
def calibration(
    files: Files,
    *,
    apply: Annotated[Sequence[InputFile], File("A displacement to compute the force of; may come again.", "FILE")] = (),
    mapping: Mapped = None,
    degree: Annotated[int, Parameter("Of the polynomials of loading and unloading.", lowest=1, highest=7)] = 3,
    levels: Annotated[int, Parameter("Of displacement in the Preisach model.", lowest=2, highest=64)] = 16,
    displacement_uncertainty: Annotated[
        Number, Quantity("Of a reading, standard.", "displacement_uncertainty")
    ] = "0um",
    test_sheet: TestSheet = None,
    **watch: Unpack[Watched],
) -> MeasuredFiles:
    """Calibration of a displacement sensor as a force gauge with hysteresis, and forces by it.

    Example: sonolube measure calibration loops.csv --apply test.csv --report gauge.html
    """
    if not apply:
        because = f"without {shown('apply')}, whose forces it makes uncertain"
        refuse_unused("displacement_uncertainty", because=because)
    settings = CalibrationSettings(
        mapping=column_mapping(mapping),
        degree=degree,
        levels=levels,
        displacement_uncertainty=in_si("displacement_uncertainty", displacement_uncertainty),
    )
    sheets, refused = each_file(files, partial(calibration_sheet, settings=settings), title="calibrating")
    if apply:
        paths = files_of(files)
        if len(paths) != 1:
            raise InvalidInput(f"{shown('apply')} needs one calibration, got {len(paths)} files")
        gauge = calibrated_hysteresis(paths[0], settings=settings)
        measure = partial(force_sheet, calibration=gauge, settings=settings)
        forces, forces_refused = each_file(apply, measure, title="computing forces")
        sheets, refused = [*sheets, *forces], refused | forces_refused
    return MeasuredFiles(title="calibration", sheets=sheets, refused=refused, test=conditions(test_sheet))
