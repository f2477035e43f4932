"""Smooth mean cross-section between the edges, by a spline of greatest likelihood in correlated noise."""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from scipy.linalg import cho_factor, cho_solve, cholesky, eigh, solve_triangular

from sonolube.checks import Floats
from sonolube.models.surfaces.height_map import Mask

__all__: list[str] = []  # used in this room only

_FLANK = 0.06  # of the depth, above which points near the edges are left out of the fit
_PASSES = 3
_MIN_POINTS = 5
_DRAWS, _SEED = 300, 20_250_101
_MIN_SLOPE, _LARGEST_SLOPE = 0.6, 2.5  # of a flank at its edge, over its mean
_FINE = 161  # points of the curve
_FLANK_END = 0.75  # of the depth, down to which points belong to the flank
_FLOOR = 0.7  # of the depth, from which points belong to the floor
_MIN_FLANK = 8  # points, of flank or floor
_CORRECTIONS = 2  # of the depth for the excess of the deepest of noisy points, by the draws; one leaves half of it
_JITTER = 1e-6  # of the variance


_Kernel = Callable[[Floats, Floats], Floats]


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

    `covariance` has shape (n, n).

    None where fewer than five points lie between the edges.

    The section is a smoothing spline, whose smoothness is that of greatest restricted likelihood under the given
    covariance: quintic over the whole and over each flank, cubic over the floor. Its edges are zeros extrapolated from
    the flanks, so that neither noise nor a ridge beyond the edge shifts them. Standard deviations are those of draws
    from the posterior distribution; that of the depth includes the difference between floor and whole.

    Source: G. Wahba, Ann. Stat. 13, 1378 (1985). doi:10.1214/aos/1176349743
    """
    noise = math.sqrt(float(np.median(np.diag(covariance))))
    left, right = edges
    fitted: tuple[tuple[Floats, Floats, Floats], Floats, list[_Edge | None]] | None = None
    for _ in range(_PASSES):
        inside = (s > left) & (s < right)
        if np.count_nonzero(inside) < _MIN_POINTS:
            break
        points = s[inside], z[inside], covariance[np.ix_(inside, inside)]
        mirrored = -points[0][::-1], points[1][::-1], points[2][::-1, ::-1]
        fit = _Spline(*points, _integrated_thrice)
        heights = fit.at(points[0])
        depth = -float(heights.min())
        ends = [
            None if cut[0] else _Edge(*points, heights, depth),
            None if cut[1] else _Edge(*mirrored, heights[::-1], depth),
        ]
        fitted = points, heights, ends
        level = -min(_FLANK * depth + noise, depth / 3)
        fine = np.linspace(*_places(points[0], ends), _FINE)
        low = fine[fit.at(fine) < level]
        if low.size < 2:
            break
        left = edges[0] if cut[0] else max(float(low[0]), s[0] - 1e-12)
        right = edges[1] if cut[1] else min(float(low[-1]), s[-1] + 1e-12)
    return None if fitted is None else _curve(*fitted)


class _Edge:
    """Zero of a flank before the first of the points, by a spline through its own; distances count inwards."""

    def __init__(self, s: Floats, z: Floats, covariance: Floats, heights: Floats, depth: float) -> None:
        deep = np.flatnonzero(heights < -_FLANK_END * depth)
        count = max(min(_MIN_FLANK, s.size), int(deep[0]) + 1 if deep.size else s.size)
        self.flank = _Spline(s[:count], z[:count], covariance[:count, :count], _integrated_thrice)
        self.first = float(s[0])
        self.secant = float(heights[0] - heights[count - 1]) / float(s[count - 1] - s[0])
        self.outwards = np.linspace(s[count - 1], s[0] + heights[0] / (_MIN_SLOPE * self.secant), _FINE)

    @property
    def place(self) -> float:
        """Zero of the flank's posterior mean, in m."""
        return float(self._zeros(self.flank.at(self.outwards)[None])[0])

    def deviation(self) -> float:
        """Standard deviation of the place over draws, in m."""
        return _deviation(self._zeros(self.flank.draws(self.outwards)))

    def slope(self, step: float) -> float:
        """Slope of the flank over two steps in m from its zero, per metre."""
        slope = abs(float(np.diff(self.flank.at(self.place + np.array([0.0, 2 * step])))[0])) / (2 * step)
        return min(max(slope, _MIN_SLOPE * self.secant), _LARGEST_SLOPE * self.secant)

    def _zeros(self, curves: Floats) -> Floats:
        """Zero of each curve along the flank outwards."""
        outwards = self.outwards
        places = _crossing(outwards, curves)
        lost = places <= outwards[-1]  # a parabola that turns back: its tangent at the last point instead
        at_end = np.array([np.interp(self.first, outwards[::-1], curve[::-1]) for curve in curves[lost]])
        places[lost] = self.first + at_end / self.secant
        return places


