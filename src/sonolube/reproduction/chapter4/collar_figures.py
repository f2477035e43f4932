"""Section 4.5, the collar: figures of impedance, of amplitudes over voltage, and of a rod pulled through it."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from sonolube.dong2015.collar_designs import FINAL_COLLAR
from sonolube.dong2015.collar_tuning import HIGHEST_FREQUENCY, LOWEST_FREQUENCY, main_resonance
from sonolube.facts.published import si_value
from sonolube.figure import COLOURS, LINES, ReportFigure
from sonolube.models.fem import ReducedModel, harmonic_response
from sonolube.reproduction.chapter4.collar import LOAD_AT_ENDS, PULL_SPEED, pulled_rod, response_model
from sonolube.reproduction.chapter4.collar_rows import finite_elements_missing
from sonolube.reproduction.plots import axes_row, line_style, single_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_ASSUMED: Final = "Dimensions that D does not print are assumed and fitted to 25 and 24.4 kHz."
_POINTS: Final = 2001


def collar_figures() -> Iterator[ReportFigure]:
    """Figures of section 4.5; none if a package of the finite elements is missing."""
    if finite_elements_missing():
        return
    yield ReportFigure(
        name="figures-4-51-4-53-collar-impedance",
        title="Impedance of the collar",
        caption="Left, figure 4.51: base free and clamped, top closed. Right, figure 4.53: top closed and open, "
        f"base free. {_ASSUMED} Closed, two pairs of half the coupling and less lie below the main one, the only "
        "one in D; open, one is distinct, while D has three. Below 15 kHz the model has pairs that D does not "
        "mention. The base is rigidly clamped by its whole lower face.",
        draw=_impedances,
    )
    yield ReportFigure(
        name="figure-4-55-collar-amplitudes",
        title="Amplitudes of the collar over voltage",
        caption="Top open, each at its own resonance: the flat of the inner ring, and the base under the stack. "
        f"{_ASSUMED} Linear, as measured. The base moves a twentieth as much as the ring, clamped a fifth. "
        "Clamping raises the ring's amplitude by less than a tenth, while in D it is significantly higher: the "
        "mode is that of the ring and the base is heavy. All amplitudes depend on the losses, which are assumed.",
        draw=_amplitudes,
    )
    yield ReportFigure(
        name="figure-4-57-collar-pull",
        title="A rod pulled through the collar",
        caption="28 V peak to peak at the resonance, multi-scale model with the structure of the finite elements. "
        f"{_ASSUMED} Load assumed {LOAD_AT_ENDS:g} times as high at the ends as in the middle; a higher load "
        "detunes the resonance and leaves less amplitude, so that friction falls least at the ends. The "
        "reduction of the work depends on the speed, which is only drawn in D.",
        draw=_pulled_rod,
    )


def _impedances() -> "Figure":
    """Draw the impedance with free and clamped base, and with closed and open top."""
    figure, (left, right) = axes_row(2, (7.8, 3.6), sharey=True)
    free = response_model(FINAL_COLLAR)
    for axes, cases in (
        (left, {"base free": free, "base clamped": response_model(FINAL_COLLAR, clamped=True)}),
        (right, {"top closed": free, "top open": response_model(FINAL_COLLAR, open_top=True)}),
    ):
        for index, (label, model) in enumerate(cases.items()):
            _impedance(axes, model, label, index)
        axes.set(xlabel="Frequency [kHz]", xlim=(LOWEST_FREQUENCY * 1e-3, HIGHEST_FREQUENCY * 1e-3))
        axes.set(ylabel="Magnitude of the impedance [Ω]")
        axes.legend()
    return figure


def _impedance(axes: "Axes", model: ReducedModel, label: str, index: int) -> None:
    """Draw the magnitude of the impedance of a model over frequency."""
    frequency = np.linspace(LOWEST_FREQUENCY, HIGHEST_FREQUENCY, _POINTS)
    admittance = harmonic_response(model, frequency=frequency).admittance
    axes.semilogy(1e-3 * frequency, 1 / np.abs(admittance), **line_style(index), label=label)


def _amplitudes() -> "Figure":
    """Draw the amplitudes of inner ring and base over voltage, with free and clamped base."""
    figure, axes = single_axes()
    swing = np.array([0.0, si_value("4.5.4-voltage")])
    for index, (label, clamped) in enumerate((("unclamped", False), ("clamped", True))):
        model = response_model(FINAL_COLLAR, clamped=clamped, open_top=True)
        at_resonance = harmonic_response(model, frequency=main_resonance(model).series_frequency)
        for line, (part, output) in enumerate((("inner ring", "crown"), ("base", "base"))):
            per_volt = np.abs(at_resonance.displacement_per_volt[model.outputs.index(output), 0])
            style: dict[str, Any] = {"linestyle": LINES[line], "color": COLOURS[index]}
            axes.plot(swing, 1e6 * per_volt * swing / 2, **style, label=f"{part}, {label}")
    axes.set(xlabel="Drive voltage, peak to peak [V]", ylabel="Amplitude [µm]", xlim=(0, swing[1]), ylim=(0, None))
    axes.legend(loc="upper left")
    return figure


def _pulled_rod() -> "Figure":
    """Draw the friction along a pulled rod, and the reductions of friction and work over its speed."""
    figure, (left, right) = axes_row(2, (7.8, 3.6))
    rod = pulled_rod()
    intrinsic = rod.normal_load / rod.normal_load.min()
    left.plot(rod.relative_position, intrinsic, **line_style(0), label="without vibration")
    reduced = intrinsic * rod.ratio_at_pull_speed
    left.plot(rod.relative_position, reduced, **line_style(1), label=f"with, {1e3 * PULL_SPEED:g} mm/s")
    left.set(xlabel="Position on the rod over its length [1]", xlim=(0, 1))
    left.set(ylabel="Friction over that in the middle [1]", ylim=(0, 1.35 * intrinsic.max()))
    left.legend(loc="upper right")
    speed = 1e3 * rod.sliding_speed
    right.plot(speed, 100 * rod.work_reduction, **line_style(0), label="work of friction")
    ends, middle = (100 * (1 - ratio) for ratio in (rod.friction_ratio.max(axis=1), rod.friction_ratio.min(axis=1)))
    right.fill_between(speed, ends, middle, color="0.85", label="friction, ends to middle")
    published = 100 * si_value("4.5.4-work-reduction")
    right.axhline(published, color="0.3", linestyle=":", label="work in D 4.5.4, speed not printed")
    right.set(xlabel="Speed of the rod [mm/s]", ylabel="Reduction [%]", xlim=(speed[0], speed[-1]), ylim=(0, 110))
    right.legend(loc="upper right")
    return figure
