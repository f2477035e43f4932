r"""Stick and slip phases of one spring under a harmonic oscillation of its limit or its end, in closed form (kernels).

The phase x is such that the force of a sticking spring less its limit varies as v x - sin x, where v is the sliding
speed over the peak velocity of the oscillation, both in deflections of the spring. The spring sticks from the phase
x = -arccos v, where that begins to fall, or from the onset of contact, and slips again where

.. math:: v x - \sin x

has returned to its value at the start. The friction deficit is the mean by which the force of the spring is below its
limit, in amplitudes of the limit; without loss of contact, with half the phase of sticking h,

.. math:: S(v) = \frac{v\, (1 - h \cot h)^2}{\pi}, \qquad v = \frac{\sin h}{\sqrt{h^2 + (1 - h \cot h)^2}}

References
----------
.. [1] M. Popov, V. L. Popov and N. V. Popov, Friction 5, 45 (2017), who give the system.
   doi:10.1007/s40544-016-0136-4
"""

from math import acos, cos, pi, sin, sqrt

import numpy as np

from sonolube.checks import Floats
from sonolube.execution.compilation import INNER, kernel

__all__: list[str] = []  # kernels of this room


@kernel(**INNER)
def stick_crossing_phase(
    v: float, level: float, first: float, last: float, from_first: float, from_last: float
) -> float:
    """Phase between two successive extrema at which v x - sin x equals `level`, by Halley's method.

    Phase to 1e-9; the deficit, whose integrand vanishes there, is insensitive to the error.
    """
    fraction = (level - from_first) / (from_last - from_first)
    x = first + (last - first) * acos(1 - 2 * min(max(fraction, 0.0), 1.0)) / pi
    for _ in range(50):
        s, c = sin(x), cos(x)
        residual, slope = v * x - s - level, v - c
        if (residual > 0) == (from_last > from_first):
            last = x
        else:
            first = x
        step = -2 * residual * slope / (2 * slope * slope - residual * s)
        if not first < x + step < last:
            step = (first + last) / 2 - x
        x += step
        if abs(step) < 1e-3 * abs(slope):  # third-order convergence
            break
    return x


@kernel(**INNER)
def half_stick_phase(v: float, contact: float) -> float:
    """Half the phase of sticking h of an element that comes into contact at the phase m - h, sin m = v h/sin h.

    Zero for an element that does not stick.
    """
    start, extremum = contact - pi / 2, acos(v)
    if start >= extremum:
        return 0.0
    bottom = v * extremum - sin(extremum)
    level, end = v * start - sin(start), 2 * pi - extremum
    return (stick_crossing_phase(v, level, extremum, end, bottom, 2 * pi * v - bottom) - start) / 2


@kernel(**INNER)
def normalized_deficit(v: float) -> float:
    """Mean friction deficit S(v) of an element that is always in contact, in amplitudes of its limit.

    From 1 for slow sliding to 0 at v = 1. Half the phase of sticking is found by two steps of Newton's method from a
    fit that is exact at both ends and within 0.5 % in between.
    """
    if v >= 1.0:
        return 0.0
    if v <= 1e-14:
        return 1.0
    w = sqrt(v)
    h = sqrt(1 - w) * (pi + w * (sqrt(pi) * (sqrt(pi) / 2 - 1) + 0.06 * w))
    for _ in range(2):
        s, c = sin(h), cos(h)
        rise = s - h * c
        D = h * h * s * s + rise * rise
        root = sqrt(D)
        speed = s * s / root
        slope = 2 * s * c / root - s * s * (h * s * (s + h * c) + rise * h * s) / (D * root)
        h -= (sqrt(speed) - w) * 2 * sqrt(speed) / slope
    return v * (1 - h * cos(h) / sin(h)) ** 2 / pi


@kernel(**INNER)
def mean_friction_limit(c: float) -> float:
    """Mean of the limit max(c - cos x, 0) over a period."""
    if c >= 1.0:
        return c
    if c <= -1.0:
        return 0.0
    return (c * (pi - acos(c)) + sqrt(1 - c * c)) / pi


@kernel(**INNER)
def mean_deficit_normal(c: float, v: float) -> float:
    """Mean friction deficit of an element with the limit max(c - cos x, 0)."""
    if v >= 1.0 or c <= -sqrt(1 - v * v):
        return 0.0
    if c >= sqrt(1 - v * v):
        return normalized_deficit(v)
    h = half_stick_phase(v, acos(c))
    s = sin(h)
    if s <= 0.0:
        return 0.0
    return sqrt(max(1 - (v * h / s) ** 2, 0.0)) * (s - h * cos(h)) / pi


@kernel(**INNER)
def mean_force_longitudinal(stroke: float, v: float) -> float:
    """Mean force over the limit of an element whose end oscillates by `stroke`, in slip lengths."""
    if v >= 1.0 or stroke <= 0.0:
        return 1.0
    extremum = acos(v)
    top = sqrt(1 - v * v) - v * extremum  # v x - sin x at -extremum
    if stroke * top <= 1.0:  # half the fall of the force on the return
        return 1 - stroke * normalized_deficit(v)
    bottom, fall = -top, 2 / stroke
    back = stick_crossing_phase(v, top - fall, -extremum, extremum, top, bottom)
    again = stick_crossing_phase(v, bottom + fall, extremum, 2 * pi - extremum, bottom, top + 2 * pi * v)
    deficit = stroke * (top * (back + extremum) - v * (back * back - extremum * extremum) / 2 - cos(back) + v)
    deficit += 2 * (extremum - back)
    deficit += (2 + stroke * bottom) * (again - extremum)
    deficit -= stroke * (v * (again * again - extremum * extremum) / 2 + cos(again) - v)
    return 1 - deficit / (2 * pi)


