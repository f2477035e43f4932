"""Friction of a spring contact on a rigid guide under oscillation along normal or sliding: closed form and table.

The ratio R of a flat contact under load-balanced normal oscillations depends on the amplitude over the approach at
rest, beta, and on the reduced speed v = sin(sigma) alone. With the phase psi for which the springs touch in each half
period,

    sin psi - psi cos psi = pi/beta, beta > 1,

springs stick from their contact on where sigma < min(psi, pi - psi). The ratio then is, with half the phase of sticking
h,

    R = 1 - cos(psi - h) (sin h - h cos h)/(sin psi - psi cos psi), v h = sin h sin(psi - h),

and is tabulated over beta and sigma/min(psi, pi - psi), in which it is smooth: below beta = pi, where psi is pi/2, over
the fourth root of 1 - 1/beta, above over ln beta. Springs stick earlier at higher speeds and below beta = 1, where
R = 1 - beta S(v), and not at all at higher speeds above beta = pi.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.models.friction.oscillating_contact.spring_contact import (
    FEW,
    NODES,
    SpringContact,
    load_balanced_approach,
    require_contact,
)
from sonolube.models.friction.oscillating_contact.stick_slip_phases import (
    flat_longitudinal_ratio,
    flat_normal_ratio,
    normalized_deficit,
    parabolic_longitudinal_ratio,
    parabolic_normal_ratio,
)
from sonolube.models.friction.uniform_spline import in_chunks, spline_coefficients, spline_values


def normal_oscillation_ratio(
    contact: SpringContact,
    *,
    approach: ArrayLike,
    normal_amplitude: ArrayLike,
    frequency: ArrayLike,
    sliding_speed: ArrayLike,
) -> Floats:
    r"""Friction ratio under an oscillation along the normal on a rigid guide. []

    Parameters
    ----------
    contact : SpringContact
    approach : array_like
        Mean approach; under a dead load that of `load_balanced_approach`. [m]
    normal_amplitude : array_like
        Amplitude along the surface normal; contact is lost for part of the period if it exceeds the approach. [m]
    frequency : array_like
        Frequency of the oscillation. [Hz]
    sliding_speed : array_like
        Mean sliding speed. [m/s]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        Friction over that of the same mean normal force: from `normal_static_ratio` for slow sliding to exactly 1 from
        `critical_speed` on.

    Raises
    ------
    InvalidInput
        If frequency or speed is not positive, the amplitude negative, or a value not finite.
    OutsideRange
        If contact is lost throughout the period.

    Notes
    -----
    Exact for massless springs: the steady period of each spring follows from the phases at which it sticks and slips.
    For the flat profile without loss of contact

    .. math::

        \frac{F_1}{F_0} = 1 - \frac au\, S\!\left( \frac{v_r}{v_c} \right), \qquad
        S = \frac{v\, (1 - h \cot h)^2}{\pi}, \quad v = \frac{\sin h}{\sqrt{h^2 + (1 - h \cot h)^2}}

    with half the phase of sticking h, to 1e-9. Parabolic profiles are integrated over the springs to 1e-6.

    See Also
    --------
    approximate_normal_ratio : Published approximation.
    guided_oscillation_ratio : The same on a compliant guide.

    References
    ----------
    .. [1] M. Popov, V. L. Popov and N. V. Popov, Friction 5, 45 (2017), who give the system.
       doi:10.1007/s40544-016-0136-4

    Examples
    --------
    >>> from sonolube.models.friction import SpringContact, normal_oscillation_ratio
    >>> contact = SpringContact(friction_coefficient=0.3, mindlin_ratio=0.8)
    >>> vibrated = {"approach": 2e-6, "normal_amplitude": 1e-6, "frequency": 20e3}
    >>> ratio = normal_oscillation_ratio(contact, sliding_speed=[1e-6, 0.02, 0.05], **vibrated)
    >>> ratio.round(2).tolist()  # from 1 - a/u to 1 beyond the critical speed of 0.047 m/s
    [0.5, 0.86, 1.0]
    """
    u, a = require_contact(approach=approach, normal_amplitude=normal_amplitude)
    omega = 2 * np.pi * require_positive(frequency=frequency)
    v_r = require_positive(sliding_speed=sliding_speed)
    u, a, omega, v_r = np.broadcast_arrays(u, a, omega, v_r)
    v = np.minimum(v_r / np.maximum(contact.slip_per_approach * omega * a, v_r), 1.0)
    c = np.where(a > 0, u / np.where(a > 0, a, 1.0), 2.0)
    if contact.profile == "flat":
        return flat_normal_ratio.for_points(c.size, at_first=FEW)(c.ravel(), v.ravel()).reshape(u.shape)
    parabolic_ratio = parabolic_normal_ratio.for_points(c.size * NODES[0].size, at_first=FEW)
    return parabolic_ratio(c.ravel(), v.ravel(), *NODES).reshape(u.shape)


def longitudinal_oscillation_ratio(
    contact: SpringContact,
    *,
    approach: ArrayLike,
    in_plane_amplitude: ArrayLike,
    frequency: ArrayLike,
    sliding_speed: ArrayLike,
) -> Floats:
    r"""Friction ratio under an oscillation along the sliding direction on a rigid guide. []

    Parameters
    ----------
    contact : SpringContact
    approach : array_like
        Approach. [m]
    in_plane_amplitude : array_like
        Amplitude along the sliding direction. [m]
    frequency : array_like
        Frequency of the oscillation. [Hz]
    sliding_speed : array_like
        Mean sliding speed. [m/s]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        Exactly 1 from the peak velocity of the oscillation on.

    Raises
    ------
    InvalidInput
        If approach, frequency or speed is not positive, the amplitude negative, or a value not finite.

    Notes
    -----
    Exact for massless springs. For the flat profile and a stroke too short for reverse slip

    .. math:: \frac{F_1}{F_0} = 1 - \frac{k_x a}{\mu F_N}\, S\!\left( \frac{v_r}{\omega a} \right)

    with the function S of `normal_oscillation_ratio`: an oscillating limit and an oscillating end have the same effect
    on a spring. Long strokes give the arcsine of `parallel_vibration_ratio`.

    See Also
    --------
    approximate_longitudinal_ratio : Approximation in closed form.

    References
    ----------
    .. [1] V. L. Popov, J. Starcevic and A. E. Filippov, Tribol. Lett. 39, 25 (2010), who give the system.
       doi:10.1007/s11249-009-9531-6
    """
    u, a, omega, v_r = np.broadcast_arrays(
        require_positive(approach=approach),
        require_non_negative(in_plane_amplitude=in_plane_amplitude),
        2 * np.pi * require_positive(frequency=frequency),
        require_positive(sliding_speed=sliding_speed),
    )
    v = np.minimum(v_r / np.maximum(omega * a, v_r), 1.0).ravel()
    stroke = (a / (contact.slip_per_approach * u)).ravel()
    if contact.profile == "flat":
        return flat_longitudinal_ratio(stroke, v).reshape(u.shape)
    return parabolic_longitudinal_ratio(stroke, v, *NODES).reshape(u.shape)


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
