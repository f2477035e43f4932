"""Section 4.4, the cutter head on the skin replica: rows and figures of friction and of the mode of the head.

Each model has one number fitted to the friction ratios under three loads. The mode of the head is not printed: D 4.4.4
states only that centre and rim move against each other.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from scipy.optimize import minimize_scalar

from dong2015 import formulas
from dong2015.chapter4.collar_rows import finite_elements_missing
from dong2015.hardware.transducers import cutter_head_quarter
from dong2015.plots import axes_row, line_style, report_figure, single_axes
from dong2015.row import Row, default_model_row, formula_row, published_formula_row
from sonolube.checks import Floats, Integers
from sonolube.facts.published import PrintedNumber, column_numbers, published_number, published_value, si_value
from sonolube.figure import COLOURS, LINES, MARKERS, ReportFigure
from sonolube.models.fem import generate_mesh, natural_modes
from sonolube.models.friction import FaceVibrationMode, exponential_layer_ratio, linear_layer_ratio

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ASSUMED_MODE: Final = FaceVibrationMode(rim_displacement_ratio=-1.0, following_fraction=1.0)
"""Rim and centre with equal and opposite displacements, which have no mean that the soft body could follow."""

_ASSUMED: Final = (
    "assumed: rim and centre move alike in opposite directions, patches act independently, the head is too heavy to"
    " follow, fibres give way by more than the 2.2 um slid in a period"
)


@dataclass(frozen=True, kw_only=True, slots=True)
class SoftLayerFit:
    """Soft-layer model with its parameter fitted to the three loads.

    Parameters
    ----------
    name : str
        Name in the rows.
    parameter : str
        Fitted parameter in words.
    value : float
        Value of the parameter.
    measured, computed : tuple of float
        Friction ratio under each load, of the printed forces and of the model.
    """

    name: str
    parameter: str
    value: float
    measured: tuple[float, ...]
    computed: tuple[float, ...]


def skin_replica_rows() -> Iterator[Row]:
    """Yield the rows of section 4.4."""
    yield from _measured_friction()
    yield from _soft_layers()


def skin_replica_figures() -> Iterator[ReportFigure]:
    """Figure of section 4.4."""
    yield report_figure("section-4-4-skin-replica", _friction_coefficients)


@cache
def soft_layer_fits() -> tuple[SoftLayerFit, ...]:
    """Both soft-layer models, each with its parameter fitted to the three friction ratios by least squares."""
    loads = _loads()
    newtons = np.array([load.value for load in loads])
    measured = np.array([_force("on", load).value / _force("off", load).value for load in loads])

    def stiffening(parameter: float) -> Floats:
        ratio = exponential_layer_ratio(ASSUMED_MODE, vibration_amplitude=parameter, decay_length=1.0)
        return np.full(newtons.shape, ratio)

    def linear(parameter: float) -> Floats:
        indentation = newtons / newtons[0]
        return linear_layer_ratio(ASSUMED_MODE, vibration_amplitude=parameter, static_indentation=indentation)

    return (
        _fit("stiffening", "amplitude over the decay length of the layer's pressure", stiffening, measured),
        _fit("linear", f"amplitude over the indentation under {newtons[0]:g} N", linear, measured),
    )


def _fit(name: str, parameter: str, model: Callable[[float], Floats], measured: Floats) -> SoftLayerFit:
    """Soft-layer model fitted to measured friction ratios."""
    best = minimize_scalar(
        lambda value: float(np.sum((model(value) - measured) ** 2)),
        bounds=(0.01, 20.0),
        method="bounded",
        options={"xatol": 1e-8},
    )
    value, ratios = float(best.x), tuple(measured.tolist())
    return SoftLayerFit(
        name=name, parameter=parameter, value=value, measured=ratios, computed=tuple(model(value).tolist())
    )


def _measured_friction() -> Iterator[Row]:
    """Yield coefficients and reductions from the forces, and the loads of the whole head."""
    coefficients = []
    for load in _loads():
        off, on = _force("off", load), _force("on", load)
        coefficients.append(on.value / load.value)
        for state, friction in (("off", off), ("on", on)):
            coefficient = f"4.4.3-coefficient-{state}-{load.text}N"
            note = f"{friction.text} N over {load.text} N, the load taken as exact"
            yield formula_row(coefficient, note, lambda force, load=load.value: force / load, friction)
        note = f"D 2.1 from {off.text} N and {on.text} N"
        yield formula_row(f"4.4.3-reduction-{load.text}N", note, formulas.friction_reduction, off, on)
    mean = float(np.mean(coefficients))
    yield published_formula_row("4.4.3-coefficient-on", mean, "mean over the three loads of force over load")
    lowest, *higher = (load.value for load in _loads())
    heads = si_value("4.4.2-total-load-6") / lowest
    for total, each in zip(("9", "12"), higher, strict=True):
        yield published_formula_row(f"4.4.2-total-load-{total}", heads * each, f"{each:g} N on each of {heads:g} heads")


def _soft_layers() -> Iterator[Row]:
    """Yield the friction coefficients with vibration by the stiffening layer, with the linear one beside it."""
    stiffening, linear = soft_layer_fits()
    for index, load in enumerate(_loads()):
        (value, note), other = (_soft_layer(fit, index) for fit in (stiffening, linear))
        published = replace(
            published_value(f"4.4.3-coefficient-on-{load.text}N"), id=f"soft-{stiffening.name}-{load.text}N"
        )
        yield default_model_row(
            published,
            value,
            note,
            fitted="the one parameter, with the numbers of the other two loads",
            alternatives={f"{linear.name} layer": other},
        )


def _soft_layer(fit: SoftLayerFit, index: int) -> tuple[float, str]:
    """Friction coefficient with vibration by a soft-layer model under a load, with its note."""
    load, ratio = _loads()[index], fit.computed[index]
    off = _force("off", load).value
    note = (
        f"{fit.name.capitalize()} layer, one number fitted to the three loads: {fit.parameter} {fit.value:.3g};"
        f" ratio {ratio:.3f} of {off:g} N over {load.text} N; {_ASSUMED}."
    )
    return ratio * off / load.value, note


def _friction_coefficients() -> "Figure":
    """Draw the printed friction coefficients, those of the forces, and the reductions of the forces."""
    figure, axes = single_axes()
    loads = _loads()
    newtons = [load.value for load in loads]
    for index, (state, label) in enumerate((("off", "without vibration"), ("on", "with vibration"))):
        printed = [si_value(f"4.4.3-coefficient-{state}-{load.text}N") for load in loads]
        of_forces = [_force(state, load).value / load.value for load in loads]
        colour = COLOURS[index]
        axes.plot(newtons, printed, MARKERS[index], color=colour, label=f"{label}, section 4.4.3")
        axes.plot(newtons, of_forces, "o", ms=11, mfc="none", color=colour, label=f"{label}, force over load")
    for load in loads:
        off, on = (_force(state, load).value for state in ("off", "on"))
        ends = (load.value, on / load.value + 0.02), (load.value, off / load.value - 0.02)
        axes.annotate("", *ends, arrowprops={"arrowstyle": "->", "color": "0.4"})
        reduction = formulas.friction_reduction(off, on)
        axes.text(load.value + 0.06, (off + on) / (2 * load.value), f"−{100 * reduction:.0f} %", va="center")
    axes.set(
        xlabel="Normal load [N]", ylabel="Coefficient of friction [1]", xlim=(1.5, 4.7), ylim=(0, 0.6), xticks=newtons
    )
    axes.legend(loc="upper left")
    return figure


def _loads() -> list[PrintedNumber]:
    """Three loads of one head, Table 4.6."""
    return list(column_numbers("4.6", "normal_load").values())


def _force(state: str, load: PrintedNumber) -> PrintedNumber:
    """Friction force without ("off") or with ("on") vibration under a load."""
    return published_number(f"4.4.3-friction-{state}-{load.text}N")


_ELEMENT_SIZE: Final = 9e-3  # m; the thickness of the disc decides the mesh
_MODES: Final = 5  # even ones, of which one is near 20 kHz and moves the centre of the disc
_UNIFORM: Final = FaceVibrationMode(rim_displacement_ratio=1.0, following_fraction=1.0)


def cutter_head_figures() -> Iterator[ReportFigure]:
    """Figures of section 4.4; that of the mode only where the packages of the finite elements are there."""
    stiffening, linear = soft_layer_fits()
    yield report_figure(
        "figures-4-42-4-46-skin-replica",
        _over_amplitude,
        stiffening=stiffening.value,
        load=column_numbers("4.6", "normal_load")[1].value,
        linear=linear.value,
    )
    if finite_elements_missing():
        return
    yield report_figure("figure-4-44-cutter-head-mode", _mode)


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
