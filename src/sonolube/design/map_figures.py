"""Figures of maps: contours of friction reduction, and the same as a page to turn over by hand."""

from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.checks import Floats
from sonolube.design.maps import PLACES
from sonolube.errors import InvalidInput
from sonolube.units import format_si

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_STEP = 5  # percent between two colours; every other edge is drawn
_MEASURED = "measured, reduction in %"
_RIDGE = "beyond it doubling the power buys less than 5 %"
_AXES = {
    "sliding_speed": (1e3, "Sliding speed [mm/s]"),
    "actuator_power": (1.0, "Power of the amplifier [W]"),
    "nominal_pressure": (1e-6, "Nominal stress [MPa]"),
    "frequency": (1e-3, "Drive frequency [kHz]"),
    "voltage_peak_to_peak": (1.0, "Voltage, peak to peak [V]"),
}


def map_figure(mapped: "xr.Dataset", *, measured: "xr.Dataset | None" = None) -> "Figure":
    """Return a map as contours, one panel to each voltage or load.

    Parameters
    ----------
    mapped : xarray.Dataset
        As one of `MAPS` returns it.
    measured : xarray.Dataset, optional
        Measured runs over `run`, with the quantities of both axes, `friction_reduction`, and that of the panels; drawn
        with their reductions in percent.

    Returns
    -------
    matplotlib.figure.Figure
    """
    from matplotlib.figure import Figure

    across, up, panel = PLACES[mapped.attrs["map"]]
    parts = _parts(mapped, panel)
    columns = _columns(len(parts))
    rows = -(-len(parts) // columns)
    levels = _levels(mapped, measured)
    width = 4.8 if len(parts) == 1 else 2.35 * columns + 0.9
    figure = Figure(figsize=(width, 3.6 if len(parts) == 1 else 2.3 * rows + 0.5))
    grid = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
    filled = None
    for index, (axes, part) in enumerate(zip(grid.flat, parts, strict=False)):
        filled = _contours(axes, part, across, up, levels)
        if panel is not None:
            axes.set_title(_told(part, panel), fontsize=8)
        if measured is not None:
            _measured(axes, part, measured, across, up, panel, levels)
        if index + columns >= len(parts):
            axes.set_xlabel(_AXES[across][1])
            axes.xaxis.set_tick_params(labelbottom=True)
        if index % columns == 0:
            axes.set_ylabel(_AXES[up][1])
    for axes in list(grid.flat)[len(parts) :]:
        axes.set_axis_off()
    assert filled is not None
    figure.colorbar(filled, ax=grid, label="Friction reduction [%]", ticks=levels[::4])
    handles, labels = _legend(grid.flat)
    if handles:
        figure.legend(handles, labels, loc="outside upper center", ncols=len(labels))
    return figure


def _contours(axes: "Axes", part: "xr.Dataset", across: str, up: str, levels: Floats) -> Any:
    from matplotlib.patheffects import Normal, Stroke

    x, y, reduction = _surface(part, across, up)
    shown = np.clip(100 * reduction, 0, 100)
    filled = axes.contourf(x, y, shown, levels=levels, cmap="cividis")
    if np.isfinite(shown).any() and np.nanmax(shown) - np.nanmin(shown) > 1:
        lines = axes.contour(x, y, shown, levels=levels[2:-1:2], colors="white", linewidths=0.6)
        for label in axes.clabel(lines, fmt="%d", fontsize=6, inline=False):
            label.set_path_effects([Stroke(linewidth=2, foreground="#2a3f6e"), Normal()])
            place = (label.get_position()[0] - x[0]) / (x[-1] - x[0])
            label.set_visible(0.05 < place < 0.95)  # those at the edge are cut
    axes.grid(visible=False)
    if "sufficient_power" in part and up == "actuator_power":
        ridge = part["sufficient_power"].values
        if np.isfinite(ridge).any():
            halo = [Stroke(linewidth=3.4, foreground="white"), Normal()]
            axes.plot(x, ridge, "--", color="black", lw=1.6, path_effects=halo, label=_RIDGE)
    return filled


def _measured(
    axes: "Axes",
    part: "xr.Dataset",
    measured: "xr.Dataset",
    across: str,
    up: str,
    panel: str | None,
    levels: Floats,
) -> None:
    own = measured
    if panel is not None and panel in measured:
        own = measured.isel(run=np.isclose(measured[panel].values, float(part[panel]), rtol=1e-3))
    if not own.sizes["run"]:
        return
    x, y = own[across].values * _AXES[across][0], own[up].values * _AXES[up][0]
    percent = 100 * own["friction_reduction"].values
    colours = {"c": percent, "cmap": "cividis", "vmin": levels[0], "vmax": levels[-1]}
    axes.scatter(x, y, s=30, edgecolors="white", zorder=4, clip_on=False, **colours)
    axes.scatter([], [], s=30, facecolors="0.6", edgecolors="black", label=measured.attrs.get("title", _MEASURED))
    box = {"boxstyle": "round,pad=0.1", "fc": "white", "ec": "none", "alpha": 0.8}
    for at, reduction in zip(zip(x, y, strict=True), percent, strict=True):
        axes.annotate(
            f"{reduction:.0f}", at, xytext=(6, -3), textcoords="offset points", fontsize=7, bbox=box, zorder=6
        )


def measured_figure(mapped: "xr.Dataset", runs: "xr.Dataset") -> "Figure":
    """Return a map of measured runs: friction reduction between them, and how uncertain it is.

    Parameters
    ----------
    mapped : xarray.Dataset
        With `friction_reduction` and `friction_reduction_uncertainty` over both axes, and its kind as `map`.
    runs : xarray.Dataset
        The measured runs, over `run`.

    Returns
    -------
    matplotlib.figure.Figure
    """
    from matplotlib.figure import Figure

    across, up, _ = PLACES[mapped.attrs["map"]]
    x, y, reduction = _surface(mapped, across, up)
    uncertainty = 100 * mapped["friction_reduction_uncertainty"].transpose(mapped[up].dims[0], mapped[across].dims[0])
    figure = Figure(figsize=(8.0, 3.6))
    left, right = figure.subplots(1, 2, sharex=True, sharey=True)
    levels = _levels(mapped, runs)
    drawn = left.contourf(x, y, np.clip(100 * reduction, 0, 100), levels=levels, cmap="cividis")
    figure.colorbar(drawn, ax=left, label="Friction reduction [%]", ticks=levels[::4])
    figure.colorbar(right.contourf(x, y, uncertainty, levels=8, cmap="Greys"), ax=right, label="Its uncertainty [%]")
    for axes in (left, right):
        places = (runs[name].values * _AXES[name][0] for name in (across, up))
        axes.plot(*places, "o", ms=4, mfc="white", color="black", clip_on=False, label="measured runs")
        axes.set_xlabel(_AXES[across][1])
        axes.grid(visible=False)
    left.set_ylabel(_AXES[up][1])
    figure.legend(*left.get_legend_handles_labels(), loc="outside upper center")
    return figure


def map_page(mapped: "xr.Dataset") -> str:
    """Return a map as one page of HTML that needs nothing else: its points tell their numbers under the pointer.

    Parameters
    ----------
    mapped : xarray.Dataset
        As one of `MAPS` returns it.

    Returns
    -------
    str

    Raises
    ------
    InvalidInput
        If Plotly is missing.
    """
    try:
        from plotly.graph_objects import Contour
        from plotly.subplots import make_subplots
    except ImportError:
        raise InvalidInput(
            "an interactive map needs Plotly, which is not installed: pip install 'sonolube[web]', or take PNG or PDF"
        ) from None
    across, up, panel = PLACES[mapped.attrs["map"]]
    parts = _parts(mapped, panel)
    columns = _columns(len(parts))
    titles = None if panel is None else [_told(part, panel) for part in parts]
    page = make_subplots(rows=-(-len(parts) // columns), cols=columns, subplot_titles=titles)
    for index, part in enumerate(parts):
        x, y, reduction = _surface(part, across, up)
        drawn = Contour(
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
        page.add_trace(drawn, row=row, col=column)
        page.update_xaxes(title_text=_AXES[across][1], row=row, col=column)
        page.update_yaxes(title_text=_AXES[up][1], row=row, col=column)
    page.update_layout(title=mapped.attrs["title"])
    return str(page.to_html(include_plotlyjs=True, full_html=True))


def _columns(panels: int) -> int:
    return panels if panels <= 3 else 3 if panels in (5, 6, 9) else 4


def _levels(mapped: "xr.Dataset", measured: "xr.Dataset | None") -> Floats:
    """Return levels from 0 to what is reached, in steps of 5 percent and to a multiple of 20."""
    reached = [mapped["friction_reduction"].values]
    if measured is not None:
        reached.append(measured["friction_reduction"].values)
    most = max((float(np.nanmax(values)) for values in reached if np.isfinite(values).any()), default=1.0)
    return np.arange(0.0, 20 * max(np.ceil(5 * min(most, 1.0)), 1) + 1, _STEP)


def _parts(mapped: "xr.Dataset", panel: str | None) -> "list[xr.Dataset]":
    return [mapped] if panel is None else [mapped.isel({panel: index}) for index in range(mapped.sizes[panel])]


def _surface(part: "xr.Dataset", across: str, up: str) -> tuple[Floats, Floats, Floats]:
    x, y = part[across], part[up]
    reduction = part["friction_reduction"].transpose(y.dims[0], x.dims[0]).values
    return x.values * _AXES[across][0], y.values * _AXES[up][0], reduction


def _told(part: "xr.Dataset", panel: str) -> str:
    if panel == "voltage_peak_to_peak":
        volts, watts = float(part[panel]), float(part["actuator_power"])
        return f"{format_si(volts, 'V')}, {format_si(watts, 'W')}"
    return f"{format_si(float(part[panel]), 'N')}, {format_si(float(part['nominal_pressure']), 'Pa')}"


def _legend(grid: Any) -> tuple[list[Any], list[str]]:
    found: dict[str, Any] = {}
    for axes in grid:
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            found.setdefault(label, handle)
    return list(found.values()), list(found)
