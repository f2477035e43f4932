"""Layouts of maps: quantities along both axes and of the panels, and whether all panels are the same."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from sonolube.rig import VOLTAGE, quantity_of_axis
from sonolube.text.units import format_si
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr

_SAME_PANELS = 0.005  # of the friction reduction, which nobody sees in contours of 5 %


MAP_LAYOUTS: Mapping[str, tuple[str, str, str | None]] = MappingProxyType(
    {
        "velocity-stress": ("sliding_speed", "nominal_pressure", "voltage_peak_to_peak"),
        "velocity-power": ("sliding_speed", "actuator_power", "normal_load"),
        "velocity-amplitude": ("sliding_speed", "vibration_amplitude", "normal_load"),
        "frequency-voltage": ("frequency", "voltage_peak_to_peak", None),
        "frequency-amplitude": ("frequency", "vibration_amplitude", None),
    }
)
"""Quantities along the x axis, along the y axis, and of the panels of each kind of map under a voltage."""


def map_layout(computed: "xr.Dataset") -> tuple[str, str, str | None]:
    """Quantities along the x axis, along the y axis, and of the panels of a map.

    Parameters
    ----------
    computed : xarray.Dataset
        Result of a function of `MAPS`.

    Returns
    -------
    tuple of str, str and str or None
        As in `MAP_LAYOUTS`, with panels of an amplitude where the rig has no voltage.
    """
    across, up, panel = MAP_LAYOUTS[computed.attrs["map"]]
    return across, up, quantity_of_axis(computed.dims).name if panel == VOLTAGE.name else panel


def same_panels(computed: "xr.Dataset") -> bool:
    """Whether every panel of a map shows the same friction reduction.

    True where the panels, of which there are several, differ nowhere by more than 0.005, a tenth of a contour step, and
    lack a result at the same points.
    """
    panel = map_layout(computed)[2]
    if panel is None or computed.sizes[panel] < 2:
        return False
    reduction = computed["friction_reduction"]
    missing = reduction.isnull()
    if bool((missing != missing.isel({panel: 0})).any()) or bool(missing.all()):
        return False
    return float(np.nanmax(np.abs(reduction - reduction.isel({panel: 0})))) <= _SAME_PANELS


def panels_text(computed: "xr.Dataset") -> str:
    """Sentence that stands for the panels of a map where all are the same; empty where they differ."""
    if not same_panels(computed):
        return ""
    panel = map_layout(computed)[2]
    values, unit = computed[panel].values, quantity(str(panel)).unit
    low, high = (format_si(float(value), unit) for value in (values[0], values[-1]))
    reduction = computed["friction_reduction"]
    apart = float(np.nanmax(np.abs(reduction - reduction.isel({panel: 0}))))
    name = quantity(str(panel)).meaning.partition(",")[0].lower()
    return f"the same at each {name} from {low} to {high}, within {100 * max(apart, 1e-4):.1g} percentage points"
