"""Waviness model of the unworn surface: polynomial form and plane waves, with covariance and Bayesian evidence."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats

_POWERS_X, _POWERS_Y = [0, 1, 0, 2, 1, 0], [0, 0, 1, 0, 1, 2]  # of the terms of the form


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class WavinessModel:
    r"""Polynomial form and a sum of plane waves.

    Parameters
    ----------
    form : ndarray, shape (3,) or (6,)
        Coefficients in m of 1, x/l, y/l and, with six, x^2/l^2, x y/l^2, y^2/l^2, with l half the longer side of the
        field.
    half_side : float
        Half the longer side of the field, l, in m.
    modes : ndarray, shape (n, 2)
        Wavenumbers along x and y, in waves per metre.
    cosine, sine : ndarray, shape (n,)
        Amplitudes in m, with phase zero at the centre of the field.
    section : ndarray, shape (functions,)
        Coefficients of the basis functions `BlockAverages.section`.
    response : ndarray, shape (p, blocks)
        Derivatives with respect to the blocks' heights of form, cosines and sines and, where wavenumbers were fitted,
        of their components along x, then y.
    section_response : ndarray, shape (functions, blocks)
        Derivatives of the coefficients of the section with respect to the blocks' heights.
    noise : tuple of float
        Variances in m2 of the means of unworn and of worn blocks about the model.
    cost : float
        Minus twice the logarithm of the evidence, up to a constant; the smaller, the more probable the model.
    random : bool
        Whether the waves are the posterior mean of a random field rather than a few fitted waves.

    Notes
    -----
    .. math:: z(x, y) = \sum_j f_j\, p_j(x/l, y/l)
        + \sum_i \left[c_i \cos 2\pi (k_{x,i} x + k_{y,i} y) + s_i \sin 2\pi (k_{x,i} x + k_{y,i} y)\right]
    """

    form: Floats
    half_side: float
    modes: Floats
    cosine: Floats
    sine: Floats
    section: Floats
    response: Floats
    section_response: Floats
    noise: tuple[float, ...]
    cost: float
    random: bool

    def form_alone(self, x: Floats, y: Floats) -> Floats:
        """Heights of the form in m at positions x, shape (1, columns), and y, shape (rows, 1), in m."""
        along_x, along_y = self._powers(x.ravel(), y.ravel())
        table = np.zeros((3, 3))
        table[_POWERS_Y[: self.form.size], _POWERS_X[: self.form.size]] = self.form
        return np.asarray(along_y @ table @ along_x.T)

    def heights(self, x: Floats, y: Floats) -> Floats:
        """Heights of form and waves in m at positions x, shape (1, columns), and y, shape (rows, 1), in m."""
        along_x, along_y = self._complex_waves(x.ravel(), y.ravel())
        waves = (along_y * (self.cosine - 1j * self.sine)) @ along_x.T
        return np.asarray(self.form_alone(x, y) + waves.real)

    def height_sum(self, x: Floats, y: Floats, weights: Floats) -> float:
        """Weighted sum of the heights in m."""
        linear = np.concatenate([self.form, self.cosine, self.sine])
        return float(self.height_sum_gradient(x, y, weights)[: linear.size] @ linear)

    def height_sum_gradient(self, x: Floats, y: Floats, weights: Floats) -> Floats:
        """Gradient of a weighted sum of the heights with respect to the fitted parameters, shape (p,)."""
        x, y = x.ravel(), y.ravel()
        powers_x, powers_y = self._powers(x, y)
        moments = powers_y.T @ weights @ powers_x
        form = moments[_POWERS_Y[: self.form.size], _POWERS_X[: self.form.size]]
        along_x, along_y = self._complex_waves(x, y)
        in_rows = weights @ along_x  # (rows, n)
        waves = np.sum(along_y * in_rows, axis=0)
        sums = [form, waves.real, waves.imag]
        if not self.random:  # d/dk of c cos + s sin = 2 pi x (-c sin + s cos)
            amplitude = 2 * math.pi * (self.sine + 1j * self.cosine)
            by_x = np.sum(along_y * (weights @ (x[:, None] * along_x)), axis=0)
            by_y = np.sum(y[:, None] * along_y * in_rows, axis=0)
            sums += [(amplitude * by_x).real, (amplitude * by_y).real]
        return np.concatenate(sums)

    def _powers(self, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Powers 0 to 2 of x/l and of y/l, whose products are the terms of the form."""
        return np.vander(x / self.half_side, 3, increasing=True), np.vander(y / self.half_side, 3, increasing=True)

    def _complex_waves(self, x: Floats, y: Floats) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
        """Factors exp(2 pi i k_x x) and exp(2 pi i k_y y), whose products are the waves."""
        factor = 2j * math.pi
        return np.exp(factor * np.outer(x, self.modes[:, 0])), np.exp(factor * np.outer(y, self.modes[:, 1]))


def model_probabilities(models: list[WavinessModel]) -> Floats:
    """Posterior probabilities of models of equal prior probability, from their evidence, shape (models,)."""
    cost = np.array([model.cost for model in models])
    weight = np.exp((cost.min() - cost) / 2)
    return np.asarray(weight / weight.sum())
