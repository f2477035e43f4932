"""Section 2.1, Poisson-effect tests: rows of modes and friction reductions, and figures of the horn and its paths."""

from collections.abc import Iterator
from functools import partial
from math import pi, sqrt
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from dong2015 import formulas
from dong2015.chapter2.horn_rows import frequency_changes, horn_rows, measured_region, node_positions
from dong2015.chapter2.poisson_horn import (
    FACE_END,
    INCH,
    FaceMotion,
    axial_mode,
    driven_face,
    friction_on_face,
    printed_shape,
    printed_solid,
)
from dong2015.plots import axes_row, line_style, report_figure, single_axes
from dong2015.published_rigs import HORNS, STEEL_ON_STEEL_NOTE, Horn, poisson_friction_ratio, poisson_waveguide
from dong2015.row import (
    Row,
    at_least,
    default_model_row,
    formula_row,
    published_model_row,
    range_rows,
    undetermined_row,
)
from sonolube.checks import Floats
from sonolube.facts.materials import material
from sonolube.facts.published import propagate_rounding, published_number, si_value
from sonolube.figure import COLOURS, LINES, MARKERS, ReportFigure, subplots
from sonolube.models.actuator import free_bar_frequency, surface_trajectory
from sonolube.models.fem import trajectory_ellipse
from sonolube.validation.contacts import STEEL_YIELD_STRENGTH, STEEL_YIELD_STRENGTHS, Bodies

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_HORN_NOTE: Final = (
    "Horns of the printed first mode (ends tapered to 3/4 in over their last inch, handbook constants: assumed), "
    "loss factor 0.001, driven on the right end at 20 kHz to 8.5 um."
)


def horn_figures() -> Iterator[ReportFigure]:
    """Figures of the horn."""
    yield report_figure("figure-2-3-horn-assumptions", _assumptions)
    yield report_figure("figure-2-4-loci-by-elements", _paths, horns=_HORN_NOTE)
    yield report_figure("figure-2-4-ellipses-along-the-face", _ellipses, horns=_HORN_NOTE)
    yield report_figure("table-2-1-friction-along-the-face", _friction, horns=_HORN_NOTE)
    yield report_figure("table-2-1-node-of-the-steel-horn", _nodes)


def _assumptions() -> "Figure":
    """Draw the changes of the first axial frequency by single assumptions."""
    figure, axes = single_axes((6.4, 3.6))
    changes = {assumption: 100 * change for assumption, change in reversed(frequency_changes().items())}
    for index, horn in enumerate(HORNS):
        printed = published_number(f"2.1.3-first-mode-{horn}")
        plain = axial_mode(printed_shape(), printed_solid(horn)).natural_frequency
        low, high = (100 * (limit / plain - 1) for limit in (printed.low, printed.high))
        axes.axvspan(low, high, color=COLOURS[index], alpha=0.3, lw=0, label=f"{horn}, to the frequency of D 2.1.3")
    bars = axes.barh(list(changes), list(changes.values()), color="0.55")
    axes.bar_label(bars, [f"{change:+.2f}".replace("-", "−") for change in changes.values()], padding=3, size=8)
    axes.set(xlabel="Change of the first axial frequency [%]", xlim=(-3, 11.5))
    axes.axvline(0, color="black", lw=0.8)
    axes.grid(False, axis="y")
    figure.legend(loc="outside lower center", ncols=2)
    return figure


def _paths() -> "Figure":
    """Draw the paths of three surface points of both horns."""
    figure, panels = axes_row(3, (7.2, 2.8), sharex=True, sharey=True)
    inch = si_value("2.1.3-outer-points")
    turn = np.exp(1j * np.linspace(0, 2 * np.pi, 361))
    for axes, place, title in zip(panels, (-inch, 0.0, inch), ("point -1", "point 0", "point +1"), strict=True):
        for index, horn in enumerate(HORNS):
            u, v = _motion(horn).at(place)
            style: dict[str, Any] = {"color": COLOURS[index], "marker": MARKERS[index], "markevery": 180}  # both ends
            axes.plot(1e6 * (u * turn).real, 1e6 * (v * turn).real, **style, label=f"{horn} horn, computed")
        axes.set(title=title.replace("-", "−"), xlabel="Axial displacement [µm]", xlim=(-6, 6), ylim=(-1.1, 1.1))
        axes.title.set_fontsize(9)
    panels[0].set(ylabel="Normal displacement\nout of the face [µm]")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return figure


