"""A height map as a page shows it: levelled or as measured, with what its form is, and sections along lines."""

from collections.abc import Sequence
from typing import Final, Literal

import numpy as np

from sonolube.charts import Axis, Chart, Line, envelope, one_panel
from sonolube.checks import Floats
from sonolube.models.surfaces import HeightMap, fit_form
from sonolube.models.surfaces.resampling import block_means, line_section
from sonolube.report.measured.surface_figures import length_scale, map_panel
from sonolube.text.units import format_si

ShownHeights = Literal["levelled", "measured", "form"]
"""Heights less their form, as measured, or the form itself."""

CELLS: Final = 400
"""Along the longer side of a map, at most."""

SECTION_POINTS: Final = 4000
"""Of a section, at most; of more the lowest and highest of each of half as many pieces."""

_FLAT: Final = 1e4  # lengths of the field, beyond which a radius is that of a plane


def shown_heights(
    surface: HeightMap, *, shown: ShownHeights, degree: int, robust: bool
) -> tuple[HeightMap, list[tuple[str, str]]]:
    """Heights to show, and what is said of the form that is fitted to them."""
    if shown == "measured":
        return surface, []
    form = fit_form(surface, degree=degree, robust=robust)
    facts = form_facts(form, degree=degree)
    return (form if shown == "form" else surface.with_height(surface.height - form.height)), facts


def form_facts(form: HeightMap, *, degree: int) -> list[tuple[str, str]]:
    """Range, mean slopes and radii of a fitted form, as text by name."""
    facts = [("Form, lowest to highest", format_si(float(np.ptp(form.height)), "m", digits=4))]
    axes = (("x", form.height, form.sides[0]), ("y", form.height.T, form.sides[1]))
    for name, height, side in axes:
        count = height.shape[1]
        if degree >= 1 and count > 1:
            slope = float(np.mean(height[:, -1] - height[:, 0])) / (side * (count - 1) / count)
            facts.append((f"Mean slope along {name}", f"{slope:.3g}"))
        if degree == 2 and count > 2:
            half = (count - 1) // 2
            second = float(np.mean(height[:, 2 * half] - 2 * height[:, half] + height[:, 0]))
            bend = second / (half * side / count) ** 2
            is_flat = abs(bend) * _FLAT * side < 1
            facts.append((f"Radius along {name}", "straight" if is_flat else format_si(1 / abs(bend), "m", digits=3)))
    return facts


def scan_chart(surface: HeightMap) -> Chart:
    """Map of heights, or the curve of a profile."""
    if 1 not in surface.height.shape:
        return Chart(panels=(map_panel(surface, most=CELLS),), size=(6.4, 4.4))
    is_row = surface.height.shape[0] == 1
    return _profile_chart(surface.x if is_row else surface.y, surface.height.ravel(), "x" if is_row else "y")


def cells_text(surface: HeightMap) -> str:
    """How many pixels a cell of the map stands for."""
    columns, rows = block_means(surface, most=CELLS).size
    return "single pixels" if columns == rows == 1 else f"means of {columns} x {rows} pixels"


def section_chart(
    surface: HeightMap, *, start: Sequence[float], end: Sequence[float]
) -> tuple[Chart, list[tuple[str, str]]]:
    """Heights along a line, and what is said of them; ends in m."""
    found = line_section(surface, start=start, end=end)
    known = found.height[np.isfinite(found.height)]
    facts = [("Length", format_si(float(found.distance[-1]), "m", digits=4)), ("Points", f"{found.distance.size}")]
    if known.size < found.distance.size:
        facts.append(("Of them missing", f"{found.distance.size - known.size}"))
    if known.size:
        facts += [
            ("Lowest to highest", format_si(float(np.ptp(known)), "m", digits=4)),
            ("Root mean square about their mean", format_si(float(np.std(known)), "m", digits=4)),
            ("From end to end", format_si(float(known[-1] - known[0]), "m", digits=4)),
        ]
    return _profile_chart(found.distance, found.height, "Distance"), facts


def _profile_chart(along: Floats, heights: Floats, name: str) -> Chart:
    """Heights over a length, at most so many points that extremes are kept."""
    across, per_metre = length_scale(along)
    unit, scale = length_scale(heights) if np.isfinite(heights).any() else ("nm", 1e9)
    x, y = envelope(per_metre * along, scale * heights, bins=SECTION_POINTS // 2)
    length = Axis(name, across, lowest=0.0, highest=per_metre * float(along[-1]) or 1.0)
    return one_panel(length, Axis("Height", unit), (Line(x=x, y=y, weight=0.8),), size=(7.4, 2.6))


def size_of(unit: str) -> float:
    """Metres of a unit of a chart. [m]"""
    return {"nm": 1e-9, "µm": 1e-6, "mm": 1e-3}[unit]
