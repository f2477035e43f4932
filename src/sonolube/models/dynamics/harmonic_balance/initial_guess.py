"""Initial guess of harmonic balance: the steady states with a single harmonic, all of them.

With a sinusoidal displacement of amplitude a about the mean that balances the static equation, the contact opposes the
motion with a force of amplitude Phi(a), and the amplitudes are the roots of

    |a + G(omega) Phi(a)| = |H(omega) V_1| .

Mean and first harmonic of an exponential contact force are the modified Bessel functions I_0 and I_1, by polynomial
approximations with errors below 2e-6; on a structure with a static stiffness its mean is Wright's function.
"""

from typing import NamedTuple

import numpy as np

from sonolube.checks import Complexes, Floats, Integers
from sonolube.models.dynamics.gap_laws.closed_form import ExponentialGap, GapLaw, force_decay_length
from sonolube.models.dynamics.harmonic_balance.batch import BatchProblem, default_truncation, sinusoidal_truncation
from sonolube.models.dynamics.harmonic_balance.equations import CONTACT_PER_FORCE, receptance
from sonolube.models.dynamics.harmonic_balance.harmonic_kernel import TAIL, Truncation

# Coefficients, lowest power first (Abramowitz and Stegun 9.8.1 to 9.8.4): up to BEND polynomials in the squared
# argument, beyond it in the inverse argument, both over BEND.
BEND = 3.75
SMALL_0 = (1.0, 3.5156229, 3.0899424, 1.2067492, 0.2659732, 0.0360768, 0.0045813)
SMALL_1 = (0.5, 0.87890594, 0.51498869, 0.15084934, 0.02658733, 0.00301532, 0.00032411)
LARGE_0, LARGE_1 = (
    (0.39894228, 0.01328592, 0.00225319, -0.00157565, 0.00916281, -0.02057706, 0.02635537, -0.01647633, 0.00392377),
    (0.39894228, -0.03988024, -0.00362018, 0.00163801, -0.01031555, 0.02282967, -0.02895312, 0.01787654, -0.00420059),
)


def bessel_ratio(argument: Floats) -> Floats:
    """I_1/I_0.

    Source: M. Abramowitz and I. A. Stegun, Handbook of Mathematical Functions, 9.8.1 to 9.8.4.
    """
    near, far = _scaled_arguments(argument)
    small = argument * _polynomial(SMALL_1, near) / _polynomial(SMALL_0, near)
    large = _polynomial(LARGE_1, far) / _polynomial(LARGE_0, far)
    return np.asarray(np.where(argument < BEND, small, large))


def log_bessel_i0(argument: Floats) -> Floats:
    """Ln I_0.

    Source: M. Abramowitz and I. A. Stegun, Handbook of Mathematical Functions, 9.8.1 and 9.8.2.
    """
    near, far = _scaled_arguments(argument)
    large = argument + np.log(_polynomial(LARGE_0, far) / np.sqrt(np.maximum(argument, BEND)))
    return np.asarray(np.where(argument < BEND, np.log(_polynomial(SMALL_0, near)), large))


def wright_omega(argument: Floats) -> Floats:
    r"""Wright's omega function of a real argument, the solution w of w + ln w = z, to rounding.

    Three steps of fourth order from exp(z), below z = 1, or from z - ln z.

    Source: P. W. Lawrence, R. M. Corless and D. J. Jeffrey, ACM Trans. Math. Softw. 38, 20 (2012), equation 6.
    """
    z = np.maximum(argument, -700.0)  # below it w is exp(z), which underflows
    above, below = np.maximum(z, 1.0), np.minimum(z, 1.0)
    w = np.where(z < -1.5, np.exp(below), np.where(z < 1.0, np.exp((below - 1) / 2), above - np.log(above)))
    for _ in range(3):
        r = z - w - np.log(w)
        q = 2 * (1 + w) * (1 + w + 2 / 3 * r)
        w = w * (1 + r / (1 + w) * (q - r) / (q - 2 * r))
    return np.asarray(np.where(argument < -700.0, 0.0, w))


def _scaled_arguments(argument: Floats) -> tuple[Floats, Floats]:
    """Variables of the polynomials on either side of BEND, clipped to their ranges."""
    return np.square(np.minimum(argument / BEND, 1.0)), BEND / np.maximum(argument, BEND)


