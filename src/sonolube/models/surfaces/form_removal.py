"""F-operation of ISO 25178-3, fit and removal of polynomial form, and dominant wavelengths of the waviness."""

from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.models.surfaces.height_map import HeightMap, Mask
from sonolube.models.surfaces.spectrum import ProfileDirection, profiles

_HIGHEST_DEGREE = 12
_SAMPLE = 4096  # pixels of the least-trimmed-squares fit
_TRIALS = 3000  # elemental fits, divided by the number of terms
_REFINED_TRIALS = 5  # best of the trials, which are refined
_CONCENTRATION_STEPS = 20
_MAX_ITERATIONS = 50
_BISQUARE_REACH = 4.685  # in standard deviations: 95 % efficiency for Gaussian heights
_CONVERGED = 1e-4  # largest change of the form over the scale of the residuals
_MIN_SCALE = 1e-9  # of the residuals, over the range of heights


def fit_form(surface: HeightMap, *, degree: int = 1, robust: bool = False, reference: Mask | None = None) -> HeightMap:
    r"""Form of a height map as a polynomial, by least squares or robust regression.

    Parameters
    ----------
    surface : HeightMap
        Missing pixels are left out.
    degree : int
        Largest total power of x and y: 0 the mean, 1 a plane, 2 also cylinder and sphere; 12 at most.
    robust : bool
        Whether pixels far from the form lose weight, so that a groove does not tilt it.
    reference : bool array, shape of the heights, optional
        Pixels to fit to; all measured ones by default.

    Returns
    -------
    HeightMap
        The form, also at missing pixels.

    Raises
    ------
    InvalidInput
        If the degree is out of range, or the reference pixels are too few or too unevenly placed to determine the form.

    See Also
    --------
    remove_form : Heights less their form.

    Notes
    -----
    .. math:: F(x, y) = \sum_{i + j \le n} c_{ij} P_i(x') P_j(y')

    with Legendre polynomials :math:`P` on the box around the reference pixels, which keep high degrees well
    conditioned; outside that box high degrees diverge. The robust fit is an iteratively reweighted least-squares fit
    with Tukey's bisquare at 4.685 standard deviations, estimated from the median absolute residual [1]_. It starts from
    the least trimmed squares [2]_ of a fixed sample of pixels and is valid while the reference is the clear majority: a
    groove may cover 40 % of the map. Where it covers more, or the degree is above 4, give the reference pixels.

    References
    ----------
    .. [1] P. J. Huber and E. M. Ronchetti, Robust Statistics, 2nd ed. (Wiley, 2009). doi:10.1002/9780470434697
    .. [2] P. J. Rousseeuw and K. Van Driessen, Data Min. Knowl. Discov. 12, 29 (2006). doi:10.1007/s10618-005-0024-4
    .. [3] ISO 25178-3:2012, 4.2 (F-operation).
    """
    counted = _reference_pixels(surface, reference)
    basis = _basis(counted, degree)
    z = np.where(counted, surface.height, 0.0)
    mean = float(np.mean(z[counted]))
    z = np.where(counted, z - mean, 0.0)
    weights = counted.astype(np.float64)
    coefficients = _fit(basis, z, weights)
    if robust:
        coefficients = _robust_fit(basis, z, counted, coefficients)
    return surface.with_height(_values(basis, coefficients) + mean)


def remove_form(
    surface: HeightMap, *, degree: int = 1, robust: bool = False, reference: Mask | None = None
) -> HeightMap:
    """Height map with its polynomial form removed (F-operation of ISO 25178-3).

    Parameters
    ----------
    surface : HeightMap
        Missing pixels stay missing.
    degree : int
        Largest total power of x and y in the form: 1 for tilt, 2 also for curvature.
    robust : bool
        Whether pixels far from the form lose weight, so that a groove does not tilt it.
    reference : bool array, shape of the heights, optional
        Pixels to fit to; all measured ones by default.

    Returns
    -------
    HeightMap
        Heights less the form of `fit_form`.

    Raises
    ------
    InvalidInput
        As `fit_form`.

    Notes
    -----
    Heights are subtracted and the surface is not rotated: accurate to 0.1 % for tilts up to 2.5 degrees.

    Examples
    --------
    >>> import numpy as np
    >>> from sonolube.models.surfaces import HeightMap, remove_form
    >>> plane = 1e-6 * np.add.outer(np.arange(5.0), np.arange(4.0))
    >>> level = remove_form(HeightMap(height=plane, spacing_x=1e-6, spacing_y=1e-6))
    >>> bool(abs(level.height).max() < 1e-15)
    True
    """
    form = fit_form(surface, degree=degree, robust=robust, reference=reference)
    return surface.with_height(surface.height - form.height)