def _ellipses() -> "Figure":
    """Draw semi-axes and phase of the elliptic paths along the face."""
    figure, (above, below) = subplots(2, 1, figsize=(5.0, 4.8), sharex=True)
    position = np.linspace(-FACE_END, FACE_END, 401)
    for index, horn in enumerate(HORNS):
        axial, normal = _motion(horn).at(position)
        path = trajectory_ellipse(axial_displacement=axial, normal_displacement=normal)
        for line, name, semi_axis in (("-", "major", path.major_semi_axis), ("--", "minor", path.minor_semi_axis)):
            label = f"{horn}, {name} semi-axis"
            above.semilogy(1e3 * position, 1e6 * semi_axis, color=COLOURS[index], ls=line, label=label)
        below.plot(1e3 * position, np.degrees(path.phase), **line_style(index), label=horn)
    above.set(ylabel="Semi-axis [µm]", ylim=(1e-4, 30))
    above.legend(loc="center", ncols=2, fontsize=7)
    below.set(xlabel="Position along the horn [mm]")
    below.set(ylabel="Lag of the normal behind\nthe axial motion [degrees]", yticks=(0, 45, 90, 135, 180))
    below.legend(loc="lower right")
    return figure


def _friction() -> "Figure":
    """Draw the friction along the faces of both horns with the transition regions of Table 2.1."""
    figure, panels = axes_row(2, (7.2, 3.0), sharex=True, sharey=True)
    for axes, (index, horn) in zip(panels, enumerate(HORNS), strict=True):
        friction = friction_on_face(horn, frequency=si_value("2.1.2-welder-frequency"))
        _draw_transition_region(axes, horn, color="0.8")
        axes.plot(friction.position / INCH, 100 * friction.ratio, **line_style(index))
        axes.axhline(0, color="black", lw=0.8)
        axes.set(xlabel="Position along the face [in]", xlim=(-FACE_END / INCH, FACE_END / INCH))
        axes.set_title(f"{horn} horn", fontsize=9)
    panels[0].set(ylabel="Friction over that at rest [%]", ylim=(-50, 100))
    band, *_ = panels[0].get_legend_handles_labels()[0]
    lines = [axes.lines[0] for axes in panels]
    labels = ["transition region, Table 2.1", *[f"{horn} horn, computed" for horn in HORNS]]
    figure.legend([band, *lines], labels, loc="outside lower center", ncols=3)
    return figure


def _nodes() -> "Figure":
    """Draw the position of the node of the steel horn under single asymmetries."""
    figure, axes = single_axes((7.2, 2.6))
    inches = {asymmetry: node / INCH for asymmetry, node in reversed(node_positions().items())}
    _draw_transition_region(axes, "steel", color=COLOURS[1], alpha=0.3)
    bars = axes.barh(list(inches), list(inches.values()), color="0.55")
    axes.bar_label(bars, [f"{node:.3f}" for node in inches.values()], padding=3, size=8)
    axes.set(xlabel="Node of the axial motion, from the centre [in]", xlim=(0, 0.22))
    axes.grid(False, axis="y")
    figure.legend(loc="outside lower center")
    return figure


def _motor_force() -> "Figure":
    """Draw the net motor force over the load at both outer points of the aluminium horn, the block held."""
    figure, axes = single_axes((4.8, 3.4))
    held = friction_on_face("aluminium", frequency=si_value("2.1.2-welder-frequency"), sliding_speed=_HELD)
    loads, coefficient = (
        np.linspace(0.0, published_number("2.1.2-normal-load").high, 2),
        si_value("2.1.5-coefficient-off"),
    )
    inch = si_value("2.1.3-outer-points")
    for index, (name, place) in enumerate((("point −1", -inch), ("point +1", inch))):
        force = -coefficient * np.interp(place, held.position, held.ratio) * loads
        axes.plot(loads, force, **line_style(index), label=name)
    axes.set(xlabel="Normal load [N]", ylabel="Net motor force [N]", xlim=(0, loads[-1]), ylim=(0, None))
    axes.legend(loc="upper left")
    return figure