def _polynomial(coefficients: tuple[float, ...], argument: Floats) -> Floats:
    """Polynomial by Horner's scheme, coefficients lowest power first."""
    result = np.full_like(argument, coefficients[-1])
    for coefficient in coefficients[-2::-1]:
        result *= argument
        result += coefficient
    return result


WEAK = 0.2
"""Contact stiffness times receptance below which fixed-point iteration finds the only solution. []"""
_ABSCISSAE = np.cos(np.pi * (np.arange(64) + 0.5) / 64)  # Gauss-Chebyshev nodes, for means over a period
_FEWER_ABSCISSAE = np.cos(np.pi * (np.arange(24) + 0.5) / 24)  # for a force without corners
_GRID, _GRID_CHUNK = 32, 4096  # amplitudes to scan for roots, and how many of all points to evaluate at once
_SMALL, _TINY = 1e-3, 1e-30  # of a decay length; m, against division by zero
_MEAN_TOLERANCE = 1e-6
_LONGEST = 1e3  # m, in place of an infinite decay length


class InitialGuess(NamedTuple):
    """Steady states with a single harmonic, one entry of each array per point."""

    mean: Floats  # (p,) m
    harmonic: Complexes  # (p,) m
    smallest_amplitude: Floats  # (p,) m: smallest root of the amplitude equation
    largest_amplitude: Floats  # (p,) m: largest root
    truncation: Truncation


class _SinusoidalMotions(NamedTuple):
    """Points for which sinusoidal motions are sought."""

    gap_law: GapLaw
    static_stiffness: float
    load: Floats  # (p,) N
    static_displacement: Floats  # (p,) m
    decay_length: Floats  # (p,) m
    receptance: Complexes  # (p,) m/N
    free_amplitude: Floats  # (p,) m, without contact force

    def select(self, chosen: Integers) -> "_SinusoidalMotions":
        return self._replace(**{name: getattr(self, name)[chosen] for name in self._fields[2:]})


def initial_guess(problem: BatchProblem, free_harmonics: Complexes, *, upper_branch: bool) -> InitialGuess:
    """Steady states of a batch with a single harmonic, and the truncation that the full ones require.

    `free_harmonics` has shape (p, K).
    """
    model, gap_law, omega, load = problem.model, problem.gap_law, problem.omega, problem.load
    decay_lengths, own = np.minimum(force_decay_length(gap_law, load), _LONGEST), free_harmonics[:, 0]
    response = receptance(model, CONTACT_PER_FORCE, omega)
    columns = (load, problem.static_displacement, decay_lengths, response, np.abs(own))
    motions = _SinusoidalMotions(gap_law, model.static_stiffness, *columns)
    smallest, largest = _amplitudes(motions)
    amplitude = largest if upper_branch else smallest
    mean, force = _balanced_mean(motions, amplitude)
    harmonic = own * amplitude / (amplitude + response * force + _TINY)
    if not gap_law.has_corner and free_harmonics.shape[1] == 1:
        follows_force = isinstance(gap_law, ExponentialGap) and gap_law.force_damping == 0.0
        truncation = sinusoidal_truncation(
            model, omega, load, decay_lengths, largest, TAIL * problem.tolerance, follows_force
        )
    else:
        truncation = default_truncation(omega.size, free_harmonics.shape[1])
    return InitialGuess(mean, harmonic, smallest, largest, truncation)


def _amplitudes(motions: _SinusoidalMotions) -> tuple[Floats, Floats]:
    """Smallest and the largest root of the amplitude equation, in m.

    Fixed-point iteration where the contact is weak beside the structure, else a search for all roots.
    """
    free = motions.free_amplitude
    if isinstance(motions.gap_law, ExponentialGap) and motions.static_stiffness == 0.0:
        strength = np.abs(motions.receptance) * motions.load / motions.decay_length
    else:
        small = _SMALL * motions.decay_length
        swinging = _force_amplitude(motions, free) / (free + _TINY)
        steepest = np.maximum(_force_amplitude(motions, small) / small, swinging)
        strength = np.abs(motions.receptance) * steepest
    amplitude = free.copy()
    for _ in range(2):
        stiffness = _force_amplitude(motions, amplitude) / (amplitude + _TINY)
        amplitude = free / np.abs(1 + stiffness * motions.receptance)
    smallest, largest = amplitude, amplitude
    strong = np.flatnonzero((strength >= WEAK) & (free > 0))
    if strong.size:
        largest = amplitude.copy()
        smallest[strong], largest[strong] = _bracketed_amplitudes(motions.select(strong))
    return smallest, largest


