"""Butterworth-Van Dyke circuits from measured impedance spectra, by rational approximation and least squares."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import numpy as np

from sonolube.checks import Complexes, Floats, require_non_negative, require_within
from sonolube.errors import InvalidInput, UnknownName
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
_DIGITS = 1e-5  # residual below which no instrument measures: what is left is the rounding of written digits
_POINTS_PER_BRANCH = 4
_MOSTLY = 0.5  # of the points
_LARGEST_LOGARITHM = 200.0  # of a parameter, so that products of three are within the range of floats
_OF_BRANCH = ("resistance", "inductance", "capacitance")
_OF_RESONANCES = ("series_frequency", "parallel_frequency", "mechanical_quality_factor", "coupling_factor")
_LEAST_GAIN = 10.0  # of the criterion, that a further part must bring
_COUPLED = 0.1  # relative difference of effective coupling and that of the branch, from which on a warning is given
_SHARES = (0.01, 0.3)  # of a typical impedance, at which the search for a part starts
_LARGEST_ERROR = 0.5  # standard error of the logarithm of a parameter

CIRCUIT_PARTS: Final = ("loss_tangent", "series_inductance", "series_resistance")
"""Parts that a circuit may have beside its parallel capacitance and its branches."""


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
        Confidence intervals of parallel_capacitance and of the parts that were fitted, and of each branch's resistance,
        inductance, capacitance, series_frequency, parallel_frequency, mechanical_quality_factor, coupling_factor and,
        where there are several branches, effective_coupling_factor, followed by the branch's number: "resistance_1".
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
    """Measured admittance, the residual to minimise, and parts of the circuit, fitted and of known value.

    The parameters of the circuit are C_0, the fitted `parts`, and for each branch f_s, Q and C.
    """

    frequency: Floats
    admittance: Complexes
    residual: str
    known: Mapping[str, float]
    parts: tuple[str, ...] = ()

    def circuit(self, logarithms: Floats) -> ButterworthVanDyke:
        """Circuit of the logarithms of its parameters, branches in order of frequency."""
        values = np.exp(np.clip(logarithms, -_LARGEST_LOGARITHM, _LARGEST_LOGARITHM))
        capacitance, parts, modes = values[0], values[1 : 1 + len(self.parts)], values[1 + len(self.parts) :]
        branches = tuple(
            MotionalBranch(
                resistance=1 / (2 * np.pi * f_s * quality * capacitance),
                inductance=1 / ((2 * np.pi * f_s) ** 2 * capacitance),
                capacitance=capacitance,
            )
            for f_s, quality, capacitance in sorted(modes.reshape(-1, 3).tolist())
        )
        fitted = dict(zip(self.parts, parts.tolist(), strict=True))
        return ButterworthVanDyke(parallel_capacitance=float(capacitance), branches=branches, **self.known, **fitted)

    def quantities(self, logarithms: Floats) -> dict[str, float]:
        """Quantities of a circuit whose confidence intervals are reported."""
        circuit = self.circuit(logarithms)
        found = circuit_resonances(circuit)
        names = ("parallel_capacitance", *self.parts)
        named = {name: getattr(circuit, name) for name in names}
        of_resonances = (*_OF_RESONANCES, *(("effective_coupling_factor",) if len(circuit.branches) > 1 else ()))
        for index, branch in enumerate(circuit.branches):
            named |= {f"{name}_{index + 1}": getattr(branch, name) for name in _OF_BRANCH}
            named |= {f"{name}_{index + 1}": float(getattr(found, name)[index]) for name in of_resonances}
        return named

    def residuals(self, logarithms: Floats) -> Floats:
        """Residuals of the circuit of given logarithms of its parameters."""
        model = circuit_admittance(self.circuit(logarithms), frequency=self.frequency)
        return residual_named(self.residual)(model, self.admittance)

    def correlation(self, fit: LogParameterFit) -> float:
        """Number of residuals over the number of independent ones."""
        return residual_inefficiency(fit, rows=fit.residuals.size // self.frequency.size)

    def resolves(self, logarithms: Floats) -> bool:
        """Whether every branch resonates within the sweep with a plausible quality factor."""
        modes = logarithms[1 + len(self.parts) :].reshape(-1, 3)
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
    parts: Collection[str] | None = None,
) -> CircuitFit:
    r"""Butterworth-Van Dyke circuit of an impedance spectrum, by rational approximation and nonlinear least squares.

    See Also
    --------
    sonolube.identification.stack_fit.fit_stack : Stack parameters, where the structure about the stack is known.

    With the parallel capacitance :math:`C_0` and, for each branch, the series frequency :math:`f_s`, quality factor
    :math:`Q` and capacitance :math:`C`, the admittance behind the leads is

    .. math::

        Y(f) = 2\pi i f \left[C_0 (1 - i\tan\delta)
        + \sum_k \frac{C_k}{1 - (f/f_{s,k})^2 + i f/(f_{s,k} Q_k)}\right] ,

    and that at the terminals :math:`Y/(1 + (R_s + 2\pi i f L_s) Y)`.

    `parts` are those of `CIRCUIT_PARTS` that are fitted. None begins without any, and adds the one that explains most
    while the corrected Akaike criterion falls by more than 10, at which the circuit without it has no support [3]_,
    and every parameter is determined within a factor of e^0.5. The criterion counts as many residuals as are
    independent by the autocorrelation of those of the larger circuit. Inductance and resistance of the leads are also
    tried together. A known `series_resistance` is not fitted.

    Branches are added one by one. Candidates are the decaying poles of rational (AAA) approximations [1]_ to the
    difference between measured and fitted admittance, within the sweep and with a quality factor of 3 or more. The
    candidates that explain most are fitted together with all earlier branches, and the best fit is taken. This
    selection minimises the log-complex residual, in which weak modes have weight; a branch of which a parameter has a
    standard error above a factor of e^0.5 is rejected. Another residual is minimised only at the end. Where only the
    magnitude was measured, candidates come from the phase that belongs to it (`minimum_phase_admittance`), and every
    sum of squares is of the logarithm of the magnitude. A spectrum of negative conductance is turned by 180 degrees
    (`passive_spectrum`).

    Confidence intervals are of first order and widened for the correlation of residuals. Where these are correlated
    over more than three points the circuit leaves properties out, such as weak modes, and how the points are
    weighted decides the estimates: the intervals then span those of the fits by every residual. Parts are found by the
    log-complex residual alone and held in fits by another.

    References
    ----------
    .. [1] Y. Nakatsukasa, O. Sete and L. N. Trefethen, SIAM J. Sci. Comput. 40, A1494 (2018). doi:10.1137/16M1106122
    .. [2] IEEE Std 176-1987, for the definitions of f_s, f_p and the coupling factor.
    .. [3] K. P. Burnham and D. R. Anderson, Model Selection and Multimodel Inference, 2nd ed., Springer (2002), 2.6.
    """
    residual_named(residual)
    if unknown := [part for part in parts or () if part not in CIRCUIT_PARTS]:
        raise UnknownName.among(CIRCUIT_PARTS, kind="part of a circuit", name=unknown[0])
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
        residual=residual_for(spectrum, LOG_COMPLEX),
        known={"series_resistance": series_resistance} if series_resistance else {},
    )
    limit = _Limit(most if branches is None else branches, by_criterion=branches is None)
    logarithmic, fits = _fits_with_parts(logarithmic, limit, parts)
    measured, chosen = logarithmic, fits[-1]
    intervals = _intervals(measured, chosen, confidence_level)
    if residual_for(spectrum, residual) != logarithmic.residual:
        measured, start = _with_known_parts(logarithmic, chosen, residual=residual)
        chosen = fit_log_parameters(measured.residuals, start)
        intervals |= _intervals(measured, chosen, confidence_level)
    circuit, correlation = measured.circuit(chosen.logarithms), measured.correlation(chosen)
    rms = float(np.sqrt(chosen.sum_of_squares / points))
    lacks_something = correlation > _CORRELATED and rms > _DIGITS
    if lacks_something:
        others = _by_other_residuals(measured, chosen, confidence_level, has_phase=spectrum.has_phase)
        intervals = spanning_intervals(intervals, [intervals | other for other in others])
    fitted = circuit_admittance(circuit, frequency=spectrum.frequency)
    of_spectrum = (*turned, *caveats_of_spectrum(spectrum, intervals), *inductive_caveats(spectrum, fitted))
    return CircuitFit(
        circuit=circuit,
        resonances=circuit_resonances(circuit),
        intervals=intervals,
        residual=measured.residual,
        residual_rms=rms,
        information_criteria=tuple(each.information_criterion for each in fits),
        residual_correlation=correlation,
        confidence_level=confidence_level,
        caveats=(
            *of_spectrum,
            *_caveats(chosen, len(circuit.branches), branches, correlation if lacks_something else 1.0),
            *_coupling_caveats(circuit_resonances(circuit)),
        ),
    )


class _Limit(NamedTuple):
    """Largest number of branches, and whether a criterion decides on fewer."""

    branches: int
    by_criterion: bool


def _fits_with_parts(
    spectrum: _Spectrum, limit: _Limit, requested: Collection[str] | None
) -> tuple[_Spectrum, list[LogParameterFit]]:
    """Fits with 1, 2, ... branches and the requested parts, or without a request those that the data demand.

    Parts are added one by one, the one that explains most first, and resistance and inductance of the leads together
    where neither is enough by itself.
    """
    fits = _fits_by_branches(spectrum, [_first_fit(spectrum)], limit)
    if requested is not None:
        parts = tuple(part for part in CIRCUIT_PARTS if part in requested and part not in spectrum.known)
        if not parts:
            return spectrum, fits
        with_parts = replace(spectrum, parts=parts)
        found = _with_more_parts(with_parts, fits, spectrum.parts, limit)
        return with_parts, max(found, key=lambda each: _gain(with_parts, each[-1], over=fits[-1]))
    while trial := next(filter(None, (_extended(spectrum, fits, limit, step) for step in _steps(spectrum))), None):
        spectrum, fits = trial
    return spectrum, fits


def _steps(spectrum: _Spectrum) -> list[list[tuple[str, ...]]]:
    """Sets of parts to try next: single ones, then those of the leads together."""
    left = [part for part in CIRCUIT_PARTS if part not in (*spectrum.parts, *spectrum.known)]
    leads = tuple(part for part in left if part.startswith("series"))
    return [[(part,) for part in left], [leads] if len(leads) > 1 else []]


def _extended(
    spectrum: _Spectrum, fits: list[LogParameterFit], limit: _Limit, step: list[tuple[str, ...]]
) -> tuple[_Spectrum, list[LogParameterFit]] | None:
    """Fits with that set of parts of a step that explains most, None where none explains more than noise may."""
    ranked = []
    for added in step:
        trial = replace(spectrum, parts=(*spectrum.parts, *added))
        for fit in (fits[0], fits[-1]) if len(fits) > 1 else fits:
            refitted = _refitted(trial, fit, spectrum.parts)
            ranked.append((_gain(trial, refitted, over=fit), trial, fit))
    ranked = [each for each in ranked if each[0] > _LEAST_GAIN]
    for _, trial, _ in sorted(ranked, key=lambda each: -each[0]):
        found = [
            each
            for each in _with_more_parts(trial, fits, spectrum.parts, limit)
            if _is_determined(trial, each[-1]) and _gain(trial, each[-1], over=fits[-1]) > _LEAST_GAIN
        ]
        if found:
            return trial, max(found, key=lambda each: _gain(trial, each[-1], over=fits[-1]))
    return None


def _with_more_parts(
    spectrum: _Spectrum, fits: list[LogParameterFit], parts: tuple[str, ...], limit: _Limit
) -> list[list[LogParameterFit]]:
    """Fits of a circuit with more parts than those given have, by branches: from one branch on, and from the last on.

    Branches that stood for a part are gone by the first way; by the second a part is found that several modes hide.
    """
    own = [_refitted(spectrum, fit, parts) for fit in fits]
    starts = [own[:1], own] if len(own) > 1 else [own]
    return [_fits_by_branches(spectrum, start, limit) for start in starts]


def _gain(spectrum: _Spectrum, fit: LogParameterFit, *, over: LogParameterFit) -> float:
    r"""By how much the corrected Akaike criterion of a fit is below that of another one to the same data.

    With :math:`n' = n/g` independent ones among n residuals, g by the residuals of the first fit, and k parameters,

    .. math:: \mathrm{AICc} = n' \ln(\mathrm{RSS}/n) + 2k + \frac{2k(k + 1)}{n' - k - 1} .
    """
    count = fit.residuals.size / spectrum.correlation(fit)

    def criterion(one: LogParameterFit) -> float:
        k, mean_square = one.logarithms.size, max(one.sum_of_squares / one.residuals.size, _ROUNDING**2)
        return count * float(np.log(mean_square)) + 2 * k + 2 * k * (k + 1) / max(count - k - 1, 1.0)

    return criterion(over) - criterion(fit)


def _refitted(spectrum: _Spectrum, fit: LogParameterFit, parts: tuple[str, ...]) -> LogParameterFit:
    """Best fit of a circuit with more parts, from the one without and several sizes of the parts."""
    kept = dict(zip(parts, fit.logarithms[1 : 1 + len(parts)], strict=True))
    impedance = float(np.median(1 / np.abs(spectrum.admittance)))
    omega = 2 * np.pi * float(np.sqrt(spectrum.frequency[0] * spectrum.frequency[-1]))
    units = {"loss_tangent": 1.0, "series_resistance": impedance, "series_inductance": impedance / omega}
    found = []
    for share in _SHARES if spectrum.parts != parts else _SHARES[:1]:
        own = [kept.get(part, np.log(share * units[part])) for part in spectrum.parts]
        start = np.concatenate([fit.logarithms[:1], own, fit.logarithms[1 + len(parts) :]])
        found.append(fit_log_parameters(spectrum.residuals, start))
    return min(found, key=lambda each: each.sum_of_squares)


def _first_fit(spectrum: _Spectrum) -> LogParameterFit:
    """Fit with one branch and no parts."""
    fit = _with_one_more_branch(spectrum, np.array([np.log(_capacitance(spectrum))]))
    if fit is None:
        raise InvalidInput(_reason_without_resonance(spectrum))
    return fit


def _fits_by_branches(spectrum: _Spectrum, start: list[LogParameterFit], limit: _Limit) -> list[LogParameterFit]:
    """Fits with 1, 2, ... branches, from those with the first ones up to the last accepted one."""
    fits = [*start]
    while len(fits) < limit.branches:
        fit = _with_one_more_branch(spectrum, fits[-1].logarithms)
        if fit is None or not _is_accepted(spectrum, fit, fits[-1], by_criterion=limit.by_criterion):
            break
        fits.append(fit)
    return fits


def _is_accepted(spectrum: _Spectrum, fit: LogParameterFit, simpler: LogParameterFit, *, by_criterion: bool) -> bool:
    """Whether all parameters are determined within a factor, and the information criterion, if it decides, is lower."""
    better = not by_criterion or fit.information_criterion < simpler.information_criterion
    return better and _is_determined(spectrum, fit)


def _is_determined(spectrum: _Spectrum, fit: LogParameterFit) -> bool:
    """Whether all parameters are determined within a factor and every branch is a resonance within the sweep."""
    determined = np.all(np.diag(fit.covariance) * spectrum.correlation(fit) < _LARGEST_ERROR**2)
    return bool(determined) and spectrum.resolves(fit.logarithms)


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
    y = spectrum.admittance / (1 - spectrum.known.get("series_resistance", 0.0) * spectrum.admittance)
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
    fitted = circuit_admittance(spectrum.circuit(logarithms), frequency=f)
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


def _with_known_parts(spectrum: _Spectrum, fit: LogParameterFit, *, residual: str) -> tuple[_Spectrum, Floats]:
    """Spectrum of another residual, whose fit takes the parts as found by this one, and where that fit starts.

    Magnitudes about a resonance alone do not tell the resistance of the leads from that of the branch.
    """
    end = 1 + len(spectrum.parts)
    found = dict(zip(spectrum.parts, np.exp(fit.logarithms[1:end]).tolist(), strict=True))
    known = {**spectrum.known, **found}
    start = np.concatenate([fit.logarithms[:1], fit.logarithms[end:]])
    return replace(spectrum, residual=residual, known=known, parts=()), start


def _by_other_residuals(
    spectrum: _Spectrum, chosen: LogParameterFit, confidence_level: float, *, has_phase: bool
) -> list[dict[str, ConfidenceInterval]]:
    """Intervals by the residuals that were not chosen, of those that need no phase that was not measured."""
    found = []
    for name in RESIDUALS:
        if name != spectrum.residual and (has_phase or name != LOG_COMPLEX):
            other, start = _with_known_parts(spectrum, chosen, residual=name)
            fit = fit_log_parameters(other.residuals, start)
            if fit.converged and other.resolves(fit.logarithms):
                found.append(_intervals(other, fit, confidence_level))
    return found


def _intervals(spectrum: _Spectrum, fit: LogParameterFit, confidence_level: float) -> dict[str, ConfidenceInterval]:
    """Confidence intervals of the quantities of a fitted circuit."""
    correlation = spectrum.correlation(fit)
    return confidence_intervals(fit, spectrum.quantities, correlation=correlation, confidence_level=confidence_level)


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
            " weaker modes, or losses that depend on frequency, may be missing; intervals span the fits to logarithms"
            " and to magnitudes"
        )
    return tuple(caveats)


def _coupling_caveats(found: CircuitResonances) -> tuple[str, ...]:
    """Warning about modes so near each other that the parallel resonances are of none of them alone."""
    apart = np.abs(found.effective_coupling_factor / found.coupling_factor - 1) > _COUPLED
    shared = [str(branch) for branch in np.flatnonzero(apart) + 1]
    if not shared:
        return ()
    several = "branches" if len(shared) > 1 else "branch"
    return (
        f"the modes couple: the parallel resonances and effective coupling factors at {several} {', '.join(shared)} are"
        " those of the whole circuit; the coupling factor of each branch is its own, by C1/(C0 + C1)",
    )
