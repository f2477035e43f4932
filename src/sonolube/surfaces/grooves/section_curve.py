"""Smooth mean cross-section between the edges, by a spline of greatest likelihood in correlated noise."""

import math
from typing import NamedTuple

import numpy as np
from scipy.linalg import cho_factor, cho_solve, cholesky, eigh, solve_triangular

from sonolube.checks import Floats

_FLANK = 0.06  # of the depth, above which points near the edges are left out of the fit
_PASSES = 3
_LEAST_POINTS = 5
_DRAWS, _SEED = 300, 20_250_101
_REACH = 0.35  # of the fitted width, beyond which no edge is sought
_FINE = 161  # points of the curve
_JITTER = 1e-6  # of the variance
_MOST_POINTS = 160


class SectionCurve(NamedTuple):
    """Edges and greatest depth of a smooth section, with the standard deviations of each, in m."""

    left: float
    right: float
    depth: float
    deepest: float
    width_deviation: float
    depth_deviation: float
    left_slope: float  # per metre, of the flank at the edge; infinite where cut
    right_slope: float


def section_curve(
    s: Floats, z: Floats, covariance: Floats, edges: tuple[float, float], cut: tuple[bool, bool]
) -> SectionCurve | None:
    """Edges and depth of the smooth section through mean heights with correlated errors.

    Parameters
    ----------
    s, z : ndarray, shape (n,)
        Distances and mean heights, in m.
    covariance : ndarray, shape (n, n)
        Of the errors of the mean heights, in m2.
    edges : tuple of float
        First estimates of the edges, in m.
    cut : tuple of bool
        Whether the groove extends beyond the field at the left and at the right; its end is taken as it is there.

    Returns
    -------
    SectionCurve or None
        None where fewer than five points lie between the edges.

    Notes
    -----
    The section is a cubic smoothing spline, whose smoothness is that of greatest restricted likelihood [1]_ under the
    given covariance. Its edges are its zeros, extrapolated from the flanks, so that neither noise nor a ridge beyond
    the edge shifts them. Standard deviations are those of draws from its posterior distribution.

    References
    ----------
    .. [1] G. Wahba, Ann. Stat. 13, 1378 (1985). doi:10.1214/aos/1176349743
    """
    inside = (s > edges[0]) & (s < edges[1])
    depth = -float(z[inside].min()) if inside.any() else 0.0
    noise = math.sqrt(float(np.median(np.diag(covariance))))
    left, right = edges
    found = None
    for _ in range(_PASSES):
        inside = (s > left) & (s < right)
        if np.count_nonzero(inside) < _LEAST_POINTS:
            return found
        fit = _Spline.of(s[inside], z[inside], covariance[np.ix_(inside, inside)])
        found = _features(fit, left, right, cut)
        level = -min(_FLANK * depth + noise, depth / 3)
        fine = np.linspace(found.left, found.right, _FINE)
        low = fine[fit.at(fine) < level]
        low = low[(low >= s[0]) & (low <= s[-1])]
        if low.size < 2:
            return found
        left = -math.inf if cut[0] else float(low[0])
        right = math.inf if cut[1] else float(low[-1])
        left, right = max(left, edges[0] if cut[0] else left), min(right, edges[1] if cut[1] else right)
        depth = found.depth
    return found


