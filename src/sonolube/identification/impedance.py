"""Equivalent circuits from measured impedance: Butterworth-Van Dyke branches, as many as the spectrum bears out."""

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import AAA

from sonolube.actuator import (
    ButterworthVanDyke,
    CircuitResonances,
    MotionalBranch,
    circuit_admittance,
    circuit_resonances,
)
from sonolube.checks import Complexes, Floats, require_non_negative, require_within
from sonolube.errors import InvalidInput
from sonolube.identification.spectral_residual import LOG_COMPLEX, residual_named
from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum
from sonolube.measurement.statistics.logarithmic_fit import (
    Interval,
    LogarithmicFit,
    correlation_factor,
    fit_logarithms,
    intervals,
)

_MOST_BRANCHES = 8
_TERMS = (3, 4, 5, 6, 8, 10)  # of the rational approximations whose poles are tried
_LEAST_QUALITY, _GREATEST_QUALITY = 3.0, 1e7
_ROUNDING = 1e-9  # share of the current below which a branch is rounding
_TRIED = 3  # candidates for the next branch
_CORRELATED = 3.0  # from so many points alike on the circuit is doubted
_POINTS_A_BRANCH = 4
_LEAST_KNOWN = 0.5  # standard error of the logarithm of a parameter


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class CircuitFit:
    """The circuit that fits a spectrum best.

    Parameters
    ----------
    circuit : ButterworthVanDyke
        Branches in order of frequency.
    resonances : CircuitResonances
        Frequencies without losses, quality and coupling factors of its branches.
    intervals : mapping of str to Interval
        Of parallel_capacitance, and of each branch's resistance, inductance, capacitance, series_frequency,
        parallel_frequency, mechanical_quality_factor and coupling_factor, with its number after it: "resistance_1".
    residual : str
        Name of what was made small.
    residual_rms : float
        Its root mean square: for "log-complex" share of the magnitude and radians together, for "linear-magnitude"
        share of the greatest admittance.
    information_criteria : tuple of float
        Bayesian criterion of the log-complex residual with 1, 2, ... branches.
    residual_correlation : float
        Samples over independent samples among the residuals, for which the intervals are widened.
    confidence_level : float
        Of the intervals. []
    caveats : tuple of str
        What speaks against the fit, one line each.
    """

    circuit: ButterworthVanDyke
    resonances: CircuitResonances
    intervals: Mapping[str, Interval]
    residual: str
    residual_rms: float
    information_criteria: tuple[float, ...]
    residual_correlation: float
    confidence_level: float
    caveats: tuple[str, ...]