def _draw_transition_region(axes: "Axes", horn: Horn, *, color: str, alpha: float = 1.0, unit: float = INCH) -> None:
    """Draw the transition region of a horn in Table 2.1 as a band, over positions in a unit of that many metres."""
    start, end = (place / unit for place in measured_region(horn))
    axes.axvspan(start, end, color=color, alpha=alpha, lw=0, label="transition region, Table 2.1")


def _motion(horn: Horn) -> FaceMotion:
    """Motion of the face of a horn at the frequency of the welder."""
    return driven_face(horn, frequency=si_value("2.1.2-welder-frequency"))


_HELD: Final = 1e-6  # m/s, at which a block counts as held
_PHASES: Final = {0.0: "driven on one end", -pi / 2: "quarter turn of D 3.25"}


def poisson_effect_rows() -> Iterator[Row]:
    """Yield the rows of section 2.1."""
    yield from _uniform_bar_modes()
    yield from horn_rows()
    yield undetermined_row("2.1.1-ewi-reduction", "all that EWI's tests were done with but their load.")
    yield from _motor_effect()
    yield from _friction_reductions()
    yield from _transition_range()


def poisson_effect_figures() -> Iterator[ReportFigure]:
    """Figures of section 2.1."""
    yield report_figure("figure-2-4-loci", _loci)
    yield report_figure("figure-2-6-motor-force", _motor_force, horns=_HORN_NOTE)
    yield from horn_figures()


def _uniform_bar_modes() -> Iterator[Row]:
    """Yield the first axial modes of the horns by the half-wave resonance of a uniform bar."""
    for horn, alloy in (("aluminium", "aluminium_2024"), ("steel", "stainless_steel_316")):
        density = material(alloy).value("density")
        frequency = propagate_rounding(
            partial(_half_wave_frequency, density=density),
            f"table-3.1-youngs_modulus_{horn}-1",
            "2.1.2-waveguide-length",
        )
        note = f"Half a wave in a uniform bar with E of Table 3.1 and {density:g} kg/m3: no tapers, no rounded edges."
        yield published_model_row(f"2.1.3-first-mode-{horn}", frequency, note)


def _half_wave_frequency(youngs_modulus: float, length: float, *, density: float) -> float:
    """First axial natural frequency of a uniform free bar. [Hz]"""
    return float(free_bar_frequency(length=length, wave_speed=sqrt(youngs_modulus / density)))


def _motor_effect() -> Iterator[Row]:
    """Yield the reduction at the outer points by the motor effect, and how its force follows the load."""
    friction = friction_on_face("aluminium", frequency=si_value("2.1.2-welder-frequency"))
    inch = si_value("2.1.3-outer-points")
    left, right = (1 - np.interp(place, friction.position, friction.ratio) for place in (-inch, inch))
    note = (
        f"Contact springs on the horn of the printed first mode, driven to 8.5 um; least of both points, {left:.0%} and"
        f" {right:.0%} of the friction at rest. D measured more than 100 % without a number."
    )
    least = float(min(left, right))
    yield default_model_row(at_least("2.1.4-motor-reduction", least), least, note)
    yield default_model_row(
        "2.1.4-motor-force-slope",
        1.0,
        "Friction of contact springs under the computed motion.",
        trivial="by Coulomb's law every friction is proportional to the load",
    )


def _transition_range() -> Iterator[Row]:
    """Yield the range of the reductions in the transition region, from those of the three pairs."""
    singles = [
        published_number(f"2.1.5-reduction-{pair}").limits()
        for pair in ("steel-on-aluminium", "aluminium-horn", "steel-on-steel")
    ]
    low, high = min(low.value for low, _ in singles), max(high.value for _, high in singles)
    yield from range_rows("2.1.7-transition-reduction", low, high, "Smallest and largest of section 2.1.5.")


