"""Figures of height maps: heights, Abbott curve, spectrum and autocorrelation."""

from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.figure import COLOURS, LINES, subplots
from sonolube.models.surfaces import (
    Autocorrelation,
    HeightMap,
    MaterialRatioCurve,
    RadialSpectrum,
    functional_parameters,
)
from sonolube.report.measured.sheet import captioned

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_PIXELS = 700  # along the longer side, more than a page resolves
_LONGEST = 2000.0  # of a unit, before the next is taken


@captioned("Heights", "The surface as evaluated, levelled and filtered; what was not measured is left white.")
def heights(surface: HeightMap) -> "Figure":
    """Height map, and a profile through its middle."""
    figure, (left, right) = subplots(1, 2, figsize=(7.4, 3.0), width_ratios=(1.15, 1))
    unit, scale = length_scale(surface.height)
    across, per_metre = length_scale(surface.x)
    show_map(left, surface)
    row = surface.height.shape[0] // 2
    left.axhline(surface.y[row] * per_metre, color="white", linewidth=1.6)
    left.axhline(surface.y[row] * per_metre, color="black", linewidth=0.8, linestyle="--")
    right.plot(surface.x * per_metre, surface.height[row] * scale, linewidth=0.8)
    right.set(xlabel=f"x ({across})", ylabel=f"height ({unit})")
    return figure


def show_map(axes: "Axes", surface: HeightMap) -> None:
    """Draw heights as colours with their scale, whose ends are the 0.1 and 99.9 % quantiles."""
    unit, scale = length_scale(surface.height)
    across, per_metre = length_scale(surface.x)
    rows, columns = surface.height.shape
    step = max(1, max(rows, columns) // _PIXELS)
    shown = axes.imshow(
        scale * surface.height[::step, ::step],
        extent=(0.0, columns * surface.spacing_x * per_metre, rows * surface.spacing_y * per_metre, 0.0),
        cmap="cividis",
        vmin=scale * float(np.nanquantile(surface.height, 0.001)),
        vmax=scale * float(np.nanquantile(surface.height, 0.999)),
        interpolation="nearest",
    )
    axes.set(xlabel=f"x ({across})", ylabel=f"y ({across})")
    axes.grid(visible=False)
    axes.figure.colorbar(shown, ax=axes, label=f"height ({unit})", shrink=0.85, extend="both")


def length_scale(lengths: Floats) -> tuple[str, float]:
    """Unit in which lengths have readable numbers, and its number in a metre."""
    spread = float(np.nanquantile(lengths, 0.99) - np.nanquantile(lengths, 0.01))
    return next(((unit, scale) for unit, scale in (("nm", 1e9), ("µm", 1e6)) if spread * scale < _LONGEST), ("mm", 1e3))


@captioned("Abbott curve", "Share of the surface at or above each height, with the core by its equivalent line.")
def abbott(curve: MaterialRatioCurve) -> "Figure":
    """Material ratio curve with the equivalent line of its core, beside the histogram of heights."""
    figure, (left, right) = subplots(1, 2, figsize=(6.4, 3.2), width_ratios=(1, 2.2), sharey=True)
    unit, scale = length_scale(curve.height)
    share = np.full(curve.height.size, 100 / curve.height.size)
    left.hist(scale * curve.height, bins=80, weights=share, orientation="horizontal", color=COLOURS[5], linewidth=0)
    left.set(xlabel="pixels (%)", ylabel=f"height above the mean ({unit})")
    stride = max(1, curve.height.size // 4000)
    right.plot(100 * curve.material_ratio[::stride], scale * curve.height[::stride], label="material ratio")
    try:
        core = functional_parameters(curve)
    except InvalidInput:
        pass
    else:
        _core(right, curve, scale, core.peak_material_ratio, core.valley_material_ratio)
    right.set(xlabel="material ratio (%)", xlim=(0, 100))
    right.legend()
    return figure


def _core(axes: "Axes", curve: MaterialRatioCurve, scale: float, first: float, second: float) -> None:
    """Draw the equivalent line of the core with its material ratios."""
    top, bottom = (scale * float(height) for height in curve.height_at(material_ratio=[first, second]))
    axes.plot([0, 100], [top, bottom], LINES[1], color=COLOURS[1], linewidth=1.2, label="equivalent line of the core")
    axes.hlines([top, bottom], [0, 100 * second], [100 * first, 100], color=COLOURS[1], linewidth=0.8)
    for ratio, height, name, shift, side in (
        (first, top, "Smr1", (3, 4), "left"),
        (second, bottom, "Smr2", (-3, -11), "right"),
    ):
        place, text = (100 * ratio, height), f"{name} {ratio:.0%}"
        axes.annotate(text, place, xytext=shift, textcoords="offset points", fontsize=8, ha=side)


@captioned(
    "Power spectrum", "Areal power spectral density, averaged over direction; least certain at the ends of the grid."
)
def spectrum(radial: RadialSpectrum) -> "Figure":
    """Radially averaged power spectral density."""
    figure, axes = subplots(figsize=(4.6, 3.2))
    inner = radial.wavenumber > 0
    axes.loglog(radial.wavenumber[inner], radial.areal_spectral_density[inner])
    axes.set(xlabel="wavenumber (1/m)", ylabel="power spectral density (m⁴)")
    above = axes.secondary_xaxis("top", functions=(wavelength, wavelength))
    above.set_xlabel("wavelength (µm)")
    return figure


def wavelength(other: Any) -> Any:
    """Wavelength in um of a wavenumber in 1/m, and the inverse."""
    return 1e6 / np.maximum(np.asarray(other, dtype=np.float64), 1e-9)


@captioned("Autocorrelation", "Along rows and columns; Sal is where it first falls to 0.2 in any direction.")
def correlation(found: Autocorrelation) -> "Figure":
    """Autocorrelation along rows and columns."""
    figure, axes = subplots(figsize=(4.6, 3.0))
    rows, columns = (size // 2 for size in found.normalized.shape)
    unit, scale = length_scale(found.lag_x)
    axes.plot(scale * found.lag_x[columns:], found.normalized[rows, columns:], LINES[0], label="along rows")
    axes.plot(scale * found.lag_y[rows:], found.normalized[rows:, columns], LINES[1], label="along columns")
    axes.axhline(0.2, color="0.5", linewidth=0.8, linestyle=":")
    axes.text(1, 0.21, "0.2 ", transform=axes.get_yaxis_transform(), ha="right", fontsize=8)
    axes.set(xlabel=f"lag ({unit})", ylabel="autocorrelation", xlim=(0, None))
    axes.legend()
    return figure
