r"""Table of friction ratios of a flat spring contact under load-balanced normal oscillations, for very many points.

The ratio R depends on the amplitude over the approach at rest, beta, and on the reduced speed v = sin(sigma) alone.
With the phase psi for which the springs touch in each half period

.. math:: \sin\psi - \psi\cos\psi = \frac{\pi}{\beta}, \qquad \beta > 1

springs stick from their contact on where sigma < min(psi, pi - psi). The ratio then is, with half the phase of sticking
h,

.. math:: R = 1 - \frac{\cos(\psi - h)\,(\sin h - h\cos h)}{\sin\psi - \psi\cos\psi}, \qquad v h = \sin h \sin(\psi - h)

and is tabulated over beta and sigma/min(psi, pi - psi), in which it is smooth: below beta = pi, where psi is pi/2, over
the fourth root of 1 - 1/beta, above over ln beta. Springs stick earlier at higher speeds and below beta = 1, where
R = 1 - beta S(v), and not at all at higher speeds above beta = pi.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.models.friction.oscillating_contact.rigid_guide import normal_oscillation_ratio
from sonolube.models.friction.oscillating_contact.spring_contact import SpringContact, load_balanced_approach
from sonolube.models.friction.oscillating_contact.stick_slip_phases import normalized_deficit
from sonolube.models.friction.uniform_spline import in_chunks, spline_coefficients, spline_values

_HIGHEST = 1e6  # amplitude over approach at rest in the last row
_LOG_ROWS = (float(np.log(np.pi)), float(np.log(_HIGHEST)))
_LAST_ROOT = float((1 - 1 / np.pi) ** 0.25)
_LOW_ROWS, _HIGH_ROWS, _COLUMNS = 129, 113, 81
_SPEEDS = 257
_UNIT = SpringContact(friction_coefficient=1.0, mindlin_ratio=1.0)


class _Table(NamedTuple):
    """Coefficients of splines."""

    reduction: Floats  # below and above pi, one after the other along the first axis
    limit: Floats  # min(psi, pi - psi), likewise
    deficit: Floats  # S(v)/(1 - v)^2 over the fourth root of v


def tabulated_spring_ratio(
    *,
    approach: ArrayLike,
    normal_amplitude: ArrayLike,
    frequency: ArrayLike,
    sliding_speed: ArrayLike,
    slip_length: ArrayLike,
) -> Floats:
    """Friction ratio of a flat spring contact under a load-balanced normal oscillation, interpolated to 2e-6. []

    Parameters
    ----------
    approach : array_like
        Approach at rest. [m]
    normal_amplitude : array_like, broadcast against `approach`
        Amplitude along the surface normal. [m]
    frequency : array_like, broadcast against them
        Frequency of the oscillation. [Hz]
    sliding_speed : array_like, broadcast against them
        Mean sliding speed. [m/s]
    slip_length : array_like, broadcast against them
        Sliding distance mu u k_z/k_x in which a spring at the approach at rest reaches its limit. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        Of `normal_oscillation_ratio` at the approach of `load_balanced_approach`; both are called for amplitudes above
        1e6 approaches.

    Raises
    ------
    InvalidInput
        If a length, frequency or speed is not positive, an amplitude negative, or a value not finite.

    Notes
    -----
    Cubic splines, computed on the first call in some hundredths of a second. A hundred thousand points then take some
    milliseconds.

    See Also
    --------
    normal_oscillation_ratio : Computed anew for each point, to 1e-9.
    tabulated_stick_slip_ratio : The same for stick-slip of asperities.
    """
    u, a = require_positive(approach=approach), require_non_negative(normal_amplitude=normal_amplitude)
    f, v_r = require_positive(frequency=frequency), require_positive(sliding_speed=sliding_speed)
    beta = a / u
    scaled_speed = v_r * (u / require_positive(slip_length=slip_length))  # v times omega a, which may be 0
    v = scaled_speed / np.maximum(2 * np.pi * f * a, scaled_speed)
    ratio = in_chunks(_interpolated, beta, v)
    beyond = np.broadcast_to(beta > _HIGHEST, ratio.shape) & (v < 1)
    if np.any(beyond):
        many, fast = (np.broadcast_to(each, ratio.shape)[beyond] for each in (beta, v))
        ratio[beyond] = _exact(many, fast)
    return ratio


def _interpolated(beta: Floats, v: Floats) -> Floats:
    """Ratios for amplitudes over the approach at rest, up to that of the last row, and reduced speeds up to 1."""
    table = _table()
    bounded = np.clip(beta, 1.0, _HIGHEST)
    low = np.sqrt(np.sqrt(1 - 1 / np.minimum(bounded, np.pi))) * ((_LOW_ROWS - 1) / _LAST_ROOT)
    high = (np.log(bounded) - _LOG_ROWS[0]) * ((_HIGH_ROWS - 1) / (_LOG_ROWS[1] - _LOG_ROWS[0]))
    row = np.where(beta < np.pi, np.minimum(low, _LOW_ROWS - 1 - 1e-9), _LOW_ROWS + 2 + np.maximum(high, 0.0))
    limit = np.where(beta > 1, spline_values(table.limit, row), 0.0)
    sigma, ratio = np.arcsin(v), np.ones(v.shape)
    late = np.flatnonzero(sigma < limit)
    share = sigma[late] / limit[late]
    ratio[late] = 1 - spline_values(table.reduction, row[late], share * (_COLUMNS - 1))
    early = np.flatnonzero((sigma >= limit) & (beta < np.pi))
    speed, slower = v[early], 1 - v[early]
    deficit = spline_values(table.deficit, np.sqrt(np.sqrt(speed)) * (_SPEEDS - 1))
    ratio[early] = 1 - beta[early] * deficit * slower * slower
    return np.clip(ratio, 0.0, 1.0)


def _exact(beta: Floats, v: Floats) -> Floats:
    """Ratios without a table."""
    return normal_oscillation_ratio(
        _UNIT,
        approach=load_balanced_approach(_UNIT, approach=np.ones_like(beta), normal_amplitude=beta),
        normal_amplitude=beta,
        frequency=1 / (2 * np.pi),
        sliding_speed=np.maximum(v * beta, np.finfo(float).tiny),
    )


@cache
def _table() -> _Table:
    """Coefficients of the splines, computed once."""
    root, share = np.linspace(0, _LAST_ROOT, _LOW_ROWS), np.linspace(0, 1, _COLUMNS)
    below, above = 1 / (1 - root**4), np.exp(np.linspace(*_LOG_ROWS, _HIGH_ROWS))
    parts = []
    for beta in (below, above):
        psi = _touching_phases(beta)
        limit = np.pi - psi if beta is below else psi
        reduction = _reductions(psi[:, None], np.sin(limit[:, None] * share))
        parts.append((spline_coefficients(reduction), spline_coefficients(limit)))
    speeds = np.linspace(0, 1, _SPEEDS)[:-1] ** 4
    steady = np.array([normalized_deficit.interpreted(v) for v in speeds.tolist()]) / (1 - speeds) ** 2
    reduction, limits = (np.concatenate(each) for each in zip(*parts, strict=True))
    return _Table(reduction, limits, spline_coefficients(np.append(steady, 9 / (4 * np.pi))))


def _touching_phases(beta: Floats) -> Floats:
    """Phases psi for which springs touch in each half period."""
    low, high = np.zeros_like(beta), np.full_like(beta, np.pi)
    for _ in range(56):
        psi = (low + high) / 2
        more = np.sin(psi) - psi * np.cos(psi) > np.pi / beta
        low, high = np.where(more, low, psi), np.where(more, psi, high)
    return np.where(beta > 1, high, np.pi)


def _reductions(psi: Floats, v: Floats) -> Floats:
    """Reductions of friction of springs that stick from their contact on."""
    psi, v = np.broadcast_arrays(psi, v)
    low, high = np.maximum(psi - np.pi / 2, 1e-12), psi
    h = (low + high) / 2
    for step in range(16):
        excess = np.sin(h) * np.sin(psi - h) / h - v
        if step < 12:  # bisection, then Newton's method
            low, high = np.where(excess < 0, low, h), np.where(excess < 0, h, high)
            h = (low + high) / 2
        else:
            slope = (np.sin(psi - 2 * h) - np.sin(h) * np.sin(psi - h) / h) / h
            h = np.clip(h - excess / np.minimum(slope, -1e-300), low, high)
    return np.cos(psi - h) * (np.sin(h) - h * np.cos(h)) / (np.sin(psi) - psi * np.cos(psi))
