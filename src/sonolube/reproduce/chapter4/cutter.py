"""Section 4.4, the cutter head on the skin replica: two soft layers, each with one number fitted to three loads."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from scipy.optimize import minimize_scalar

from sonolube.checks import Floats
from sonolube.friction import FaceVibrationMode, exponential_layer_ratio, linear_layer_ratio
from sonolube.published.values import stated
from sonolube.reproduce.row import Row, compare
from sonolube.validation.inputs import said
from sonolube.validation.power_map import printed

# nobody printed the mode: D 4.4.4 has only that centre and rim move against each other
ASSUMED_MODE = FaceVibrationMode(rim_displacement_ratio=-1.0, following_fraction=1.0)
"""Rim as far as the centre the other way, which leaves no mean motion for the soft body to follow."""

_ASSUMED = (
    "assumed: rim and centre move alike in opposite directions, patches act for themselves, the head is too heavy to"
    " follow, fibres give way by more than the 2.2 um slid in a period"
)


@dataclass(frozen=True, kw_only=True, slots=True)
class SoftLayerFit:
    """One layer law with the amplitude that suits the three loads best.

    Parameters
    ----------
    name : str
        Its name in the rows.
    fitted : str
        What was fitted.
    value : float
        Its value.
    load : tuple of float
        Loads of one head in N.
    measured, computed : tuple of float
        Friction with vibration over friction without, as printed forces and the model have it.
    """

    name: str
    fitted: str
    value: float
    load: tuple[float, ...]
    measured: tuple[float, ...]
    computed: tuple[float, ...]


@cache
def soft_layer_fits() -> tuple[SoftLayerFit, ...]:
    """Return both layer laws, each with its one number fitted to the three ratios by least squares."""
    cells = printed("4.6", "normal_load").values()
    loads = np.array([load.value for load in cells])
    measured = np.array([_force("on", load.text) / _force("off", load.text) for load in cells])

    def stiffening(reach: float) -> Floats:
        ratio = exponential_layer_ratio(ASSUMED_MODE, vibration_amplitude=reach, decay_length=1.0)
        return np.full(loads.shape, ratio)

    def linear(reach: float) -> Floats:
        return linear_layer_ratio(ASSUMED_MODE, vibration_amplitude=reach, static_indentation=loads / loads[0])

    return (
        _fit("stiffening", "amplitude over the decay length of the layer's pressure", stiffening, loads, measured),
        _fit("linear", f"amplitude over the indentation under {loads[0]:g} N", linear, loads, measured),
    )


def cutter_rows() -> Iterator[Row]:
    """Yield for each layer law and load the friction coefficient with vibration."""
    for fit in soft_layer_fits():
        for load, ratio in zip(printed("4.6", "normal_load").values(), fit.computed, strict=True):
            published = stated(f"4.4.3-coefficient-on-{load.text}N")
            note = (
                f"{fit.name.capitalize()} layer, one number fitted to the three loads: {fit.fitted} {fit.value:.3g};"
                f" ratio {ratio:.3f} of {_force('off', load.text):g} N over {load.text} N; {_ASSUMED}."
            )
            computed = ratio * _force("off", load.text) / load.value
            yield compare(replace(published, id=f"soft-{fit.name}-{load.text}N"), computed, note)


def _fit(name: str, fitted: str, law: Callable[[float], Floats], loads: Floats, measured: Floats) -> SoftLayerFit:
    best = minimize_scalar(
        lambda reach: float(np.sum((law(reach) - measured) ** 2)),
        bounds=(0.01, 20.0),
        method="bounded",
        options={"xatol": 1e-8},
    )
    return SoftLayerFit(
        name=name,
        fitted=fitted,
        value=float(best.x),
        load=tuple(loads.tolist()),
        measured=tuple(measured.tolist()),
        computed=tuple(law(float(best.x)).tolist()),
    )


def _force(state: str, load: str) -> float:
    return said(f"4.4.3-friction-{state}-{load}N").value
