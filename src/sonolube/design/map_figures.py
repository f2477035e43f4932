"""Layouts of maps, and figures of them: contours of friction reduction with measured runs, and interactive pages."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from sonolube.charts import Axis, Chart, Field, Line, Panel, Part, Points
from sonolube.checks import Floats
from sonolube.extras import missing_package
from sonolube.rig import AMPLITUDE, VOLTAGE, quantity_of_axis
from sonolube.text.units import format_si
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr

_SAMEAXES = 0.01  # of the largest value of an axis, which nobody sees along it
_SAME_PANELS = 0.005  # of the friction reduction, which nobody sees in contours of 5 %


MAP_LAYOUTS: Mapping[str, tuple[str, str, str | None]] = MappingProxyType(
    {
        "velocity-stress": ("sliding_speed", "nominal_pressure", "voltage_peak_to_peak"),
        "velocity-power": ("sliding_speed", "power_to_supply", "normal_load"),
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
        As in `MAP_LAYOUTS`, with panels of an amplitude where the rig has no voltage, and over the charge of the
        capacitance where the map is of that power.
    """
    across, up, panel = MAP_LAYOUTS[computed.attrs["map"]]
    up = map_power(computed) if up == "power_to_supply" else up
    return across, up, quantity_of_axis(computed.dims).name if panel == VOLTAGE.name else panel


def map_power(computed: "xr.Dataset") -> str:
    """Name of the power of a map: to be supplied, or the charge of the capacitance."""
    return str(computed.attrs.get("power", "power_to_supply"))


def same_panels(computed: "xr.Dataset") -> bool:
    """Whether every panel of a map shows the same friction reduction.

    True where the panels, of which there are several, differ nowhere by more than 0.005, a tenth of a contour step,
    lack a result at the same points, and have one vertical axis within 1 % of its end.
    """
    _, up, panel = map_layout(computed)
    if panel is None or computed.sizes[panel] < 2:
        return False
    if panel in computed[up].dims:
        heights = computed[up]
        if float(np.abs(heights - heights.isel({panel: 0})).max()) > _SAMEAXES * float(heights.max()):
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


_STEP = 5  # percent between two contour levels
_MEASURED_LABEL = "measured, reduction in %"
_MOVED_LABEL = "measured, moved to the panel by the model"
_SATURATION_LABEL = "above it doubling the power gains less than 5 %"
AXES: dict[str, tuple[float, Axis]] = {
    "sliding_speed": (1e3, Axis("Sliding speed", "mm/s")),
    "power_to_supply": (1.0, Axis("Power to supply", "W")),
    "charging_power": (1.0, Axis("Power of the amplifier", "W")),
    "nominal_pressure": (1e-6, Axis("Nominal stress", "MPa")),
    "frequency": (1e-3, Axis("Drive frequency", "kHz")),
    **{each.name: (each.axis_scale, each.axis) for each in (VOLTAGE, AMPLITUDE)},
}


