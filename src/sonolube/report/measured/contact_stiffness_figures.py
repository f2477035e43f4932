"""Figure of a contact's stiffness: spectra free and pressed with their fitted resonances."""

from typing import TYPE_CHECKING

import numpy as np

from sonolube.checks import Complexes
from sonolube.figure import COLOURS, LINES, subplots
from sonolube.measurement.contact_stiffness.analysis import MeasuredContactStiffness
from sonolube.measurement.contact_stiffness.resonance_fit import ResonanceFit
from sonolube.report.measured.sheet import captioned

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@captioned("Resonance free and pressed", "Measured (points) and fitted (lines); the marks are the resonances compared.")
def resonances(found: MeasuredContactStiffness) -> "Figure":
    """Spectra free, pressed, free again and at large drive, with fits and the resonances that were compared."""
    figure, axes = subplots(figsize=(6.4, 3.8))
    for place, (name, fit) in enumerate(_named(found)):
        f = fit.spectrum.frequency
        scale = 1e3 if f[-1] > 1e4 else 1.0
        axes.plot(f / scale, _level(fit, fit.spectrum.response), ".", color=COLOURS[place], markersize=2, alpha=0.5)
        axes.plot(
            f / scale, _level(fit, fit.fitted), linestyle=LINES[place], color=COLOURS[place], linewidth=1.2, label=name
        )
        compared = [one for one in fit.resonances if one in found.chosen]
        for one in compared:
            axes.axvline(one.frequency / scale, color=COLOURS[place], linestyle=LINES[place], linewidth=0.8)
        axes.set_xlabel("frequency (kHz)" if scale > 1 else "frequency (Hz)")
    kinds = {fit.spectrum.quantity for _, fit in _named(found)}
    axes.set(ylabel=f"response by {', '.join(sorted(kinds))} over its maximum", yscale="log")
    figure.legend(loc="outside upper center", ncols=4)
    return figure


def _named(found: MeasuredContactStiffness) -> list[tuple[str, ResonanceFit]]:
    """Fits by the name of their spectrum."""
    free = list(zip(("free", "free again"), found.free, strict=False))
    return [*free, ("pressed", found.pressed), *([] if found.large is None else [("large drive", found.large)])]


def _level(fit: ResonanceFit, values: Complexes) -> Complexes:
    """Magnitude over the greatest one of the spectrum."""
    return np.asarray(np.abs(values) / np.max(np.abs(fit.spectrum.response)))