def robust_deviation(deviations: Floats) -> float:
    """Standard deviation of Gaussian values, estimated from the median of their absolute deviations."""
    return 1.4826 * float(np.median(np.abs(deviations)))


class _Basis(NamedTuple):
    """Products of Legendre polynomials of total power up to the degree."""

    along_x: Floats  # (columns, powers)
    along_y: Floats  # (rows, powers)
    power_x: NDArray[np.intp]  # (terms,)
    power_y: NDArray[np.intp]


def _reference_pixels(surface: HeightMap, reference: Mask | None) -> Mask:
    """Measured pixels of a checked reference, all measured ones without it."""
    if reference is None:
        return surface.measured
    mask = np.asarray(reference)
    if mask.dtype != np.bool_ or mask.shape != surface.height.shape:
        raise InvalidInput(
            f"reference must be true or false for each of {surface.height.shape} pixels,"
            f" got shape {mask.shape} of {mask.dtype}"
        )
    return mask & surface.measured


def _basis(counted: Mask, degree: int) -> _Basis:
    """Basis on the box around the reference pixels."""
    if not 0 <= degree <= _HIGHEST_DEGREE:
        raise InvalidInput(f"degree must lie between 0 and {_HIGHEST_DEGREE}, got {degree!r}")
    rows, columns = np.flatnonzero(counted.any(axis=1)), np.flatnonzero(counted.any(axis=0))
    if not rows.size:
        raise InvalidInput("reference has no measured pixel")
    power_x, power_y = np.indices((min(degree + 1, columns.size), min(degree + 1, rows.size)))  # one row: no y
    kept = power_x + power_y <= degree
    return _Basis(
        along_x=_legendre(counted.shape[1], columns, int(power_x.max())),
        along_y=_legendre(counted.shape[0], rows, int(power_y.max())),
        power_x=power_x[kept],
        power_y=power_y[kept],
    )


def _legendre(count: int, used: NDArray[np.intp], power: int) -> Floats:
    """Legendre polynomials at each of `count` rows or columns, on the interval of the used ones."""
    half = max(float(used[-1] - used[0]) / 2, 0.5)
    return np.asarray(legendre.legvander((np.arange(count) - (used[0] + used[-1]) / 2) / half, power))


def _fit(basis: _Basis, z: Floats, weights: Floats) -> Floats:
    """Coefficients of weighted least squares by the normal equations with one step of iterative refinement."""
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
        raise InvalidInput(f"reference does not determine all {terms} coefficients of the form; lower the degree")
    coefficients = np.zeros(terms)
    for _ in range(2):
        remaining = weights * (z - _values(basis, coefficients)) if coefficients.any() else weights * z
        moments = (basis.along_y.T @ (remaining @ basis.along_x))[j, i]
        coefficients = coefficients + vectors @ ((vectors.T @ moments) / values)
    return coefficients


