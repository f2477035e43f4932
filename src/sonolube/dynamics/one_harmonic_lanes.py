"""The steady state with a single harmonic on lanes: what an exponential contact needs, point beside point."""

from typing import NamedTuple

import numba
import numpy as np

from sonolube.checks import Floats
from sonolube.dynamics.contact_port import ContactPort
from sonolube.dynamics.lanes import INSIDE, LANES

WEAK = 0.2  # contact stiffness times receptance up to which substitution finds the only solution
_NOTHING = 1e-30  # m, which keeps an amplitude of zero from dividing
# polynomials for the modified Bessel functions, lowest power first (Abramowitz and Stegun 9.8.1 to 9.8.4)
SMALL_0 = (1.0, 3.5156229, 3.0899424, 1.2067492, 0.2659732, 0.0360768, 0.0045813)
SMALL_1 = (0.5, 0.87890594, 0.51498869, 0.15084934, 0.02658733, 0.00301532, 0.00032411)
LARGE_0 = (
    0.39894228,
    0.01328592,
    0.00225319,
    -0.00157565,
    0.00916281,
    -0.02057706,
    0.02635537,
    -0.01647633,
    0.00392377,
)
LARGE_1 = (
    0.39894228,
    -0.03988024,
    -0.00362018,
    0.00163801,
    -0.01031555,
    0.02282967,
    -0.02895312,
    0.01787654,
    -0.00420059,
)


class Block(NamedTuple):
    """A block of points, one lane each."""

    omega: Floats
    load: Floats
    length: Floats  # over which the contact changes, in m
    strength: Floats  # contact stiffness times receptance
    amplitude: Floats  # largest that balances, in m


@numba.njit(**INSIDE)
def substitute(block: Block, answer: Floats, work: Floats) -> None:
    """Write the amplitudes that balance by three substitutions, the force against them, and whether this is sure."""
    force, free, ratio, beta = work[0], work[1], work[2], work[3]
    for lane in range(LANES):
        free[lane] = np.sqrt(answer[2, lane] * answer[2, lane] + answer[3, lane] * answer[3, lane])
        block.amplitude[lane] = free[lane]
    for substitution in range(4):
        for lane in range(LANES):
            beta[lane] = block.amplitude[lane] / block.length[lane]
        _bessel_ratios(beta, ratio, work[4:])
        for lane in range(LANES):
            force[lane] = 2 * block.load[lane] * ratio[lane]
        if substitution == 0:
            for lane in range(LANES):
                receptance = np.sqrt(answer[0, lane] * answer[0, lane] + answer[1, lane] * answer[1, lane])
                block.strength[lane] = receptance * block.load[lane] / block.length[lane]
        if substitution < 3:
            for lane in range(LANES):
                share = force[lane] / (block.amplitude[lane] + _NOTHING)
                re, im = 1 + share * answer[0, lane], share * answer[1, lane]
                block.amplitude[lane] = free[lane] / np.sqrt(re * re + im * im)


@numba.njit(**INSIDE)
def _bessel_ratios(beta: Floats, ratio: Floats, work: Floats) -> None:
    """Write I_1/I_0 to within 1e-6."""
    t, i0, i1 = work[0], work[1], work[2]
    for lane in range(LANES):
        t[lane] = min(beta[lane] / 3.75, 1.0) ** 2
    _polynomials(SMALL_0, t, i0)
    _polynomials(SMALL_1, t, i1)
    for lane in range(LANES):
        ratio[lane] = beta[lane] * i1[lane] / i0[lane]
        t[lane] = 3.75 / max(beta[lane], 3.75)
    _polynomials(LARGE_0, t, i0)
    _polynomials(LARGE_1, t, i1)
    for lane in range(LANES):
        ratio[lane] = ratio[lane] if beta[lane] < 3.75 else i1[lane] / i0[lane]


@numba.njit(**INSIDE)
def _polynomials(coefficients: tuple[float, ...], argument: Floats, result: Floats) -> None:
    for lane in range(LANES):
        result[lane] = 0.0
    for power in range(len(coefficients) - 1, -1, -1):
        coefficient = coefficients[power]
        for lane in range(LANES):
            result[lane] = coefficient + argument[lane] * result[lane]


@numba.njit(**INSIDE)
def choose_orders(port: ContactPort, tolerance: float, block: Block, work: Floats, orders: Floats) -> None:
    """Write harmonics, coupled harmonics and the order of the force that is left out, as if it were exponential."""
    beta, share, receptance = work[0], work[1], work[2]
    steepest = 0.0
    for lane in range(LANES):
        beta[lane], share[lane] = block.amplitude[lane] / block.length[lane], 1.0
        orders[0, lane], orders[1, lane], orders[2, lane] = 2.0, 1.0, 1.0
        steepest = max(steepest, beta[lane])
    order, left = 1, 1.0
    while left >= tolerance and order < 64:
        left *= _bessel_step(steepest, order)
        for lane in range(LANES):
            receptance[lane] = 0.0
        for pair in range(port.trace.size):
            constant, slope = abs(port.constant[0, pair]), abs(port.slope[0, pair]) * order
            determinant, trace = port.determinant[pair], abs(port.trace[pair]) * order
            for lane in range(LANES):
                s = block.omega[lane]
                below = abs(determinant - order * order * s * s) + trace * s
                receptance[lane] += (constant + slope * s) / below  # at most 1.4 times too large or too small
        for lane in range(LANES):
            share[lane] *= _bessel_step(beta[lane], order)
            answer = 2 * block.load[lane] * share[lane] * receptance[lane]
            here = share[lane] >= tolerance
            orders[0, lane] = order if here and answer > 0.5 * tolerance * block.amplitude[lane] else orders[0, lane]
            orders[1, lane] = order if here and answer > WEAK / 10 * block.length[lane] else orders[1, lane]
            orders[2, lane] = order + 1 if here else orders[2, lane]
        order += 1
    for lane in range(LANES):
        orders[0, lane] = max(orders[0, lane], orders[1, lane], 2.0)


@numba.njit(**INSIDE)
def _bessel_step(beta: float, order: int) -> float:
    """Return about I_k/I_(k-1), a little too much (D. E. Amos)."""
    return float(beta / (order - 0.5 + np.sqrt((order + 0.5) ** 2 + beta * beta)))
