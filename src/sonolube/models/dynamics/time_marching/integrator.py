r"""Exponential multistep integrator: one time step, exact for the linear motion and the drive of a structure.

Over a step of duration h the pairs of states obey :math:`\dot s = A s + b V + c f` with the contact force f less the
dead load, hence

.. math:: s(t + h) = e^{Ah} s(t) + \int_0^h e^{A(h-\sigma)} \left[b\,V(t+\sigma) + c\,f(t+\sigma)\right] d\sigma .

The drive is integrated exactly; the force is interpolated through its values at past steps. The step is written as a
linear recursive filter of these values.
"""

import math
from functools import cache

import numpy as np

from sonolube.checks import Complexes, Floats
from sonolube.errors import InvalidInput
from sonolube.models.dynamics.linear import FirstOrderModes
from sonolube.models.dynamics.waveform import Sine, Waveform, waveform_value

PAST = 5
"""Past values of the force that the integrator keeps. []"""
_FITTED_HARMONICS = 2  # of the drive, for which the force is integrated exactly
_NODES = 16  # of the quadrature over a step, beside those that a fast pole requires
_LARGEST_PHASE = 1000.0  # modulus of the fastest pole times the step, in radians, beyond which nodes are too many


def step_quadrature(modes: FirstOrderModes, *, steps: int, slowest: float) -> tuple[Floats, Floats]:
    """Gauss-Legendre nodes and weights from 0 to 1 that resolve the free motion over a step; shape (nodes,)."""
    phase = _fastest(modes) / (steps * slowest)
    if phase > _LARGEST_PHASE:
        raise InvalidInput(
            f"steps_per_period = {steps} is too few for a drive as slow as {slowest:.3g} Hz beside this structure's"
            f" fastest mode; take {minimum_steps(modes, frequency=slowest)} at least, or a higher frequency"
        )
    return _gauss_legendre(_NODES + int(np.ceil(0.6 * phase)))


