"""Figure of an answer, or of a labelled result read again from its file."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from sonolube.charts import Chart
from sonolube.errors import InvalidInput
from sonolube.figure import figure_style, shown_in_notebooks
from sonolube.report import Drawing
from sonolube.tasks.answer import Answer
from sonolube.variants import VariantTable

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

_CHARTS: VariantTable[Callable[[Any], Chart]] = VariantTable(
    "result",
    {
        "comparison": "sonolube.validation.figures:comparison_chart",
        "map": "sonolube.design.map_figures:map_chart",
        "prediction": "sonolube.prediction.figures:prediction_chart",
        "simulation": "sonolube.rig.figures:simulation_chart",
        "sweep": "sonolube.design.sweep_figures:sweep_chart",
    },
)
"""Functions that return the chart of a dataset, by its attribute `result`."""


def plot(result: "Answer | xr.Dataset", *, title: str | None = None, style: str | None = None) -> "Figure":
    """Figure of an answer.

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

    Examples
    --------
    >>> import sonolube as sl
    >>> figure = sl.plot(sl.response("examples/rigs/tribometer.toml"))
    >>> figure.axes[-1].get_xlabel()
    'Frequency [kHz]'
    """
    if isinstance(result, Answer):
        return result.plot(title, style=style)
    kind = str(getattr(result, "attrs", {}).get("result", type(result).__name__))
    if kind not in _CHARTS:
        raise InvalidInput(f"plot draws answers of tasks, and datasets of {', '.join(_CHARTS)}, got {kind}")
    with figure_style(style):
        return shown_in_notebooks(Drawing(chart=lambda: _CHARTS[kind](result)).figure())
