"""Figures of the Poisson horn by finite elements."""

from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.checks import Floats
from sonolube.fem import TrajectoryEllipse, trajectory_ellipse
from sonolube.figure import COLOURS, LINES, MARKERS, ReportFigure
from sonolube.reproduce.chapter2.horn_regions import FACE_END, driven_face, friction_on_face
from sonolube.reproduce.chapter2.horn_sensitivity import frequency_changes, node_shifts
from sonolube.reproduce.chapter2.poisson_horn import (
    HORNS,
    FaceMotion,
    Horn,
    axial_mode,
    printed_shape,
    printed_solid,
)
from sonolube.validation.inputs import in_table, said

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_INCH: Final = 0.0254
_REGION_ROW: Final = {"aluminium": 0, "steel": 3}
_HORN_NOTE: Final = (
    "Horns of the printed first mode (ends tapered to 3/4 in over their last inch, handbook constants: assumed), "
    "loss factor 0.001, driven on the right end at 20 kHz to 8.5 um."
)


def figures() -> tuple[ReportFigure, ...]:
    """Return the figures of the horn."""
    return (
        ReportFigure(
            name="figure-2-3-horn-assumptions",
            chapter=2,
            title="What single assumptions do to the first axial mode",
            caption="Computed, plain steel block with the constants of Table 3.1. Bands: what the printed 20.8 kHz and "
            "20.6 kHz of D 2.1.3 ask for from either plain block; no single shape gives both, for the moduli and "
            "densities put steel 2 % below aluminium, and D prints it 1 % above.",
            draw=_assumptions,
        ),
        ReportFigure(
            name="figure-2-4-loci-by-elements",
            chapter=2,
            title="Paths of three points on the horns' surfaces, by finite elements",
            caption=f"Computed. {_HORN_NOTE} All paths are lines but for a hundredth of their length: losses of the "
            "horn do not open them to the ellipses of D 3.25.",
            draw=_loci,
        ),
        ReportFigure(
            name="figure-2-4-ellipses-along-the-face",
            chapter=2,
            title="Half axes of the paths and phase along the horns' faces",
            caption=f"Computed. {_HORN_NOTE} Points turn the same way all along the face, as energy flows one "
            "way; D 3.25 has a lag of a quarter turn.",
            draw=_ellipses,
        ),
        ReportFigure(
            name="table-2-1-friction-along-the-face",
            chapter=2,
            title="Friction of a block that slides towards the node, along the horns' faces",
            caption=f"Computed at 5 mm/s. {_HORN_NOTE} Springs of the contact of Table 3.1 with Mindlin's ratio. Below "
            "zero the face drives the block: the motor region. Bands: transition regions of Table 2.1.",
            draw=_friction,
        ),
        ReportFigure(
            name="table-2-1-node-of-the-steel-horn",
            chapter=2,
            title="Where single asymmetries put the node of the steel horn",
            caption="Computed, steel horn of the printed first mode; drives act on its right end. Band: transition "
            "region of Table 2.1. A symmetric horn on its resonance has its node in the middle; driven below it, the "
            "node moves towards the drive.",
            draw=_nodes,
        ),
    )


def _assumptions() -> "Figure":
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(figsize=(6.4, 3.6))
    changes = frequency_changes()[::-1]
    for index, horn in enumerate(HORNS):
        printed = said(f"2.1.3-first-mode-{horn}")
        plain = axial_mode(printed_shape(), printed_solid(horn)).natural_frequency
        low, high = (100 * (end / plain - 1) for end in (printed.low, printed.high))
        axes.axvspan(low, high, color=COLOURS[index], alpha=0.3, lw=0, label=f"{horn}, asked for by D 2.1.3")
    bars = axes.barh([change.name for change in changes], [100 * change.change for change in changes], color="0.55")
    axes.bar_label(bars, [f"{100 * change.change:+.2f}".replace("-", "−") for change in changes], padding=3, size=8)
    axes.set(xlabel="Change of the first axial frequency [%]", xlim=(-3, 11.5))
    axes.axvline(0, color="black", lw=0.8)
    axes.grid(False, axis="y")
    figure.legend(loc="outside lower center", ncols=2)
    return figure


