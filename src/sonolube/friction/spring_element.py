"""One spring before a slider, under an oscillation of its limit or of its stretch: when it grips, and what that costs.

Phases x are such that the sticking spring's force less its limit runs as v x - sin x: v is the steady sliding over
the peak speed of the oscillation, in lengths of the spring. It grips where that begins to fall, at x = -arccos v, or
where it touches, and slips again where v x - sin x has come back to its value at the start.
"""

from math import acos, cos, pi, sin, sqrt

import numba
import numpy as np

from sonolube.checks import Floats

__all__: list[str] = []  # of use in this room only


@numba.njit(cache=True)
def crossing(v: float, level: float, first: float, last: float, from_first: float, from_last: float) -> float:
    """Return where v x - sin x passes `level` between two turning points that follow each other, and its values there.

    Good to 1e-9: the shortfall, whose integrand vanishes there, does not feel the error.
    """
    passed = (level - from_first) / (from_last - from_first)
    x = first + (last - first) * acos(1 - 2 * min(max(passed, 0.0), 1.0)) / pi
    for _ in range(50):
        s, c = sin(x), cos(x)
        miss, slope = v * x - s - level, v - c
        if (miss > 0) == (from_last > from_first):
            last = x
        else:
            first = x
        step = -2 * miss * slope / (2 * slope * slope - miss * s)  # Halley's
        if not first < x + step < last:
            step = (first + last) / 2 - x
        x += step
        if abs(step) < 1e-3 * abs(slope):  # of third order
            break
    return x


@numba.njit(cache=True)
def half_grip(v: float, touch: float) -> float:
    """Return half the phase for which an element that touches at a phase grips: m - h = touch, sin m = v h/sin h."""
    start, turn = touch - pi / 2, acos(v)
    if start >= turn:
        return 0.0
    bottom = v * turn - sin(turn)
    return (crossing(v, v * start - sin(start), turn, 2 * pi - turn, bottom, 2 * pi * v - bottom) - start) / 2


@numba.njit(cache=True)
def lacking_share(v: float) -> float:
    """Return by what an element that never parts falls short of its limit, on average, in amplitudes of that limit.

    With h half the phase it grips, v = sin h/sqrt(h^2 + (1 - h cot h)^2) and the shortfall is v (1 - h cot h)^2/pi:
    from one for slow sliding to none at v = 1.
    """
    if v >= 1.0:
        return 0.0
    if v <= 1e-14:
        return 1.0
    w = sqrt(v)
    h = sqrt(1 - w) * (pi + w * (sqrt(pi) * (sqrt(pi) / 2 - 1) + 0.06 * w))  # right at both ends, and within 0.5 %
    for _ in range(2):
        s, c = sin(h), cos(h)
        rise = s - h * c
        D = h * h * s * s + rise * rise
        root = sqrt(D)
        reached = s * s / root
        slope = 2 * s * c / root - s * s * (h * s * (s + h * c) + rise * h * s) / (D * root)
        h -= (sqrt(reached) - w) * 2 * sqrt(reached) / slope
    return v * (1 - h * cos(h) / sin(h)) ** 2 / pi


@numba.njit(cache=True)
def mean_limit(c: float) -> float:
    """Return the mean of max(c - cos x, 0)."""
    if c >= 1.0:
        return c
    if c <= -1.0:
        return 0.0
    return (c * (pi - acos(c)) + sqrt(1 - c * c)) / pi


@numba.njit(cache=True)
def lacking_under_load(c: float, v: float) -> float:
    """Return by what an element of limit max(c - cos x, 0) falls short of it on average."""
    if v >= 1.0 or c <= -sqrt(1 - v * v):
        return 0.0
    if c >= sqrt(1 - v * v):
        return lacking_share(v)
    h = half_grip(v, acos(c))
    s = sin(h)
    if s <= 0.0:
        return 0.0
    return sqrt(max(1 - (v * h / s) ** 2, 0.0)) * (s - h * cos(h)) / pi


