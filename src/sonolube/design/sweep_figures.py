"""Figures of parameter sweeps, with axes over quantities of the vocabulary and levels of contours."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.charts import Axis, Band, Chart, Field, Line, Panel, Part, Points, one_panel
from sonolube.checks import Floats
from sonolube.rig.figures import predicted_parts
from sonolube.text.units import format_quantity
from sonolube.vocabulary import quantities

if TYPE_CHECKING:
    import xarray as xr

_RATIO_TOLERANCE = 1e-6  # relative, within which ratios of neighbouring values count as equal
_SCALE_TOLERANCE = 1e-6  # relative, within which a scale is a power of ten
_STEPS = (1.0, 2.0, 2.5, 5.0, 10.0)  # between contour levels, times a power of ten


def scaled_axis(name: str, values: ArrayLike) -> tuple[float, Axis]:
    """Scale from SI to a unit that suits the values of a quantity, and the axis in that unit.

    `axis`: Such as "Sliding speed" in "mm/s"; logarithmic where the values are a geometric sequence.
    """
    array = np.asarray(values, dtype=np.float64)
    known = quantities().get(name)
    if known is None:
        label, unit = name.replace("_", " "), ""
        label = label[:1].upper() + label[1:]
    else:
        label, unit = known.meaning, known.unit
    largest = float(np.abs(array[np.isfinite(array)]).max(initial=0.0))
    scale = 1.0
    if unit and largest:
        number, _, unit = format_quantity(largest, name, digits=9).partition(" ")
        unit = unit.replace("u", "µ", 1) if unit.startswith("u") else unit
        scale = float(number) / largest
        power = 10.0 ** round(np.log10(scale))
        scale = power if abs(scale / power - 1) < _SCALE_TOLERANCE else scale
    return scale, Axis(label, unit, logarithmic=_is_geometric(array))


def contour_levels(values: Floats, *, steps: int = 18) -> Floats:
    """Round levels of contours about all known values, ascending by equal steps; two at least."""
    known = values[np.isfinite(values)]
    low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)
    least = max(high - low, 1e-6 * max(abs(low), abs(high)), 1e-12) / steps
    power = 10.0 ** np.floor(np.log10(least))
    step = power * next(each for each in _STEPS if each * power >= least * (1 - 1e-9))
    first, last = np.floor(low / step + 1e-9), np.ceil(high / step - 1e-9)
    levels: Floats = step * np.arange(first, max(last, first + 1) + 1)
    return levels


def _is_geometric(values: Floats) -> bool:
    """Whether values along an axis have one ratio to their neighbours."""
    if values.ndim != 1 or values.size < 3 or not values.min() > 0:
        return False
    ratios = values[1:] / values[:-1]
    return bool(ratios[0] != 1 and np.ptp(ratios) < _RATIO_TOLERANCE * ratios[0])


_OUTCOME = "friction_ratio"
_OUTCOME_LABEL = "Friction ratio, with over without vibration"
_LABELS = {
    _OUTCOME: "Friction ratio",
    "vibration_amplitude": "Amplitude",
    "power_to_supply": "Power to supply",
    "dissipated_power": "Power dissipated",
}
_MAX_SAMPLED = 50_000  # points from which quantiles are computed
_MAX_DRAWN = 3_000  # of these, drawn in a panel
_FAMILY_SIZE = 7  # values up to which each is drawn as a curve of its own
_BINS = 20
_MARGIN = 0.05  # of the friction ratio, beyond its ends
_MAX_MARKED = 60  # points of a curve up to which each has a marker


def sweep_chart(swept: "xr.Dataset") -> Chart:
    """Friction ratio over the swept keys.

    Parameters
    ----------
    swept : xarray.Dataset
        Result of `sweep`.

    Returns
    -------
    Chart
        For one key curves of friction ratio, amplitude and powers; for a grid of two keys a family of curves or a
        contour map; for more keys, and for points of a list or a Latin hypercube, the scatter of the friction ratio
        over each key, with its median and 90 % range.
    """
    names = swept_variables(swept)
    if swept[_OUTCOME].dims == ("point",) or len(names) > 2:
        return _scatter(swept, names)
    if len(names) == 1:
        return _curves(swept, names[0])
    few = [name for name in names if _is_text(swept, name) or swept[name].size <= _FAMILY_SIZE]
    if few:
        family = min(few, key=lambda name: (not _is_text(swept, name), swept[name].size))
        return _family_of_curves(swept, x_name=next(name for name in names if name != family), family=family)
    return _contour_map(swept, *names)


def swept_variables(swept: "xr.Dataset") -> list[str]:
    """Names of the coordinates of a sweep that are swept keys, in the order of the plan.

    Parameters
    ----------
    swept : xarray.Dataset
        Result of `sweep`.

    Returns
    -------
    list of str
    """
    return [str(name) for name, array in swept.variables.items() if "key" in array.attrs]


def _curves(swept: "xr.Dataset", name: str) -> Chart:
    """Curves of friction ratio, amplitude and powers over one key, a panel for each that is known."""
    own = _quantity_name(swept, name)
    others = [outcome for outcome in _LABELS if outcome != own]
    known = [each for each in others if each == _OUTCOME or np.isfinite(swept[each].values).any()]
    x, x_axis = _axis(swept, name)
    panels = []
    for outcome in known:
        values = swept[outcome].values
        scale, axis = scaled_axis(outcome, values)
        beside = predicted_parts(swept, x) if outcome == _OUTCOME else ()
        label = str(swept.attrs.get("friction_model", "friction model")) if beside else ""
        part: Part = Line(x=x, y=scale * values, marker=_marker(x, 0), label=label)
        if _is_text(swept, name):
            part = Points(x=x, y=scale * values, label=label)
        y_axis = Axis(_LABELS[outcome], axis.unit)
        panels.append(Panel(x=x_axis, y=y_axis, parts=(*beside, part)))
    columns = min(len(known), 2)
    unknown = ", ".join(_LABELS[each].lower() for each in others if each not in known)
    return Chart(
        panels=tuple(panels),
        size=(7.2, 2.3 * -(-len(known) // 2)) if columns > 1 else (5.2, 3.4),
        columns=columns,
        title=f"Not known here: {unknown}" if unknown else "",
    )


def _family_of_curves(swept: "xr.Dataset", *, x_name: str, family: str) -> Chart:
    """Curves of the friction ratio over one key, one for each value of the other."""
    x, axis = _axis(swept, x_name)
    ratio, labels = swept[_OUTCOME].transpose(family, x_name).values, _value_labels(swept, family)
    bands = [
        part
        for place in sorted({0, len(labels) - 1})
        for part in predicted_parts(swept.isel({family: place}), x, colour=place, of=labels[place])
    ]
    lines = tuple(
        Line(x=x, y=row, label=label, colour=place, dash=place, marker=_marker(x, place))
        for place, (row, label) in enumerate(zip(ratio, labels, strict=True))
    )
    return one_panel(
        axis,
        Axis(_OUTCOME_LABEL),
        (*bands, *lines),
        size=(5.6, 3.6),
        legend="right",
        legend_title=_axis(swept, family)[1].label,
    )


def _contour_map(swept: "xr.Dataset", x_name: str, y_name: str) -> Chart:
    """Filled contours of the friction ratio over two keys."""
    (x, x_axis), (y, y_axis) = _axis(swept, x_name), _axis(swept, y_name)
    ratio = swept[_OUTCOME].transpose(y_name, x_name).values
    field = Field(x=x, y=y, values=ratio, label=_OUTCOME_LABEL, levels=contour_levels(ratio))
    return one_panel(x_axis, y_axis, (field,), size=(5.2, 3.8))


def _scatter(swept: "xr.Dataset", names: list[str]) -> Chart:
    """Scatter of the friction ratio over each key, with median and 90 % range, a panel each."""
    columns = min(len(names), 3)
    rows = -(-len(names) // columns)
    ratio = swept[_OUTCOME]
    sampled = _sampled_points(ratio.size)
    indices = dict(zip(ratio.dims, np.unravel_index(sampled, ratio.shape), strict=True))
    y = ratio.values.ravel()[sampled]
    drawn = np.random.default_rng(0).permutation(sampled.size)[:_MAX_DRAWN]
    panels = []
    for name in names:
        values, axis = _axis(swept, name)
        x = values[indices[swept[name].dims[0]]]
        centre, low, median, high = _binned_quantiles(x, y)
        parts = (
            Points(x=x[drawn], y=y[drawn], colour="0.7", label="points", is_faint=True),
            Band(x=centre, low=low, high=high, label="90 % of them", opacity=0.2),
            Line(x=centre, y=median, label="median"),
        )
        panels.append(Panel(x=axis, y=_height(y), parts=parts))
    size = (2.5 * columns + 0.7, 2.5 * rows + 0.4)
    return Chart(panels=tuple(panels), size=size, columns=columns, legend="top", shares_y=True)


def _height(ratio: Floats) -> Axis:
    """Axis of the friction ratio with the same ends in all rows."""
    known = ratio[np.isfinite(ratio)]
    if not known.size:
        return Axis("Friction ratio")
    margin = max(_MARGIN * float(np.ptp(known)), 1e-3)
    return Axis("Friction ratio", lowest=float(known.min()) - margin, highest=float(known.max()) + margin)


def _marker(x: Floats, number: int) -> int | None:
    """Number of the marker of a curve; none where it has many points."""
    return number if x.size <= _MAX_MARKED else None


def _binned_quantiles(x: Floats, y: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Bin centres and the 5, 50 and 95 % quantiles there; a bin per distinct value of few, else of equal counts."""
    valid = np.isfinite(y)
    x, y = x[valid], y[valid]
    if x.size == 0:
        return (np.empty(0),) * 4
    distinct = np.unique(x)
    if distinct.size <= 3 * _BINS:
        bins = [(value, y[x == value]) for value in distinct]
    else:
        parts = np.array_split(np.argsort(x), _BINS)
        bins = [(float(np.median(x[part])), y[part]) for part in parts]
    centre, low, median, high = np.array([[value, *np.quantile(own, (0.05, 0.5, 0.95))] for value, own in bins]).T
    return centre, low, median, high


