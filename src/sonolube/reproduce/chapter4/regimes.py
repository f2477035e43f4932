"""Section 4.2: dry, ultrasonic, lubricated and combined, and where each is best."""

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from sonolube.checks import Floats
from sonolube.figure import COLOURS, LINES, ReportFigure
from sonolube.friction import (
    BoundaryLubricant,
    LubricationCoefficients,
    LubricationMethod,
    best_lubrication_method,
    lubrication_coefficients,
    sine_stick_slip_ratio,
)
from sonolube.published.values import stated
from sonolube.reproduce.row import Row, compare, undetermined
from sonolube.validation.inputs import named, range_ends, said
from sonolube.validation.power_map import printed

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_DECAY_LENGTH = 2e-6
_DRY = 1.0  # all coefficients over that of dry friction, which is only drawn
_SMALLEST_GAIN = 0.04  # of friction, for which vibration is worth its power beside a lubricant; assumed
_FULL_ASPERITY_PRESSURE = 200e6  # assumed

_INFERRED = (
    "Load sharing: vibration acts on the asperities, whose share grows with the stress, the film does not feel it. "
    "Friction under vibration by the stick-slip closure; friction under Molykote is only drawn (Figs. 4.24 to 4.27), "
    "and its film's is inferred from the printed speed at the lowest stress"
)


def regime_rows() -> Iterator[Row]:
    """Yield the rows of section 4.2.4."""
    best, useless = stated("4.2.4-speed-ultrasonic-best"), stated("4.2.4-speed-ultrasonic-useless")
    share = float(vibrated_ratio(sliding_speed=said("4.2.4-speed-ultrasonic-best").value))
    yield undetermined(
        best,
        "friction under Molykote, which is only drawn (Figs. 4.24 to 4.27); by the stick-slip closure and load sharing "
        f"a film with {share:.2f} of the dry friction would put the limit at the printed speed",
    )
    limit = replace(best, number=said("4.2.4-speed-ultrasonic-best"))
    for pressure in _pressures()[1:]:
        note = f"{_INFERRED}; at this stress predicted, for the text has it hold regardless of the load"
        yield compare(named(limit, f"at-{1e-6 * pressure:.0f}-MPa"), _last_best_speed(float(pressure)), note)
    highest = max(_last_best_speed(float(pressure)) for pressure in _pressures())
    note = f"Highest speed at which vibration alone is best at any stress, which must not exceed the print. {_INFERRED}"
    ends = replace(useless.number, low=0.0, high=useless.number.value)
    yield compare(replace(useless, number=ends), highest, note)


def regime_figures() -> tuple[ReportFigure, ...]:
    """Return the figures of section 4.2."""
    return (
        ReportFigure(
            name="figure-4-27-lubrication-regimes",
            chapter=4,
            title="Best way of lubrication over speed and stress",
            caption="Left: friction over that of the dry contact at 48 MPa. Right: the way with the lowest friction; "
            f"vibration counts beside a lubricant where it takes {100 * _SMALLEST_GAIN:g} % off. Load sharing with the "
            "stick-slip closure; the film's friction is inferred from the 90 mm/s of D; that share and the stress at "
            "which "
            f"asperities carry all, {1e-6 * _FULL_ASPERITY_PRESSURE:g} MPa, are assumed. Below 90 mm/s vibration is "
            "best at every stress, above it both together, "
            "unless the stress is low: as D has it.",
            draw=_regime_map,
        ),
    )


def vibrated_ratio(*, sliding_speed: ArrayLike) -> Floats:
    """Return what vibration leaves of dry friction in the tests of Table 4.3. []

    Parameters
    ----------
    sliding_speed : array_like, any shape
        Speed of the sliding. [m/s]

    Returns
    -------
    ndarray, shape of `sliding_speed`
    """
    return sine_stick_slip_ratio(
        decay_length=_DECAY_LENGTH,
        vibration_amplitude=printed("4.3", "vibration_amplitude")[0].value,
        frequency=printed("4.3", "frequency")[0].value,
        sliding_speed=sliding_speed,
    )


