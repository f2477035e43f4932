"""Width, depth and volume of a groove with 95 % intervals, from the covariance of the unworn roughness."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import toeplitz

from sonolube.checks import Floats
from sonolube.models.surfaces.grooves.roughness_covariance import Cells, coverage_factor, roughness_covariance
from sonolube.models.surfaces.grooves.section_curve import section_curve
from sonolube.models.surfaces.grooves.track import GrooveExtent, MeanCrossSection
from sonolube.models.surfaces.grooves.unworn_reference import UnwornReference
from sonolube.models.surfaces.height_map import HeightMap, Mask

__all__: list[str] = []  # used in this room only

_MIN_SCALE, _LARGEST_SCALE = 0.1, 4.0  # of the floor's roughness over that of the surface
_MIN_EIGENVALUE = 1e-3  # of a covariance over the mean of them
_MIN_PIXELS = 0.15  # of a bin, over those of the fullest, to count in the section


class Estimate(NamedTuple):
    """A value with its standard uncertainty and the half-width of its 95 % interval."""

    value: float
    uncertainty: float
    half_width: float

    @property
    def interval(self) -> tuple[float, float]:
        """Ends of the 95 % interval."""
        return self.value - self.half_width, self.value + self.half_width


class GrooveErrors:
    """Random errors of sums over the heights of a levelled scan: roughness within, reference below.

    They are from the scan's unworn pixels and the residual of its groove.

    Parameters
    ----------
    levelled, surface : HeightMap
        The scan, levelled and as it was.
    reference : UnwornReference
    coordinates : pair of ndarray, shape of the heights
        Transverse coordinate and arc length about the track, in m.
    section : MeanCrossSection
    edges : GrooveExtent
    counted : ndarray of bool, shape of the heights
    """

    def __init__(
        self,
        levelled: HeightMap,
        surface: HeightMap,
        reference: UnwornReference,
        coordinates: tuple[Floats, Floats],
        section: MeanCrossSection,
        edges: GrooveExtent,
        counted: Mask,
    ) -> None:
        self.levelled, self.reference, self.section, self.cells = levelled, reference, section, Cells(levelled)
        self.transverse, self.arc_length = coordinates
        worn = (self.transverse > edges.left) & (self.transverse < edges.right)
        beside = (self.transverse < edges.left_foot) | (self.transverse > edges.right_foot)
        self.covariance = roughness_covariance(self.cells, reference.random_part(surface), counted & beside)
        residual = np.where(counted, levelled.height - section.at(self.transverse), 0.0)
        floor, outer = (_mean_square(self.cells, residual, counted & part) for part in (worn, beside))
        scale = math.sqrt(floor / outer) if outer > 0 and floor > 0 else 1.0  # of the floor's roughness
        self.floor_scale = min(max(scale, _MIN_SCALE), _LARGEST_SCALE)

    def sum_over(self, worn: Mask, volume: float) -> Estimate:
        """Volume below the reference over worn pixels; a missing one weighs on those of its bin."""
        measured = worn & self.levelled.measured
        whole, known = (np.bincount(self.bins[mask], minlength=self.section.pixels.size) for mask in (worn, measured))
        share = (whole / np.maximum(known, 1))[self.bins]
        pixel = self.levelled.spacing_x * self.levelled.spacing_y
        direct = np.where(measured, share * pixel, 0.0)
        weights = self.floor_scale * direct - self.reference.pixel_weights(direct)
        return Estimate(volume, *self._combined(weights, self.reference.deviation_between_models(direct)))

    def of_reference(self, direct: Floats, *further: float) -> tuple[float, float]:
        """Standard uncertainty and 95 % half-width of a sum of heights above the reference, from the latter alone."""
        between = self.reference.deviation_between_models(direct)
        return self._combined(-self.reference.pixel_weights(direct), between, *further)

    def of_corner(self, corner: int, strip: Floats) -> float:
        """Standard uncertainty from the track's direction and curvature of a corner's distance from a strip, in m."""
        t = self.arc_length
        rotation, bending = (float(power.flat[corner] - np.sum(strip * power)) for power in (t, t**2 / 2))
        return self._combined(self.floor_scale * self.reference.track_pixel_weights((rotation, bending)))[0]

    def _combined(self, weights: Floats, *further: float) -> tuple[float, float]:
        variance, derivative = self.covariance.variance(self.cells.sums(weights))
        white = self.covariance.noise_of_pixel * float(np.sum(weights**2))
        total = variance + white + sum(each**2 for each in further)
        factor = coverage_factor(self.covariance.uncertainty(total, derivative))
        uncertainty = math.sqrt(max(total, 0.0))
        return uncertainty, factor * uncertainty

    def section_covariance(self, chosen: Mask) -> Floats:
        """Covariance of the mean heights of chosen bins of the section, in m2."""
        count = self.section.pixels.astype(np.float64)
        numbers = self.bins
        centre = int(np.flatnonzero(chosen)[np.argmax(count[chosen])])
        measured = self.levelled.measured
        strip = np.where((numbers == centre) & measured, 1 / count[centre], 0.0)
        smeared = self.covariance.smeared(self.cells.sums(strip))
        of_pixels = self.cells.of_pixels(smeared)
        total = np.bincount(numbers.ravel(), np.where(measured, of_pixels, 0.0).ravel(), minlength=count.size)
        row = total / np.maximum(count, 1.0)
        lags = np.abs(np.arange(count.size) - centre)
        mean = np.bincount(lags, row * (count > 0)) / np.maximum(np.bincount(lags, count > 0), 1)
        shared = np.sqrt(count[centre] / np.maximum(count, 1.0))
        size = int(np.count_nonzero(chosen))
        row_of_lag = np.zeros(size)
        row_of_lag[: min(size, mean.size)] = mean[:size]
        inner = shared[chosen]
        matrix = toeplitz(row_of_lag) * np.outer(inner, inner)
        matrix[np.diag_indices(size)] += self.covariance.noise_of_pixel / np.maximum(count[chosen], 1.0)
        values, vectors = np.linalg.eigh(matrix)  # lags beyond the field leave it slightly indefinite
        values = np.maximum(values, _MIN_EIGENVALUE * values.mean())
        return np.asarray(self.floor_scale**2 * (vectors * values) @ vectors.T)

    @property
    def bins(self) -> NDArray[np.intp]:
        """Number of the section's bin of each pixel."""
        first = self.section.transverse[0] - self.section.step / 2
        number = np.floor((self.transverse - first) / self.section.step).astype(np.intp)
        return np.asarray(np.clip(number, 0, self.section.pixels.size - 1))


