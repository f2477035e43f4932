"""Section 4.1.2 on load: rows and figure of the natural frequency of the loading arm and of its effect on friction."""

from collections.abc import Iterator
from functools import cache
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.charts import Zone, draw_chart
from sonolube.facts.published import published_number, si_value
from sonolube.figure import ReportFigure
from sonolube.models.friction import EMPIRICAL_MEMORY_LENGTH
from sonolube.reproduction.row import Row, default_model_row
from sonolube.reproduction.tribometer_rigs import IDENTIFIED_NOTE, plate_rig
from sonolube.rig import load_study
from sonolube.rig.study_figures import load_chart

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

_NO_EXCITATION: Final = (
    "Nothing in the model excites the arm at its own frequency: D 3.31 has neither the plate's wobble nor the motor."
)


@cache
def response_over_load() -> "xr.Dataset":
    """Response of the tribometer with steel plates over the weights of section 4.1."""
    loads = published_number("4.1.1-normal-load")
    return load_study(plate_rig(), normal_load=np.arange(loads.low, loads.high + 0.125, 0.25))


def load_rows() -> Iterator[Row]:
    """Yield the rows of the loading arm."""
    response = response_over_load()
    loads, reduction, arm = (
        response[name].values for name in ("normal_load", "friction_reduction", "natural_frequency")
    )
    middle = (si_value("4.1.2-peak-load-1") + si_value("4.1.2-peak-load-2")) / 2
    note = (
        f"Natural frequency of the arm with the weights for {middle:g} N; {arm.min():.0f} to {arm.max():.0f} Hz over "
        f"all loads. {IDENTIFIED_NOTE}, of which this is one."
    )
    yield default_model_row("4.1.2-arm-frequency", float(np.interp(middle, loads, arm)), note)
    spread = float(np.ptp(reduction))
    note = f"Largest minus smallest reduction from 3 to 9 N at 25.9 V and 65.5 mm/s. {_NO_EXCITATION}"
    yield default_model_row("4.1.2-arm-extra-reduction", spread, note)
    best = float(loads[np.argmax(reduction)])
    rig = plate_rig()
    needed = rig.sliding_speed / (2 * np.pi * si_value("4.1.2-arm-frequency") * EMPIRICAL_MEMORY_LENGTH)
    for published in ("4.1.2-peak-load-1", "4.1.2-peak-load-2"):
        note = (
            f"The computed reduction is constant to {100 * spread:.2g} %. {_NO_EXCITATION} Nor could the arm reduce "
            f"friction: at 100 Hz asperity stick-slip has no reduction at {1e3 * rig.sliding_speed:g} mm/s below an "
            f"amplitude of {needed:.0f} decay lengths of the contact, at which it would be open for nearly all the time"
        )
        yield default_model_row(published, best, note)


def load_figures() -> Iterator[ReportFigure]:
    """Figure of section 4.1.2 on load."""
    yield ReportFigure(
        name="figure-4-7-load",
        title="Normal load, hung on the arm",
        caption="The reduction does not depend on the load: force and its decay length keep their proportion. The "
        "arm's natural frequency passes 100 Hz near 6.5 N, where the text has the largest reduction, but nothing "
        "in the model excites the arm. Band: loads of the maximum in the text.",
        draw=_load,
    )


def _load() -> "Figure":
    """Draw the response over load with the loads of the maximum in the text."""
    low, high = (np.array([si_value(f"4.1.2-peak-load-{end}")]) for end in (1, 2))
    zone = Zone(first=low, last=high, label="D 4.1.2", colour="0.88")
    return draw_chart(load_chart(response_over_load()).with_parts(0, zone).with_parts(1, zone))
