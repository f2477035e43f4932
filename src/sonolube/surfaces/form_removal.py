"""Form of a surface and its removal: planes and polynomials through what counts as reference."""

from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.surfaces.height_map import HeightMap

Mask = NDArray[np.bool_]

_HIGHEST_DEGREE = 12
_SAMPLE = 4096  # pixels among which the majority is sought
_TRIALS = 3000  # small fits through few pixels, shared by the terms
_BEST = 5  # of the trials, which are followed up
_CONCENTRATIONS = 20
_MOST_ROUNDS = 50
_BISQUARE_REACH = 4.685  # in standard deviations: 95 % efficient for Gaussian heights
_DEVIATION_OVER_MEDIAN = 1.4826  # of Gaussian deviations
_SETTLED = 1e-4  # change of the form, over the scale of what remains
_FLAT = 1e-9  # of the range of heights: what remains is no smaller


def fit_form(
    height_map: HeightMap, *, degree: int = 1, robust: bool = False, reference: Mask | None = None
) -> HeightMap:
    """Fit a polynomial to the heights by least squares.

    Parameters
    ----------
    height_map : HeightMap
        The surface; missing pixels do not count.
    degree : int
        Highest total power of x and y: 0 the mean, 1 a plane, 2 with cylinder and sphere; 12 at the most.
    robust : bool
        Whether pixels far from the form lose their weight, so that a groove does not tilt it.
    reference : bool array, shape of the heights, optional
        Pixels that count as reference; all measured ones where it is not given.

    Returns
    -------
    HeightMap
        The form, at missing pixels too; subtract it, or let `remove_form` do so.

    Raises
    ------
    InvalidInput
        If the degree is out of range, or the reference has too few pixels or ones too badly placed to decide it.

    Notes
    -----
    The robust fit weighs each pixel by Tukey's bisquare of its distance from the form, at 4.685 standard deviations
    as estimated from the median, again until the form rests. It starts from the least trimmed squares of a sample of
    pixels, always the same, and so holds while the reference is the clear majority: a groove may cover 40 % of the
    map. Where it covers more, or the degree is above 4, say what is reference. Products of Legendre polynomials on the
    box around the reference keep high degrees well conditioned; beyond that box a high degree runs away.

    References
    ----------
    .. [1] P. J. Huber and E. M. Ronchetti, Robust Statistics, 2nd ed. (Wiley, 2009). doi:10.1002/9780470434697
    .. [2] P. J. Rousseeuw and K. Van Driessen, Data Min. Knowl. Discov. 12, 29 (2006). doi:10.1007/s10618-005-0024-4
    .. [3] ISO 25178-3:2012, 4.2 (F-operation).
    """
    counted = _counted(height_map, reference)
    basis = _basis(counted, degree)
    z = np.where(counted, height_map.height, 0.0)
    middle = float(np.mean(z[counted]))
    z = np.where(counted, z - middle, 0.0)
    weights = counted.astype(np.float64)
    coefficients = _fit(basis, z, weights)
    if robust:
        coefficients = _robust_fit(basis, z, counted, coefficients)
    return height_map.with_height(_values(basis, coefficients) + middle)


def remove_form(
    height_map: HeightMap, *, degree: int = 1, robust: bool = False, reference: Mask | None = None
) -> HeightMap:
    """Take the form off the heights, which then lie about zero.

    Parameters
    ----------
    height_map : HeightMap
        The surface; missing pixels stay missing.
    degree : int
        Highest total power of x and y in the form: 1 for tilt, 2 for curvature as well.
    robust : bool
        Whether pixels far from the form lose their weight, so that a groove does not tilt it.
    reference : bool array, shape of the heights, optional
        Pixels that count as reference; all measured ones where it is not given.

    Returns
    -------
    HeightMap
        The heights less their `fit_form`.

    Raises
    ------
    InvalidInput
        As `fit_form`.

    Notes
    -----
    Heights are subtracted, the surface is not turned: right to a part in a thousand for tilts to 2.5 degrees.
    """
    removed = fit_form(height_map, degree=degree, robust=robust, reference=reference)
    return height_map.with_height(height_map.height - removed.height)


class _Basis(NamedTuple):
    """Products of Legendre polynomials, of total power up to the degree."""

    along_x: Floats  # (columns, powers)
    along_y: Floats  # (rows, powers)
    power_x: NDArray[np.intp]  # (terms,)
    power_y: NDArray[np.intp]


def _counted(height_map: HeightMap, reference: Mask | None) -> Mask:
    if reference is None:
        return height_map.measured
    mask = np.asarray(reference)
    if mask.dtype != np.bool_ or mask.shape != height_map.height.shape:
        raise InvalidInput(
            f"reference must be true or false for each of {height_map.height.shape} pixels,"
            f" got shape {mask.shape} of {mask.dtype}"
        )
    return mask & height_map.measured