def section_estimates(errors: GrooveErrors, edges: GrooveExtent) -> tuple[GrooveExtent, Estimate, Estimate] | None:
    """Edges, width and depth of the mean section with their uncertainty; None where too few points lie within."""
    section = errors.section
    chosen = (section.pixels >= _MIN_PIXELS * section.pixels.max()) & np.isfinite(section.height)
    margin = 3 * section.step
    chosen &= (section.transverse > edges.left - margin) & (section.transverse < edges.right + margin)
    if np.count_nonzero(chosen) < 8:
        return None
    covariance = errors.section_covariance(chosen)
    s, z = section.transverse[chosen], section.height[chosen]
    cut = (not edges.left_in_field, not edges.right_in_field)
    curve = section_curve(s, z, covariance, (edges.left, edges.right), cut)
    if curve is None:
        return None
    width, across = curve.right - curve.left, errors.transverse

    def strip(place: float) -> Floats:
        half = max(2 * section.step, width / 20)
        inside = (np.abs(across - place) < half) & errors.levelled.measured
        return inside / max(int(np.count_nonzero(inside)), 1)

    at_edges = strip(curve.left) / curve.left_slope + strip(curve.right) / curve.right_slope
    corners = int(across.argmin()), int(across.argmax())
    left = float(across.flat[corners[0]]) if cut[0] else curve.left
    right = float(across.flat[corners[1]]) if cut[1] else curve.right
    opposite = strip(curve.right), strip(curve.left)
    turned = [errors.of_corner(corners[side], opposite[side]) for side in (0, 1) if cut[side]]
    found = edges._replace(left=edges.left if cut[0] else curve.left, right=edges.right if cut[1] else curve.right)
    return (
        found._replace(left_foot=min(found.left, edges.left_foot), right_foot=max(found.right, edges.right_foot)),
        Estimate(right - left, *errors.of_reference(at_edges, curve.width_deviation, *turned)),
        Estimate(curve.depth, *errors.of_reference(strip(curve.deepest), curve.depth_deviation)),
    )


def _mean_square(cells: Cells, residual: Floats, counted: Mask) -> float:
    """Mean square over cells of the residual about the section."""
    mean, filled = cells.means(residual, counted)
    return float(np.mean(mean[filled] ** 2)) if filled.any() else 0.0
