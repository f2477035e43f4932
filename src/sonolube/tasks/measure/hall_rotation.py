"""Task `measure rotation`: speed of a disc and of the pin on it from a Hall probe."""

from functools import partial
from typing import Annotated, Unpack

from sonolube.report.measured.rotation import RotationSettings, rotation_sheet
from sonolube.tasks.measure.measured_files import Files, MeasuredFiles, TestSheet, column_mapping, measured
from sonolube.tasks.own_tables import Mapped
from sonolube.tasks.parameters import Number, Parameter, Quantity, Watched
from sonolube.tasks.task import in_si, task


@task
def rotation(
    files: Files,
    *,
    groove_diameter: Annotated[Number, Quantity("Of the circle under the pin.", "groove_diameter")],
    magnets: Annotated[int, Parameter("Magnets at the rim.", lowest=1)] = 1,
    prominence: Annotated[
        float, Parameter("Weakest pulse that counts over the strongest.", lowest=0.01, highest=1.0)
    ] = 0.25,
    mapping: Mapped = None,
    test_sheet: TestSheet = None,
    **watch: Unpack[Watched],
) -> MeasuredFiles:
    """Rotation from a Hall probe: speed of the disc and of the pin on it, missing pulses repaired.

    Example: sonolube measure rotation hall.csv --groove-diameter 50mm --magnets 2 --report hall.html

    Examples
    --------
    >>> from math import exp
    >>> import sonolube as sl
    >>> from sonolube.tasks.files import NamedBytes
    >>> pulses = (f"{k / 200},{exp(-(((k % 250 - 125) / 6) ** 2))}" for k in range(4000))
    >>> file = NamedBytes("hall.csv", chr(10).join(["time (s),magnetic_flux_density (mT)", *pulses]).encode())
    >>> answer = sl.measure.rotation(file, groove_diameter="50mm")
    >>> round(float(answer["rotation_speed"]), 3), round(float(answer["sliding_speed"]), 3)  # pi 50 mm 0.8/s
    (0.8, 0.126)
    """
    settings = RotationSettings(
        groove_diameter=in_si("groove_diameter", groove_diameter),
        magnets=magnets,
        prominence=prominence,
        mapping=column_mapping(mapping),
    )
    return measured("rotation", files, partial(rotation_sheet, settings=settings), test_sheet)