@dataclass(frozen=True, kw_only=True, slots=True)
class _Problem:
    frequency: Floats
    admittance: Complexes
    series_resistance: float
    residual: str

    def residuals(self, logarithms: Floats) -> Floats:
        model = circuit_admittance(_circuit(logarithms, self.series_resistance), frequency=self.frequency)
        return residual_named(self.residual)(model, self.admittance)

    def correlation(self, fit: LogarithmicFit) -> float:
        """Samples over independent samples among the residuals."""
        return correlation_factor(fit, rows=fit.residuals.size // self.frequency.size)

    def inside(self, logarithms: Floats) -> bool:
        """Whether every branch is a mode within the sweep, and not a background that poses as one."""
        modes = logarithms[1:].reshape(-1, 3)
        f_s, quality = np.exp(modes[:, 0]), np.exp(modes[:, 1])
        swept = (f_s > self.frequency[0]) & (f_s < self.frequency[-1])
        return bool(np.all(swept & (quality > _LEAST_QUALITY) & (quality < _GREATEST_QUALITY)))


def fit_circuit(
    spectrum: ImpedanceSpectrum,
    *,
    branches: int | None = None,
    residual: str = LOG_COMPLEX,
    series_resistance: float = 0.0,
    confidence_level: float = 0.95,
) -> CircuitFit:
    """Return the Butterworth-Van Dyke circuit that fits a measured spectrum best.

    Parameters
    ----------
    spectrum : ImpedanceSpectrum
    branches : int or None
        How many modes; None takes as many as lower the Bayesian information criterion.
    residual : str
        "log-complex" or "linear-magnitude"; where the circuit is not all the truth they give different quality factors.
    series_resistance : float
        Of the leads, as known. [ohm]
    confidence_level : float
        Of the intervals. []

    Returns
    -------
    CircuitFit

    Raises
    ------
    InvalidInput
        If the spectrum has fewer than 8 points, its current nowhere leads like that of a capacitance, no mode stands
        out of it, or `branches` is not 1 to 8 or more than its points allow.
    UnknownName
        If the residual is none of `RESIDUALS`.

    Notes
    -----
    Branches are added one by one. Poles of rational approximations [1]_ to what the circuit so far leaves over give
    the candidates; those that grow, lie outside the sweep or have a quality factor below 3 are spurious. The candidate
    that explains most is taken and all parameters are fitted anew. All this goes by the log-complex residual, in which
    weak modes count; a branch that lowers the criterion but is not known within a factor of e^0.5 is not taken. Another
    residual only fits the parameters in the end.

    Intervals are first-order and widened for residuals that resemble their neighbours; they know the noise, not the
    losses of the dielectric and other truths the circuit leaves out.

    References
    ----------
    .. [1] Y. Nakatsukasa, O. Sete and L. N. Trefethen, SIAM J. Sci. Comput. 40, A1494 (2018). doi:10.1137/16M1106122
    .. [2] IEEE Std 176-1987, for the definitions of f_s, f_p and the coupling factor.
    """
    residual_named(residual)
    require_non_negative(series_resistance=series_resistance)
    require_within(0.5, 0.9999, confidence_level=confidence_level)
    most = min(_MOST_BRANCHES, spectrum.frequency.size // _POINTS_A_BRANCH - 1)
    if most < 1:
        raise InvalidInput(f"a spectrum of {spectrum.frequency.size} points is too short; give {2 * _POINTS_A_BRANCH}")
    if branches is not None and not 1 <= branches <= most:
        raise InvalidInput(f"branches must lie between 1 and {most} here, got {branches}")
    proportional = _Problem(
        frequency=spectrum.frequency,
        admittance=spectrum.admittance,
        series_resistance=series_resistance,
        residual=LOG_COMPLEX,
    )
    fits = _grown(proportional, most if branches is None else branches, by_criterion=branches is None)
    problem = replace(proportional, residual=residual)
    chosen = fits[-1] if residual == LOG_COMPLEX else fit_logarithms(problem.residuals, fits[-1].logarithms)
    return _record(problem, chosen, fits, branches, confidence_level)


def _grown(problem: _Problem, most: int, *, by_criterion: bool) -> list[LogarithmicFit]:
    """Return the fits with 1, 2, ... branches."""
    logarithms = np.array([np.log(_capacitance(problem))])
    fits: list[LogarithmicFit] = []
    while len(fits) < most:
        fit = _with_one_more(problem, logarithms)
        if fit is None or (fits and not _stands(problem, fit, fits[-1], by_criterion=by_criterion)):
            break
        fits.append(fit)
        logarithms = fit.logarithms
    if not fits:
        raise InvalidInput(
            "no mode stands out of the spectrum; sweep about a resonance, with more points, and see to the phase's sign"
        )
    return fits


def _stands(problem: _Problem, fit: LogarithmicFit, simpler: LogarithmicFit, *, by_criterion: bool) -> bool:
    """Whether the last branch is one: all is known within a factor, and the criterion, if it is to decide, is lower."""
    known = np.all(np.diag(fit.covariance) * problem.correlation(fit) < _LEAST_KNOWN**2)
    return bool(known) and (not by_criterion or fit.information_criterion < simpler.information_criterion)


def _capacitance(problem: _Problem) -> float:
    y = problem.admittance / (1 - problem.series_resistance * problem.admittance)
    capacitance = np.imag(y) / (2 * np.pi * problem.frequency)
    if not np.any(capacitance > 0):
        raise InvalidInput(
            "the current leads the voltage nowhere, as it would through a capacitance; is the sign right?"
        )
    return float(np.median(capacitance[capacitance > 0]))


def _with_one_more(problem: _Problem, logarithms: Floats) -> LogarithmicFit | None:
    """Return the best fit with one branch more, or None where no pole stands up."""
    tried = []
    for candidate in _candidates(problem, logarithms)[:_TRIED]:
        fit = fit_logarithms(problem.residuals, np.concatenate([logarithms, candidate]))
        if problem.inside(fit.logarithms):
            tried.append(fit)
    return min(tried, key=lambda fit: fit.sum_of_squares, default=None)


def _candidates(problem: _Problem, logarithms: Floats) -> list[Floats]:
    """Return logarithms of frequency, quality and capacitance of possible branches, those that explain most first."""
    f = problem.frequency
    circuit = _circuit(logarithms, problem.series_resistance)
    own = circuit_admittance(circuit, frequency=f)
    left_over = (problem.admittance - own) / (2j * np.pi * f)
    relative = problem.admittance / own - 1
    ranked = []
    for pole in {*_poles(f, left_over), *_poles(f, relative)}:
        f_s, quality = abs(pole), abs(pole) / (-2 * pole.real)
        if not (f[0] < f_s < f[-1] and _LEAST_QUALITY < quality < _GREATEST_QUALITY):
            continue
        shape = 2j * np.pi * f / (1 - (f / f_s) ** 2 + 1j * f / (f_s * quality)) / own
        capacitance = float(np.real(np.vdot(shape, relative)) / np.real(np.vdot(shape, shape)))
        explained = capacitance**2 * float(np.real(np.vdot(shape, shape)))
        if capacitance > 0 and explained > f.size * _ROUNDING**2:
            ranked.append((explained, np.log([f_s, quality, capacitance])))
    distinct: list[Floats] = []
    for _, candidate in sorted(ranked, key=lambda pair: -pair[0]):
        if all(abs(candidate[0] - other[0]) > np.exp(-other[1]) for other in distinct):  # a width of resonance apart
            distinct.append(candidate)
    return distinct


def _poles(f: Floats, values: Complexes) -> list[complex]:
    """Return decaying poles of rational approximations that are real for real signals, in Hz."""
    scale = float(np.sqrt(f[0] * f[-1]))
    x, y = np.concatenate([1j * f, -1j * f]) / scale, np.concatenate([values, values.conj()])
    found: list[complex] = []
    for terms in _TERMS:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore", RuntimeWarning)  # it stops at so many terms, as it is told to
            poles = scale * AAA(x, y, max_terms=terms, rtol=1e-10).poles()
        found.extend(complex(pole) for pole in poles if pole.imag > 0 and pole.real < 0)
    return found


def _circuit(logarithms: Floats, series_resistance: float) -> ButterworthVanDyke:
    """Return the circuit of ln C_0 and, for each branch, ln f_s, ln Q and ln C."""
    values = np.exp(np.clip(logarithms, -300, 300))
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
    circuit = _circuit(logarithms, 0.0)
    found = circuit_resonances(circuit)
    named = {"parallel_capacitance": circuit.parallel_capacitance}
    for place, branch in enumerate(circuit.branches):
        named |= {
            f"resistance_{place + 1}": branch.resistance,
            f"inductance_{place + 1}": branch.inductance,
            f"capacitance_{place + 1}": branch.capacitance,
            f"series_frequency_{place + 1}": float(found.series_frequency[place]),
            f"parallel_frequency_{place + 1}": float(found.parallel_frequency[place]),
            f"mechanical_quality_factor_{place + 1}": float(found.mechanical_quality_factor[place]),
            f"coupling_factor_{place + 1}": float(found.coupling_factor[place]),
        }
    return named


def _record(
    problem: _Problem, fit: LogarithmicFit, fits: list[LogarithmicFit], wanted: int | None, confidence_level: float
) -> CircuitFit:
    circuit = _circuit(fit.logarithms, problem.series_resistance)
    correlation = problem.correlation(fit)
    return CircuitFit(
        circuit=circuit,
        resonances=circuit_resonances(circuit),
        intervals=intervals(fit, _quantities, correlation=correlation, confidence_level=confidence_level),
        residual=problem.residual,
        residual_rms=float(np.sqrt(fit.sum_of_squares / problem.frequency.size)),
        information_criteria=tuple(each.information_criterion for each in fits),
        residual_correlation=correlation,
        confidence_level=confidence_level,
        caveats=_caveats(fit, len(circuit.branches), wanted, correlation),
    )


def _caveats(fit: LogarithmicFit, branches: int, wanted: int | None, correlation: float) -> tuple[str, ...]:
    caveats = []
    if wanted is not None and branches < wanted:
        caveats.append(f"{wanted} branches were asked for; only {branches} stand up: sweep wider or with more points")
    if not fit.converged:
        caveats.append("the search did not end by itself; take fewer branches")
    if correlation > _CORRELATED:
        caveats.append(
            f"residuals resemble their neighbours over {correlation:.0f} points: the circuit leaves something out,"
            " such as losses of the dielectric or weaker modes"
        )
    return tuple(caveats)