def _sampled_points(points: int) -> NDArray[np.intp]:
    """Flat indices of all points, or of a random subset of many."""
    if points <= _MAX_SAMPLED:
        return np.arange(points)
    return np.unique(np.random.default_rng(0).integers(0, points, _MAX_SAMPLED))


def _axis(swept: "xr.Dataset", name: str) -> tuple[Floats, Axis]:
    """Values of a swept key in the unit of its axis, and that axis between its ends; text values are numbered."""
    values, quantity = swept[name].values, _quantity_name(swept, name)
    if _is_text(swept, name):
        words = list(dict.fromkeys(map(str, values)))
        numbers = np.array([words.index(str(value)) for value in values], dtype=np.float64)
        texts = tuple(word.replace("_", " ") for word in words)
        return numbers, replace(scaled_axis(quantity, 1.0)[1], words=texts, lowest=-0.5, highest=len(words) - 0.5)
    scale, axis = scaled_axis(quantity, values)
    return scale * values, axis


def _value_labels(swept: "xr.Dataset", name: str) -> list[str]:
    """Values of a swept key as text with their unit."""
    values, axis = _axis(swept, name)
    return [axis.words[int(each)] if axis.words else f"{each:.4g} {axis.unit}".strip() for each in values]


def _quantity_name(swept: "xr.Dataset", name: str) -> str:
    """Name of the quantity of a swept key: its last word."""
    return str(swept[name].attrs["key"]).rpartition(".")[2]


def _is_text(swept: "xr.Dataset", name: str) -> bool:
    """Whether the values of a swept key are text."""
    return swept[name].dtype.kind not in "fiu"