def _basis(counted: Mask, degree: int) -> _Basis:
    if not 0 <= degree <= _HIGHEST_DEGREE:
        raise InvalidInput(f"degree must lie between 0 and {_HIGHEST_DEGREE}, got {degree!r}")
    rows, columns = np.flatnonzero(counted.any(axis=1)), np.flatnonzero(counted.any(axis=0))
    if not rows.size:
        raise InvalidInput("reference holds no measured pixel")
    power_x, power_y = np.indices((min(degree + 1, columns.size), min(degree + 1, rows.size)))  # one row: no y
    kept = power_x + power_y <= degree
    return _Basis(
        along_x=_legendre(counted.shape[1], columns, int(power_x.max())),
        along_y=_legendre(counted.shape[0], rows, int(power_y.max())),
        power_x=power_x[kept],
        power_y=power_y[kept],
    )


def _legendre(count: int, used: NDArray[np.intp], power: int) -> Floats:
    half = max(float(used[-1] - used[0]) / 2, 0.5)
    return np.asarray(legendre.legvander((np.arange(count) - (used[0] + used[-1]) / 2) / half, power))


def _fit(basis: _Basis, z: Floats, weights: Floats) -> Floats:
    """Return the coefficients of weighted least squares: normal equations, refined once to restore their digits."""
    i, j = basis.power_x, basis.power_y
    terms = i.size
    pairs_x = (basis.along_x[:, :, None] * basis.along_x[:, None, :]).reshape(basis.along_x.shape[0], -1)
    pairs_y = (basis.along_y[:, :, None] * basis.along_y[:, None, :]).reshape(basis.along_y.shape[0], -1)
    sums = (pairs_y.T @ (weights @ pairs_x)).reshape(
        basis.along_y.shape[1], basis.along_y.shape[1], basis.along_x.shape[1], basis.along_x.shape[1]
    )
    gram = sums[j[:, None], j[None, :], i[:, None], i[None, :]]
    values, vectors = np.linalg.eigh(gram)
    if values[0] <= 1e-12 * max(values[-1], np.finfo(float).tiny):
        raise InvalidInput(f"reference leaves some of the {terms} coefficients of the form undecided; lower the degree")
    coefficients = np.zeros(terms)
    for _ in range(2):
        remaining = weights * (z - _values(basis, coefficients)) if coefficients.any() else weights * z
        moments = (basis.along_y.T @ (remaining @ basis.along_x))[j, i]
        coefficients = coefficients + vectors @ ((vectors.T @ moments) / values)
    return coefficients


def _majority_fit(basis: _Basis, z: Floats, counted: Mask, coefficients: Floats) -> Floats:
    """Return the coefficients of least trimmed squares: those that the closer half of a sample of pixels agrees on."""
    rng = np.random.default_rng(0)
    pixels = np.flatnonzero(counted)
    pixels = rng.choice(pixels, min(_SAMPLE, pixels.size), replace=False)
    row, column = np.divmod(pixels, counted.shape[1])
    design = basis.along_x[column][:, basis.power_x] * basis.along_y[row][:, basis.power_y]
    height = z.flat[pixels]
    terms = coefficients.size
    half = min((pixels.size + terms + 1) // 2, pixels.size)

    def closer_half(candidate: Floats) -> NDArray[np.intp]:
        return np.argpartition(np.abs(height - design @ candidate), half - 1)[:half]

    def trimmed(candidate: Floats) -> float:
        return float(np.sum((height - design @ candidate)[closer_half(candidate)] ** 2))

    few = rng.integers(pixels.size, size=(_TRIALS // terms, terms))
    trials = (np.linalg.pinv(design[few]) @ height[few][..., None])[..., 0]
    candidates = sorted([coefficients, *trials], key=trimmed)[:_BEST]
    for index, candidate in enumerate(candidates):
        for _ in range(_CONCENTRATIONS):
            kept = closer_half(candidate)
            candidate = np.linalg.lstsq(design[kept], height[kept])[0]
        candidates[index] = candidate
    return min(candidates, key=trimmed)


def _robust_fit(basis: _Basis, z: Floats, counted: Mask, coefficients: Floats) -> Floats:
    floor = _FLAT * float(np.ptp(z[counted])) or np.finfo(float).tiny
    coefficients = _majority_fit(basis, z, counted, coefficients)
    current = _values(basis, coefficients)
    for _ in range(_MOST_ROUNDS):
        distance = np.abs(z - current)
        scale = max(_DEVIATION_OVER_MEDIAN * float(np.median(distance[counted])), floor)
        weights = counted * np.maximum(0.0, 1 - (distance / (_BISQUARE_REACH * scale)) ** 2) ** 2
        coefficients = _fit(basis, z, weights)
        previous, current = current, _values(basis, coefficients)
        if np.max(np.abs(current - previous)) <= _SETTLED * scale:
            break
    return coefficients


def _values(basis: _Basis, coefficients: Floats) -> Floats:
    table = np.zeros((basis.along_y.shape[1], basis.along_x.shape[1]))
    table[basis.power_y, basis.power_x] = coefficients
    return basis.along_y @ table @ basis.along_x.T
