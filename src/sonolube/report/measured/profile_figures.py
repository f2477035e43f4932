"""Figures of line profiles: heights before and after the filter, and power spectrum."""

from typing import TYPE_CHECKING

import numpy as np

from sonolube.figure import COLOURS, LINES, subplots
from sonolube.models.surfaces import ProfileEvaluation, ProfileSpectrum
from sonolube.report.measured.sheet import captioned
from sonolube.report.measured.surface_figures import length_scale, wavelength

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_POINTS = 20000  # along the page, more than it resolves


@captioned("Profile", "Above, the primary profile without form; below, the profile evaluated, with its sections.")
def profile(found: ProfileEvaluation, *, spacing: float) -> "Figure":
    """Primary profile above the one evaluated.

    Parameters
    ----------
    found : ProfileEvaluation
    spacing : float
        Distance of neighbouring points. [m]

    Returns
    -------
    matplotlib.figure.Figure
    """
    figure, (upper, lower) = subplots(2, 1, figsize=(7.4, 4.2), sharex=True)
    x = spacing * np.arange(found.primary.size, dtype=np.float64)
    across, per_metre = length_scale(x)
    stride = max(1, x.size // _POINTS)
    for axes, heights, start, colour in (
        (upper, found.primary, 0, COLOURS[0]),
        (lower, found.evaluated, found.start, COLOURS[1]),
    ):
        unit, scale = length_scale(heights)
        at = x[start : start + heights.size]
        axes.plot(per_metre * at[::stride], scale * heights[::stride], color=colour, linewidth=0.8)
        axes.set(ylabel=f"height ({unit})")
    for section in range(found.section_count + 1):
        edge = found.start * spacing + section * found.section_length
        lower.axvline(per_metre * edge, color="0.5", linewidth=0.8, linestyle=":")
    lower.axhline(0.0, color="0.5", linewidth=0.6)
    lower.set(xlabel=f"x ({across})")
    return figure


@captioned("Power spectrum", "Of the primary profile, two-sided; dashed, the cutoff of the L-filter.")
def spectrum(found: ProfileSpectrum, *, cutoff: float | None) -> "Figure":
    """Power spectral density of a profile."""
    figure, axes = subplots(figsize=(4.6, 3.2))
    inner = (found.wavenumber > 0) & (found.profile_spectral_density > 0)
    axes.loglog(found.wavenumber[inner], found.profile_spectral_density[inner], linewidth=0.8)
    if cutoff is not None:
        axes.axvline(1 / cutoff, color="0.3", linewidth=1.0, linestyle=LINES[1])
    axes.set(xlabel="wavenumber (1/m)", ylabel="power spectral density (m$^3$)")
    above = axes.secondary_xaxis("top", functions=(wavelength, wavelength))
    above.set_xlabel("wavelength (µm)")
    return figure