class ExponentialIntegrator:
    r"""Coefficients of a time step at each of several drive frequencies, all with the same number of steps per period.

    Between its samples the force is the combination of a constant, the first two harmonics of the drive and, where six
    samples are available, a straight line that passes through them: for many steps a polynomial, for few steps exact
    for what a steady contact force mostly consists of. The displacement is predicted from five past forces (exponential
    Adams-Bashforth); the new force at that displacement corrects the state (exponential Adams-Moulton). The order is
    five

    Source: M. Hochbruck and A. Ostermann, Acta Numerica 19, 209 (2010). doi:10.1017/S0962492910000048

    Parameters
    ----------
    modes : FirstOrderModes
    contact_output : ndarray, shape (2, n, 2)
        Displacement and velocity of the contact per state.
    frequency : ndarray, shape (frequencies,)
        Of the drive. [Hz]
    steps : int
        Per period.
    waveform : Sine or PiecewiseLinear

    Attributes
    ----------
    propagator : ndarray, shape (frequencies, n, 2, 2)
        State transition matrices E = exp(A h).
    oldest : ndarray, shape (frequencies, n, 2)
        Contribution o of the oldest force to the auxiliary state.
    recent : ndarray, shape (frequencies, 5, n, 2)
        Contributions r_j of the recent forces to the state.
    predictor : ndarray, shape (frequencies, 2, 5)
        Contributions of the recent forces to displacement and velocity of the contact one step ahead, beside those of
        the new auxiliary state.
    ahead : ndarray, shape (frequencies, 2, 4, 5)
        Contributions of the forces now and at the next four steps to displacement and velocity of the contact at these
        steps, for a start without history.
    backward : ndarray, shape (5, 5)
        Extrapolation of the forces now and at the next four steps to the past, for a start without history.
    wave : ndarray, shape (frequencies, 3, steps, n, 2)
        Contribution of the drive to each step of a period, per volt peak to peak, under ramps of 1, s and s^2, with s
        from 0 to 1 over the step.
    offset : ndarray, shape (frequencies, 3, n, 2)
        Contribution of the drive per volt of offset, likewise.

    Notes
    -----
    With the force :math:`f_j` of j steps ago (less the load), the state s is obtained from the auxiliary state y by

    .. math:: y \to E\,y + o\,f_4 + d, \qquad s = y + \sum_{j=0}^4 r_j f_j

    where d is the contribution of the drive.
    """

    def __init__(
        self, modes: FirstOrderModes, contact_output: Floats, *, frequency: Floats, steps: int, waveform: Waveform
    ) -> None:
        h = 1 / (frequency * steps)
        nodes, weights = step_quadrature(modes, steps=steps, slowest=float(frequency.min()))
        theta, back, ahead = 2 * np.pi / steps, 1.0 - np.arange(PAST + 1.0), np.arange(float(PAST))  # samples, in steps
        # exp(A h (1 - s)) c
        moved = _propagated(modes.state_matrix, modes.contact_input, np.multiply.outer(h, 1 - nodes))
        moved *= h[:, np.newaxis, np.newaxis, np.newaxis]

        def added(sampled_at: Floats, first: int = 0) -> Floats:
            """State that each sample of the force adds over a step, by its interpolation at the nodes."""
            sample_weights = _interpolation(first + nodes, sampled_at, theta) * weights[:, np.newaxis]
            return np.asarray(np.einsum("fmqa,qj->fjma", moved, sample_weights))

        units = [np.broadcast_to(row, modes.contact_input.shape) for row in np.eye(2)]
        columns = [_propagated(modes.state_matrix, unit, h[:, np.newaxis])[:, :, 0] for unit in units]
        self.propagator = np.stack(columns, axis=-1)
        corrected = added(back)
        self.recent = corrected[:, :PAST].copy()
        for j in range(1, PAST):  # filter W(q) = (1 - E q) V(q) + q^5 U, with the delay operator q
            self.recent[:, j] += _apply(self.propagator, self.recent[:, j - 1])
        self.oldest = corrected[:, PAST] + _apply(self.propagator, self.recent[:, PAST - 1])
        self.predictor = _at_contact(contact_output, added(back[1:]))
        propagated = np.stack([_apply(self.propagator, self.recent[:, j]) for j in range(PAST)], axis=1)
        self.predictor += _at_contact(contact_output, propagated)
        self.predictor[..., PAST - 1] -= np.einsum("kma,fma->fk", contact_output, self.oldest)
        later, reached = [], np.zeros_like(self.recent)
        for first in range(PAST - 1):
            reached = np.stack([_apply(self.propagator, reached[:, j]) for j in range(PAST)], axis=1)
            reached += added(ahead, first)
            later.append(_at_contact(contact_output, reached))
        self.wave, self.offset = _drive_contributions(modes, h, steps, waveform, nodes, weights)
        self.ahead = np.stack(later, axis=2)
        self.backward = _interpolation(-ahead, ahead, theta)


def minimum_steps(modes: FirstOrderModes, *, frequency: float) -> int:
    """Fewest steps per period, a multiple of 4, that resolve the structure's fastest mode."""
    return 4 * max(math.ceil(_fastest(modes) / (4 * _LARGEST_PHASE * frequency)), 2)


def _fastest(modes: FirstOrderModes) -> float:
    """Largest modulus of all poles, in 1/s."""
    return float(np.abs(np.linalg.eigvals(modes.state_matrix)).max(initial=0.0))


def _apply(propagator: Floats, states: Floats) -> Floats:
    """States one step later without forces."""
    return np.asarray(np.einsum("fmab,fmb->fma", propagator, states))


def _at_contact(contact_output: Floats, states: Floats) -> Floats:
    """Displacement and velocity of the contact, shape (frequencies, 2, samples)."""
    return np.asarray(np.einsum("kma,fjma->fkj", contact_output, states))


def _propagated(state_matrix: Floats, start: Floats, time: Floats) -> Floats:
    r"""exp(A t) applied to one start per pair of states, shape (frequencies, n, times, 2).

    Notes
    -----
    With :math:`A = m I + B`, m half the trace, :math:`B^2 = \delta^2 I`,

    .. math:: e^{At} = e^{mt} \left(\cosh(\delta t)\, I + \frac{\sinh(\delta t)}{\delta}\, B\right) .
    """
    middle = np.trace(state_matrix, axis1=1, axis2=2) / 2
    traceless = state_matrix - middle[:, np.newaxis, np.newaxis] * np.eye(2)
    half_gap: Complexes = np.sqrt(-np.linalg.det(traceless).astype(np.complex128))  # poles are middle +- half_gap
    t = time[:, np.newaxis, :]
    mu, delta = middle[:, np.newaxis], half_gap[:, np.newaxis]
    one, other, both = np.exp((mu + delta) * t), np.exp((mu - delta) * t), np.exp(mu * t)
    cosine = (one + other).real / 2
    small = np.abs(delta * t) < 1e-2
    series = both * t * (1 + (delta * t) ** 2 / 6 * (1 + (delta * t) ** 2 / 20 * (1 + (delta * t) ** 2 / 42)))
    sine = np.where(small, series, (one - other) / np.where(small, 1.0, 2 * delta)).real
    image = np.einsum("mab,mb->ma", traceless, start)
    return np.asarray(cosine[..., np.newaxis] * start[:, np.newaxis] + sine[..., np.newaxis] * image[:, np.newaxis])


