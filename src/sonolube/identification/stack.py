"""The stack in a structure from the impedance measured at its terminals."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import nnls

from sonolube.actuator import PiezoStack
from sonolube.checks import Complexes, Floats, require_within
from sonolube.dynamics.structure import Structure, electrical_admittance
from sonolube.errors import InvalidInput
from sonolube.identification.spectral_residual import LOG_COMPLEX, residual_named
from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum
from sonolube.measurement.statistics.log_parameter_fit import (
    ConfidenceInterval,
    confidence_intervals,
    fit_log_parameters,
    residual_inefficiency,
)

_STIFFNESS_FACTORS = np.geomspace(1 / 30, 30, 121)
_DAMPING_FACTORS = (0.1, 1.0, 10.0)
_LEAST_POINTS = 8
_CORRELATED = 3.0


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class StackFit:
    """The stack with which a structure draws the current measured.

    Parameters
    ----------
    stack : PiezoStack
        Its mass, limits and preload are those it was given.
    intervals : mapping of str to ConfidenceInterval
        Of free_capacitance, free_stroke_per_volt, stack_stiffness, stack_damping, clamped_capacitance and
        coupling_factor.
    charge_per_elongation : ConfidenceInterval
        Blocked force per volt, in N/V.
    residual : str
        Name of what was made small.
    residual_rms : float
        Its root mean square.
    residual_correlation : float
        Samples over independent samples among the residuals, for which the intervals are widened.
    confidence_level : float
        Of the intervals. []
    caveats : tuple of str
        What speaks against the fit, one line each.
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
    """Return the stack whose structure fits a measured spectrum best, the contact free.

    Parameters
    ----------
    spectrum : ImpedanceSpectrum
        Over a resonance in which the stack takes part.
    stack : PiezoStack
        As its maker states it, or as guessed.
    in_structure : callable
        Returns the structure with a stack in it; all else about the structure is known.
    residual : str
        "log-complex" or "linear-magnitude".
    confidence_level : float
        Of the intervals. []

    Returns
    -------
    StackFit

    Raises
    ------
    InvalidInput
        If the spectrum has fewer than 8 points, or no stack within 30 times the stiffness stated comes near it.
    UnknownName
        If the residual is none of `RESIDUALS`.

    Notes
    -----
    With everything else known the admittance i w (C_S + (N d33 k_p)^2 h(w)) gives all four parameters: h, elongation
    per force along the stack, has its resonance where the stiffness puts it, as high as the damping lets it; the
    distance of the two resonances and the level give the rest. The search starts at the best of 363 stiffnesses and
    dampings, for which the two factors follow linearly. Masses that are a tenth wrong make the stiffness a tenth wrong.

    References
    ----------
    .. [1] D 3.3.4, figure 3.12, where parameters were found by matching the curves.
    """
    compare = residual_named(residual)
    require_within(0.5, 0.9999, confidence_level=confidence_level)
    if spectrum.frequency.size < _LEAST_POINTS:
        raise InvalidInput(f"a spectrum of {spectrum.frequency.size} points is too short; give {_LEAST_POINTS}")

    def model(candidate: PiezoStack) -> Complexes:
        return electrical_admittance(in_structure(candidate), frequency=spectrum.frequency)

    guess = _first_guess(spectrum, replace(stack, coupling_factor=None), model)
    fit = fit_log_parameters(
        lambda logarithms: compare(model(_stack(guess, logarithms)), spectrum.admittance), _logarithms(guess)
    )
    correlation = residual_inefficiency(fit, rows=fit.residuals.size // spectrum.frequency.size)
    known = confidence_intervals(
        fit,
        lambda logarithms: _quantities(_stack(guess, logarithms)),
        correlation=correlation,
        confidence_level=confidence_level,
    )
    return StackFit(
        stack=_stack(guess, fit.logarithms),
        charge_per_elongation=known.pop("charge_per_elongation"),
        intervals=known,
        residual=residual,
        residual_rms=float(np.sqrt(fit.sum_of_squares / spectrum.frequency.size)),
        residual_correlation=correlation,
        confidence_level=confidence_level,
        caveats=_caveats(fit.converged, correlation, known["stack_stiffness"]),
    )


def _first_guess(
    spectrum: ImpedanceSpectrum, stack: PiezoStack, model: Callable[[PiezoStack], Complexes]
) -> PiezoStack:
    omega, measured = 2 * np.pi * spectrum.frequency, spectrum.admittance
    best, least = None, np.inf
    for stiffness in stack.stack_stiffness * _STIFFNESS_FACTORS:
        for damping in (stack.stack_damping or _light_damping(stack)) * np.array(_DAMPING_FACTORS):
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
            (clamped, square), miss = nnls(stacked, target)
            if miss < least and clamped > 0 and square > 0:
                least = miss
                force = float(np.sqrt(square / scale[1]))
                best = replace(
                    trial,
                    free_stroke_per_volt=force / trial.stack_stiffness,
                    free_capacitance=float(clamped / scale[0]) + force**2 / trial.stack_stiffness,
                )
    if best is None:
        raise InvalidInput(
            "no stack in this structure comes near the spectrum; do its masses and the sweep fit together?"
        )
    return best


def _light_damping(stack: PiezoStack) -> float:
    return 1e-6 * stack.stack_stiffness / (2 * np.pi)  # a loss of 2 % at 20 kHz


def _logarithms(stack: PiezoStack) -> Floats:
    squared = stack.derived_coupling_factor**2
    return np.log([stack.free_capacitance, squared / (1 - squared), stack.stack_stiffness, stack.stack_damping])


def _stack(template: PiezoStack, logarithms: Floats) -> PiezoStack:
    """Return the stack of ln C_T, ln k^2/(1 - k^2), ln k_p and ln c_p: any such numbers make a possible one."""
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
    caveats = []
    if not converged:
        caveats.append("the search did not end by itself; does the sweep hold a resonance of the stack?")
    if not stiffness.upper < 4 * stiffness.lower:
        caveats.append("the stiffness is hardly known; sweep over a resonance in which the stack takes part")
    if correlation > _CORRELATED:
        caveats.append(
            f"residuals resemble their neighbours over {correlation:.0f} points: the structure leaves something out"
        )
    return tuple(caveats)
