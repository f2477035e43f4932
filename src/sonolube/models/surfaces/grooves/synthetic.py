"""Synthetic scans of a wear groove of known volume in a tilted, wavy and rough surface with missing pixels."""

import math
from dataclasses import dataclass

import numpy as np

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive, require_within
from sonolube.errors import InvalidInput
from sonolube.models.surfaces.grooves.track import GrooveTrack, centred_coordinates
from sonolube.models.surfaces.height_map import HeightMap
from sonolube.models.surfaces.random_surface import GaussianCorrelationSpectrum, gaussian_surface

_PIXELS_PER_CORRELATION_LENGTH = 2.0  # the finest roughness that the pixels resolve


@dataclass(frozen=True, kw_only=True, slots=True)
class GrooveShape:
    """Cross-section of a wear groove: the circular segment that a ball leaves, between parabolic pile-up ridges.

    Parameters
    ----------
    groove_width : float
        Distance of the edges on the unworn surface. [m]
    groove_depth : float
        Greatest depth below the unworn surface, at most half the width. [m]
    pile_up_height : float
        Height of the ridge beyond each edge. [m]
    pile_up_width : float
        Width of each ridge. [m]
    indentation_spacing : float or None
        Period of a sinusoidal modulation of the depth along the track; None for none. [m]
    indentation_fraction : float
        Amplitude of that modulation over the depth. []

    Raises
    ------
    InvalidInput
        If a length is out of range.
    """

    groove_width: float
    groove_depth: float
    pile_up_height: float = 0.0
    pile_up_width: float = 0.0
    indentation_spacing: float | None = None
    indentation_fraction: float = 0.0

    def __post_init__(self) -> None:
        require_positive(groove_width=self.groove_width, groove_depth=self.groove_depth)
        require_within(0.0, self.groove_width / 2, groove_depth=self.groove_depth)
        require_non_negative(pile_up_height=self.pile_up_height, pile_up_width=self.pile_up_width)
        require_within(0.0, 1.0, indentation_fraction=self.indentation_fraction)
        if self.indentation_spacing is not None:
            require_positive(indentation_spacing=self.indentation_spacing)

    @property
    def cross_section_area(self) -> float:
        """Area of the cross-section below the unworn surface, averaged along the track. [m2]"""
        radius = self._radius
        half_angle = math.asin(min(1.0, self.groove_width / (2 * radius)))
        return radius**2 * half_angle - self.groove_width / 2 * (radius - self.groove_depth)

    @property
    def _radius(self) -> float:
        """Radius of the circular segment. [m]"""
        return (self.groove_width**2 / 4 + self.groove_depth**2) / (2 * self.groove_depth)

    def depth_at(self, transverse: Floats, arc_length: Floats) -> Floats:
        """Depth below the unworn surface at points of given coordinates in m about the track, in m."""
        half, radius = self.groove_width / 2, self._radius
        depth = np.sqrt(radius**2 - np.minimum(np.abs(transverse), half) ** 2) - (radius - self.groove_depth)
        if self.indentation_spacing is not None:
            phase = 2 * math.pi * arc_length / self.indentation_spacing
            depth = depth * (1 + self.indentation_fraction * np.cos(phase))
        return np.asarray(depth)

    def ridge_at(self, transverse: Floats) -> Floats:
        """Height of the pile-up ridges at transverse distances in m from the track, in m."""
        if not self.pile_up_width:
            return np.zeros_like(transverse)
        from_crest = (np.abs(transverse) - self.groove_width / 2) / self.pile_up_width * 2 - 1
        return self.pile_up_height * np.maximum(0.0, 1 - from_crest**2)


