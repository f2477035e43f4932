"""Parameters of a piezoelectric stack in a known structure, by least squares on its measured impedance spectrum."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import nnls

from sonolube.checks import Complexes, Floats, require_within
from sonolube.errors import InvalidInput
from sonolube.identification.minimum_phase import admittance_with_phase
from sonolube.identification.spectral_residual import LOG_COMPLEX, caveats_of_spectrum, residual_for, residual_named
from sonolube.measurement.impedance.passivity import passive_spectrum
from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum
from sonolube.measurement.statistics.log_parameter_fit import (
    ConfidenceInterval,
    confidence_intervals,
    fit_log_parameters,
    residual_inefficiency,
)
from sonolube.models.actuator import PiezoStack
from sonolube.models.dynamics.structure import Structure, electrical_admittance

_STIFFNESS_FACTORS = np.geomspace(1 / 30, 30, 121)
_DAMPING_FACTORS = (0.1, 1.0, 10.0)
_MIN_POINTS = 8
_CORRELATED = 3.0


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class StackFit:
    """Parameters of a stack fitted to an impedance spectrum, with confidence intervals.

    Parameters
    ----------
    stack : PiezoStack
        Fitted stack; mass, limits and preload are those of the initial one.
    intervals : mapping of str to ConfidenceInterval
        Confidence intervals of free_capacitance, free_stroke_per_volt, stack_stiffness, stack_damping,
        clamped_capacitance and coupling_factor.
    charge_per_elongation : ConfidenceInterval
        Confidence interval of the blocked force per volt, in N/V.
    residual : str
        Name of the residual whose sum of squares was minimised.
    residual_rms : float
        Root mean square of the residual.
    residual_correlation : float
        Number of residuals over the number of independent ones, for which the intervals are widened.
    confidence_level : float
        Of the intervals. []
    caveats : tuple of str
        Warnings about the fit, one line each.
    """

    stack: PiezoStack
    intervals: Mapping[str, ConfidenceInterval]
    charge_per_elongation: ConfidenceInterval
    residual: str
    residual_rms: float
    residual_correlation: float
    confidence_level: float
    caveats: tuple[str, ...]


def fit_stack(
    spectrum: ImpedanceSpectrum,
    stack: PiezoStack,
    *,
    in_structure: Callable[[PiezoStack], Structure],
    residual: str = LOG_COMPLEX,
    confidence_level: float = 0.95,
) -> StackFit:
    r"""Stack parameters from the impedance spectrum of its structure, the contact free, by nonlinear least squares.

    See Also
    --------
    sonolube.identification.circuit_fit.fit_circuit : Equivalent circuit, without knowledge of the structure.

    The admittance of the structure is

    .. math:: Y(\omega) = i\omega \left[C_S + (N d_{33} k_p)^2\, h(\omega; k_p, c_p)\right]

    with the elongation per force :math:`h` along the stack. The frequency and width of its resonance determine
    :math:`k_p` and :math:`c_p`; the level and the distance to the antiresonance determine :math:`C_S` and
    :math:`N d_{33}`. Initial values are the best of 363 pairs :math:`(k_p, c_p)`, for each of which the two factors
    follow by non-negative linear least squares. A relative error of the masses causes the same relative error of the
    stiffness.

    Source: D 3.3.4, figure 3.12, where the parameters were found by matching the curves by eye.
    """
    residual_named(residual)
    require_within(0.5, 0.9999, confidence_level=confidence_level)
    if spectrum.frequency.size < _MIN_POINTS:
        raise InvalidInput(f"spectrum must have at least {_MIN_POINTS} points, got {spectrum.frequency.size}")

    spectrum, turned = passive_spectrum(spectrum)
    residual = residual_for(spectrum, residual)
    compare, admittance = residual_named(residual), admittance_with_phase(spectrum)

    def model(candidate: PiezoStack) -> Complexes:
        return electrical_admittance(in_structure(candidate), frequency=spectrum.frequency)

    initial = _initial_stack(spectrum, replace(stack, coupling_factor=None), model)
    fit = fit_log_parameters(
        lambda logarithms: compare(model(_stack(initial, logarithms)), admittance), _logarithms(initial)
    )
    correlation = residual_inefficiency(fit, rows=fit.residuals.size // spectrum.frequency.size)
    known = confidence_intervals(
        fit,
        lambda logarithms: _quantities(_stack(initial, logarithms)),
        correlation=correlation,
        confidence_level=confidence_level,
    )
    return StackFit(
        stack=_stack(initial, fit.logarithms),
        charge_per_elongation=known.pop("charge_per_elongation"),
        intervals=known,
        residual=residual,
        residual_rms=float(np.sqrt(fit.sum_of_squares / spectrum.frequency.size)),
        residual_correlation=correlation,
        confidence_level=confidence_level,
        caveats=(
            *turned,
            *(caveats_of_spectrum(spectrum, known) if not spectrum.has_phase else ()),
            *_caveats(fit.converged, correlation, known["stack_stiffness"]),
        ),
    )


def _initial_stack(
    spectrum: ImpedanceSpectrum, stack: PiezoStack, model: Callable[[PiezoStack], Complexes]
) -> PiezoStack:
    """Initial values: best of a grid of stiffnesses and dampings, capacitance and stroke by linear least squares."""
    omega, measured = 2 * np.pi * spectrum.frequency, admittance_with_phase(spectrum)
    best, least = None, np.inf
    for stiffness in stack.stack_stiffness * _STIFFNESS_FACTORS:
        light = 1e-6 * stack.stack_stiffness / (2 * np.pi)  # that of a loss factor of 2 % at 20 kHz
        for damping in (stack.stack_damping or light) * np.array(_DAMPING_FACTORS):
            trial = replace(
                stack,
                stack_stiffness=float(stiffness),
                stack_damping=float(damping),
                free_stroke_per_volt=stack.free_stroke_per_volt * float(min(1.0, (stack.stack_stiffness / stiffness))),
            )
            response = (model(trial) / (1j * omega) - trial.clamped_capacitance) / trial.charge_per_elongation**2
            columns = np.stack([np.ones_like(response), response], axis=-1) * (1j * omega / measured)[:, np.newaxis]
            scale = np.abs(columns).max(axis=0)
            stacked = np.concatenate([columns.real, columns.imag]) / scale
            target = np.concatenate([np.ones_like(omega), np.zeros_like(omega)])
            (clamped, square), misfit = nnls(stacked, target)
            if misfit < least and clamped > 0 and square > 0:
                least = misfit
                force = float(np.sqrt(square / scale[1]))
                best = replace(
                    trial,
                    free_stroke_per_volt=force / trial.stack_stiffness,
                    free_capacitance=float(clamped / scale[0]) + force**2 / trial.stack_stiffness,
                )
    if best is None:
        raise InvalidInput(
            "no stack in this structure fits the spectrum; check the masses of the structure and the range of the sweep"
        )
    return best


def _logarithms(stack: PiezoStack) -> Floats:
    """Unbounded parameters of a stack: ln C_T, ln k^2/(1 - k^2), ln k_p and ln c_p, shape (4,)."""
    squared = stack.derived_coupling_factor**2
    return np.log([stack.free_capacitance, squared / (1 - squared), stack.stack_stiffness, stack.stack_damping])


def _stack(template: PiezoStack, logarithms: Floats) -> PiezoStack:
    """Stack of the unbounded parameters, any of which make a possible stack."""
    capacitance, odds, stiffness, damping = np.exp(np.clip(logarithms, -200, 200)).tolist()
    squared = min(odds / (1 + odds), 1 - 1e-12)
    return replace(
        template,
        free_capacitance=capacitance,
        free_stroke_per_volt=float(np.sqrt(squared * capacitance / stiffness)),
        stack_stiffness=stiffness,
        stack_damping=damping,
    )


def _quantities(stack: PiezoStack) -> dict[str, float]:
    """Quantities of a stack whose confidence intervals are reported."""
    return {
        "free_capacitance": stack.free_capacitance,
        "free_stroke_per_volt": stack.free_stroke_per_volt,
        "stack_stiffness": stack.stack_stiffness,
        "stack_damping": stack.stack_damping,
        "clamped_capacitance": stack.clamped_capacitance,
        "coupling_factor": stack.derived_coupling_factor,
        "charge_per_elongation": stack.charge_per_elongation,
    }


def _caveats(converged: bool, correlation: float, stiffness: ConfidenceInterval) -> tuple[str, ...]:
    """Warnings about convergence, an undetermined stiffness and correlated residuals."""
    caveats = []
    if not converged:
        caveats.append("the fit did not converge; sweep over a resonance of the stack")
    if not stiffness.upper < 4 * stiffness.lower:
        caveats.append("the stiffness is hardly determined; sweep over a resonance in which the stack takes part")
    if correlation > _CORRELATED:
        caveats.append(
            f"residuals are correlated over {correlation:.0f} points: the structure does not describe the spectrum"
            " fully"
        )
    return tuple(caveats)