@numba.njit(cache=True)
def mean_under_stroke(stroke: float, v: float) -> float:
    """Return the mean force, in limits, of an element whose end oscillates by `stroke` of its slip lengths."""
    if v >= 1.0 or stroke <= 0.0:
        return 1.0
    turn = acos(v)
    top = sqrt(1 - v * v) - v * turn  # v x - sin x at -turn
    if stroke * top <= 1.0:  # half of what the force falls on the way back
        return 1 - stroke * lacking_share(v)
    bottom, fall = -top, 2 / stroke
    back = crossing(v, top - fall, -turn, turn, top, bottom)
    again = crossing(v, bottom + fall, turn, 2 * pi - turn, bottom, top + 2 * pi * v)
    lacking = stroke * (top * (back + turn) - v * (back * back - turn * turn) / 2 - cos(back) + v)
    lacking += 2 * (turn - back)
    lacking += (2 + stroke * bottom) * (again - turn)
    lacking -= stroke * (v * (again * again - turn * turn) / 2 + cos(again) - v)
    return 1 - lacking / (2 * pi)


@numba.njit(cache=True)
def flat_under_load(c: Floats, v: Floats) -> Floats:
    """Return the mean friction over the mean limit of one element under each mean limit c and speed v."""
    ratio = np.empty(c.size)
    for i in range(c.size):
        ratio[i] = 1 - lacking_under_load(c[i], v[i]) / mean_limit(c[i])
    return ratio


@numba.njit(cache=True)
def parabolic_under_load(c: Floats, v: Floats, nodes: Floats, weights: Floats) -> Floats:
    """Return the same for elements side by side whose mean limits fall from c with the square of their distance."""
    ratio = np.empty(c.size)
    for i in range(c.size):
        last = sqrt(1 - v[i] * v[i]) if v[i] < 1 else 0.0
        ends = (0.0, sqrt(max(c[i] - last, 0.0)), sqrt(max(c[i] + last, 0.0)))
        lacking = ends[1] * lacking_share(v[i])
        half = (ends[2] - ends[1]) / 2
        for j in range(nodes.size):
            q = ends[1] + half * (1 + nodes[j])
            lacking += half * weights[j] * lacking_under_load(c[i] - q * q, v[i])
        ratio[i] = 1 - lacking / parabolic_limit(c[i], nodes, weights)
    return ratio


@numba.njit(cache=True)
def parabolic_limit(c: float, nodes: Floats, weights: Floats) -> float:
    """Return the integral over their distances of the mean limits of such elements."""
    inner, outer = sqrt(max(c - 1, 0.0)), sqrt(max(c + 1, 0.0))
    total = c * inner - inner**3 / 3
    half = (outer - inner) / 2
    for j in range(nodes.size):
        q = inner + half * (1 + nodes[j])
        total += half * weights[j] * mean_limit(c - q * q)
    return total


@numba.njit(cache=True)
def flat_under_stroke(stroke: Floats, v: Floats) -> Floats:
    """Return the mean friction over the limit of one element under each stroke and speed."""
    ratio = np.empty(stroke.size)
    for i in range(stroke.size):
        ratio[i] = mean_under_stroke(stroke[i], v[i])
    return ratio


@numba.njit(cache=True)
def parabolic_under_stroke(stroke: Floats, v: Floats, nodes: Floats, weights: Floats) -> Floats:
    """Return the same for elements whose limits fall as 1 - q^2 towards the edge; `stroke` is that at the centre."""
    ratio = np.ones(stroke.size)
    for i in range(stroke.size):
        if v[i] >= 1.0:
            continue
        changes = stroke[i] * (sqrt(1 - v[i] * v[i]) - v[i] * acos(v[i]))  # limit below which one slips back
        ends = (0.0, sqrt(max(1 - changes, 0.0)), 1.0)
        total = 0.0
        for piece in range(2):
            half = (ends[piece + 1] - ends[piece]) / 2
            for j in range(nodes.size):
                limit = 1 - (ends[piece] + half * (1 + nodes[j])) ** 2
                total += 1.5 * half * weights[j] * limit * mean_under_stroke(stroke[i] / limit, v[i])
        ratio[i] = total
    return ratio


@numba.njit(cache=True)
def mean_limits(c: Floats, flat: bool, nodes: Floats, weights: Floats) -> Floats:
    """Return for each c the mean limit of one element, or the integral of those of elements side by side."""
    means = np.empty(c.size)
    for i in range(c.size):
        means[i] = mean_limit(c[i]) if flat else parabolic_limit(c[i], nodes, weights)
    return means