def _bracketed_amplitudes(motions: _SinusoidalMotions) -> tuple[Floats, Floats]:
    """Smallest and the largest of possibly several amplitudes, bracketed on a grid."""

    def excess(amplitude: Floats, own: _SinusoidalMotions = motions) -> Floats:
        return np.asarray(np.abs(amplitude + own.receptance * _force_amplitude(own, amplitude)) - own.free_amplitude)

    extent = np.arcsinh(_amplitude_bound(motions) / motions.decay_length)
    edges = motions.decay_length * np.sinh(np.multiply.outer(np.arange(_GRID + 1) / _GRID, extent))
    values = np.empty_like(edges)
    values[0] = -motions.free_amplitude
    count = motions.free_amplitude.size
    rows_at_once = max(_GRID_CHUNK // count, 1)
    for start in range(1, _GRID + 1, rows_at_once):
        rows = edges[start : start + rows_at_once]
        own = motions.select(np.tile(np.arange(count), len(rows)))
        values[start : start + rows_at_once] = excess(rows.reshape(-1), own).reshape(rows.shape)
    crossed = (values[:-1] < 0) & (values[1:] >= 0)
    first, last = crossed.argmax(axis=0), _GRID - 1 - crossed[::-1].argmax(axis=0)
    roots: list[Floats] = []
    for cell in (first, last):
        if roots and np.array_equal(first, last):
            break
        points = np.arange(cell.size)
        ends = (edges[cell, points], values[cell, points], edges[cell + 1, points], values[cell + 1, points])
        root = _regula_falsi(excess, *ends, tolerance=1e-4 * motions.free_amplitude)
        roots.append(np.where(crossed.any(axis=0), root, motions.free_amplitude))
    return roots[0], roots[-1]


def _amplitude_bound(motions: _SinusoidalMotions) -> Floats:
    """Upper bounds of all roots of the amplitude equation, in m."""
    bound = 1.1 * motions.free_amplitude + _SMALL * motions.decay_length
    for _ in range(60):
        force = _force_amplitude(motions, bound)
        above = np.abs(bound + motions.receptance * force) > motions.free_amplitude
        short = ~(above & (bound > np.abs(motions.receptance) * force))
        if not short.any():
            break
        bound[short] *= 1.5
    return bound


def _regula_falsi(  # type: ignore[no-untyped-def]
    function, lower: Floats, lower_value: Floats, upper: Floats, upper_value: Floats, *, tolerance: Floats
) -> Floats:
    """Bracketed roots of a function by false position (Illinois variant)."""
    middle, above, found = upper, np.zeros(upper.size, dtype=bool), np.zeros(upper.size, dtype=bool)
    for _ in range(12):
        secant = (lower * upper_value - upper * lower_value) / np.maximum(upper_value - lower_value, _TINY)
        middle = np.where(found, middle, secant)
        value = function(middle)
        high = value > 0
        halved_lower, halved_upper = np.where(above, 0.5, 1.0) * lower_value, np.where(above, 1.0, 0.5) * upper_value
        lower, lower_value = np.where(high, lower, middle), np.where(high, halved_lower, value)
        upper, upper_value = np.where(high, middle, upper), np.where(high, value, halved_upper)
        above = high
        found |= np.abs(value) < tolerance
        if found.all():
            break
    return middle


def _force_amplitude(motions: _SinusoidalMotions, amplitude: Floats) -> Floats:
    """Amplitude of the contact force opposing a sinusoidal motion about the balanced mean, in N."""
    return _balanced_mean(motions, amplitude)[1]


def _balanced_mean(motions: _SinusoidalMotions, amplitude: Floats) -> tuple[Floats, Floats]:
    r"""Mean that satisfies the static equation under a sinusoidal motion, and the opposing force amplitude.

    Notes
    -----
    For an exponential contact with :math:`\beta = a/l` on a floating structure

    .. math:: \bar x = l \ln I_0(\beta), \qquad \Phi = 2 F_N \frac{I_1(\beta)}{I_0(\beta)} ;

    any other law is integrated over the period by Gauss-Chebyshev quadrature.
    """
    if isinstance(motions.gap_law, ExponentialGap):
        beta = amplitude / motions.decay_length
        mean, force = motions.decay_length * log_bessel_i0(beta), motions.load
        if motions.static_stiffness > 0.0:
            mean, force = _held_mean(motions, mean)
        return mean, 2 * force * bessel_ratio(beta)
    return _iterated_mean(motions, amplitude)


def _held_mean(motions: _SinusoidalMotions, floating_mean: Floats) -> tuple[Floats, Floats]:
    r"""Mean displacement and mean force of an exponential contact on a structure with static stiffness.

    Notes
    -----
    With the mean :math:`\bar x_f` of a floating structure, the mean force :math:`F_N e^{(\bar x_f - \bar x)/l}` equals
    that of the static stiffness beyond the displacement at which the contact is unloaded,
    :math:`\bar x_u = \bar x_0 - F_N/S_0`. The solution is Wright's omega function,

    .. math::
        \bar x = \bar x_u + l\,\omega\!\left(\ln\frac{F_N}{S_0 l} + \frac{\bar x_f - \bar x_u}{l}\right) .
    """
    spring_force = motions.static_stiffness * motions.decay_length
    unloaded = motions.static_displacement - motions.load / motions.static_stiffness
    stretch = wright_omega(np.log(motions.load / spring_force) + (floating_mean - unloaded) / motions.decay_length)
    return unloaded + motions.decay_length * stretch, spring_force * stretch


def _iterated_mean(motions: _SinusoidalMotions, amplitude: Floats) -> tuple[Floats, Floats]:
    """Mean displacement that balances the load for any law, by Newton's method in a bracket."""
    floating = motions.static_stiffness == 0.0
    lower = np.zeros_like(amplitude) if floating else np.minimum(motions.static_displacement, 0.0)
    upper = amplitude.copy() if floating else np.maximum(motions.static_displacement, amplitude)
    mean, opposing = lower.copy(), np.zeros_like(amplitude)
    left, own = np.arange(mean.size), motions
    for _ in range(60):
        with np.errstate(over="ignore"):
            force, opposing[left], slope = _force_moments(own, mean[left], amplitude[left])
        excess = own.static_stiffness * (mean[left] - own.static_displacement) - (force - own.load)
        short = excess < 0
        lower[left[short]], upper[left[~short]] = mean[left[short]], mean[left[~short]]
        with np.errstate(divide="ignore", invalid="ignore"):
            step = excess / (own.static_stiffness + slope)
            if floating and not motions.gap_law.has_corner:
                step = np.log(own.load / force) * force / slope  # the logarithm of the force is nearly linear
            step[np.isinf(slope)] = np.nan  # which leads to bisection
        after = mean[left] - step
        inside = (lower[left] <= after) & (after <= upper[left])
        mean[left] = np.where(inside, after, 0.5 * (lower[left] + upper[left]))
        left = left[~(np.abs(step) < _MEAN_TOLERANCE * (amplitude[left] + _SMALL * own.decay_length))]
        if not left.size:
            break
        own = motions.select(left)
    return mean, opposing


def _force_moments(motions: _SinusoidalMotions, mean: Floats, amplitude: Floats) -> tuple[Floats, Floats, Floats]:
    """Mean force, amplitude of the opposing force and mean stiffness under a sinusoidal motion."""
    cosines = _ABSCISSAE if motions.gap_law.has_corner else _FEWER_ABSCISSAE
    x, load = mean[:, np.newaxis] + np.multiply.outer(amplitude, cosines), motions.load[:, np.newaxis]
    force, slope = motions.gap_law.force(x, load), motions.gap_law.stiffness(x, load)
    return force.mean(axis=1), -2 * (force * cosines).mean(axis=1), slope.mean(axis=1)