class _Spline(NamedTuple):
    """Posterior of a cubic smoothing spline."""

    middle: float
    scale: float
    points: Floats
    inverse: tuple[Floats, bool]  # Cholesky factor of noise and prior
    line: Floats  # of the points, (n, 2)
    line_covariance: Floats
    coefficients: Floats
    weights: Floats
    power: float

    @classmethod
    def of(cls, s: Floats, z: Floats, covariance: Floats) -> "_Spline":
        """Spline through points with correlated errors."""
        middle, scale = float(s[0]), float(np.ptp(s)) / 2
        u = (s - middle) / scale
        line = np.stack([np.ones_like(u), u], axis=1)
        variance = float(np.mean(np.diag(covariance)))
        noise = covariance + _JITTER * variance * np.eye(u.size)
        prior = _kernel(u, u)
        power = _most_likely_power(noise, prior, line, z, variance)
        factor = cho_factor(noise + power * prior, lower=True)
        solved = cho_solve(factor, line)
        line_covariance = np.linalg.inv(line.T @ solved)
        coefficients = line_covariance @ (solved.T @ z)
        weights = cho_solve(factor, z - line @ coefficients)
        return cls(middle, scale, u, factor, line, line_covariance, coefficients, weights, power)

    def at(self, s: Floats) -> Floats:
        """Posterior mean of the heights in m at distances in m."""
        u = (s - self.middle) / self.scale
        return np.asarray(
            self.coefficients[0] + self.coefficients[1] * u + self.power * _kernel(u, self.points) @ self.weights
        )

    def draws(self, s: Floats) -> Floats:
        """Draws from the posterior at distances in m, shape (draws, points)."""
        u = (s - self.middle) / self.scale
        cross = self.power * _kernel(u, self.points)
        solved = cho_solve(self.inverse, cross.T)
        rest = np.stack([np.ones_like(u), u], axis=1) - cross @ cho_solve(self.inverse, self.line)
        covariance = self.power * _kernel(u, u) - cross @ solved + rest @ self.line_covariance @ rest.T
        values, vectors = eigh(covariance)
        normal = np.random.default_rng(_SEED).standard_normal((_DRAWS // 2, u.size))
        normal = np.concatenate([normal, -normal])
        return np.asarray(self.at(s) + (normal * np.sqrt(np.maximum(values, 0.0))) @ vectors.T)


def _kernel(u: Floats, v: Floats) -> Floats:
    """Covariance of a twice integrated white noise, that of a cubic spline, two-sided about the first point."""
    a, b = u[:, None], v[None, :]
    same = np.sign(a) == np.sign(b)
    low, high = np.minimum(np.abs(a), np.abs(b)), np.maximum(np.abs(a), np.abs(b))
    return np.asarray(np.where(same, low**2 * (3 * high - low) / 6, 0.0))


def _most_likely_power(noise: Floats, prior: Floats, line: Floats, z: Floats, variance: float) -> float:
    """Power of the spline's prior of greatest restricted likelihood."""
    root = cholesky(noise, lower=True)
    q = np.linalg.qr(solve_triangular(root, line, lower=True), mode="complete")[0][:, 2:]
    whitened = solve_triangular(root, solve_triangular(root, prior, lower=True).T, lower=True)
    values, vectors = eigh(q.T @ whitened @ q)
    values = np.maximum(values, 0.0)
    squares = np.square(vectors.T @ (q.T @ solve_triangular(root, z, lower=True)))
    powers = variance * np.logspace(-4, 12, 129)
    total = 1 + powers[:, None] * values
    cost = np.sum(np.log(total) + squares / total, axis=1)
    return float(powers[int(np.argmin(cost))])


def _features(fit: _Spline, left: float, right: float, cut: tuple[bool, bool]) -> SectionCurve:
    """Edges and depth of a spline, with their scatter over draws."""
    first, last = fit.middle, fit.middle + 2 * fit.scale
    reach = _REACH * (last - first)
    s = np.linspace(first if cut[0] else first - reach, last if cut[1] else last + reach, _FINE)
    mean = fit.at(s)
    within = (s >= min(first, left if math.isfinite(left) else first)) & (s <= last)
    at = int(np.flatnonzero(within)[np.argmin(mean[within])])
    curves = np.concatenate([mean[None], fit.draws(s)])
    lefts = np.full(len(curves), first) if cut[0] else _crossing(s[at::-1], curves[:, at::-1])
    rights = np.full(len(curves), last) if cut[1] else _crossing(s[at:], curves[:, at:])
    depths = -curves[:, within].min(axis=1)
    step = s[1] - s[0]

    def slope(place: float) -> float:
        return abs(float(np.diff(fit.at(np.array([place - step, place + step])))[0])) / (2 * step)

    return SectionCurve(
        left=float(lefts[0]),
        right=float(rights[0]),
        depth=float(depths[0]),
        deepest=float(s[at]),
        width_deviation=_deviation((rights - lefts)[1:]),
        depth_deviation=_deviation(depths[1:]),
        left_slope=math.inf if cut[0] else slope(float(lefts[0])),
        right_slope=math.inf if cut[1] else slope(float(rights[0])),
    )


def _deviation(values: Floats) -> float:
    """Standard deviation of a normal distribution with the same central 95 %."""
    low, high = np.quantile(values, [0.025, 0.975])
    return float(high - low) / (2 * 1.96)


def _crossing(s: Floats, curves: Floats) -> Floats:
    """First zero of each curve along the points, that of its last line where there is none."""
    above = curves >= 0
    above[:, 0] = False
    index = np.where(above.any(axis=1), np.argmax(above, axis=1), s.size - 1)
    rows = np.arange(len(curves))
    before, after = curves[rows, index - 1], curves[rows, index]
    share = np.clip(-before / np.where(after > before, after - before, 1.0), 0.0, 1.0)
    return np.asarray(s[index - 1] + np.where(after > before, share, 1.0) * (s[index] - s[index - 1]))
