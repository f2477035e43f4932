"""Section 4.3.4: figure of the contact temperature before the vibration, over the sliding speed."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.facts.published import si_value
from sonolube.figure import COLOURS, LINES, ReportFigure
from sonolube.reproduction.chapter4 import temperature_tests as tests
from sonolube.reproduction.plots import line_style, point_style, single_axes

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_MIN_COEFFICIENT: Final = 0.067  # on coated steel; D 4.1.3 prints 0.67 N (E18)
_CELSIUS: Final = tests.ROOM_TEMPERATURE - 273.15


def dry_temperature_figures() -> Iterator[ReportFigure]:
    """Figure of the temperature before the vibration."""
    last = si_value("4.1.3-friction-coated-last")
    yield ReportFigure(
        name="figure-4-31-temperature-over-speed",
        title="Contact temperature over sliding speed",
        caption="As D figure 4.31, of which no temperature is printed: computed at 12 s, after 10 s of sliding without "
        f"vibration, with the least-squares lines (dashed). {tests.ASSUMED}. Bands: coefficients of friction from "
        f"{_MIN_COEFFICIENT:g} to {last:g}, those of D 4.1.3 with their misprint (E18). Nearly "
        "linear, and steeper at the higher stress, as in the text.",
        draw=_over_speed,
    )


def _over_speed() -> "Figure":
    """Draw the temperatures of both stresses over speed with their lines."""
    figure, axes = single_axes()
    along, area = tests.speeds(), si_value("table-4.4-nominal_area-1")
    least = _MIN_COEFFICIENT / si_value("4.1.3-friction-coated-last")
    for index, (load, rise) in enumerate(zip(tests.loads(), tests.dry_rises(), strict=True)):
        low = _CELSIUS + rise * least  # heat, and so the rise, is proportional to friction
        axes.fill_between(1e3 * along, low, _CELSIUS + rise, color=COLOURS[index], alpha=0.2, linewidth=0)
        label = f"{1e-6 * load / area:.0f} MPa"
        axes.plot(1e3 * along, _CELSIUS + rise, **point_style(index), label=label)
        slope, intercept = np.polyfit(along, rise, 1)
        line = np.array([0.0, 0.24])
        label = f"{1e-3 * slope:.2g} K/(mm/s)"
        axes.plot(
            1e3 * line, _CELSIUS + intercept + slope * line, **line_style(index) | {"linestyle": LINES[1]}, label=label
        )
    axes.set(xlabel="Sliding speed [mm/s]", ylabel="Temperature of the contact at 12 s [°C]", xlim=(0, 240))
    axes.locator_params(axis="y", nbins=6)
    axes.legend(loc="upper left")
    return figure
