"""Section 4.4: figures of friction on the skin replica over voltage and amplitude, and of the mode of the head."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from sonolube.checks import Floats, Integers
from sonolube.dong2015.cutter import cutter_head_quarter
from sonolube.facts.published import column_numbers, si_value
from sonolube.figure import COLOURS, LINES, MARKERS, ReportFigure
from sonolube.models.fem import generate_mesh, natural_modes
from sonolube.models.friction import FaceVibrationMode, exponential_layer_ratio, linear_layer_ratio
from sonolube.reproduction.chapter4.collar_rows import finite_elements_missing
from sonolube.reproduction.chapter4.skin_replica import ASSUMED_MODE, soft_layer_fits
from sonolube.reproduction.plots import axes_row, line_style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_ELEMENT_SIZE: Final = 9e-3  # m; the thickness of the disc decides the mesh
_MODES: Final = 5  # even ones, of which one is near 20 kHz and moves the centre of the disc
_UNIFORM: Final = FaceVibrationMode(rim_displacement_ratio=1.0, following_fraction=1.0)


def cutter_head_figures() -> Iterator[ReportFigure]:
    """Figures of section 4.4; that of the mode only where the packages of the finite elements are there."""
    stiffening, linear = soft_layer_fits()
    yield ReportFigure(
        name="figures-4-42-4-46-skin-replica",
        title="Friction on the skin replica over voltage and amplitude",
        caption="As D figures 4.42 and 4.46. Neither voltages nor amplitudes are printed. Voltages are over that of "
        "the tests under three loads, with the amplitude in proportion (D figure 4.45). The amplitude is over "
        f"the decay length of the layer's pressure, {stiffening.value:.2g} in those tests, and over the indentation "
        f"under {column_numbers('4.6', 'normal_load')[1].value:g} N for the linear layer, {linear.value:.2g}, each "
        "fitted to the three printed ratios. Points: D 4.4.3. Right: with rim and centre in antiphase, as assumed, and "
        "with a uniform motion, which a body behind so soft a layer follows: no reduction, as in failed attempts of "
        "earlier studies (D 4.4.1).",
        draw=_over_amplitude,
    )
    if finite_elements_missing():
        return
    yield ReportFigure(
        name="figure-4-44-cutter-head-mode",
        title="Vibration mode of the cutter head",
        caption="As D figure 4.44, by finite elements: displacement along the axis on the face of the disc, over its "
        "largest. None of the sizes is printed; those taken are chosen for a mode at 20 kHz, and slots are left out. "
        "Right: the same over the radius, with the mode that the models of the soft layer assume; that has no mean "
        "over the face, this one has. Centre and rim move against each other, as the vibrometer showed.",
        draw=_mode,
    )


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class HeadMode:
    """Mode of the cutter head at its drive: displacement of the face of the disc along the axis.

    Parameters
    ----------
    frequency : float
        Natural frequency, short-circuited. [Hz]
    places : ndarray, shape (n, 2)
        Nodes on a quarter of the face, from its centre, in m.
    shape : ndarray, shape (n,)
        Displacement over its largest, positive at the centre.
    """

    frequency: float
    places: Floats
    shape: Floats

    @property
    def radius(self) -> Floats:
        """Distances of the nodes from the centre. [m]"""
        return np.asarray(np.hypot(*self.places.T))


@cache
def head_mode() -> HeadMode:
    """Mode nearest to the frequency of Table 4.6 of those that move the centre of the disc."""
    head = cutter_head_quarter()
    mesh = generate_mesh(head.geometry, element_size=_ELEMENT_SIZE)
    modes = natural_modes(head.model(mesh), count=_MODES)
    face = mesh.face_nodes("tip.+z")
    places, motion = mesh.nodes[face, :2], modes.shapes[:, face, 2]
    centre = motion[:, np.argmin(np.hypot(*places.T))]
    moving = np.abs(centre) > np.abs(motion).max(axis=1) / 2
    apart = np.abs(modes.natural_frequency - si_value("table-4.6-frequency-1"))
    best = int(np.argmin(np.where(moving, apart, np.inf)))
    shape = motion[best] * np.sign(centre[best])
    return HeadMode(frequency=float(modes.natural_frequency[best]), places=places, shape=shape / np.abs(shape).max())


def _over_amplitude() -> "Figure":
    """Draw the coefficient of friction over voltage and amplitude, and the reduction by two modes over amplitude."""
    figure, (volts, coefficients, reductions) = axes_row(3, (7.8, 3.4))
    stiffening, linear = soft_layer_fits()
    loads = [load.text for load in column_numbers("4.6", "normal_load").values()]
    relative = np.linspace(0.0, 2.0, 101)
    tested = si_value("4.4.3-voltage-test-load")
    off = si_value(f"4.4.3-coefficient-off-{tested:g}N")
    beta = stiffening.value * relative
    ratio = exponential_layer_ratio(ASSUMED_MODE, vibration_amplitude=beta, decay_length=1.0)
    first = column_numbers("4.6", "normal_load")[1].value
    of_linear = linear_layer_ratio(
        ASSUMED_MODE, vibration_amplitude=linear.value * relative, static_indentation=tested / first
    )
    for index, (curve, label) in enumerate(((ratio, "stiffening layer"), (of_linear, "linear layer"))):
        volts.plot(relative, off * curve, **line_style(index), label=label)
    printed = [si_value(f"4.4.3-coefficient-{state}-{tested:g}N") for state in ("off", "on")]
    volts.plot([0.0, 1.0], printed, MARKERS[0], color="black", zorder=4, label="3 N, D 4.4.3")
    for index, load in enumerate(loads):
        style: dict[str, Any] = {"color": COLOURS[index], "zorder": 4}
        coefficient = si_value(f"4.4.3-coefficient-off-{load}N")
        coefficients.plot(beta, coefficient * ratio, LINES[index], **style, label=f"{load} N")
        printed = [si_value(f"4.4.3-coefficient-{state}-{load}N") for state in ("off", "on")]
        coefficients.plot([0.0, stiffening.value], printed, MARKERS[index], **style)
        reductions.plot(stiffening.value, 100 * si_value(f"4.4.3-reduction-{load}N"), MARKERS[index], **style)
    uniform = exponential_layer_ratio(_UNIFORM, vibration_amplitude=beta, decay_length=1.0)
    for index, (curve, label) in enumerate(((ratio, "antiphase"), (uniform, "uniform"))):
        reductions.plot(beta, 100 * (1 - curve), color="0.3", linestyle=LINES[3 * index], label=label)
    volts.set(xlabel="Voltage over that\nof the three tests [1]", xticks=(0, 1, 2))
    for axes in (coefficients, reductions):
        axes.set(xlabel="Amplitude at the centre\nover the decay length [1]", xticks=(0, 2, 4))
    for axes in (volts, coefficients):
        axes.set(ylabel="Coefficient of friction [1]", ylim=(0, 0.52), yticks=(0, 0.1, 0.2, 0.3, 0.4))
        axes.legend(loc="upper right")
    reductions.set(ylabel="Friction reduction [%]", ylim=(-3, 125), yticks=(0, 50, 100))
    reductions.legend(loc="upper left")
    return figure


def _mode() -> "Figure":
    """Draw the displacement of the face as a map and over the radius."""
    figure, (face, profile) = axes_row(2, (7.2, 3.3))
    mode = head_mode()
    quarters = [1e3 * mode.places * signs for signs in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
    (x, y), first = _without_twins(np.concatenate(quarters))
    displacement = np.tile(mode.shape, len(quarters))[first]
    filled = face.tricontourf(x, y, displacement, levels=np.linspace(-1, 1, 21), cmap="PuOr")
    face.tricontour(x, y, displacement, levels=[0.0], colors="black", linewidths=0.8)
    figure.colorbar(filled, ax=face, label="Displacement over its largest [1]", ticks=np.linspace(-1, 1, 5))
    face.set(xlabel="x [mm]", ylabel="y [mm]", aspect="equal", xticks=(-15, 0, 15), yticks=(-15, 0, 15))
    face.grid(visible=False)
    edge = 1e3 * mode.radius.max()
    profile.plot(
        1e3 * mode.radius,
        mode.shape,
        ".",
        color=COLOURS[0],
        ms=3,
        label=f"finite elements, {1e-3 * mode.frequency:.1f} kHz",
    )
    rim, radius = ASSUMED_MODE.rim_displacement_ratio, np.linspace(0.0, 1.0, 101)
    assumed = 1 - (1 - rim) * radius**2
    profile.plot(edge * radius, assumed, LINES[1], color=COLOURS[1], label="assumed for the layer")
    profile.axhline(0.0, color="0.4", linestyle=":", linewidth=1)
    profile.set(xlabel="Radius [mm]", ylabel="Displacement over its largest [1]")
    profile.set(xticks=(0, 5, 10, 15), yticks=(-1, -0.5, 0, 0.5, 1))
    profile.legend(loc="lower left")
    return figure


def _without_twins(points: Floats) -> tuple[Floats, Integers]:
    """Coordinates of shape (2, m) of points of which none occurs twice, and their places among all."""
    _, first = np.unique(points.round(6), axis=0, return_index=True)
    return points[first].T, first