def map_chart(computed: "xr.Dataset", *, measured: "xr.Dataset | None" = None) -> Chart:
    """Contours of friction reduction, one panel for each voltage or load, or one where all are the same.

    Parameters
    ----------
    computed : xarray.Dataset
        Result of a function of `MAPS`.
    measured : xarray.Dataset, optional
        Measured runs as `runs_on_map` returns them; drawn with their reductions in percent.

    Returns
    -------
    Chart

    See Also
    --------
    map_page, measured_map_chart
    """
    x_name, y_name, panel = map_layout(computed)
    parts, panel = panels_of(computed, panel)
    levels = _levels(computed, measured)
    columns = _columns(len(parts))
    text = panels_text(computed)
    panels = []
    for place, part in enumerate(parts):
        drawn = (*_contours(part, x_name, y_name, levels), *_runs(measured, x_name, y_name, place))
        title = text[:1].upper() + text[1:] if panel is None else panel_title(part, panel)
        panels.append(Panel(x=AXES[x_name][1], y=AXES[y_name][1], parts=drawn, title=title))
    rows = -(-len(parts) // columns)
    size = (4.8, 3.6) if len(parts) == 1 else (2.35 * columns + 0.9, 2.3 * rows + 0.5)
    shares = len(parts) > 1
    return Chart(panels=tuple(panels), size=size, columns=columns, legend="top", shares_x=shares, shares_y=shares)


def measured_map_chart(interpolated: "xr.Dataset", runs: "xr.Dataset") -> Chart:
    """Contours of friction reduction interpolated between measured runs, beside those of its uncertainty.

    Parameters
    ----------
    interpolated : xarray.Dataset
        With `friction_reduction` and `friction_reduction_uncertainty` over both axes, and its kind as `map`.
    runs : xarray.Dataset
        The measured runs, over `run`.

    Returns
    -------
    Chart

    See Also
    --------
    map_chart, gaussian_process_map
    """
    x_name, y_name, _ = map_layout(interpolated)
    x, y, reduction = surface(interpolated, x_name, y_name)
    _, _, uncertainty = surface(interpolated, x_name, y_name, of="friction_reduction_uncertainty")
    levels = _levels(interpolated, runs)
    across, up = (AXES[name][0] * runs[name].values for name in (x_name, y_name))
    points = Points(x=across, y=up, colour="0", is_hollow=True, label="measured runs")
    steps = np.linspace(0.0, max(100 * float(np.nanmax(uncertainty)), 1e-3), 9)
    fields = (
        Field(
            x=x, y=y, values=100 * reduction, label="Friction reduction", unit="%", levels=levels, lines=levels[2::2]
        ),
        Field(x=x, y=y, values=100 * uncertainty, label="Standard uncertainty", unit="%", levels=steps, scale="grey"),
    )
    panels = tuple(Panel(x=AXES[x_name][1], y=AXES[y_name][1], parts=(field, points)) for field in fields)
    return Chart(panels=panels, size=(8.0, 3.6), columns=2, legend="top", shares_y=True)


def map_page(computed: "xr.Dataset") -> str:
    """Interactive contours of friction reduction as a self-contained HTML page, with values under the pointer.

    Parameters
    ----------
    computed : xarray.Dataset
        Result of a function of `MAPS`.

    Returns
    -------
    str

    Raises
    ------
    MissingPackage
        If Plotly is not installed.

    See Also
    --------
    map_chart
    """
    try:
        from plotly.graph_objects import Contour
        from plotly.subplots import make_subplots
    except ImportError:
        raise missing_package("web", remedy="take PNG or PDF") from None
    x_name, y_name, panel = map_layout(computed)
    parts, panel = panels_of(computed, panel)
    columns = _columns(len(parts))
    titles = None if panel is None else [panel_title(part, panel) for part in parts]
    page = make_subplots(rows=-(-len(parts) // columns), cols=columns, subplot_titles=titles)
    for index, part in enumerate(parts):
        x, y, reduction = surface(part, x_name, y_name)
        contour = Contour(
            x=x,
            y=y,
            z=100 * reduction,
            zmin=0,
            zmax=100,
            colorscale="Cividis",
            showscale=index == 0,
            colorbar={"title": "Friction reduction [%]"},
            contours={"start": 0, "end": 100, "size": 10},
        )
        row, column = index // columns + 1, index % columns + 1
        page.add_trace(contour, row=row, col=column)
        page.update_xaxes(title_text=AXES[x_name][1].text, row=row, col=column)
        page.update_yaxes(title_text=AXES[y_name][1].text, row=row, col=column)
    page.update_layout(title=", ".join(filter(None, (computed.attrs["title"], panels_text(computed)))))
    return str(page.to_html(include_plotlyjs=True, full_html=True))


def _contours(part: "xr.Dataset", x_name: str, y_name: str, levels: Floats) -> tuple[Part, ...]:
    """Contours of one panel, and the saturation power where the map has it."""
    x, y, reduction = surface(part, x_name, y_name)
    percent = 100 * reduction
    varies = bool(np.isfinite(percent).any()) and np.nanmax(percent) - np.nanmin(percent) > 1
    lines = levels[2:-1:2] if varies else None
    field = Field(x=x, y=y, values=percent, label="Friction reduction", unit="%", levels=levels, lines=lines)
    saturation = part["saturation_power"].values if "saturation_power" in part else np.array([np.nan])
    if y_name not in ("power_to_supply", "charging_power") or not np.isfinite(saturation).any():
        return (field,)
    ridge = Line(x=x, y=saturation, label=_SATURATION_LABEL, colour="0", dash=1, has_halo=True)
    return field, ridge


def _runs(measured: "xr.Dataset | None", x_name: str, y_name: str, place: int) -> tuple[Points, ...]:
    """Measured runs of a panel with their reductions in percent, those moved there apart."""
    if measured is None:
        return ()
    found = []
    own = measured["panel"].values == place
    for chosen, label, marker in (
        (own & ~measured["is_moved"].values, measured.attrs.get("title", _MEASURED_LABEL), 0),
        (own & measured["is_moved"].values, _MOVED_LABEL, 2),
    ):
        runs = measured.isel(run=chosen)
        percent = 100 * runs["shown_friction_reduction"].values
        points = Points(
            x=AXES[x_name][0] * runs[x_name].values,
            y=AXES[y_name][0] * runs[y_name].values,
            shades=percent,
            texts=tuple(f"{each:.0f}" for each in percent),
            label=label,
            marker=marker,
            sources=tuple(f"measured {100 * each:.3g} %" for each in runs["friction_reduction"].values),
        )
        found += [points] if chosen.any() else []
    return tuple(found)


def _columns(panels: int) -> int:
    """Number of columns in which panels are arranged."""
    return panels if panels <= 3 else 3 if panels in (5, 6, 9) else 4


def _levels(computed: "xr.Dataset", measured: "xr.Dataset | None") -> Floats:
    """Contour levels from 0 to the largest reduction, rounded up to a multiple of 20 percent, by 5 percent."""
    reductions = [computed["friction_reduction"].values]
    if measured is not None:
        reductions.append(measured["friction_reduction"].values)
    largest = max((float(np.nanmax(values)) for values in reductions if np.isfinite(values).any()), default=1.0)
    return np.arange(0.0, 20 * max(np.ceil(5 * min(largest, 1.0)), 1) + 1, _STEP)


def panels_of(computed: "xr.Dataset", panel: str | None) -> "tuple[list[xr.Dataset], str | None]":
    """Parts of a map, one for each value of the quantity of its panels, and that; one part where all are the same."""
    if panel is None:
        return [computed], None
    if same_panels(computed):
        return [computed.isel({panel: 0})], None
    return [computed.isel({panel: index}) for index in range(computed.sizes[panel])], panel


def surface(
    part: "xr.Dataset", x_name: str, y_name: str, *, of: str = "friction_reduction"
) -> tuple[Floats, Floats, Floats]:
    """Coordinates in the units of their axes, and friction reduction over y and x."""
    x, y = part[x_name], part[y_name]
    order = np.argsort(y.values, kind="stable")  # a power may fall where the voltage rises past a resonance
    reduction = part[of].transpose(y.dims[0], x.dims[0]).values[order]
    return x.values * AXES[x_name][0], y.values[order] * AXES[y_name][0], reduction


def panel_title(part: "xr.Dataset", panel: str) -> str:
    """Voltage and power, amplitude, or load and stress, of a panel."""
    if panel == AMPLITUDE.name:
        return f"amplitude {format_si(float(part[panel]), AMPLITUDE.unit)}"
    if panel == "voltage_peak_to_peak":
        volts, watts = float(part[panel]), part[map_power(part)].values
        low, high = (format_si(float(end), "W") for end in (watts.min(), watts.max()))
        is_one = float(np.ptp(watts)) <= _SAMEAXES * float(watts.max())
        return f"{format_si(volts, 'V')}, {high if is_one else f'{low} to {high}'}"
    return f"{format_si(float(part[panel]), 'N')}, {format_si(float(part['nominal_pressure']), 'Pa')}"
