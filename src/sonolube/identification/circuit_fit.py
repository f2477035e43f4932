"""Butterworth-Van Dyke circuits from measured impedance spectra, by rational approximation and least squares."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from sonolube.checks import Complexes, Floats, require_non_negative, require_within
from sonolube.errors import InvalidInput
from sonolube.identification.stack_fit import (
    LOG_COMPLEX,
    RESIDUALS,
    admittance_with_phase,
    caveats_of_spectrum,
    inductive_caveats,
    residual_for,
    residual_named,
)
from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum, passive_spectrum
from sonolube.measurement.statistics.log_parameter_fit import (
    ConfidenceInterval,
    LogParameterFit,
    confidence_intervals,
    distinct_modes,
    fit_log_parameters,
    rational_poles,
    residual_inefficiency,
    spanning_intervals,
)
from sonolube.models.actuator import (
    ButterworthVanDyke,
    CircuitResonances,
    MotionalBranch,
    circuit_admittance,
    circuit_resonances,
)

_MAX_BRANCHES = 8
_LOWEST_QUALITY, _HIGHEST_QUALITY = 3.0, 1e7
_ROUNDING = 1e-9  # current of a branch over the total, below which it is rounding
_MAX_CANDIDATES = 3  # fitted for the next branch
_CORRELATED = 3.0  # residuals over independent ones, from which on a warning is given
_POINTS_PER_BRANCH = 4
_MOSTLY = 0.5  # of the points
_LARGEST_LOGARITHM = 300.0  # of a parameter, so that its square does not overflow
_OF_RESONANCES = ("series_frequency", "parallel_frequency", "mechanical_quality_factor", "coupling_factor")
_LARGEST_ERROR = 0.5  # standard error of the logarithm of a parameter


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class CircuitFit:
    """Butterworth-Van Dyke circuit fitted to an impedance spectrum, with confidence intervals.

    Parameters
    ----------
    circuit : ButterworthVanDyke
        Fitted circuit, branches in order of frequency.
    resonances : CircuitResonances
        Series and parallel frequencies without losses, quality and coupling factors of its branches.
    intervals : mapping of str to ConfidenceInterval
        Confidence intervals of parallel_capacitance, and of each branch's resistance, inductance, capacitance,
        series_frequency, parallel_frequency, mechanical_quality_factor and coupling_factor, followed by the branch's
        number: "resistance_1".
    residual : str
        Name of the residual whose sum of squares was minimised.
    residual_rms : float
        Root mean square of the residual: for "log-complex" of relative magnitude and phase in rad together, for
        "linear-magnitude" relative to the largest admittance.
    information_criteria : tuple of float
        Bayesian information criterion of the log-complex residual with 1, 2, ... branches.
    residual_correlation : float
        Number of residuals over the number of independent ones, for which the intervals are widened.
    confidence_level : float
        Of the intervals. []
    caveats : tuple of str
        Warnings about the fit, one line each.
    """

    circuit: ButterworthVanDyke
    resonances: CircuitResonances
    intervals: Mapping[str, ConfidenceInterval]
    residual: str
    residual_rms: float
    information_criteria: tuple[float, ...]
    residual_correlation: float
    confidence_level: float
    caveats: tuple[str, ...]


@dataclass(frozen=True, kw_only=True, slots=True)
class _Spectrum:
    """Measured admittance, series resistance of the leads, and the residual to minimise."""

    frequency: Floats
    admittance: Complexes
    series_resistance: float
    residual: str

    def residuals(self, logarithms: Floats) -> Floats:
        """Residuals of the circuit of given logarithms of its parameters."""
        model = circuit_admittance(_circuit(logarithms, self.series_resistance), frequency=self.frequency)
        return residual_named(self.residual)(model, self.admittance)

    def correlation(self, fit: LogParameterFit) -> float:
        """Number of residuals over the number of independent ones."""
        return residual_inefficiency(fit, rows=fit.residuals.size // self.frequency.size)

    def resolves(self, logarithms: Floats) -> bool:
        """Whether every branch resonates within the sweep with a plausible quality factor."""
        modes = logarithms[1:].reshape(-1, 3)
        f_s, quality = np.exp(np.clip(modes[:, :2].T, -_LARGEST_LOGARITHM, _LARGEST_LOGARITHM))
        swept = (f_s > self.frequency[0]) & (f_s < self.frequency[-1])
        return bool(np.all(swept & (quality > _LOWEST_QUALITY) & (quality < _HIGHEST_QUALITY)))


def fit_circuit(
    spectrum: ImpedanceSpectrum,
    *,
    branches: int | None = None,
    residual: str = LOG_COMPLEX,
    series_resistance: float = 0.0,
    confidence_level: float = 0.95,
) -> CircuitFit:
    r"""Butterworth-Van Dyke circuit of an impedance spectrum, by rational approximation and nonlinear least squares.

    See Also
    --------
    sonolube.identification.stack_fit.fit_stack : Stack parameters, where the structure about the stack is known.

    With the parallel capacitance :math:`C_0` and, for each branch, the series frequency :math:`f_s`, quality factor
    :math:`Q` and capacitance :math:`C`, the admittance behind the leads is

    .. math:: Y(f) = 2\pi i f \left[C_0 + \sum_k \frac{C_k}{1 - (f/f_{s,k})^2 + i f/(f_{s,k} Q_k)}\right] .

    Branches are added one by one. Candidates are the decaying poles of rational (AAA) approximations [1]_ to the
    difference between measured and fitted admittance, within the sweep and with a quality factor of 3 or more. The
    candidates that explain most are fitted together with all earlier branches, and the best fit is taken. This
    selection minimises the log-complex residual, in which weak modes have weight; a branch of which a parameter has a
    standard error above a factor of e^0.5 is rejected. Another residual is minimised only at the end. Where only the
    magnitude was measured, candidates come from the phase that belongs to it (`minimum_phase_admittance`), and every
    sum of squares is of the logarithm of the magnitude. A spectrum of negative conductance is turned by 180 degrees
    (`passive_spectrum`).

    Confidence intervals are of first order and widened for the correlation of residuals. Where these are correlated
    over more than three points the circuit leaves properties out, such as dielectric losses, and how the points are
    weighted decides the estimates: the intervals then span those of the fits by every residual.

    References
    ----------
    .. [1] Y. Nakatsukasa, O. Sete and L. N. Trefethen, SIAM J. Sci. Comput. 40, A1494 (2018). doi:10.1137/16M1106122
    .. [2] IEEE Std 176-1987, for the definitions of f_s, f_p and the coupling factor.
    """
    residual_named(residual)
    require_non_negative(series_resistance=series_resistance)
    require_within(0.5, 0.9999, confidence_level=confidence_level)
    points = spectrum.frequency.size
    most = min(_MAX_BRANCHES, points // _POINTS_PER_BRANCH - 1)
    if most < 1:
        raise InvalidInput(f"spectrum must have at least {2 * _POINTS_PER_BRANCH} points, got {points}")
    if branches is not None and not 1 <= branches <= most:
        raise InvalidInput(f"branches must lie between 1 and {most} for {points} points, got {branches}")
    spectrum, turned = passive_spectrum(spectrum)
    logarithmic = _Spectrum(
        frequency=spectrum.frequency,
        admittance=admittance_with_phase(spectrum),
        series_resistance=series_resistance,
        residual=residual_for(spectrum, LOG_COMPLEX),
    )
    fits = _fits_by_branches(logarithmic, most if branches is None else branches, by_criterion=branches is None)
    measured = replace(logarithmic, residual=residual_for(spectrum, residual))
    is_selected = measured.residual == logarithmic.residual
    chosen = fits[-1] if is_selected else fit_log_parameters(measured.residuals, fits[-1].logarithms)
    circuit, correlation = _circuit(chosen.logarithms, series_resistance), measured.correlation(chosen)
    intervals = _intervals(measured, chosen, confidence_level)
    if correlation > _CORRELATED:
        others = _by_other_residuals(measured, chosen, confidence_level, has_phase=spectrum.has_phase)
        intervals = spanning_intervals(intervals, others)
    fitted = circuit_admittance(circuit, frequency=spectrum.frequency)
    of_spectrum = (*turned, *caveats_of_spectrum(spectrum, intervals), *inductive_caveats(spectrum, fitted))
    return CircuitFit(
        circuit=circuit,
        resonances=circuit_resonances(circuit),
        intervals=intervals,
        residual=measured.residual,
        residual_rms=float(np.sqrt(chosen.sum_of_squares / points)),
        information_criteria=tuple(each.information_criterion for each in fits),
        residual_correlation=correlation,
        confidence_level=confidence_level,
        caveats=(*of_spectrum, *_caveats(chosen, len(circuit.branches), branches, correlation)),
    )


def _fits_by_branches(spectrum: _Spectrum, most: int, *, by_criterion: bool) -> list[LogParameterFit]:
    """Fits with 1, 2, ... branches, up to the last accepted one."""
    logarithms = np.array([np.log(_capacitance(spectrum))])
    fits: list[LogParameterFit] = []
    while len(fits) < most:
        fit = _with_one_more_branch(spectrum, logarithms)
        if fit is None or (fits and not _is_accepted(spectrum, fit, fits[-1], by_criterion=by_criterion)):
            break
        fits.append(fit)
        logarithms = fit.logarithms
    if not fits:
        raise InvalidInput(_reason_without_resonance(spectrum))
    return fits


def _is_accepted(spectrum: _Spectrum, fit: LogParameterFit, simpler: LogParameterFit, *, by_criterion: bool) -> bool:
    """Whether all parameters are determined within a factor, and the information criterion, if it decides, is lower."""
    determined = np.all(np.diag(fit.covariance) * spectrum.correlation(fit) < _LARGEST_ERROR**2)
    return bool(determined) and (not by_criterion or fit.information_criterion < simpler.information_criterion)


def _reason_without_resonance(spectrum: _Spectrum) -> str:
    """Content of a spectrum in which no resonance of a capacitive part is found."""
    f, inductive = spectrum.frequency, float(np.mean(spectrum.admittance.imag < 0))
    found = f"no resonance of a transducer found among {f.size} points from {f[0]:.6g} to {f[-1]:.6g} Hz:"
    if inductive > _MOSTLY:
        return (
            f"{found} the impedance is inductive at {inductive:.0%} of them, where a transducer is capacitive; a coil"
            " in series or parallel, or a phase or reactance written with the opposite sign"
        )
    return (
        f"{found} the impedance is that of a capacitance; a resonance f_s of quality factor Q shows in a sweep over it"
        " with steps below f_s/Q"
    )


def _capacitance(spectrum: _Spectrum) -> float:
    """Median capacitance behind the leads where it is positive, the initial parallel capacitance. [F]"""
    y = spectrum.admittance / (1 - spectrum.series_resistance * spectrum.admittance)
    capacitance = np.imag(y) / (2 * np.pi * spectrum.frequency)
    if not np.any(capacitance > 0):
        raise InvalidInput(_reason_without_resonance(spectrum))
    return float(np.median(capacitance[capacitance > 0]))


def _with_one_more_branch(spectrum: _Spectrum, logarithms: Floats) -> LogParameterFit | None:
    """Best fit with one branch more, or None where every candidate leaves the sweep or is not resonant."""
    fits = []
    for candidate in _candidates(spectrum, logarithms)[:_MAX_CANDIDATES]:
        fit = fit_log_parameters(spectrum.residuals, np.concatenate([logarithms, candidate]))
        if spectrum.resolves(fit.logarithms):
            fits.append(fit)
    return min(fits, key=lambda fit: fit.sum_of_squares, default=None)


def _candidates(spectrum: _Spectrum, logarithms: Floats) -> list[Floats]:
    """Logarithms of frequency, quality factor and capacitance of possible branches, the most explaining first."""
    f = spectrum.frequency
    circuit = _circuit(logarithms, spectrum.series_resistance)
    fitted = circuit_admittance(circuit, frequency=f)
    capacitive = (spectrum.admittance - fitted) / (2j * np.pi * f)
    relative = spectrum.admittance / fitted - 1
    ranked = []
    for pole in {*_poles(f, capacitive), *_poles(f, relative)}:
        f_s, quality = abs(pole), abs(pole) / (-2 * pole.real)
        if not (f[0] < f_s < f[-1] and _LOWEST_QUALITY < quality < _HIGHEST_QUALITY):
            continue
        shape = 2j * np.pi * f / (1 - (f / f_s) ** 2 + 1j * f / (f_s * quality)) / fitted
        capacitance = float(np.real(np.vdot(shape, relative)) / np.real(np.vdot(shape, shape)))
        explained = capacitance**2 * float(np.real(np.vdot(shape, shape)))
        if capacitance > 0 and explained > f.size * _ROUNDING**2:
            ranked.append((-explained, np.log([f_s, quality, capacitance])))
    return distinct_modes(ranked, widths=1.0)


def _poles(f: Floats, values: Complexes) -> list[complex]:
    """Decaying poles of AAA approximations that are real for real signals, in Hz."""
    scale = float(np.sqrt(f[0] * f[-1]))
    x, y = np.concatenate([1j * f, -1j * f]) / scale, np.concatenate([values, values.conj()])
    return [pole for pole in rational_poles(x, y, scale=scale) if pole.imag > 0 and pole.real < 0]


def _by_other_residuals(
    spectrum: _Spectrum, chosen: LogParameterFit, confidence_level: float, *, has_phase: bool
) -> list[dict[str, ConfidenceInterval]]:
    """Intervals by the residuals that were not chosen, of those that need no phase that was not measured."""
    found = []
    for name in RESIDUALS:
        if name != spectrum.residual and (has_phase or name != LOG_COMPLEX):
            other = replace(spectrum, residual=name)
            fit = fit_log_parameters(other.residuals, chosen.logarithms)
            if fit.converged and other.resolves(fit.logarithms):
                found.append(_intervals(other, fit, confidence_level))
    return found


def _intervals(spectrum: _Spectrum, fit: LogParameterFit, confidence_level: float) -> dict[str, ConfidenceInterval]:
    """Confidence intervals of the quantities of a fitted circuit."""
    correlation = spectrum.correlation(fit)
    return confidence_intervals(fit, _quantities, correlation=correlation, confidence_level=confidence_level)


def _circuit(logarithms: Floats, series_resistance: float) -> ButterworthVanDyke:
    """Circuit of the logarithms of C_0 and, for each branch, of f_s, Q and C."""
    values = np.exp(np.clip(logarithms, -_LARGEST_LOGARITHM, _LARGEST_LOGARITHM))
    branches = tuple(
        MotionalBranch(
            resistance=1 / (2 * np.pi * f_s * quality * capacitance),
            inductance=1 / ((2 * np.pi * f_s) ** 2 * capacitance),
            capacitance=capacitance,
        )
        for f_s, quality, capacitance in sorted(values[1:].reshape(-1, 3).tolist())
    )
    return ButterworthVanDyke(
        parallel_capacitance=float(values[0]), branches=branches, series_resistance=series_resistance
    )


def _quantities(logarithms: Floats) -> dict[str, float]:
    """Quantities of a circuit whose confidence intervals are reported."""
    circuit = _circuit(logarithms, 0.0)
    found = circuit_resonances(circuit)
    named = {"parallel_capacitance": circuit.parallel_capacitance}
    for index, branch in enumerate(circuit.branches):
        named |= {f"{name}_{index + 1}": getattr(branch, name) for name in ("resistance", "inductance", "capacitance")}
        named |= {f"{name}_{index + 1}": float(getattr(found, name)[index]) for name in _OF_RESONANCES}
    return named


def _caveats(fit: LogParameterFit, branches: int, requested: int | None, correlation: float) -> tuple[str, ...]:
    """Warnings about too few branches, convergence and correlated residuals."""
    caveats = []
    if requested is not None and branches < requested:
        caveats.append(
            f"{requested} branches were requested; the spectrum determines only {branches}: sweep wider or with more"
            " points"
        )
    if not fit.converged:
        caveats.append("the fit did not converge; take fewer branches")
    if correlation > _CORRELATED:
        caveats.append(
            f"residuals are correlated over {correlation:.0f} points: the circuit does not describe the spectrum fully;"
            " dielectric losses or weaker modes may be missing; intervals span the fits to logarithms and to magnitudes"
        )
    return tuple(caveats)