def _loci() -> "Figure":
    from matplotlib import pyplot as plt

    figure, panels = plt.subplots(1, 3, figsize=(7.2, 2.8), sharex=True, sharey=True)
    inch = said("2.1.3-outer-points").value
    turn = np.exp(1j * np.linspace(0, 2 * np.pi, 361))
    for axes, place, title in zip(panels, (-inch, 0.0, inch), ("point -1", "point 0", "point +1"), strict=True):
        for index, horn in enumerate(HORNS):
            u, v = _motion(horn).at(place)
            axes.plot(
                1e6 * (u * turn).real,
                1e6 * (v * turn).real,
                marker=MARKERS[index],
                markevery=180,  # its ends
                color=COLOURS[index],
                label=f"{horn} horn, computed",
            )
        axes.set(title=title.replace("-", "−"), xlabel="Axial displacement [µm]", xlim=(-6, 6), ylim=(-1.1, 1.1))
        axes.title.set_fontsize(9)
    panels[0].set(ylabel="Normal displacement\nout of the face [µm]")
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return figure


def _ellipses() -> "Figure":
    from matplotlib import pyplot as plt

    figure, (above, below) = plt.subplots(2, 1, figsize=(5.0, 4.8), sharex=True)
    places = np.linspace(-FACE_END, FACE_END, 401)
    for index, horn in enumerate(HORNS):
        x = 1e3 * places
        path = _paths(horn, places)
        above.semilogy(x, 1e6 * path.major_semi_axis, color=COLOURS[index], ls="-", label=f"{horn}, long half axis")
        above.semilogy(x, 1e6 * path.minor_semi_axis, color=COLOURS[index], ls="--", label=f"{horn}, short half axis")
        below.plot(x, np.degrees(path.phase), color=COLOURS[index], ls=LINES[index], label=horn)
    above.set(ylabel="Half axis [µm]", ylim=(1e-4, 30))
    above.legend(loc="center", ncols=2, fontsize=7)
    below.set(
        xlabel="Position along the horn [mm]",
        ylabel="Lag of the normal behind\nthe axial motion [degrees]",
        yticks=(0, 45, 90, 135, 180),
    )
    below.legend(loc="lower right")
    return figure


def _friction() -> "Figure":
    from matplotlib import pyplot as plt

    figure, panels = plt.subplots(1, 2, figsize=(7.2, 3.0), sharex=True, sharey=True)
    for axes, (index, horn) in zip(panels, enumerate(HORNS), strict=True):
        friction = friction_on_face(horn, frequency=said("2.1.2-welder-frequency").value)
        _band(axes, horn)
        axes.plot(friction.position / _INCH, 100 * friction.ratio, color=COLOURS[index], ls=LINES[index])
        axes.axhline(0, color="black", lw=0.8)
        axes.set(
            title=f"{horn} horn", xlabel="Position along the face [in]", xlim=(-FACE_END / _INCH, FACE_END / _INCH)
        )
        axes.title.set_fontsize(9)
    panels[0].set(ylabel="Friction over that at rest [%]", ylim=(-50, 100))
    band, *_ = panels[0].get_legend_handles_labels()[0]
    lines = [axes.lines[0] for axes in panels]
    labels = ["transition region, Table 2.1", *[f"{horn} horn, computed" for horn in HORNS]]
    figure.legend([band, *lines], labels, loc="outside lower center", ncols=3)
    return figure


def _nodes() -> "Figure":
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(figsize=(7.2, 2.6))
    shifts = node_shifts()[::-1]
    start, end = (in_table("2.1", side, _REGION_ROW["steel"]).value / _INCH for side in ("start", "end"))
    axes.axvspan(start, end, color=COLOURS[1], alpha=0.3, lw=0, label="transition region, Table 2.1")
    bars = axes.barh([shift.name for shift in shifts], [shift.node / _INCH for shift in shifts], color="0.55")
    axes.bar_label(bars, [f"{shift.node / _INCH:.3f}" for shift in shifts], padding=3, size=8)
    axes.set(xlabel="Node of the axial motion, from the centre [in]", xlim=(0, 0.22))
    axes.grid(False, axis="y")
    figure.legend(loc="outside lower center")
    return figure


def _band(axes: "Axes", horn: Horn) -> None:
    start, end = (in_table("2.1", side, _REGION_ROW[horn]).value / _INCH for side in ("start", "end"))
    axes.axvspan(start, end, color="0.8", lw=0, label="transition region, Table 2.1")


def _motion(horn: Horn) -> FaceMotion:
    return driven_face(horn, frequency=said("2.1.2-welder-frequency").value)


def _paths(horn: Horn, places: Floats) -> TrajectoryEllipse:
    axial, normal = _motion(horn).at(places)
    return trajectory_ellipse(axial_displacement=axial, normal_displacement=normal)
