"""Rigs with known friction under vibration, by stick-slip stepped through a period: code of its own.

Truth is drawn from what was learned of the population: memory length, decay length, and a discrepancy of the model that
is a Gaussian process over the logarithms of amplitude and speed with Student's scale, as large as what vibration can do
there, and drawn anew until all ratios lie between 0 and 1.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import i0e

from sonolube.checks import Floats

_STEPS = 2048  # of a period
_ELEMENTS = 160  # asperities that open in a period
_REFERENCE = 1.5e-6  # m, of the learned factor on the decay length
_AMPLITUDE_ERROR = 0.05
_TRIES = 1000
_DEGREES = 4.0  # of freedom of the discrepancy's scale


@dataclass(frozen=True, kw_only=True)
class SyntheticRig:
    """Runs of one rig at settings within a factor of two about its middle, the first of which is kept unseen.

    Parameters
    ----------
    vibration_amplitude, sliding_speed : ndarray, shape (n,)
        As stated, in m and in m/s.
    frequency : float
        In Hz.
    truth, measured : ndarray, shape (n,)
        Friction ratios, and the same with noise.
    noise : float
        Standard deviation.
    """

    vibration_amplitude: Floats
    sliding_speed: Floats
    frequency: float
    truth: Floats
    measured: Floats
    noise: float


def stepped_stick_slip_ratio(beta: Floats, speed: Floats) -> Floats:
    """Friction ratio of a load-balanced sine of beta decay lengths, the spring growing at a speed per radian.

    Elements touch at the gap c, in amplitudes. Those with c above 1 never open: their force is that of c = 1 shifted by
    c - 1, so that their part is known; the others are stepped through two periods from the widest gap.
    """
    b, v = np.broadcast_arrays(np.asarray(beta, float), np.asarray(speed, float))
    edges = -1 + 2 * (np.arange(_ELEMENTS) + 0.5) / _ELEMENTS
    c = np.append(edges, 1.0)
    tau, total = np.zeros((b.size, c.size)), np.zeros((b.size, c.size))
    step = v.ravel()[:, None] * 2 * np.pi / _STEPS
    cosines = np.cos(2 * np.pi * (np.arange(_STEPS) + 0.5) / _STEPS)
    for period in range(2):
        for cosine in cosines:
            tau = np.minimum(tau + step, np.maximum(c - cosine, 0.0))
            if period:
                total += tau
    mean = total / _STEPS
    flat = b.ravel()
    opening = np.sum(np.exp(-flat[:, None] * (c[:-1] + 1)) * mean[:, :-1], axis=1) * 2 / _ELEMENTS
    closed = np.exp(-2 * flat) * (mean[:, -1] / flat + 1 / flat**2)
    ratio = flat**2 / i0e(flat) * (opening + closed)
    return np.where(v.ravel() >= 1, 1.0, np.minimum(ratio, 1.0)).reshape(b.shape)


def true_ratios(
    rng: np.random.Generator, mean: Floats, effect: Floats, logs: Floats, *, sigma: float, length: float
) -> Floats:
    """Ratios about those of the model, with a discrepancy that is correlated over logarithms of the settings."""
    distances = np.sum((logs[:, :, None] - logs[:, None, :]) ** 2, axis=0)
    near = np.exp(-0.5 * distances / np.exp(2 * length)) + 1e-9 * np.eye(mean.size)
    factor = np.linalg.cholesky(near)
    for _ in range(_TRIES):
        scale = np.exp(sigma) * np.sqrt(_DEGREES / rng.chisquare(_DEGREES))
        side = scale * np.clip((1 - mean) / 0.2, 0.25, 1.0) * effect
        truth = mean + side * (factor @ rng.standard_normal(mean.size))
        if np.all((truth >= 0) & (truth <= 1)):
            return np.asarray(truth)
    return mean


def synthetic_rig(
    rng: np.random.Generator, hyperparameters: Floats, *, runs: int, with_discrepancy: bool = True, noise: float = 0.05
) -> SyntheticRig:
    """Rig drawn from one row of learned hyperparameters, with one setting more than runs."""
    mu, kappa, tau, tau_l, sigma, length = hyperparameters
    middle_a = 1e-6 * np.exp(rng.uniform(np.log(0.8), np.log(4)))
    middle_v = np.exp(rng.uniform(np.log(0.02), np.log(0.2)))
    shifts = rng.uniform(-np.log(2), np.log(2), (2, runs + 1))
    a, v, f = middle_a * np.exp(shifts[0]), middle_v * np.exp(shifts[1]), rng.uniform(16e3, 22e3)
    memory = np.exp(mu + np.exp(tau) * rng.standard_normal())
    decay = _REFERENCE * np.exp(kappa + np.exp(tau_l) * rng.standard_normal())
    true_a = a * np.exp(_AMPLITUDE_ERROR * rng.standard_normal())
    slow = v * decay / (2 * np.pi * f * true_a * memory)
    mean = stepped_stick_slip_ratio(true_a / decay, slow)
    effect = np.minimum(true_a / (0.2 * decay), 1.0) / (1 + slow**2) * float(with_discrepancy)
    truth = true_ratios(rng, mean, effect, np.log(np.stack([a, v])), sigma=sigma, length=length)
    return SyntheticRig(
        vibration_amplitude=a,
        sliding_speed=v,
        frequency=f,
        truth=truth,
        measured=truth + noise * rng.standard_normal(a.size),
        noise=noise,
    )