def _floor(s: Floats, z: Floats, covariance: Floats, heights: Floats, depth: float) -> tuple["_Spline", Floats]:
    """Spline of the floor, which may be less smooth than the flanks, and positions along it."""
    deep = np.flatnonzero(heights < -_FLOOR * depth)
    middle = (int(deep[0]) + int(deep[-1])) // 2
    first = max(0, min(int(deep[0]), middle - _MIN_FLANK // 2))
    last = min(s.size, max(int(deep[-1]) + 1, middle + _MIN_FLANK // 2))
    part = slice(first, last)
    spline = _Spline(s[part], z[part], covariance[part, part], _integrated_twice)
    return spline, np.linspace(s[first], s[last - 1], _FINE)


def _places(s: Floats, ends: Sequence[_Edge | None]) -> tuple[float, float]:
    """Places of both edges, the first and the last of the points where they are cut."""
    left, right = ends
    return float(s[0]) if left is None else left.place, float(s[-1]) if right is None else -right.place


def _curve(points: tuple[Floats, Floats, Floats], heights: Floats, ends: Sequence[_Edge | None]) -> SectionCurve:
    """Edges and depth from the splines of the floor and of the flanks, with the heights of the spline of the whole."""
    of_whole = -float(heights.min())
    spline, fine = _floor(*points, heights, of_whole)
    mean = spline.at(fine)
    depths = -spline.draws(fine).min(axis=1)
    excess = float(depths.mean() + mean.min())
    left, right = _places(points[0], ends)
    steps = float(points[0][1] - points[0][0]), float(points[0][-1] - points[0][-2])
    slopes = [math.inf if end is None else end.slope(step) for end, step in zip(ends, steps, strict=True)]
    return SectionCurve(
        left=left,
        right=right,
        depth=-float(mean.min()) - _CORRECTIONS * excess,
        deepest=float(fine[np.argmin(mean)]),
        width_deviation=math.hypot(*(end.deviation() for end in ends if end is not None)),
        depth_deviation=math.hypot(_deviation(depths), excess, of_whole + float(mean.min())),
        left_slope=slopes[0],
        right_slope=slopes[1],
    )


class _Spline:
    """Posterior of a smoothing spline with a free parabola, through points with correlated errors."""

    def __init__(self, s: Floats, z: Floats, covariance: Floats, kernel: _Kernel) -> None:
        self.middle, self.scale, self.kernel = float(s[0]), float(np.ptp(s)) / 2, kernel
        self.points = (s - self.middle) / self.scale
        self.line = _parabolas(self.points)
        variance = float(np.mean(np.diag(covariance)))
        noise = covariance + _JITTER * variance * np.eye(s.size)
        prior = kernel(self.points, self.points)
        self.power = _most_likely_power(noise, prior, self.line, z, variance)
        self.inverse = cho_factor(noise + self.power * prior, lower=True)
        solved = cho_solve(self.inverse, self.line)
        self.line_covariance = np.linalg.inv(self.line.T @ solved)
        self.coefficients = self.line_covariance @ (solved.T @ z)
        self.weights = cho_solve(self.inverse, z - self.line @ self.coefficients)

    def at(self, s: Floats) -> Floats:
        """Posterior mean of the heights in m at distances in m."""
        u = (s - self.middle) / self.scale
        return np.asarray(_parabolas(u) @ self.coefficients + self.power * self.kernel(u, self.points) @ self.weights)

    def draws(self, s: Floats) -> Floats:
        """Draws from the posterior at distances in m, shape (draws, points)."""
        u = (s - self.middle) / self.scale
        cross = self.power * self.kernel(u, self.points)
        solved = cho_solve(self.inverse, cross.T)
        rest = _parabolas(u) - cross @ cho_solve(self.inverse, self.line)
        covariance = self.power * self.kernel(u, u) - cross @ solved + rest @ self.line_covariance @ rest.T
        values, vectors = eigh(covariance)
        normal = np.random.default_rng(_SEED).standard_normal((_DRAWS // 2, u.size))
        normal = np.concatenate([normal, -normal])
        return np.asarray(self.at(s) + (normal * np.sqrt(np.maximum(values, 0.0))) @ vectors.T)


def _parabolas(u: Floats) -> Floats:
    """Powers that the prior leaves free, shape (n, 3)."""
    return np.stack([np.ones_like(u), u, u**2], axis=1)


def _integrated_twice(u: Floats, v: Floats) -> Floats:
    """Covariance of white noise integrated twice, that of a cubic spline, on both sides of the first point."""
    same, low, high = _nearer_and_farther(u, v)
    return np.asarray(np.where(same, low**2 * (3 * high - low) / 6, 0.0))


def _integrated_thrice(u: Floats, v: Floats) -> Floats:
    """Covariance of white noise integrated three times, that of a quintic spline, on both sides of the first point."""
    same, low, high = _nearer_and_farther(u, v)
    return np.asarray(np.where(same, low**5 / 20 + (high - low) * low**4 / 8 + (high - low) ** 2 * low**3 / 12, 0.0))


def _nearer_and_farther(u: Floats, v: Floats) -> tuple[Mask, Floats, Floats]:
    """Whether two points lie on the same side of the first, and their distances from it, the smaller one first."""
    a, b = u[:, None], v[None, :]
    return np.sign(a) == np.sign(b), np.minimum(np.abs(a), np.abs(b)), np.maximum(np.abs(a), np.abs(b))


def _most_likely_power(noise: Floats, prior: Floats, line: Floats, z: Floats, variance: float) -> float:
    """Power of the spline's prior of greatest restricted likelihood."""
    root = cholesky(noise, lower=True)
    q = np.linalg.qr(solve_triangular(root, line, lower=True), mode="complete")[0][:, 3:]
    whitened = solve_triangular(root, solve_triangular(root, prior, lower=True).T, lower=True)
    values, vectors = eigh(q.T @ whitened @ q, driver="evd")
    values = np.maximum(values, 0.0)
    squares = np.square(vectors.T @ (q.T @ solve_triangular(root, z, lower=True)))
    powers = variance * np.logspace(-4, 12, 129)
    total = 1 + powers[:, None] * values
    cost = np.sum(np.log(total) + squares / total, axis=1)
    return float(powers[int(np.argmin(cost))])


def _deviation(values: Floats) -> float:
    """Standard deviation of a normal distribution with the same central 95 %."""
    low, high = np.quantile(values, [0.025, 0.975])
    return float(high - low) / (2 * 1.96)


def _crossing(s: Floats, curves: Floats) -> Floats:
    """First zero of each curve along the points, their last where there is none."""
    above = curves >= 0
    above[:, 0] = False
    index = np.where(above.any(axis=1), np.argmax(above, axis=1), s.size - 1)
    rows = np.arange(len(curves))
    before, after = curves[rows, index - 1], curves[rows, index]
    share = np.where(after >= 0, np.clip(-before / np.where(after > before, after - before, 1.0), 0.0, 1.0), 1.0)
    return np.asarray(s[index - 1] + share * (s[index] - s[index - 1]))
