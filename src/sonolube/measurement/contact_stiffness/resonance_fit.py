"""Resonances of a spectrum by nonlinear least squares, with the standard uncertainty of their frequencies."""

from dataclasses import dataclass

import numpy as np

from sonolube.checks import Complexes, Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.contact_stiffness.resonance_spectrum import ResonanceSpectrum
from sonolube.measurement.statistics.autocorrelation import statistical_inefficiency
from sonolube.measurement.statistics.log_parameter_fit import distinct_modes, rational_poles

_MAX_MODES = 5
_LOWEST_QUALITY, _HIGHEST_QUALITY = 0.6, 1e7  # of a resonance
_BEYOND = 1.6  # frequency over the end of the sweep of a mode that still shows in it
_MAX_CANDIDATES = 3  # fitted for the next mode
_LARGEST_ERROR = 0.3  # standard error of the logarithm of a frequency or quality factor
_ROUNDING = 1e-12  # residuals below which fits do not differ
_STEP = 1e-5  # of central differences, in a logarithm
_EVALUATIONS = 40  # for each parameter
_BACKGROUND = 5  # columns
_FAINTEST = 1e-3  # magnitude over the largest one, below which its square has no more weight
_POINTS_OF_CANDIDATES = 200
_CORRELATED = 3.0  # residuals over independent ones, from which on a warning is given


@dataclass(frozen=True, kw_only=True, slots=True)
class Resonance:
    """Resonance found in a spectrum.

    Parameters
    ----------
    frequency : float
        Modulus of its pole. [Hz]
    frequency_uncertainty : float
        Standard uncertainty by the noise of the spectrum, in Hz.
    quality_factor : float
        Frequency over full width at half power. []
    relative_height : float
        Response at the resonance without the other modes, relative to the largest of the spectrum.
    """

    frequency: float
    frequency_uncertainty: float
    quality_factor: float
    relative_height: float

    @property
    def half_width(self) -> float:
        """Half width at half power, in Hz."""
        return self.frequency / (2 * self.quality_factor)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ResonanceFit:
    """Resonances fitted to a spectrum.

    Parameters
    ----------
    spectrum : ResonanceSpectrum
        To which they were fitted.
    resonances : tuple of Resonance
        In order of frequency.
    fitted : ndarray, shape (n,)
        Fitted response at the frequencies of the spectrum.
    residual_correlation : float
        Number of residuals over the number of independent ones, by which the variances are multiplied.
    caveats : tuple of str
        Warnings about the fit, one line each.
    """

    spectrum: ResonanceSpectrum
    resonances: tuple[Resonance, ...]
    fitted: Complexes
    residual_correlation: float
    caveats: tuple[str, ...]

    def nearest(self, frequency: float) -> Resonance:
        """Resonance nearest to a frequency."""
        return min(self.resonances, key=lambda one: abs(one.frequency - frequency))

    def strongest(self) -> Resonance:
        """Resonance of the greatest response."""
        return max(self.resonances, key=lambda one: one.relative_height)


def fit_resonances(spectrum: ResonanceSpectrum, *, modes: int | None = None) -> ResonanceFit:
    r"""Resonances of a spectrum, by least squares with as many modes as the Bayesian information criterion supports.

    Parameters
    ----------
    spectrum : ResonanceSpectrum
    modes : int or None
        Number of modes; None takes as many as lower the criterion, at most 5.

    Returns
    -------
    ResonanceFit

    Raises
    ------
    InvalidInput
        If the spectrum shows no resonance.

    See Also
    --------
    sonolube.identification.circuit_fit.fit_circuit : all elements of the equivalent circuit of an impedance.

    Notes
    -----
    The response is a sum of modes and a background of stiffer and of floating modes, with complex coefficients,

    .. math::

        H(f) = \sum_k \frac{a_k + c_k f}{D_k} + b_0 + b_1 f + \frac{b_2}{f} + \frac{b_3}{f^2} + \frac{b_4}{f^3} ,
        \qquad D_k = f_k^2 - f^2 + i f f_k/Q_k .

    Without phase the squared magnitude is fitted, a rational function of :math:`f^2` with the same poles:
    :math:`|D_k|^2` takes the place of :math:`D_k`. The coefficients are linear and are eliminated; candidates
    for the next mode are poles of rational approximations of the residual. The covariance is that of White, which needs
    no equal variance of the noise, times the correlation of the residuals; times its square from 3 points on, where the
    residuals are errors of the model, coherent over a resonance.

    References
    ----------
    .. [1] H. White, Econometrica 48, 817 (1980). doi:10.2307/1912934
    .. [2] G. H. Golub and V. Pereyra, SIAM J. Numer. Anal. 10, 413 (1973). doi:10.1137/0710036
    """
    problem = _Problem(spectrum)
    chosen: _Solution | None = None
    for _ in range(_MAX_MODES if modes is None else modes):
        found = problem.with_one_more_mode(chosen)
        if found is None:
            break
        if (
            chosen is not None
            and modes is None
            and not (found.criterion < chosen.criterion and problem.is_determined(found))
        ):
            break
        chosen = found
    if chosen is None or not problem.inside(chosen):
        f = spectrum.frequency
        raise InvalidInput(
            f"{spectrum.file_name or 'spectrum'}: no resonance found among {f.size} points from {f[0]:.6g} to"
            f" {f[-1]:.6g} Hz; sweep over it with steps below its width"
        )
    return problem.result(chosen)


