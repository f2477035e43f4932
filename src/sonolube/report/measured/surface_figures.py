"""Charts of height maps: heights, Abbott curve, spectrum and autocorrelation."""

from typing import Final

import numpy as np

from sonolube.charts import Axis, Bars, Chart, Field, Line, Note, Panel, Part, Rule, one_panel
from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.models.surfaces import (
    Autocorrelation,
    HeightMap,
    MaterialRatioCurve,
    RadialSpectrum,
    functional_parameters,
)
from sonolube.models.surfaces.resampling import block_means
from sonolube.report.measured.sheet import captioned

_CELLS: Final = 700  # along the longer side, more than a page resolves
_LONGEST: Final = 2000.0  # of a unit, before the next is taken
_BINS: Final = 80  # of heights
WAVENUMBER: Final = Axis("Wavenumber", "1/m", logarithmic=True, reciprocal=(1e6, "Wavelength [µm]"))
"""Axis of a spectrum, with the wavelength above."""


@captioned("Heights", "The surface as evaluated, levelled and filtered; what was not measured is left white.")
def heights(surface: HeightMap) -> Chart:
    """Height map, and a profile through its middle."""
    unit, scale = length_scale(surface.height)
    across, per_metre = length_scale(surface.x)
    row = surface.height.shape[0] // 2
    x = surface.x * per_metre
    at = Line(x=x[[0, -1]], y=np.full(2, surface.y[row] * per_metre), colour="0", dash=1, weight=0.6, has_halo=True)
    profile = Panel(
        x=Axis("x", across), y=Axis("Height", unit), parts=(Line(x=x, y=surface.height[row] * scale, weight=0.6),)
    )
    return Chart(panels=(map_panel(surface, at), profile), size=(7.4, 3.0), columns=2, widths=(1.15, 1))


def map_panel(surface: HeightMap, *others: Part, most: int = _CELLS) -> Panel:
    """Heights as colours, means over blocks in large maps, and further parts on them.

    The ends of the scale are the 0.1 and 99.9 % quantiles; cells that were not measured are left out.
    """
    unit, scale = length_scale(surface.height)
    across, per_metre = length_scale(surface.x)
    cells = block_means(surface, most=most)
    lowest, highest = (scale * float(np.nanquantile(surface.height, share)) for share in (0.001, 0.999))
    field = Field(
        x=per_metre * cells.x,
        y=per_metre * cells.y,
        values=scale * cells.height,
        label="Height",
        unit=unit,
        lowest=lowest,
        highest=highest,
    )
    rows, columns = surface.height.shape
    left, right = (per_metre * surface.spacing_x * (column - 0.5) for column in (0, columns))
    top, bottom = (per_metre * surface.spacing_y * (row - 0.5) for row in (0, rows))
    return Panel(
        x=Axis("x", across, lowest=left, highest=right),
        y=Axis("y", across, lowest=bottom, highest=top),  # the first row is the top
        parts=(field, *others),
        has_equal_scales=True,
    )


def length_scale(lengths: Floats) -> tuple[str, float]:
    """Unit in which lengths have readable numbers, and its number in a metre."""
    spread = float(np.nanquantile(lengths, 0.99) - np.nanquantile(lengths, 0.01))
    return next(((unit, scale) for unit, scale in (("nm", 1e9), ("µm", 1e6)) if spread * scale < _LONGEST), ("mm", 1e3))


def abbott(curve: MaterialRatioCurve) -> Chart:
    """Material ratio curve with the equivalent line of its core, beside the histogram of heights."""
    unit, scale = length_scale(curve.height)
    counts, edges = np.histogram(scale * curve.height, bins=_BINS)
    middles, width = (edges[1:] + edges[:-1]) / 2, float(edges[1] - edges[0])
    bars = Bars(places=middles, lengths=100 * counts / curve.height.size, breadth=width, colour=5)
    stride = max(1, curve.height.size // 4000)
    ratio = Line(x=100 * curve.material_ratio[::stride], y=scale * curve.height[::stride], label="material ratio")
    y = Axis("Height above the mean", unit)
    panels = (
        Panel(x=Axis("Pixels", "%"), y=y, parts=(bars,)),
        Panel(x=Axis("Material ratio", "%", lowest=0.0, highest=100.0), y=y, parts=(ratio, *_core(curve, scale))),
    )
    return Chart(panels=panels, size=(6.4, 3.2), columns=2, widths=(1, 2.2), shares_y=True)


def _core(curve: MaterialRatioCurve, scale: float) -> tuple[Part, ...]:
    """Equivalent line of the core with its material ratios; nothing where the curve has no core."""
    try:
        core = functional_parameters(curve)
    except InvalidInput:
        return ()
    first, second = core.peak_material_ratio, core.valley_material_ratio
    top, bottom = (scale * float(height) for height in curve.height_at(material_ratio=[first, second]))
    ends = np.array([0.0, 100.0])
    return (
        Line(x=ends, y=np.array([top, bottom]), label="equivalent line of the core", colour=1, dash=1, weight=0.85),
        Line(x=np.array([0.0, 100 * first]), y=np.full(2, top), colour=1, weight=0.6),
        Line(x=np.array([100 * second, 100.0]), y=np.full(2, bottom), colour=1, weight=0.6),
        Note(x=100 * first, y=top, text=f"Smr1 {first:.0%}"),
        Note(x=100 * second, y=bottom, text=f"Smr2 {second:.0%}", side="left"),
    )


@captioned(
    "Power spectrum", "Areal power spectral density, averaged over direction; least certain at the ends of the grid."
)
def spectrum(radial: RadialSpectrum) -> Chart:
    """Radially averaged power spectral density."""
    inner = radial.wavenumber > 0
    curve = Line(x=radial.wavenumber[inner], y=radial.areal_spectral_density[inner])
    density = Axis("Power spectral density", "m⁴", logarithmic=True)
    return one_panel(WAVENUMBER, density, (curve,), size=(4.6, 3.2))


@captioned("Autocorrelation", "Along rows and columns; Sal is where it first falls to 0.2 in any direction.")
def correlation(found: Autocorrelation) -> Chart:
    """Autocorrelation along rows and columns."""
    rows, columns = (size // 2 for size in found.normalized.shape)
    unit, scale = length_scale(found.lag_x)
    along_rows, along_columns = scale * found.lag_x[columns:], scale * found.lag_y[rows:]
    parts = (
        Line(x=along_rows, y=found.normalized[rows, columns:], label="along rows"),
        Line(x=along_columns, y=found.normalized[rows:, columns], label="along columns", colour=1, dash=1),
        Rule(value=0.2, along="y", colour="0.5"),
        Note(x=float(max(along_rows[-1], along_columns[-1])), y=0.2, text="0.2", side="above"),
    )
    return one_panel(Axis("Lag", unit, lowest=0.0), Axis("Autocorrelation"), parts, size=(4.6, 3.0))
