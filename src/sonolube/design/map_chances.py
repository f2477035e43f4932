"""Chances of a friction reduction over a map: the variable of its dataset, its contours, and where they suffice."""

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from sonolube.charts import Chart, Field, Panel
from sonolube.checks import Floats
from sonolube.design.map_figures import AXES, map_layout, panel_title, panels_of, surface
from sonolube.prediction.chances import ReductionChances, odds_text
from sonolube.text.units import format_si
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr

CHANCE: Final = "reduction_chance"
"""Variable of a map: probability that the target is reached."""

_LEVELS: Final = np.linspace(0.0, 100.0, 11)  # percent


def with_chances(computed: "xr.Dataset", chances: ReductionChances, *, friction_reduction: float) -> "xr.Dataset":
    """Map with the chance of a reduction at each of its points, by the amplitude there.

    Parameters
    ----------
    computed : xarray.Dataset
        Result of a function of `MAPS`.
    chances : ReductionChances
    friction_reduction : float
        Target. []

    Returns
    -------
    xarray.Dataset
        With `reduction_chance`, NaN where the map has no result, and the attribute `target_reduction`.
    """
    amplitude, other = computed["vibration_amplitude"], "frequency" if "frequency" in computed.dims else "sliding_speed"
    over = computed[other].broadcast_like(amplitude).transpose(*amplitude.dims).values
    found = chances.over_grid(friction_reduction, amplitude.values, over, name=other)
    known = np.where(computed["friction_reduction"].transpose(*amplitude.dims).isnull(), np.nan, found)
    labels = {"units": "1", "long_name": quantity(CHANCE).meaning}
    return computed.assign({CHANCE: (amplitude.dims, known, labels)}).assign_attrs(target_reduction=friction_reduction)


def chance_chart(computed: "xr.Dataset", *, confidence: float | None = None) -> Chart:
    """Contours of the chance that the target of a map is reached, a line where it is as high as wanted.

    Parameters
    ----------
    computed : xarray.Dataset
        By `with_chances`.
    confidence : float, optional
        Chance that is wanted.

    Returns
    -------
    Chart
    """
    x_name, y_name, panel = map_layout(computed)
    parts, panel = panels_of(computed, panel)
    target = f"Chance of {100 * computed.attrs['target_reduction']:.3g} % less friction"
    panels = []
    for part in parts:
        x, y, values = surface(part, x_name, y_name, of=CHANCE)
        field = Field(
            x=x, y=y, values=100 * values, label=target, unit="%", levels=_LEVELS, lines=_lines(values, confidence)
        )
        title = "" if panel is None else panel_title(part, panel)
        panels.append(Panel(x=AXES[x_name][1], y=AXES[y_name][1], parts=(field,), title=title))
    columns = min(len(panels), 4)
    rows = -(-len(panels) // columns)
    size = (4.8, 3.6) if len(panels) == 1 else (2.35 * columns + 0.9, 2.3 * rows + 0.5)
    shares = len(panels) > 1
    return Chart(panels=tuple(panels), size=size, columns=columns, shares_x=shares, shares_y=shares)


def chance_facts(computed: "xr.Dataset", *, confidence: float | None = None) -> list[tuple[str, str]]:
    """Highest chance of the target on a map, and the least setting at which it is as high as wanted."""
    chance, target = computed[CHANCE], 100 * float(computed.attrs["target_reduction"])
    if chance.isnull().all():
        return [("chance", f"of {target:.3g} % less friction: no point has a result")]
    best = _at(computed, int(np.nanargmax(chance.values)))
    facts = [("chance", f"of {target:.3g} % less friction, at most {odds_text(float(np.nanmax(chance)))}: {best}")]
    if confidence is None:
        return facts
    _, up, _ = map_layout(computed)
    reached = chance.values >= confidence
    if not reached.any():
        text = f"{odds_text(confidence)} are reached nowhere on this map; one run of your own would tell"
        return [*facts, ("wanted", text)]
    levels = np.where(reached, computed[up].broadcast_like(chance).transpose(*chance.dims).values, np.inf)
    text = f"{odds_text(confidence)} first at {_at(computed, int(np.argmin(levels)))}"
    return [*facts, ("wanted", text)]


def chance_object(computed: "xr.Dataset", *, confidence: float | None) -> dict[str, Any]:
    """Target, wanted chance and highest chance of a map, for JSON."""
    chance = computed[CHANCE]
    highest = None if chance.isnull().all() else float(np.nanmax(chance))
    return {
        "target_reduction": float(computed.attrs["target_reduction"]),
        "confidence": confidence,
        "highest_chance": highest,
    }


def _at(computed: "xr.Dataset", place: int) -> str:
    """Settings of a point of a map, in words."""
    chance = computed[CHANCE]
    index = dict(zip(chance.dims, np.unravel_index(place, chance.shape), strict=True))
    point = computed.isel({name: int(at) for name, at in index.items()})
    names = [*chance.dims, *(name for name in ("power_to_supply",) if name in computed.coords)]
    return ", ".join(format_si(float(point[name]), quantity(str(name)).unit) for name in names)


def _lines(values: Floats, confidence: float | None) -> Floats | None:
    """Levels drawn as lines: each fifth, and the chance that is wanted; none where all values are alike."""
    known = values[np.isfinite(values)]
    if not known.size or np.ptp(known) < 0.01:
        return None
    return _LEVELS[2:-1:2] if confidence is None else np.union1d(_LEVELS[2:-1:2], [100 * confidence])
