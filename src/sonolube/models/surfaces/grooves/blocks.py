"""Waviness models of an unworn surface, and the block averages of a worn scan to which they are fitted.

A model is a polynomial form and plane waves, with covariance and Bayesian evidence; worn blocks are averaged less the
mean cross-section.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.models.surfaces.form_removal import robust_deviation
from sonolube.models.surfaces.grooves.track import GrooveTrack, block_edges, block_means, centred_coordinates, monomials
from sonolube.models.surfaces.height_map import HeightMap, Mask

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
    cost : float
        Minus twice the logarithm of the evidence, up to a constant; the smaller, the more probable the model.
    noise : tuple of float
        Variances in m2 of the means of unworn and of worn blocks about the model.
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
    cost: float
    noise: tuple[float, ...] = ()
    random: bool = False

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


SHORTEST_RELATIVE_WAVELENGTH = 1 / 6
"""Shortest wavelength of the reference, over the longer side of the field."""

HEIGHT_RESOLUTION = 1e-12
"""Height below the resolution of any instrument, in m."""

_PERIOD = 1.5  # of the Fourier modes over the field, so that a wave of any length is near one
_BLOCKS = 48  # along the longer side
_KNOT = 50e-6 / 2.4e-3  # distance of the knots of the section, over the longer side
_SLOPE_WINDOW = 7  # pixels
_MIN_UNWORN = 12  # blocks
_MODULATIONS, _MAX_MODULATIONS = 12, 8.0  # harmonics of the groove's depth along it; most waves in the longer side
_OUTLIER = 5.0  # deviation of a worn block from the mean section, over the standard deviation: debris or torn-out chips


@dataclass(frozen=True, kw_only=True, eq=False)
class BlockAverages:
    """Means of a scan over square blocks, unworn blocks first.

    Parameters
    ----------
    x, y : ndarray, shape (n,)
        Centres of the blocks from the centre of the field, in m.
    mean_height : ndarray, shape (n,)
        Mean height in m; of worn blocks less the mean cross-section of the groove.
    weight : ndarray, shape (n,)
        Number of measured pixels over that of a full block.
    mean_section : ndarray, shape (n,)
        Subtracted mean cross-section, in m.
    section : ndarray, shape (n, functions)
        Basis functions of what the subtraction leaves in worn blocks: a correction of the section, linear between
        knots; modulations of its depth along the track; and last the errors for a track rotated by one radian, and for
        a change of direction over the field larger by one radian, both per longer side of the field. Zero for unworn
        blocks; no columns without worn blocks.
    unworn : int
        Number of unworn blocks.
    field : tuple of float
        Lengths of the field along x and y, in m.
    labels : int array, shape of the heights
        Number of the block that each pixel belongs to; -1 for pixels of none.
    """

    x: Floats
    y: Floats
    mean_height: Floats
    weight: Floats
    mean_section: Floats
    section: Floats
    unworn: int
    field: tuple[float, float]
    labels: NDArray[np.intp]

    @property
    def longer_side(self) -> float:
        """Longer side of the field. [m]"""
        return max(self.field)

    @property
    def parts(self) -> list[slice]:
        """Slices of the unworn blocks and, if any, of the worn ones."""
        both = slice(0, self.unworn), slice(self.unworn, self.x.size)
        return [part for part in both if part.start < part.stop]

    @property
    def deviation(self) -> float:
        """Standard deviation of the unworn blocks. [m]"""
        return max(float(np.std(self.mean_height[: self.unworn])), HEIGHT_RESOLUTION)

    def per_part(self, values: Sequence[float] | Floats) -> Floats:
        """A value of the unworn and one of the worn blocks, for each block."""
        return np.repeat(values, [part.stop - part.start for part in self.parts])

    def pixel_weights(self, weights: Floats) -> Floats:
        """Weights of the pixels in a sum of block means with given weights, shape of the heights."""
        count = np.bincount(self.labels[self.labels >= 0], minlength=self.x.size)
        return np.where(self.labels >= 0, (weights / np.maximum(count, 1))[self.labels], 0.0)

    def modes(self) -> Floats:
        """Wavenumbers of the Fourier modes of a box around the field, one of each pair k, -k, in 1/m, shape (n, 2)."""
        along_x, along_y, of_x, of_y = self._mode_components()
        return np.stack([along_x[of_x], along_y[of_y]], axis=1)

    @cached_property
    def fourier_waves(self) -> tuple[Floats, Floats]:
        """Cosine and sine of each of `modes` at the centre of each block, both of shape (blocks, modes)."""
        along_x, along_y, of_x, of_y = self._mode_components()
        cos_x, sin_x = self.waves(np.stack([along_x, 0 * along_x], axis=1))
        cos_y, sin_y = self.waves(np.stack([0 * along_y, along_y], axis=1))
        cos_x, sin_x, cos_y, sin_y = cos_x[:, of_x], sin_x[:, of_x], cos_y[:, of_y], sin_y[:, of_y]
        return cos_x * cos_y - sin_x * sin_y, sin_x * cos_y + cos_x * sin_y

    def _mode_components(self) -> tuple[Floats, Floats, NDArray[np.intp], NDArray[np.intp]]:
        """Wavenumbers along x and along y in 1/m, and the numbers of those of each Fourier mode."""
        longer = self.longer_side
        box_x, box_y = (_PERIOD * length for length in self.field)
        reach_x, reach_y = (int(box / (SHORTEST_RELATIVE_WAVELENGTH * longer)) for box in (box_x, box_y))
        along_x, along_y = np.arange(reach_x + 1) / box_x, np.arange(-reach_y, reach_y + 1) / box_y
        of_x, of_y = (part.ravel() for part in np.meshgrid(np.arange(along_x.size), np.arange(along_y.size)))
        half = (of_x > 0) | (of_y > reach_y)
        kept = half & (np.hypot(along_x[of_x], along_y[of_y]) <= 1 / (SHORTEST_RELATIVE_WAVELENGTH * longer))
        return along_x, along_y, of_x[kept], of_y[kept]

    def waves(self, modes: Floats) -> tuple[Floats, Floats]:
        """Cosine and sine of each mode at the centre of each block, both of shape (blocks, modes)."""
        phase = 2 * math.pi * (np.outer(self.x, modes[:, 0]) + np.outer(self.y, modes[:, 1]))
        return np.cos(phase), np.sin(phase)

    def form(self, terms: int) -> Floats:
        """First monomials of position over half the longer side at each block, shape (blocks, terms)."""
        half = self.longer_side / 2
        return np.stack(monomials(self.x / half, self.y / half, terms), axis=1)

    def without_groove(self) -> "BlockAverages":
        """The blocks with the mean cross-section restored, all as unworn."""
        return replace(
            self,
            mean_height=self.mean_height + self.mean_section,
            mean_section=np.zeros_like(self.mean_section),
            section=self.section[:, :0],
            unworn=self.x.size,
        )


def block_averages(
    surface: HeightMap, *, track: GrooveTrack, worn_band: tuple[float, float], excluded: Mask | None = None
) -> BlockAverages:
    """Block averages of a scan with a groove, worn blocks less its mean cross-section."""
    longer = max(surface.sides)
    transverse, arc_length = track.curvilinear_coordinates(surface)
    counted = surface.measured if excluded is None else surface.measured & ~excluded
    inside = (transverse > worn_band[0]) & (transverse < worn_band[1])
    worn = counted & inside
    section, rotated, bent = np.zeros((3, *surface.height.shape))
    if worn.any():
        t = arc_length[worn] / longer
        means, slope = _transverse_means(transverse[worn], np.stack([surface.height[worn], t, t**2 / 2]), surface)
        section[worn] = means[0]
        rotated[worn] = -slope * (t - means[1])
        bent[worn] = -slope * (t**2 / 2 - means[2])
    x, y = centred_coordinates(surface)
    fields = (x, y, surface.height - section, section, transverse, rotated, bent, arc_length)
    edges = block_edges(surface, longer / _BLOCKS)
    unworn, groove = block_means(fields[:4], counted & ~inside, edges), block_means(fields, worn, edges)
    if unworn.shape[1] < _MIN_UNWORN:
        raise InvalidInput(f"only {unworn.shape[1]} blocks of {longer / _BLOCKS:.2g} m are unworn; scan a wider field")
    deviation = max(float(np.std(unworn[2])), robust_deviation(groove[2]) if groove.size else 0.0)
    kept = np.abs(groove[2]) < _OUTLIER * deviation
    groove = groove[:, kept]
    free = np.empty((0, 0))
    if groove.size:
        hats, modulations = _hat_functions(groove[4], _KNOT * longer), _modulations(groove[3], groove[7] / longer)
        free = np.column_stack([hats, modulations, groove[5:7].T])
    both = np.concatenate([unworn, groove[[0, 1, 2, 3, -1]]], axis=1)
    return BlockAverages(
        x=both[0],
        y=both[1],
        mean_height=both[2],
        weight=both[-1] / both[-1].max(),
        mean_section=both[3],
        section=np.concatenate([np.zeros((unworn.shape[1], free.shape[1])), free]),
        unworn=unworn.shape[1],
        field=surface.sides,
        labels=_labels((counted & ~inside, worn), kept, edges, unworn.shape[1]),
    )


def _labels(masks: tuple[Mask, Mask], kept: Mask, edges: list[NDArray[np.intp]], unworn: int) -> NDArray[np.intp]:
    """Number of the block of each pixel, of the unworn blocks and then of the worn ones that are kept."""
    rows, columns = (
        np.searchsorted(edge, np.arange(count), side="right") - 1
        for edge, count in zip(edges, masks[0].shape, strict=True)
    )
    cell = rows[:, None] * edges[1].size + columns
    labels = np.full(masks[0].shape, -1, dtype=np.intp)
    for mask, numbers in zip(masks, (np.arange(unworn), np.where(kept, unworn + np.cumsum(kept) - 1, -1)), strict=True):
        of_cell = np.full(edges[0].size * edges[1].size, -1, dtype=np.intp)
        of_cell[np.flatnonzero(np.bincount(cell[mask]))] = numbers
        labels[mask] = of_cell[cell[mask]]
    return labels


def _hat_functions(at: Floats, step: float) -> Floats:
    """Piecewise linear basis functions between knots, shape (n, knots)."""
    hats = np.maximum(0.0, 1 - np.abs(at[:, None] - np.arange(at.min(), at.max() + step, step)) / step)
    return np.asarray(hats[:, hats.sum(axis=0) > 0])


def _transverse_means(transverse: Floats, values: Floats, surface: HeightMap) -> tuple[Floats, Floats]:
    """Means of values over pixels of equal distance from the track, and the transverse slope of the first of them."""
    position = transverse / min(surface.spacing_x, surface.spacing_y)
    bins = np.floor(position - position.min()).astype(np.intp)
    count = np.bincount(bins)
    used = count > 0
    at = np.bincount(bins, position)[used] / count[used]
    means = [np.bincount(bins, value)[used] / count[used] for value in values]
    step = min(surface.spacing_x, surface.spacing_y)
    slope = np.gradient(uniform_filter1d(means[0], _SLOPE_WINDOW, mode="nearest"), at * step) if at.size > 1 else at * 0
    return np.stack([np.interp(position, at, mean) for mean in means]), np.interp(position, at, slope)


def _modulations(section: Floats, arc_length: Floats) -> Floats:
    """Section times harmonics of the arc length, normalised by the depth, shape (n, functions)."""
    phase = 2 * math.pi * np.outer(arc_length, np.arange(1, _MODULATIONS + 1) / _MODULATIONS * _MAX_MODULATIONS)
    depth = section[:, None] / max(float(np.max(np.abs(section))), np.finfo(float).tiny)
    return np.concatenate([depth * np.cos(phase), depth * np.sin(phase)], axis=1)
