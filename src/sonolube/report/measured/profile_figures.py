"""Charts of line profiles: heights before and after the filter, and power spectrum."""

import numpy as np

from sonolube.charts import Axis, Chart, Line, Panel, Part, Rule, envelope, one_panel
from sonolube.models.surfaces import ProfileEvaluation, ProfileSpectrum
from sonolube.report.measured.sheet import captioned
from sonolube.report.measured.surface_figures import WAVENUMBER, length_scale

_BINS = 5000  # along the page, more than it resolves


@captioned("Profile", "Above, the primary profile without form; below, the profile evaluated, with its sections.")
def profile_figure(found: ProfileEvaluation, *, spacing: float) -> Chart:
    """Primary profile above the one evaluated."""
    x = spacing * np.arange(found.primary.size, dtype=np.float64)
    across, per_metre = length_scale(x)
    edges = found.start * spacing + found.section_length * np.arange(found.section_count + 1)
    marks = [Rule(value=per_metre * float(edge), colour="0.5") for edge in edges]
    zero = Rule(value=0.0, along="y", colour="0.5", dash=0)
    panels = []
    for heights, start, colour, others in (
        (found.primary, 0, 0, ()),
        (found.evaluated, found.start, 1, (*marks, zero)),
    ):
        unit, scale = length_scale(heights)
        place, height = envelope(per_metre * x[start : start + heights.size], scale * heights, bins=_BINS)
        parts: tuple[Part, ...] = (Line(x=place, y=height, colour=colour, weight=0.6), *others)
        panels.append(Panel(x=Axis("x", across), y=Axis("Height", unit), parts=parts))
    return Chart(panels=tuple(panels), size=(7.4, 4.2), shares_x=True)


@captioned("Power spectrum", "Of the primary profile, two-sided; dashed, the cutoff of the L-filter.")
def spectrum_figure(found: ProfileSpectrum, *, cutoff: float | None) -> Chart:
    """Power spectral density of a profile."""
    inner = (found.wavenumber > 0) & (found.profile_spectral_density > 0)
    curve = Line(x=found.wavenumber[inner], y=found.profile_spectral_density[inner], weight=0.6)
    filtered = () if cutoff is None else (Rule(value=1 / cutoff, colour="0.3", dash=1),)
    density = Axis("Power spectral density", "m³", logarithmic=True)
    return one_panel(WAVENUMBER, density, (curve, *filtered), size=(4.6, 3.2))
