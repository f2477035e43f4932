"""Task `measure surface`: areal and profile parameters, spectra and summits of height maps."""

from functools import partial
from typing import Annotated, Unpack

from sonolube.report.measured.surface import SurfaceSettings, spacings, surface_sheet
from sonolube.tasks.measure.measured_files import Files, MeasuredFiles, TestSheet, measured
from sonolube.tasks.parameters import Number, Parameter, Quantity, Watched
from sonolube.tasks.task import in_si, shown, task

Spacing = Annotated[
    str | float | None, Parameter("Distance of pixels, for files that lack it; one or 'x,y'.", "LENGTH")
]
LengthUnit = Annotated[str | None, Parameter("For files that lack it, such as um.", "UNIT")]


@task
def surface(
    files: Files,
    *,
    spacing: Spacing = None,
    length_unit: LengthUnit = None,
    form: Annotated[
        int, Parameter("Degree of the form that is removed: 1 tilt, 2 curvature.", lowest=0, highest=12)
    ] = 1,
    robust: Annotated[bool, Parameter("Weight pixels far from the form less.")] = False,
    short_cutoff: Annotated[Number | None, Quantity("Remove shorter waves, as noise.", "short_cutoff_length")] = None,
    long_cutoff: Annotated[Number | None, Quantity("Remove longer waves, as waviness.", "long_cutoff_length")] = None,
    test_sheet: TestSheet = None,
    **watch: Unpack[Watched],
) -> MeasuredFiles:
    """Surfaces: parameters of ISO 25178-2 and of profiles, spectra, and summits for the contact models.

    Example: sonolube measure surface plate.opd --long-cutoff 25um --report plate.html

    Examples
    --------
    >>> import io
    >>> import numpy as np
    >>> import sonolube as sl
    >>> from sonolube.tasks.files import NamedBytes
    >>> file, x = io.BytesIO(), np.arange(64) - 31.5
    >>> np.save(file, 1e-6 * np.tile(np.cos(2 * np.pi * x / 16), (64, 1)))
    >>> answer = sl.measure.surface(NamedBytes("plate.npy", file.getvalue()), spacing="1um")
    >>> round(1e6 * float(answer["rms_height"]), 3)  # of a cosine 1/sqrt(2)
    0.707
    """
    spacing_x, spacing_y = spacings(spacing, name=shown("spacing"))
    settings = SurfaceSettings(
        spacing_x=spacing_x,
        spacing_y=spacing_y,
        length_unit=length_unit,
        degree=form,
        robust=robust,
        short_cutoff_length=in_si("short_cutoff", short_cutoff),
        long_cutoff_length=in_si("long_cutoff", long_cutoff),
    )
    return measured("surfaces", files, partial(surface_sheet, settings=settings), test_sheet)
