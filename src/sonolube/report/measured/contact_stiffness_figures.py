"""Chart of a contact's stiffness: spectra free and pressed with their fitted resonances."""

import numpy as np

from sonolube.charts import Axis, Chart, Line, Part, Points, Rule, one_panel
from sonolube.checks import Complexes, Floats
from sonolube.measurement.contact_stiffness.analysis import MeasuredContactStiffness
from sonolube.measurement.contact_stiffness.resonance_fit import ResonanceFit
from sonolube.report.measured.sheet import captioned


@captioned("Resonance free and pressed", "Measured (points) and fitted (lines); the marks are the resonances compared.")
def resonances_figure(found: MeasuredContactStiffness) -> Chart:
    """Spectra free, pressed, free again and at large drive, with fits and the resonances that were compared."""
    fits = _named(found)
    highest = max(fit.spectrum.frequency[-1] for _, fit in fits)
    unit, scale = ("kHz", 1e-3) if highest > 1e4 else ("Hz", 1.0)
    parts: list[Part] = []
    for place, (name, fit) in enumerate(fits):
        f = scale * fit.spectrum.frequency
        parts += [
            Points(x=f, y=_level(fit, fit.spectrum.response), colour=place, is_faint=True),
            Line(x=f, y=_level(fit, fit.fitted), label=name, colour=place, dash=place, weight=0.85),
        ]
        compared = [one for one in fit.resonances if one in found.chosen]
        parts += [Rule(value=scale * one.frequency, colour=place, dash=place) for one in compared]
    kinds = ", ".join(sorted({fit.spectrum.quantity for _, fit in fits}))
    level = Axis(f"Response by {kinds} over its maximum", logarithmic=True)
    return one_panel(Axis("Frequency", unit), level, parts, size=(6.4, 3.8), legend="top", legend_columns=4)


def _named(found: MeasuredContactStiffness) -> list[tuple[str, ResonanceFit]]:
    """Fits by the name of their spectrum."""
    free = list(zip(("free", "free again"), found.free, strict=False))
    return [*free, ("pressed", found.pressed), *([] if found.large is None else [("large drive", found.large)])]


def _level(fit: ResonanceFit, values: Complexes) -> Floats:
    """Magnitude over the greatest one of the spectrum."""
    return np.asarray(np.abs(values) / np.max(np.abs(fit.spectrum.response)))