def molykote() -> BoundaryLubricant:
    """Return the lubricant whose film rubs as the vibrated contact does at the printed speed; its stress assumed."""
    at_limit = float(vibrated_ratio(sliding_speed=said("4.2.4-speed-ultrasonic-best").value))
    return BoundaryLubricant(film_coefficient=at_limit * _DRY, full_asperity_pressure=_FULL_ASPERITY_PRESSURE)


def coefficients(*, sliding_speed: ArrayLike, nominal_pressure: ArrayLike) -> LubricationCoefficients:
    """Return friction of the four ways over that of the dry contact.

    Parameters
    ----------
    sliding_speed : array_like
        Speed of the sliding. [m/s]
    nominal_pressure : array_like, broadcast against `sliding_speed`
        Load over nominal area. [Pa]

    Returns
    -------
    LubricationCoefficients
    """
    return lubrication_coefficients(
        molykote(),
        friction_coefficient=_DRY,
        friction_ratio=vibrated_ratio(sliding_speed=sliding_speed),
        nominal_pressure=nominal_pressure,
    )


def _pressures() -> Floats:
    area = printed("4.3", "nominal_area")[0].value
    return np.array([load.value / area for load in printed("4.3", "normal_load").values()])


def _last_best_speed(pressure: float) -> float:
    """Return the speed up to which vibration alone is best."""

    def excess(speed: float) -> float:
        of = coefficients(sliding_speed=speed, nominal_pressure=pressure)
        return float(of.ultrasonic - np.minimum(of.combined, of.lubricant))

    low, high = range_ends(printed("4.3", "sliding_speed")[0])
    return float(brentq(excess, low.value, high.value, xtol=1e-9))


def _regime_map() -> "Figure":
    from matplotlib import pyplot as plt
    from matplotlib.colors import ListedColormap

    figure, (left, right) = plt.subplots(1, 2, figsize=(7.8, 3.6))
    low, high = (end.value for end in range_ends(printed("4.3", "sliding_speed")[0]))
    speeds = np.linspace(low, high, 161)
    curves = coefficients(sliding_speed=speeds, nominal_pressure=_pressures()[1])._asdict()
    for index, (name, curve) in enumerate(curves.items()):
        left.plot(1e3 * speeds, curve, linestyle=LINES[index], color=COLOURS[index], label=name)
    left.set(xlabel="Sliding speed [mm/s]", ylabel="Friction over dry friction [1]", ylim=(0.4, 1.05))
    left.legend(loc="lower right")
    stresses = np.linspace(5e6, 80e6, 151)
    best = best_lubrication_method(
        coefficients(sliding_speed=speeds[np.newaxis, :], nominal_pressure=stresses[:, np.newaxis]),
        smallest_gain=_SMALLEST_GAIN,
    )
    names = [str(method) for method in LubricationMethod]
    numbers = np.vectorize(names.index)(best)
    right.pcolormesh(
        1e3 * speeds,
        1e-6 * stresses,
        numbers,
        cmap=ListedColormap(["0.6", "#9ecae1", "#fdd0a2", "#c7e9c0"]),
        vmin=-0.5,
        vmax=3.5,
        rasterized=True,
    )
    for name in np.unique(best):
        rows, columns = np.nonzero(best == name)
        place = np.median(columns).astype(int), np.median(rows).astype(int)
        middle = 1e3 * speeds[place[0]], 1e-6 * stresses[place[1]]
        right.text(*middle, name, ha="center", va="center", bbox={"facecolor": "white", "linewidth": 0, "pad": 2})
    for name in ("4.2.4-speed-ultrasonic-best", "4.2.4-speed-ultrasonic-useless"):
        right.axvline(1e3 * said(name).value, color="black", linestyle=":", linewidth=1.2)
    right.plot([], [], ":k", label="90 and 110 mm/s of D 4.2.4")
    right.plot(np.full(3, 61.0), 1e-6 * _pressures(), "k>", label="stresses of Table 4.3", clip_on=False)
    right.set(xlabel="Sliding speed [mm/s]", ylabel="Nominal stress [MPa]")
    right.grid(visible=False)
    figure.legend(*right.get_legend_handles_labels(), loc="outside upper center", ncols=2)
    return figure