def _least_trimmed_squares(basis: _Basis, z: Floats, counted: Mask, coefficients: Floats) -> Floats:
    """Coefficients of least trimmed squares of a sample of pixels, by elemental fits and concentration steps [2]."""
    rng = np.random.default_rng(0)
    pixels = np.flatnonzero(counted)
    pixels = rng.choice(pixels, min(_SAMPLE, pixels.size), replace=False)
    row, column = np.divmod(pixels, counted.shape[1])
    design = basis.along_x[column][:, basis.power_x] * basis.along_y[row][:, basis.power_y]
    height = z.flat[pixels]
    terms = coefficients.size
    half = min((pixels.size + terms + 1) // 2, pixels.size)

    def half_of_least_residual(candidate: Floats) -> NDArray[np.intp]:
        return np.argpartition(np.abs(height - design @ candidate), half - 1)[:half]

    def trimmed_squares(candidate: Floats) -> float:
        return float(np.sum((height - design @ candidate)[half_of_least_residual(candidate)] ** 2))

    elements = rng.integers(pixels.size, size=(_TRIALS // terms, terms))
    trials = (np.linalg.pinv(design[elements]) @ height[elements][..., None])[..., 0]
    candidates = sorted([coefficients, *trials], key=trimmed_squares)[:_REFINED_TRIALS]
    for index, candidate in enumerate(candidates):
        for _ in range(_CONCENTRATION_STEPS):
            kept = half_of_least_residual(candidate)
            candidate = np.linalg.lstsq(design[kept], height[kept])[0]
        candidates[index] = candidate
    return min(candidates, key=trimmed_squares)


def _robust_fit(basis: _Basis, z: Floats, counted: Mask, coefficients: Floats) -> Floats:
    """Coefficients by iteratively reweighted least squares with Tukey's bisquare, from least trimmed squares."""
    floor = _MIN_SCALE * float(np.ptp(z[counted])) or np.finfo(float).tiny
    coefficients = _least_trimmed_squares(basis, z, counted, coefficients)
    current = _values(basis, coefficients)
    for _ in range(_MAX_ITERATIONS):
        residual = np.abs(z - current)
        scale = max(robust_deviation(residual[counted]), floor)
        weights = counted * np.maximum(0.0, 1 - (residual / (_BISQUARE_REACH * scale)) ** 2) ** 2
        coefficients = _fit(basis, z, weights)
        previous, current = current, _values(basis, coefficients)
        if np.max(np.abs(current - previous)) <= _CONVERGED * scale:
            break
    return coefficients


def _values(basis: _Basis, coefficients: Floats) -> Floats:
    """Polynomial at every pixel."""
    table = np.zeros((basis.along_y.shape[1], basis.along_x.shape[1]))
    table[basis.power_y, basis.power_x] = coefficients
    return basis.along_y @ table @ basis.along_x.T


_PADDING = 8  # zero padding, so that a parabola locates the peak of the spectrum
_MIN_WAVES = 1.5  # in the map: longer waves are not distinguishable from form


def dominant_wavelengths(surface: HeightMap, *, along: ProfileDirection = "rows", most: int = 3) -> Floats:
    """Dominant wavelengths of the waviness in one direction, the strongest first. [m]

    Parameters
    ----------
    surface : HeightMap
        Its tilt is removed here, and missing pixels are set to zero. For several scales of waviness, as on coated
        steel, evaluate the low pass and the high pass as well.
    along : {"rows", "columns"}
        Direction of the profiles: along rows, the x-direction, or along columns, y.
    most : int
        Largest number of wavelengths to return.

    Returns
    -------
    ndarray, shape (found,)
        Wavelengths at the peaks of the mean power spectrum of all profiles with a Hann window; empty where the spectrum
        has no peak between 1.5 waves in the map and four pixels per wave.

    Raises
    ------
    InvalidInput
        If the map has fewer than 16 pixels in that direction.

    Notes
    -----
    In a map of length L a wavelength l is found to 5 % of l**2/L where the map contains four waves or more, and to a
    third of it where it contains two. Two wavelengths are resolved if they differ by about 2 l**2/L.

    References
    ----------
    .. [1] D 4.1.3, where Fourier transforms of the heights give 0.18 mm in both directions for a powder coating and
       1.25 mm and 0.95 mm for its coarser level.
    """
    levelled, spacing = profiles(remove_form(surface), along=along)
    z, points = np.nan_to_num(levelled), levelled.shape[1]
    if points < 16:
        raise InvalidInput(f"waviness requires at least 16 pixels along {along}, got {points}")
    spectrum = np.fft.rfft(z * np.hanning(points + 1)[:-1], _PADDING * points, axis=1)
    power = np.mean(np.abs(spectrum) ** 2, axis=0)
    inner = power[1:-1]
    waves = np.arange(1, power.size - 1) / _PADDING  # in the map
    peak = (inner > power[:-2]) & (inner >= power[2:]) & (waves >= _MIN_WAVES) & (waves <= points / 4)
    peak &= inner > 1e-3 * np.max(inner, initial=0.0)  # side lobes of the window are below
    found = 1 + np.flatnonzero(peak)
    left, middle, right = np.log(power[found - 1]), np.log(power[found]), np.log(power[found + 1])
    shift = (left - right) / (2 * (left - 2 * middle + right))
    strongest = np.argsort(-middle)[:most]
    return np.asarray(points * spacing * _PADDING / (found + shift)[strongest])