@dataclass(frozen=True, slots=True, eq=False)
class _Solution:
    """Least-squares solution: logarithms of the frequency and quality factor of each mode."""

    shape: Floats
    residuals: Floats
    covariance: Floats
    correlation: float

    @property
    def criterion(self) -> float:
        """Bayesian information criterion, all but the shape of the modes alike."""
        n, count = self.residuals.size, 3 * self.shape.size
        return n * float(np.log(max(float(np.mean(self.residuals**2)), _ROUNDING**2))) + count * float(np.log(n))


class _Problem:
    """Weighted least-squares problem of one spectrum: of its complex response, or of its squared magnitude."""

    def __init__(self, spectrum: ResonanceSpectrum) -> None:
        self.spectrum = spectrum
        self.f = spectrum.frequency
        magnitude = np.abs(spectrum.response)
        values, weight = spectrum.response, spectrum.weight
        if not spectrum.has_phase:
            weight = weight / (2 * np.maximum(magnitude, _FAINTEST * magnitude.max()))
            values = magnitude**2
        self.weight = weight / float(np.max(np.abs(weight * values)))
        self.data = self.weight * values

    def columns(self, shape: Floats) -> Complexes | Floats:
        """Weighted modes and background, a column each: modes, their slopes, background."""
        f_r, quality = np.exp(shape.reshape(-1, 2)).T
        f, over = self.f[:, np.newaxis], self.f[0] / self.f
        with np.errstate(all="ignore"):
            resonant = f_r**2 / (f_r**2 - f**2 + 1j * f * f_r / quality) / quality
        if not self.spectrum.has_phase:
            resonant, over = np.abs(resonant) ** 2, over**2
        offset = (2 * self.f - self.f[0] - self.f[-1]) / (self.f[-1] - self.f[0])
        background = np.stack([np.ones_like(self.f), offset, over, over**2, over**3], axis=1)
        every = np.hstack([resonant, resonant * (f / f_r - 1), background])
        return np.asarray(np.nan_to_num(every) * self.weight[:, np.newaxis])

    def left_over(self, shape: Floats) -> Complexes | Floats:
        """Weighted data less the best fit of modes and background."""
        basis = np.linalg.qr(self.columns(shape))[0]
        return np.asarray(self.data - basis @ (basis.conj().T @ self.data))

    def residuals(self, shape: Floats) -> Floats:
        """Weighted residuals: real, then imaginary parts where the response is complex."""
        apart = self.left_over(shape)
        return np.concatenate([apart.real, apart.imag]) if self.spectrum.has_phase else np.asarray(apart.real)

    def with_one_more_mode(self, simpler: _Solution | None) -> _Solution | None:
        """Best solution with one mode more, or None where no candidate stays within the spectrum."""
        before = np.empty(0) if simpler is None else simpler.shape
        solved = [self.solved(np.concatenate([before, one])) for one in self.candidates(before)[:_MAX_CANDIDATES]]
        found = [one for one in solved if one is not None]
        return min(found, key=lambda one: float(np.sum(one.residuals**2)), default=None)

    def candidates(self, before: Floats) -> list[Floats]:
        """Logarithms of frequency and quality factor of possible modes, the most explaining first."""
        ranked = []
        for pole in self.poles(self.left_over(before) / self.weight if before.size else self.data / self.weight):
            f_r, quality = abs(pole), abs(pole) / (2 * pole.imag)
            if self.is_within(f_r, quality):
                added = np.log([f_r, quality])
                ranked.append((float(np.sum(self.residuals(np.concatenate([before, added])) ** 2)), added))
        return distinct_modes(ranked, widths=0.5)

    def poles(self, values: Complexes | Floats) -> list[complex]:
        """Frequencies of free decay, complex, by rational approximations that are real for real signals."""
        thinned = slice(None, None, -(-self.f.size // _POINTS_OF_CANDIDATES))
        f, y = self.f[thinned] / self.f[-1], values[thinned]
        x, y = np.concatenate([f, -f]), np.concatenate([y, y.conj()])
        return [root for root in rational_poles(x, y, scale=self.f[-1]) if root.imag > 0 and root.real > 0]

    def is_within(self, f_r: float, quality: float) -> bool:
        """Whether a mode resonates within the sweep or near its ends."""
        near = self.f[0] / _BEYOND < f_r < self.f[-1] * _BEYOND
        return bool(near and _LOWEST_QUALITY < quality < _HIGHEST_QUALITY)

    def inside(self, solution: _Solution) -> list[int]:
        """Modes that resonate within the sweep, in order of frequency."""
        f_r = np.exp(solution.shape[::2])
        return [int(k) for k in np.argsort(f_r) if self.f[0] < f_r[k] < self.f[-1]]

    def is_determined(self, solution: _Solution) -> bool:
        """Whether frequency and quality factor of every mode within the sweep are determined within a factor."""
        variance = np.diag(solution.covariance).reshape(-1, 2)
        return bool(np.all(variance[self.inside(solution)] < _LARGEST_ERROR**2))

    def solved(self, start: Floats) -> _Solution | None:
        """Local least-squares solution, or None where a mode leaves the spectrum."""
        from scipy.optimize import least_squares

        with np.errstate(all="ignore"):
            fit = least_squares(
                self.residuals, start, method="lm", xtol=1e-8, ftol=1e-8, max_nfev=_EVALUATIONS * start.size
            )
        pairs = np.exp(np.clip(fit.x, -200, 200)).reshape(-1, 2)
        if not all(self.is_within(*pair) for pair in pairs) or _overlap(pairs):
            return None
        return self.with_covariance(np.asarray(fit.x), np.asarray(fit.fun))

    def with_covariance(self, shape: Floats, residuals: Floats) -> _Solution:
        """Solution with White's covariance, widened for the correlation of its residuals."""
        steps = _STEP * np.eye(shape.size)
        jacobian = np.stack(
            [(self.residuals(shape + step) - self.residuals(shape - step)) / (2 * _STEP) for step in steps], axis=1
        )
        inverse = np.linalg.pinv(jacobian, rcond=1e-12)
        rows = 2 if self.spectrum.has_phase else 1
        series = residuals.reshape(rows, -1)
        correlation = max(statistical_inefficiency(row) if np.ptp(row) > _ROUNDING else 1.0 for row in series)
        linear = rows * (shape.size + _BACKGROUND)
        freedom = max(1.0, residuals.size / correlation - shape.size - linear)
        coherent = correlation if correlation > _CORRELATED else 1.0
        covariance = (inverse * residuals**2) @ inverse.T * (residuals.size / freedom * coherent)
        return _Solution(shape, residuals, covariance, correlation)

    def result(self, solution: _Solution) -> ResonanceFit:
        """Record of a solution."""
        pairs, columns = np.exp(solution.shape.reshape(-1, 2)), self.columns(solution.shape)
        error = np.sqrt(np.diag(solution.covariance)[::2])
        linear = np.linalg.lstsq(columns, self.data, rcond=1e-12)[0]
        fitted = columns @ linear / self.weight
        modes, slopes = linear[: len(pairs)], linear[len(pairs) : 2 * len(pairs)]
        if self.spectrum.has_phase:
            # the residue at the pole: over a narrow sweep mode and slope are each known but for a smooth background
            pole = np.sqrt(1 - 0.25 / pairs[:, 1] ** 2) + 0.5j / pairs[:, 1]
            heights = np.abs(modes + slopes * (pole - 1))
        else:
            fitted, heights = np.sqrt(np.maximum(fitted.real, 0)), np.sqrt(np.abs(modes))
        largest = float(np.max(np.abs(self.spectrum.response)))
        found = [
            Resonance(
                frequency=float(pairs[k, 0]),
                frequency_uncertainty=float(pairs[k, 0] * error[k]),
                quality_factor=float(pairs[k, 1]),
                relative_height=float(heights[k]) / largest,
            )
            for k in self.inside(solution)
        ]
        correlated = (
            f"residuals of the fit are correlated over {solution.correlation:.0f} points, which widens the"
            " intervals: the sweep shows more than the fitted modes; sweep less far"
        )
        return ResonanceFit(
            spectrum=self.spectrum,
            resonances=tuple(found),
            fitted=np.asarray(fitted, dtype=np.complex128),
            residual_correlation=solution.correlation,
            caveats=(correlated,) if solution.correlation > _CORRELATED else (),
        )


def _overlap(pairs: Floats) -> bool:
    """Whether two modes lie within an eighth of a full width of each other, which no sweep resolves."""
    ordered = pairs[np.argsort(pairs[:, 0])]
    widths = ordered[:, 0] / ordered[:, 1]
    return bool(np.any(np.diff(ordered[:, 0]) < np.minimum(widths[1:], widths[:-1]) / 8))