@kernel(cache=True, no_cfunc_wrapper=True)
def flat_normal_ratio(c: Floats, v: Floats) -> Floats:
    """Friction ratio of a flat profile under normal oscillation, for mean approaches c and speeds v."""
    ratio = np.empty(c.size)
    for i in range(c.size):
        ratio[i] = 1 - mean_deficit_normal(c[i], v[i]) / mean_friction_limit(c[i])
    return ratio


@kernel(cache=True, no_cfunc_wrapper=True)
def parabolic_normal_ratio(c: Floats, v: Floats, nodes: Floats, weights: Floats) -> Floats:
    """Friction ratio of a parabolic profile under normal oscillation, with mean limits c - q^2."""
    ratio = np.empty(c.size)
    for i in range(c.size):
        last = sqrt(1 - v[i] * v[i]) if v[i] < 1 else 0.0
        ends = (0.0, sqrt(max(c[i] - last, 0.0)), sqrt(max(c[i] + last, 0.0)))
        deficit = ends[1] * normalized_deficit(v[i])
        half = (ends[2] - ends[1]) / 2
        for j in range(nodes.size):
            q = ends[1] + half * (1 + nodes[j])
            deficit += half * weights[j] * mean_deficit_normal(c[i] - q * q, v[i])
        ratio[i] = 1 - deficit / parabolic_mean_limit(c[i], nodes, weights)
    return ratio


@kernel(**INNER)
def parabolic_mean_limit(c: float, nodes: Floats, weights: Floats) -> float:
    """Integral of the mean limits over the springs of a parabolic profile."""
    inner, outer = sqrt(max(c - 1, 0.0)), sqrt(max(c + 1, 0.0))
    total = c * inner - inner**3 / 3
    half = (outer - inner) / 2
    for j in range(nodes.size):
        q = inner + half * (1 + nodes[j])
        total += half * weights[j] * mean_friction_limit(c - q * q)
    return total


@kernel(cache=True, no_cfunc_wrapper=True)
def flat_longitudinal_ratio(stroke: Floats, v: Floats) -> Floats:
    """Friction ratio of a flat profile under longitudinal oscillation, for strokes and speeds."""
    ratio = np.empty(stroke.size)
    for i in range(stroke.size):
        ratio[i] = mean_force_longitudinal(stroke[i], v[i])
    return ratio


@kernel(cache=True, no_cfunc_wrapper=True)
def parabolic_longitudinal_ratio(stroke: Floats, v: Floats, nodes: Floats, weights: Floats) -> Floats:
    """Friction ratio of a parabolic profile under longitudinal oscillation, for strokes at its centre."""
    ratio = np.ones(stroke.size)
    for i in range(stroke.size):
        if v[i] >= 1.0:
            continue
        reversal = stroke[i] * (sqrt(1 - v[i] * v[i]) - v[i] * acos(v[i]))  # limit below which slip reverses
        ends = (0.0, sqrt(max(1 - reversal, 0.0)), 1.0)
        total = 0.0
        for piece in range(2):
            half = (ends[piece + 1] - ends[piece]) / 2
            for j in range(nodes.size):
                limit = 1 - (ends[piece] + half * (1 + nodes[j])) ** 2
                total += 1.5 * half * weights[j] * limit * mean_force_longitudinal(stroke[i] / limit, v[i])
        ratio[i] = total
    return ratio


@kernel(cache=True, no_cfunc_wrapper=True)
def profile_mean_limits(c: Floats, flat: bool, nodes: Floats, weights: Floats) -> Floats:
    """Mean limit of a flat profile, or its integral over a parabolic one, for each mean approach c."""
    means = np.empty(c.size)
    for i in range(c.size):
        means[i] = mean_friction_limit(c[i]) if flat else parabolic_mean_limit(c[i], nodes, weights)
    return means


@kernel(cache=True, no_cfunc_wrapper=True)
def balanced_approaches(c: Floats, flat: bool, nodes: Floats, weights: Floats) -> Floats:
    """Mean approach, in amplitudes, at which the mean limit of a profile is that at rest at approach c."""
    balanced = np.empty(c.size)
    for i in range(c.size):
        at, target = c[i], c[i] if flat else c[i] ** 1.5 / 1.5
        for _ in range(100):  # the mean is convex in the approach, so that Newton's method falls from above to its root
            value = mean_friction_limit(at) if flat else parabolic_mean_limit(at, nodes, weights)
            slope = contact_fraction(at) if flat else _parabolic_slope(at, nodes, weights)
            step = (value - target) / slope
            at -= step
            if not step > 4e-16 * (1 + abs(at)):
                break
        balanced[i] = at
    return balanced


@kernel(**INNER)
def contact_fraction(c: float) -> float:
    """Fraction of a period in which the limit c - cos x is positive."""
    return 1 - acos(min(max(c, -1.0), 1.0)) / pi


@kernel(**INNER)
def _parabolic_slope(c: float, nodes: Floats, weights: Floats) -> float:
    """Derivative of `parabolic_mean_limit` by the approach."""
    inner, outer = sqrt(max(c - 1, 0.0)), sqrt(max(c + 1, 0.0))
    total, half = inner, (outer - inner) / 2
    for j in range(nodes.size):
        q = inner + half * (1 + nodes[j])
        total += half * weights[j] * contact_fraction(c - q * q)
    return total
