"""Modified Bessel functions I_0 and I_1 by polynomial approximations, with errors below 2e-6, and Wright's function.

They are the mean and the first harmonic of an exponential contact force under a sinusoidal displacement, and its mean
on a structure with a static stiffness.
"""

import numpy as np

from sonolube.checks import Floats

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
