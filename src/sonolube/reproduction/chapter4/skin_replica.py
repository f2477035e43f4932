"""Section 4.4, the cutter head on the skin replica: rows and figure of friction, and two fitted soft-layer models.

Each model has one number fitted to the friction ratios under three loads. The mode of the head is not printed: D 4.4.4
states only that centre and rim move against each other.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING, Final

import numpy as np
from scipy.optimize import minimize_scalar

from sonolube.checks import Floats
from sonolube.facts.published import PrintedNumber, column_numbers, published_number, published_value, si_value
from sonolube.figure import COLOURS, MARKERS, ReportFigure
from sonolube.models.friction import FaceVibrationMode, exponential_layer_ratio, linear_layer_ratio
from sonolube.reproduction import formulas
from sonolube.reproduction.plots import single_axes
from sonolube.reproduction.row import Row, default_model_row, formula_row, published_formula_row

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
    yield ReportFigure(
        name="section-4-4-skin-replica",
        title="Friction coefficient on the skin replica",
        caption="Steel cutter head on a skin replica, 44.3 mm/s and 20 kHz. Filled: coefficients as section 4.4.3 "
        "prints them. Rings: its forces over the loads of Table 4.6. Arrows: reductions of those forces.",
        draw=_friction_coefficients,
    )


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
