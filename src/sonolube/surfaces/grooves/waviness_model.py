"""WavinessModel that may pass below a groove, and how likely they are."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.surfaces.grooves.plane_coordinates import monomials


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class WavinessModel:
    """A plane and waves.

    Parameters
    ----------
    form : ndarray, shape (3,) or (6,)
        Height in the middle of the field in m, and what x/l, y/l and perhaps x^2/l^2, x y/l^2, y^2/l^2 add, with l half
        the longer side of the field.
    half_side : float
        That half, in m.
    modes : ndarray, shape (n, 2)
        Waves per metre along x and y.
    cosine, sine : ndarray, shape (n,)
        Amplitudes in m, the phase counted from the middle of the field.
    section : ndarray, shape (functions,)
        What the section takes of the worn blocks (`WornBlocks.section`).
    covariance : ndarray, shape (p, p)
        Of form, cosines and sines, and where they were fitted, of all components of the modes along x, then along y.
    noise : tuple of float
        Variance of the means of unworn and of worn blocks about it, in m2; of worn ones also what varies in the groove.
    cost : float
        Minus twice the logarithm of the evidence; the smaller, the better the model.
    random : bool
        Whether they stand for a random field.
    """

    form: Floats
    half_side: float
    modes: Floats
    cosine: Floats
    sine: Floats
    section: Floats
    covariance: Floats
    noise: tuple[float, ...]
    cost: float
    random: bool

    def form_alone(self, x: Floats, y: Floats) -> Floats:
        """Return the form's heights in m at columns x and rows y, of shapes (1, columns) and (rows, 1) and in m."""
        terms = monomials(x / self.half_side, y / self.half_side, self.form.size)
        return np.asarray(sum(share * power for share, power in zip(self.form, terms, strict=True)))

    def heights(self, x: Floats, y: Floats) -> Floats:
        """Return the heights in m at columns x and rows y, of shapes (1, columns) and (rows, 1) and in m."""
        along_x, along_y = self._turning(x.ravel(), y.ravel())
        waves = (along_y * (self.cosine - 1j * self.sine)) @ along_x.T
        return np.asarray(self.form_alone(x, y) + waves.real)

    def sums(self, x: Floats, y: Floats, region: NDArray[np.bool_]) -> Floats:
        """Return the change of the sum of heights over a region with each of the fitted numbers, shape (p,)."""
        terms = monomials(x / self.half_side, y / self.half_side, self.form.size)
        form = [float(np.sum(np.broadcast_to(power, region.shape)[region])) for power in terms]
        x, y = x.ravel(), y.ravel()
        along_x, along_y = self._turning(x, y)
        in_rows = region.astype(np.float64) @ along_x  # (rows, n)
        waves = np.sum(along_y * in_rows, axis=0)
        sums = [np.array(form), waves.real, waves.imag]
        if not self.random:  # d/dk of c cos + s sin = 2 pi x (-c sin + s cos)
            amplitude = 2 * math.pi * (self.sine + 1j * self.cosine)
            by_x = np.sum(along_y * (region @ (x[:, None] * along_x)), axis=0)
            by_y = np.sum(y[:, None] * along_y * in_rows, axis=0)
            sums += [(amplitude * by_x).real, (amplitude * by_y).real]
        return np.concatenate(sums)

    def _turning(self, x: Floats, y: Floats) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
        turn = 2j * math.pi
        return np.exp(turn * np.outer(x, self.modes[:, 0])), np.exp(turn * np.outer(y, self.modes[:, 1]))


def model_probabilities(models: list[WavinessModel]) -> Floats:
    """Return the probability of each model after its evidence, shape (models,)."""
    cost = np.array([model.cost for model in models])
    weight = np.exp((cost.min() - cost) / 2)
    return np.asarray(weight / weight.sum())
