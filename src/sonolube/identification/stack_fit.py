"""Residuals of a model's admittance against a measured spectrum, and parameters of a stack by least squares on them.

Where only the magnitude of the admittance was measured, its phase is that of minimum phase, for initial values.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
from scipy.optimize import nnls

from sonolube.checks import Complexes, Floats, require_within
from sonolube.errors import InvalidInput, UnknownName
from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum, passive_spectrum
from sonolube.measurement.statistics.log_parameter_fit import (
    ConfidenceInterval,
    confidence_intervals,
    fit_log_parameters,
    residual_inefficiency,
)
from sonolube.models.actuator import PiezoStack
from sonolube.models.dynamics.structure import Structure, electrical_admittance

_INDUCTIVE_SHARE = 0.05  # of the points
_HARDLY_DETERMINED = 4.0  # upper end of an interval over the lower

LOG_COMPLEX = "log-complex"
LOG_MAGNITUDE = "log-magnitude"
LINEAR_MAGNITUDE = "linear-magnitude"


def _log_complex(model: Complexes, measured: Complexes) -> Floats:
    """Logarithms of the magnitude ratio, then phase differences in rad, shape (2n,)."""
    ratio = np.log(model / measured)  # principal branch: phase differences lie between -pi and pi
    return np.concatenate([ratio.real, ratio.imag])


def _log_magnitude(model: Complexes, measured: Complexes) -> Floats:
    """Logarithms of the magnitude ratio, shape (n,)."""
    return np.asarray(np.log(np.abs(model) / np.abs(measured)))


def _linear_magnitude(model: Complexes, measured: Complexes) -> Floats:
    """Differences of the magnitudes over the largest measured one, shape (n,)."""
    magnitude = np.abs(measured)
    return np.asarray((np.abs(model) - magnitude) / magnitude.max())


RESIDUALS: Mapping[str, Callable[[Complexes, Complexes], Floats]] = MappingProxyType(
    {LOG_COMPLEX: _log_complex, LOG_MAGNITUDE: _log_magnitude, LINEAR_MAGNITUDE: _linear_magnitude}
)


def residual_for(spectrum: ImpedanceSpectrum, name: str) -> str:
    """Name of the residual for a spectrum: "log-magnitude" in place of "log-complex" where no phase was measured."""
    return LOG_MAGNITUDE if name == LOG_COMPLEX and not spectrum.has_phase else name


def hardly_determined(intervals: Mapping[str, ConfidenceInterval]) -> list[str]:
    """Names of the parameters that a spectrum hardly determines."""
    return [name for name, found in intervals.items() if not found.upper < _HARDLY_DETERMINED * found.lower]


def caveats_of_spectrum(spectrum: ImpedanceSpectrum, intervals: Mapping[str, ConfidenceInterval]) -> tuple[str, ...]:
    """Warnings about a spectrum of magnitudes only, and about parameters that a spectrum hardly determines."""
    loose = hardly_determined(intervals)
    named = f"hardly determined: {', '.join(loose)}" if loose else "it determines every parameter"
    if not spectrum.has_phase:
        return (f"the spectrum has no phase, so the fit is to the magnitude of the admittance alone; {named}",)
    return (f"{named}; the spectrum is not that of the model",) if loose else ()


def inductive_caveats(spectrum: ImpedanceSpectrum, fitted: Complexes) -> tuple[str, ...]:
    """Warning about a part of a spectrum that is inductive where the fitted admittance is capacitive.

    A transducer is inductive between its series and its parallel resonance, and so is the fitted admittance.
    """
    f = spectrum.frequency
    apart = (spectrum.admittance.imag < 0) & (fitted.imag > 0)
    if not np.mean(apart) > _INDUCTIVE_SHARE:
        return ()
    return (
        f"the impedance is inductive at {np.mean(apart):.0%} of the points, from {f[apart][0]:.6g} to"
        f" {f[apart][-1]:.6g} Hz, where the fitted circuit is capacitive: leads or a coil in series,"
        " which the circuit lacks",
    )


def residual_named(name: str) -> Callable[[Complexes, Complexes], Floats]:
    r"""Residual function of a name, which takes a model's admittance and the measured one.

    For the model's admittance :math:`Y_i` and the measured one :math:`\hat Y_i`, "log-complex" is

    .. math:: \left(\operatorname{Re} \ln \frac{Y_i}{\hat Y_i},\ \operatorname{Im} \ln \frac{Y_i}{\hat Y_i}\right),

    which gives every point the same relative weight, "log-magnitude" its first part, and "linear-magnitude" is

    .. math:: \frac{|Y_i| - |\hat Y_i|}{\max_j |\hat Y_j|},

    in which points about the resonance have nearly all the weight.
    """
    if name not in RESIDUALS:
        raise UnknownName.among(RESIDUALS, kind="residual", name=name)
    return RESIDUALS[name]


_MAX_POINTS = 5000  # of which the phase is computed; between them it is interpolated


def admittance_with_phase(spectrum: ImpedanceSpectrum) -> Complexes:
    """Measured admittance, its phase that of minimum phase where only the magnitude was measured."""
    if spectrum.has_phase:
        return spectrum.admittance
    return minimum_phase_admittance(np.abs(spectrum.admittance), frequency=spectrum.frequency)


def minimum_phase_admittance(magnitude: Floats, *, frequency: Floats) -> Complexes:
    r"""Admittance of a capacitive one-port from its magnitude, by the relation of gain and phase.

    Complex, of the given magnitude.

    An admittance of passive parts has neither poles nor zeros in the right half-plane, so that its phase follows from
    its magnitude With :math:`g = \ln(|Y|/f)`, which is constant far from resonances,

    .. math:: \varphi(f) = \frac{\pi}{2} + \frac{2f}{\pi} \int_0^\infty \frac{g(\nu) - g(f)}{\nu^2 - f^2}\,d\nu .

    Beyond the sweep g is continued as constant, so the phase is approximate near the ends of a sweep that begins or
    ends close to a resonance.

    Source: H. W. Bode, Network Analysis and Feedback Amplifier Design, Van Nostrand (1945), chapter 14.
    """
    step = -(-frequency.size // _MAX_POINTS)
    f = frequency[::step]
    phase = np.interp(frequency, f, _phase(np.log(magnitude[::step] / f), f))
    return np.asarray(magnitude * np.exp(1j * np.clip(phase, -np.pi / 2, np.pi / 2)))


def _phase(gain: Floats, frequency: Floats) -> Floats:
    """Phase in rad, by the trapezoidal rule within the sweep and in closed form beyond."""
    phase = np.empty_like(gain)
    width = np.gradient(frequency)
    lowest, highest = frequency[0], frequency[-1]
    slope = np.gradient(gain, frequency)
    for at, f in enumerate(frequency):
        with np.errstate(divide="ignore", invalid="ignore"):
            kernel = (gain - gain[at]) / (frequency**2 - f**2)
            below = np.log((f + lowest) / (f - lowest)) / (2 * f)
            above = np.log((highest + f) / (highest - f)) / (2 * f)
        kernel[at] = slope[at] / (2 * f)
        inside = float(np.sum(kernel * width)) - 0.5 * float(kernel[0] * width[0] + kernel[-1] * width[-1])
        beyond = (gain[-1] - gain[at]) * above if at < gain.size - 1 else 0.0
        before = (gain[0] - gain[at]) * below if at else 0.0
        phase[at] = np.pi / 2 + 2 * f / np.pi * (inside + beyond - before)
    return phase


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
    fitted = ("free_capacitance", "free_stroke_per_volt", "stack_stiffness", "stack_damping", "clamped_capacitance")
    derived = {"coupling_factor": stack.derived_coupling_factor, "charge_per_elongation": stack.charge_per_elongation}
    return {name: getattr(stack, name) for name in fitted} | derived


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