def _friction_reductions() -> Iterator[Row]:
    """Yield the friction reductions of section 2.1.5 from coefficients and by the cube."""
    note = "D 2.1 from both coefficients; D calls all three numbers approximate."
    coefficients = "2.1.5-coefficient-off", "2.1.5-coefficient-on"
    yield formula_row("2.1.5-reduction-aluminium-horn", note, formulas.friction_reduction, *coefficients)
    load = si_value("2.1.2-normal-load")
    tests: tuple[tuple[str, str, Bodies, Horn, str], ...] = (
        ("2.1.5-reduction-aluminium-horn", "cube", "aluminium_steel", "aluminium", ""),
        ("2.1.5-reduction-steel-on-aluminium", "", "aluminium_steel", "steel", ""),
        ("2.1.5-reduction-steel-on-steel", "", "steel_steel", "steel", f" Assumed: {STEEL_ON_STEEL_NOTE}."),
    )
    for published, suffix, bodies, horn, remark in tests:
        reduction = partial(_cube_reduction, bodies=bodies, horn=horn, normal_load=load)
        at_waveguide_amplitude = reduction("4.3.5-waveguide-amplitude")
        note = (
            f"Cube, D 3.15, {load:g} N, amplitude of D 2.1.2; with that of D 4.3.5 "
            f"{100 * at_waveguide_amplitude:.1f} %.{remark}"
        )
        weakest, strongest = (
            reduction("2.1.2-welder-amplitude", yield_strength=strength) for strength in STEEL_YIELD_STRENGTHS
        )
        yield published_model_row(
            published,
            reduction("2.1.2-welder-amplitude"),
            note,
            suffix=suffix,
            possible=(weakest, strongest) if bodies == "steel_steel" else None,
        )


def _cube_reduction(
    amplitude: str, *, bodies: Bodies, horn: Horn, normal_load: float, yield_strength: float = STEEL_YIELD_STRENGTH
) -> float:
    """Friction reduction by the cube at a published axial amplitude, given by its id. []"""
    ratio = poisson_friction_ratio(
        bodies=bodies,
        horn=horn,
        normal_load=np.asarray(normal_load),
        axial_amplitude=si_value(amplitude),
        yield_strength=yield_strength,
    )
    return 1 - float(ratio)


def _loci() -> "Figure":
    """Draw the paths of three surface points of both horns for both lags."""
    figure, panels = axes_row(3, (7.2, 2.7), sharex=True, sharey=True)
    inch = si_value("2.1.3-outer-points")
    drive = {"axial_amplitude": si_value("2.1.2-welder-amplitude"), "frequency": si_value("2.1.2-welder-frequency")}
    for axes, place, title in zip(panels, (-inch, 0.0, inch), ("point -1", "point 0", "point +1"), strict=True):
        for index, horn in enumerate(HORNS):
            for line, (phase, lag) in zip(LINES, _PHASES.items(), strict=False):
                path = surface_trajectory(poisson_waveguide(horn, **drive), position=place, phase=phase)
                u, v = 1e6 * path.axial_displacement, 1e6 * path.normal_displacement
                axes.plot(u, v, linestyle=line, color=COLOURS[index], label=f"{horn} horn, {lag}")
                if index == 0 and phase and place:
                    _draw_sense_of_motion(axes, u, v)
        axes.set(title=f"{title}, x = {1e3 * place:g} mm".replace("-", "−"), xlabel="Axial displacement [µm]")
        axes.title.set_fontsize(9)
    panels[0].set(ylabel="Normal displacement\ninto the bar [µm]", ylim=(-1.1, 1.1), xlim=(-6, 6))
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return figure


def _draw_sense_of_motion(axes: "Axes", u: Floats, v: Floats) -> None:
    """Draw an arrow along a path at its lowest point."""
    lowest = int(np.argmin(v))
    before, after = max(lowest - 12, 0), min(lowest + 12, v.size - 1)
    arrow = {"arrowstyle": "-|>", "color": COLOURS[0], "mutation_scale": 14, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", xy=(u[after], v[after]), xytext=(u[before], v[before]), arrowprops=arrow)