@dataclass(frozen=True, kw_only=True, slots=True)
class ScannedField:
    """Field of a synthetic scan: grid, tilt, waviness, roughness and missing pixels.

    Parameters
    ----------
    field_shape : tuple of int
        Numbers of rows and columns.
    spacing_x : float
        Distance of neighbouring columns. [m]
    spacing_y : float
        Distance of neighbouring rows. [m]
    tilt : float
        Height difference between the lowest and the highest corner of the mean plane. [m]
    waviness_amplitude : float
        Amplitude of a plane wave of random direction and phase. [m]
    waviness_length : float
        Wavelength of that wave. [m]
    rms_height : float
        Standard deviation of the roughness. [m]
    missing_fraction : float
        Fraction of randomly placed missing pixels. []

    Raises
    ------
    InvalidInput
        If a value is out of range.
    """

    field_shape: tuple[int, int] = (480, 640)
    spacing_x: float = 3.75e-6
    spacing_y: float = 3.75e-6
    tilt: float = 5e-6
    waviness_amplitude: float = 1e-6
    waviness_length: float = 1e-3
    rms_height: float = 0.6e-6
    missing_fraction: float = 0.05

    def __post_init__(self) -> None:
        require_positive(spacing_x=self.spacing_x, spacing_y=self.spacing_y, waviness_length=self.waviness_length)
        require_non_negative(tilt=self.tilt, waviness_amplitude=self.waviness_amplitude, rms_height=self.rms_height)
        require_within(0.0, 0.99, missing_fraction=self.missing_fraction)
        if len(self.field_shape) != 2 or min(self.field_shape) < 1:
            raise InvalidInput(f"field_shape must be two numbers, of rows and columns, got {self.field_shape!r}")


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SyntheticGroove:
    """Synthetic scan of a wear groove with its exact volumes.

    Parameters
    ----------
    scan : HeightMap
        Heights as measured.
    unworn : HeightMap
        Unworn surface: tilt and waviness without roughness.
    wear_volume : float
        Exact volume of the groove below the unworn surface within the field. [m3]
    pile_up_volume : float
        Exact volume of the ridges within the field. [m3]
    """

    scan: HeightMap
    unworn: HeightMap
    wear_volume: float
    pile_up_volume: float


def synthetic_groove(
    shape: GrooveShape, *, track: GrooveTrack, seed: int, field: ScannedField | None = None
) -> SyntheticGroove:
    """Synthetic scan of a wear groove of known volume.

    Parameters
    ----------
    shape : GrooveShape
        Cross-section of the groove.
    track : GrooveTrack
        Its centre line.
    seed : int
        Seed of the random numbers.
    field : ScannedField, optional
        Field of the scan; by default 2.4 mm by 1.8 mm with a tilt of 5 um, a wave of 1 um amplitude and 1 mm length, a
        roughness of 0.6 um and 5 % of the pixels missing.

    Returns
    -------
    SyntheticGroove

    Notes
    -----
    Depth and ridges are subtracted from and added to the rough surface, so that groove and surroundings have the same
    roughness. Volumes are sums over all pixels, including missing ones.
    """
    field = field or ScannedField()
    rng = np.random.default_rng(seed)
    flat = HeightMap(height=np.zeros(field.field_shape), spacing_x=field.spacing_x, spacing_y=field.spacing_y)
    x, y = centred_coordinates(flat)
    unworn = flat.with_height(_plane(field, x, y, rng) + _wave(field, x, y, rng))
    transverse, arc_length = track.curvilinear_coordinates(unworn)
    depth, ridge = shape.depth_at(transverse, arc_length), shape.ridge_at(transverse)
    height = unworn.height - depth + ridge
    if field.rms_height:
        height += _roughness(field, seed)
    height[rng.random(height.shape) < field.missing_fraction] = np.nan
    pixel = field.spacing_x * field.spacing_y
    return SyntheticGroove(
        scan=unworn.with_height(height),
        unworn=unworn,
        wear_volume=float(depth.sum()) * pixel,
        pile_up_volume=float(ridge.sum()) * pixel,
    )


def _plane(field: ScannedField, x: Floats, y: Floats, rng: np.random.Generator) -> Floats:
    """Plane of the field's tilt in a random direction."""
    angle = rng.uniform(0, 2 * math.pi)
    plane = x * math.cos(angle) + y * math.sin(angle)
    return np.asarray(plane * (field.tilt / max(float(np.ptp(plane)), np.finfo(float).tiny)))


def _wave(field: ScannedField, x: Floats, y: Floats, rng: np.random.Generator) -> Floats:
    """Plane wave of the field's waviness in a random direction."""
    angle, phase = rng.uniform(0, 2 * math.pi, 2)
    along = x * math.cos(angle) + y * math.sin(angle)
    return np.asarray(field.waviness_amplitude * np.sin(2 * math.pi / field.waviness_length * along + phase))


def _roughness(field: ScannedField, seed: int) -> Floats:
    """Random roughness of the field."""
    length = _PIXELS_PER_CORRELATION_LENGTH * max(field.spacing_x, field.spacing_y)
    return gaussian_surface(
        rms_height=require_finite(rms_height=field.rms_height).item(),
        spectrum=GaussianCorrelationSpectrum(correlation_length=length),
        shape=field.field_shape,
        spacing_x=field.spacing_x,
        spacing_y=field.spacing_y,
        seed=seed,
    ).height