def _interpolation(time: Floats, sampled_at: Floats, theta: float) -> Floats:
    """Interpolation weights of samples at times in steps, theta the phase of a step.

    The interpolant combines a constant, the first two harmonics of the drive and powers of time, all solutions of one
    linear differential equation, whose fundamental matrix is a matrix exponential.
    """
    harmonics = [0.0j, *(sign * 1j * k * theta for k in range(1, _FITTED_HARMONICS + 1) for sign in (1, -1))]
    exponents = harmonics + [0.0j] * (sampled_at.size - len(harmonics))
    companion = np.diag(np.ones(sampled_at.size - 1), 1)
    companion[-1] = -np.poly(np.array(exponents)).real[:0:-1]
    from scipy.linalg import expm

    basis = expm(np.multiply.outer(np.concatenate([time, sampled_at]), companion))[:, 0, :]
    return np.asarray(np.linalg.solve(basis[time.size :].T, basis[: time.size].T).T)


def _drive_contributions(
    modes: FirstOrderModes, h: Floats, steps: int, waveform: Waveform, nodes: Floats, weights: Floats
) -> tuple[Floats, Floats]:
    """Contributions of the drive to each step, per volt peak to peak and per volt of offset."""
    powers, scale = np.arange(3)[:, np.newaxis], h[:, np.newaxis, np.newaxis, np.newaxis]
    steady = scale * _propagated(modes.state_matrix, modes.drive_input, np.multiply.outer(h, 1 - nodes))
    offset = np.einsum("fmqa,kq->fkma", steady, weights * nodes**powers)
    at, split_weights = _split_at_corners(waveform, steps, nodes, weights)
    moved = scale * _propagated(modes.state_matrix, modes.drive_input, np.multiply.outer(h, 1 - at.ravel()))
    moved = moved.reshape(*moved.shape[:2], *at.shape, 2)
    values = waveform_value(waveform, phase=2 * np.pi / steps * (np.arange(steps)[:, np.newaxis] + at))
    weighted = split_weights * values * at ** powers[..., np.newaxis]
    if at.shape[0] == 1:  # the same nodes in every step
        return np.einsum("fmqa,knq->fknma", moved[:, :, 0], weighted), offset
    return np.einsum("fmnqa,knq->fknma", moved, weighted), offset


def corners_within_steps(waveform: Waveform, steps: int) -> Floats:
    """Corners of a waveform that fall within steps, in steps from the start of the period."""
    corners = np.empty(0) if isinstance(waveform, Sine) else waveform.starts_at * steps / (2 * np.pi)
    return np.asarray(corners[np.abs(corners - np.round(corners)) > 1e-9])


def _split_at_corners(waveform: Waveform, steps: int, nodes: Floats, weights: Floats) -> tuple[Floats, Floats]:
    """Quadrature nodes and weights of each step, one row for all where no corner falls within a step."""
    inside = corners_within_steps(waveform, steps)
    if not inside.size:
        return nodes[np.newaxis], weights[np.newaxis]
    most = int(np.bincount(inside.astype(np.int64)).max())
    edges = np.ones((steps, most + 2))  # surplus pieces have no length
    edges[:, 0] = 0.0
    for step in range(steps):
        own = np.sort(inside[inside.astype(np.int64) == step]) - step
        edges[step, 1 : 1 + own.size] = own
    length = np.diff(edges, axis=1)[..., np.newaxis]
    at = edges[:, :-1, np.newaxis] + length * nodes
    return at.reshape(steps, -1), (length * weights).reshape(steps, -1)


@cache
def _gauss_legendre(count: int) -> tuple[Floats, Floats]:
    """Nodes and weights of Gauss-Legendre quadrature from 0 to 1."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    return (1 + nodes) / 2, weights / 2
