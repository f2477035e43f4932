"""Section 2.1, Poisson-effect tests: rows of modes and friction reductions, and the paths of surface points."""

from collections.abc import Iterator
from functools import partial
from math import pi, sqrt
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.checks import Floats
from sonolube.facts.materials import material
from sonolube.facts.published import propagate_rounding, si_value
from sonolube.figure import COLOURS, LINES, ReportFigure
from sonolube.models.actuator import free_bar_frequency, surface_trajectory
from sonolube.reproduction import formulas
from sonolube.reproduction.chapter2.horn_figures import horn_figures
from sonolube.reproduction.chapter2.horn_rows import horn_rows
from sonolube.reproduction.cube import HORNS, STEEL_ON_STEEL_NOTE, Horn, poisson_friction_ratio, poisson_waveguide
from sonolube.reproduction.plots import axes_row
from sonolube.reproduction.row import Row, formula_row, published_model_row
from sonolube.validation.contacts import STEEL_YIELD_STRENGTH, STEEL_YIELD_STRENGTHS, Bodies

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_PHASES: Final = {0.0: "driven on one end", -pi / 2: "quarter turn of D 3.25"}


def poisson_effect_rows() -> Iterator[Row]:
    """Yield the rows of section 2.1."""
    yield from _uniform_bar_modes()
    yield from horn_rows()
    yield from _friction_reductions()


def poisson_effect_figures() -> Iterator[ReportFigure]:
    """Figures of section 2.1."""
    yield ReportFigure(
        name="figure-2-4-loci",
        title="Paths of three points on the waveguide's surface",
        caption="Computed, D 3.22 and 3.25 at the amplitude of section 2.1.2: one inch left of the centre, at the "
        "centre, one inch right of it. Full: a horn driven on one end, whose normal motion has no delay to the axial "
        "one, so that the lag is zero on one side and half a turn on the other, and paths are lines. Broken: normal "
        "motion a quarter turn ahead, the lag of D 3.25, which such a horn does not have, with the sign with which the "
        "surface moves towards the centre while it is lowest, as the block did; the arrow shows the sense of motion.",
        draw=_paths,
    )
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


def _paths() -> "Figure":
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
