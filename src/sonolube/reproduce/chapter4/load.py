"""Section 4.1.2 on load: what the loading arm adds to the reduction of friction."""

from collections.abc import Iterator

import numpy as np

from sonolube.published.values import stated
from sonolube.reproduce.chapter3.study_results import over_load
from sonolube.reproduce.row import Row, compare
from sonolube.validation.inputs import said
from sonolube.validation.tribometer_rig import IDENTIFIED_NOTE

_NOTHING_SHAKES_IT = (
    "Nothing in the model shakes the arm at its own frequency: D 3.31 knows neither the plate's wobble nor the motor."
)


def load_rows() -> Iterator[Row]:
    """Yield the rows of the loading arm."""
    study = over_load()
    loads, reduction, arm = (study[name].values for name in ("normal_load", "friction_reduction", "natural_frequency"))
    between = (said("4.1.2-peak-load-1").value + said("4.1.2-peak-load-2").value) / 2
    yield compare(
        stated("4.1.2-arm-frequency"),
        float(np.interp(between, loads, arm)),
        f"Natural frequency of the arm with the weights for {between:g} N; {arm.min():.0f} to {arm.max():.0f} Hz over "
        f"all loads. {IDENTIFIED_NOTE}, of which this is one.",
    )
    spread = float(np.ptp(reduction))
    yield compare(
        stated("4.1.2-arm-extra-reduction"),
        spread,
        f"Largest less smallest reduction from 3 to 9 N at 25.9 V and 65.5 mm/s. {_NOTHING_SHAKES_IT}",
    )
    best = float(loads[np.argmax(reduction)])
    for name in ("4.1.2-peak-load-1", "4.1.2-peak-load-2"):
        yield compare(
            stated(name), best, f"The computed reduction is flat to {100 * spread:.2g} %. {_NOTHING_SHAKES_IT}"
        )
