"""Figure of a result: the very one that the command of the same name writes."""

from collections.abc import Callable, Mapping
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING

import xarray as xr

from sonolube.design import map_figure, sweep_figure
from sonolube.errors import InvalidInput, UnknownName
from sonolube.figure import fit_to_style, publication_style
from sonolube.models.fem.figures import ShapedSurface, mode_figure
from sonolube.models.fem.mode_files import frequency_text
from sonolube.prediction.figures import prediction_figure
from sonolube.report.measured.sheet import Sheet
from sonolube.rig.figures import simulation_figure
from sonolube.validation.figures import comparison_figure
from sonolube.validation.runs_figures import runs_fit_figure
from sonolube.validation.runs_fit import RunsFit

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def modes_figure(result: xr.Dataset) -> "Figure":
    """Deformed surface of a part in the first mode of a result of `modes`.

    Parameters
    ----------
    result : xarray.Dataset

    Returns
    -------
    matplotlib.figure.Figure
    """
    one = result.isel(mode=0)
    surface = ShapedSurface(
        points=one["surface_point"].to_numpy(),
        triangles=one["surface_triangle"].to_numpy(),
        displacement=one["mode_shape"].to_numpy(),
    )
    frequency, error = (float(one[name]) for name in ("natural_frequency", "frequency_error"))
    text = frequency_text(frequency=frequency, relative_error=error)
    return mode_figure(surface, title=f"{one['mode'].item()}, {text}")


FIGURES: Mapping[str, Callable[[xr.Dataset], "Figure"]] = MappingProxyType(
    {
        "comparison": comparison_figure,
        "map": map_figure,
        "modes": modes_figure,
        "prediction": prediction_figure,
        "simulation": simulation_figure,
        "sweep": sweep_figure,
    }
)
"""Functions that draw a result, by its attribute `result`."""

_FIGURE_TITLES: Mapping[str, str] = MappingProxyType({"modes": "mode"})  # coordinate of results of several figures


def plot(result: xr.Dataset | Sheet | RunsFit, *, title: str | None = None, style: str | None = None) -> "Figure":
    """Return the figure of a result.

    Parameters
    ----------
    result : xarray.Dataset, Sheet or RunsFit
        Of `simulate`, `predict`, `sweep`, `map`, `compare` or `modes`, also read again from its netCDF file; of a
        function of `measure`; or of `fit`.
    title : str, optional
        Of which figure, for a sheet or for modes, which have several; the first by default.
    style : str, optional
        Key of `sonolube.figure.FIGURE_STYLES`: "journal" or "slides".

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InvalidInput
        If the result is of another kind, or the sheet has no figure.
    UnknownName
        If the result has no figure of that title.
    """
    with publication_style(style):
        figure = _drawer(result, title)()
        fit_to_style(figure)
        return figure


def _drawer(result: xr.Dataset | Sheet | RunsFit, title: str | None) -> "Callable[[], Figure]":
    """Function that draws a result."""
    if isinstance(result, Sheet):
        return _sheet_figure(result, title)
    if isinstance(result, RunsFit):
        return partial(runs_fit_figure, result)
    return _dataset_figure(result, title)


def _dataset_figure(result: xr.Dataset, title: str | None) -> "Callable[[], Figure]":
    """Function that draws a labelled result."""
    kind = str(result.attrs.get("result")) if isinstance(result, xr.Dataset) else type(result).__name__
    if kind not in FIGURES:
        raise InvalidInput(f"plot draws results of {', '.join(FIGURES)} and of measure and fit, got {kind}")
    if title is None:
        return partial(FIGURES[kind], result)
    along = _FIGURE_TITLES.get(kind)
    titles = [] if along is None else [str(name) for name in result[along].to_numpy()]
    if title not in titles:
        raise UnknownName.among(titles, kind=f"figure of {kind}", name=title)
    return partial(FIGURES[kind], result.sel({along: [title]}))


def _sheet_figure(result: Sheet, title: str | None) -> "Callable[[], Figure]":
    """Function that draws a figure of a sheet."""
    figures = {figure.title: figure.draw for figure in result.figures}
    if not figures:
        raise InvalidInput(f"{result.title}: nothing was found that could be drawn")
    if title is not None and title not in figures:
        raise UnknownName.among(list(figures), kind="figure", name=title)
    return figures[title or next(iter(figures))]
