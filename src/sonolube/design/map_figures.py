"""Figures of maps: contours of friction reduction with measured runs, and interactive pages of the same."""

from textwrap import wrap
from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.checks import Floats
from sonolube.design.map_layouts import map_layout, panels_text, same_panels
from sonolube.extras import missing_package
from sonolube.rig import AMPLITUDE, VOLTAGE
from sonolube.units import format_si

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_STEP = 5  # percent between two contour levels
_TITLE_WIDTH = 60  # characters of a line above the one panel
_RUNS_LABEL = "measured, reduction in %"
_SATURATION_LABEL = "above it doubling the power gains less than 5 %"
_AXES: dict[str, tuple[float, str]] = {
    "sliding_speed": (1e3, "Sliding speed [mm/s]"),
    "actuator_power": (1.0, "Power of the amplifier [W]"),
    "nominal_pressure": (1e-6, "Nominal stress [MPa]"),
    "frequency": (1e-3, "Drive frequency [kHz]"),
    VOLTAGE.name: (VOLTAGE.axis_scale, VOLTAGE.axis_label),
    AMPLITUDE.name: (AMPLITUDE.axis_scale, AMPLITUDE.axis_label),
}


def map_figure(computed: "xr.Dataset", *, measured: "xr.Dataset | None" = None) -> "Figure":
    """Contours of friction reduction, one panel for each voltage or load, or one where all are the same.

    Parameters
    ----------
    computed : xarray.Dataset
        Result of a function of `MAPS`.
    measured : xarray.Dataset, optional
        Measured runs over `run`, with the quantities of both axes, `friction_reduction`, and that of the panels; drawn
        with their reductions in percent.

    Returns
    -------
    matplotlib.figure.Figure

    See Also
    --------
    map_page, measured_map_figure
    """
    from matplotlib.figure import Figure

    x_name, y_name, panel = map_layout(computed)
    parts, panel = _panels(computed, panel)
    columns = _columns(len(parts))
    rows = -(-len(parts) // columns)
    levels = _levels(computed, measured)
    width = 4.8 if len(parts) == 1 else 2.35 * columns + 0.9
    figure = Figure(figsize=(width, 3.6 if len(parts) == 1 else 2.3 * rows + 0.5))
    grid = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
    filled = None
    for index, (axes, part) in enumerate(zip(grid.flat, parts, strict=False)):
        filled = _draw_contours(axes, part, x_name, y_name, levels)
        if panel is not None:
            axes.set_title(_panel_title(part, panel), fontsize=8)
        if measured is not None:
            _draw_runs(axes, part, measured, x_name, y_name, panel, levels)
        if index + columns >= len(parts):
            axes.set_xlabel(_AXES[x_name][1])
            axes.xaxis.set_tick_params(labelbottom=True)
        if index % columns == 0:
            axes.set_ylabel(_AXES[y_name][1])
    for axes in list(grid.flat)[len(parts) :]:
        axes.set_axis_off()
    if text := panels_text(computed):
        grid[0, 0].set_title("\n".join(wrap(text[:1].upper() + text[1:], _TITLE_WIDTH)), fontsize=8)
    assert filled is not None
    figure.colorbar(filled, ax=grid, label="Friction reduction [%]", ticks=levels[::4])
    handles, labels = _legend_entries(grid.flat)
    if handles:
        figure.legend(handles, labels, loc="outside upper center", ncols=len(labels))
    return figure


def measured_map_figure(interpolated: "xr.Dataset", runs: "xr.Dataset") -> "Figure":
    """Contours of friction reduction interpolated between measured runs, beside those of its uncertainty.

    Parameters
    ----------
    interpolated : xarray.Dataset
        With `friction_reduction` and `friction_reduction_uncertainty` over both axes, and its kind as `map`.
    runs : xarray.Dataset
        The measured runs, over `run`.

    Returns
    -------
    matplotlib.figure.Figure

    See Also
    --------
    map_figure, gaussian_process_map
    """
    from matplotlib.figure import Figure

    x_name, y_name, _ = map_layout(interpolated)
    x, y, reduction = _surface(interpolated, x_name, y_name)
    uncertainty = 100 * interpolated["friction_reduction_uncertainty"].transpose(
        interpolated[y_name].dims[0], interpolated[x_name].dims[0]
    )
    figure = Figure(figsize=(8.0, 3.6))
    left, right = figure.subplots(1, 2, sharex=True, sharey=True)
    levels = _levels(interpolated, runs)
    filled = left.contourf(x, y, np.clip(100 * reduction, 0, 100), levels=levels, cmap="cividis")
    figure.colorbar(filled, ax=left, label="Friction reduction [%]", ticks=levels[::4])
    shaded = right.contourf(x, y, uncertainty, levels=8, cmap="Greys")
    figure.colorbar(shaded, ax=right, label="Standard uncertainty [%]")
    for axes in (left, right):
        places = (runs[name].values * _AXES[name][0] for name in (x_name, y_name))
        axes.plot(*places, "o", ms=4, mfc="white", color="black", clip_on=False, label="measured runs")
        axes.set_xlabel(_AXES[x_name][1])
        axes.grid(visible=False)
    left.set_ylabel(_AXES[y_name][1])
    figure.legend(*left.get_legend_handles_labels(), loc="outside upper center")
    return figure


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
    map_figure
    """
    try:
        from plotly.graph_objects import Contour
        from plotly.subplots import make_subplots
    except ImportError:
        raise missing_package("web", remedy="take PNG or PDF") from None
    x_name, y_name, panel = map_layout(computed)
    parts, panel = _panels(computed, panel)
    columns = _columns(len(parts))
    titles = None if panel is None else [_panel_title(part, panel) for part in parts]
    page = make_subplots(rows=-(-len(parts) // columns), cols=columns, subplot_titles=titles)
    for index, part in enumerate(parts):
        x, y, reduction = _surface(part, x_name, y_name)
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
        page.update_xaxes(title_text=_AXES[x_name][1], row=row, col=column)
        page.update_yaxes(title_text=_AXES[y_name][1], row=row, col=column)
    page.update_layout(title=", ".join(filter(None, (computed.attrs["title"], panels_text(computed)))))
    return str(page.to_html(include_plotlyjs=True, full_html=True))


def _draw_contours(axes: "Axes", part: "xr.Dataset", x_name: str, y_name: str, levels: Floats) -> Any:
    """Draw the contours of one panel, and the saturation power where the map has it; return the filled contours."""
    from matplotlib.patheffects import Normal, Stroke

    x, y, reduction = _surface(part, x_name, y_name)
    percent = np.clip(100 * reduction, 0, 100)
    filled = axes.contourf(x, y, percent, levels=levels, cmap="cividis")
    if np.isfinite(percent).any() and np.nanmax(percent) - np.nanmin(percent) > 1:
        lines = axes.contour(x, y, percent, levels=levels[2:-1:2], colors="white", linewidths=0.6)
        for label in axes.clabel(lines, fmt="%d", fontsize=6, inline=False):
            label.set_path_effects([Stroke(linewidth=2, foreground="#2a3f6e"), Normal()])
            position = (label.get_position()[0] - x[0]) / (x[-1] - x[0])
            label.set_visible(0.05 < position < 0.95)  # labels near the edge would be cut off
    axes.grid(visible=False)
    if "saturation_power" in part and y_name == "actuator_power":
        saturation = part["saturation_power"].values
        if np.isfinite(saturation).any():
            halo = [Stroke(linewidth=3.4, foreground="white"), Normal()]
            axes.plot(x, saturation, "--", color="black", lw=1.6, path_effects=halo, label=_SATURATION_LABEL)
    return filled


def _draw_runs(
    axes: "Axes",
    part: "xr.Dataset",
    measured: "xr.Dataset",
    x_name: str,
    y_name: str,
    panel: str | None,
    levels: Floats,
) -> None:
    """Draw the measured runs that belong to a panel, with their reductions in percent."""
    runs = measured
    if panel is not None and panel in measured:
        runs = measured.isel(run=np.isclose(measured[panel].values, float(part[panel]), rtol=1e-3))
    if not runs.sizes["run"]:
        return
    x, y = runs[x_name].values * _AXES[x_name][0], runs[y_name].values * _AXES[y_name][0]
    percent = 100 * runs["friction_reduction"].values
    colours = {"c": percent, "cmap": "cividis", "vmin": levels[0], "vmax": levels[-1]}
    axes.scatter(x, y, s=30, edgecolors="white", zorder=4, clip_on=False, **colours)
    axes.scatter([], [], s=30, facecolors="0.6", edgecolors="black", label=measured.attrs.get("title", _RUNS_LABEL))
    box = {"boxstyle": "round,pad=0.1", "fc": "white", "ec": "none", "alpha": 0.8}
    style: dict[str, Any] = {"textcoords": "offset points", "fontsize": 7, "bbox": box, "zorder": 6}
    for place, reduction in zip(zip(x, y, strict=True), percent, strict=True):
        axes.annotate(f"{reduction:.0f}", place, xytext=(6, -3), **style)


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


def _panels(computed: "xr.Dataset", panel: str | None) -> "tuple[list[xr.Dataset], str | None]":
    """Parts of a map, one for each value of the quantity of its panels, and that; one part where all are the same."""
    if panel is None:
        return [computed], None
    if same_panels(computed):
        return [computed.isel({panel: 0})], None
    return [computed.isel({panel: index}) for index in range(computed.sizes[panel])], panel


def _surface(part: "xr.Dataset", x_name: str, y_name: str) -> tuple[Floats, Floats, Floats]:
    """Coordinates in the units of their axes, and friction reduction over y and x."""
    x, y = part[x_name], part[y_name]
    reduction = part["friction_reduction"].transpose(y.dims[0], x.dims[0]).values
    return x.values * _AXES[x_name][0], y.values * _AXES[y_name][0], reduction


def _panel_title(part: "xr.Dataset", panel: str) -> str:
    """Voltage and power, amplitude, or load and stress, of a panel."""
    if panel == AMPLITUDE.name:
        return f"amplitude {format_si(float(part[panel]), AMPLITUDE.unit)}"
    if panel == "voltage_peak_to_peak":
        volts, watts = float(part[panel]), float(part["actuator_power"])
        return f"{format_si(volts, 'V')}, {format_si(watts, 'W')}"
    return f"{format_si(float(part[panel]), 'N')}, {format_si(float(part['nominal_pressure']), 'Pa')}"


def _legend_entries(grid: Any) -> tuple[list[Any], list[str]]:
    """Handles and labels of all panels, each label once."""
    entries: dict[str, Any] = {}
    for axes in grid:
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            entries.setdefault(label, handle)
    return list(entries.values()), list(entries)
