"""Figure of an answer, or of a labelled result read again from its file."""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING

from sonolube.errors import InvalidInput
from sonolube.figure import fit_to_style, publication_style, shown_in_notebooks
from sonolube.tasks.answer import Answer

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

_FIGURES: Mapping[str, str] = MappingProxyType(
    {
        "comparison": "sonolube.validation.figures:comparison_figure",
        "map": "sonolube.design.map_figures:map_figure",
        "prediction": "sonolube.prediction.figures:prediction_figure",
        "simulation": "sonolube.rig.figures:simulation_figure",
        "sweep": "sonolube.design.sweep_figures:sweep_figure",
    }
)
"""Functions that draw a dataset, by its attribute `result`."""


def plot(result: "Answer | xr.Dataset", *, title: str | None = None, style: str | None = None) -> "Figure":
    """Return the figure of an answer.

    Parameters
    ----------
    result : Answer or xarray.Dataset
        Of any task with a figure; or the dataset of `simulate`, `predict`, `sweep`, `map` or `compare`, such as one
        read again from its netCDF file.
    title : str, optional
        Of which figure of an answer, such as "axial 1"; the first where absent.
    style : str, optional
        Key of `sonolube.figure.FIGURE_STYLES`: "journal" or "slides".

    Returns
    -------
    matplotlib.figure.Figure
        A notebook shows it where it is the value of a cell.

    Raises
    ------
    InvalidInput
        If the result has no figure.
    UnknownName
        If it has none of that title.
    """
    if isinstance(result, Answer):
        return result.plot(title, style=style)
    kind = str(getattr(result, "attrs", {}).get("result", type(result).__name__))
    if kind not in _FIGURES:
        raise InvalidInput(f"plot draws answers of tasks, and datasets of {', '.join(_FIGURES)}, got {kind}")
    with publication_style(style):
        figure = _drawer(kind)(result)
        fit_to_style(figure)
    return shown_in_notebooks(figure)


def _drawer(kind: str) -> "Callable[[xr.Dataset], Figure]":
    """Function that draws datasets of a kind."""
    from importlib import import_module

    module, _, name = _FIGURES[kind].partition(":")
    drawer: Callable[[xr.Dataset], Figure] = getattr(import_module(module), name)
    return drawer
