"""Height maps of wear grooves of known width, depth and volume, by code of its own (numpy and scipy alone)."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import log_ndtr

Array = NDArray[np.float64]

CLASSES = (
    "straight",
    "arc",
    "half outside the field",
    "one-sided pile-up",
    "3 um on Sq 1 um",
    "random lay",
    "waviness",
    "outliers and missing",
    "floor rougher or smoother",
    "flat floor, leaning flanks",
)
"""Classes of grooves; the trial with seed n is of class n modulo their number."""

FAMILIES: dict[str, Callable[[Array, float], Array]] = {
    "self-affine, round roll-off": lambda squared, hurst: (1 + squared) ** -(1 + hurst),
    "self-affine, sharp roll-off": lambda squared, hurst: np.maximum(1.0, squared) ** -(1 + hurst),
    "Gaussian spectrum, skewed heights": lambda squared, hurst: np.exp(-squared / 4),
}
"""Spectra over the squared wavenumber, in units of the roll-off, and the Hurst exponent. The analysis knows the first.

The trial with seed n is of the family whose number is the integer part of n/10, modulo their number.
"""

_SKEWED = "Gaussian spectrum, skewed heights"
_WEIBULL = 1.5  # shape of the distribution of the skewed depths below a plateau: skewness -1.07, excess kurtosis 1.39


@dataclass(frozen=True)
class Drawn:
    """A groove as drawn, without the roughness.

    Parameters
    ----------
    kind : str
        One of `CLASSES`.
    family : str
        Of the roughness, one of `FAMILIES`.
    pixel : float
        Distance of neighbouring pixels in both directions. [m]
    ground : ndarray, shape (rows, columns)
        Tilt, form and waviness of the unworn surface. [m]
    relief : ndarray, shape (rows, columns)
        Ridges less the depth of the groove. [m]
    inside : bool array, shape (rows, columns)
        Pixels of the groove.
    roughness : tuple of float
        Standard deviation in m, correlation lengths along and across the lay in m, direction of the lay in rad, Hurst
        exponent, and that of the instrument's noise in m.
    floor_factor : float
        Standard deviation of the floor's own roughness over that of the surface; 0 where the floor has the surface's.
    missing : float
        Fraction of missing pixels, beside missing patches.
    outliers : float
        Fraction of outliers.
    groove_width, groove_depth, wear_volume : float
        Of the groove within the field, in m, m and m3.
    """

    kind: str
    family: str
    pixel: float
    ground: Array
    relief: Array
    inside: NDArray[np.bool_]
    roughness: tuple[float, float, float, float, float, float]
    floor_factor: float
    missing: float
    outliers: float
    groove_width: float
    groove_depth: float
    wear_volume: float


def drawn_groove(seed: int, *, shape: tuple[int, int] = (180, 240)) -> Drawn:
    """Groove of a seed, 5 to 30 um deep (3 um in one class) on a surface of Sq 0.2 to 1 um."""
    rng = np.random.default_rng([seed, 1])
    kind = CLASSES[seed % len(CLASSES)]
    rows, columns = shape
    pixel = 2.4e-3 / columns
    x, y = np.meshgrid((np.arange(columns) - (columns - 1) / 2) * pixel, (np.arange(rows) - (rows - 1) / 2) * pixel)
    shallow, cut = kind == "3 um on Sq 1 um", kind == "half outside the field"
    width, depth = rng.uniform(0.3e-3, 0.8e-3), 3e-6 if shallow else rng.uniform(5e-6, 30e-6)
    sq = 1e-6 if shallow else rng.uniform(0.2e-6, 1e-6)
    angle = rng.uniform(0, 2 * math.pi)
    s, reach = _distance(x, y, angle, rng, kind)
    # cut by the field: the middle of the groove near its side
    s = s - reach if cut else s - rng.uniform(-0.25e-3, 0.25e-3)
    depth_at, ridge = _section(s, width, depth, rng, kind)
    t = rng.uniform(-2e-6, 2e-6, 6)
    u, v = x / 1.2e-3, y / 1.2e-3
    ground = t[0] * u + t[1] * v + 0.5 * (t[2] * u * u + t[3] * u * v + t[4] * v * v)
    if kind == "waviness":
        direction, length = rng.uniform(0, math.pi), rng.uniform(0.5e-3, 2e-3)
        phase = 2 * math.pi * (x * math.cos(direction) + y * math.sin(direction)) / length
        ground = ground + rng.uniform(0.5, 1.5) * sq * np.sin(phase + rng.uniform(0, 2 * math.pi))
    along = math.exp(rng.uniform(math.log(12e-6), math.log(80e-6)))
    across = along / rng.uniform(2, 6) if kind == "random lay" else along
    rough = (sq, along, across, rng.uniform(0, math.pi), rng.uniform(0.3, 1.0), rng.uniform(0.01, 0.05) * 1e-6)
    dirty = kind == "outliers and missing"
    visible = min(width, float(np.max(s)) + width / 2, width / 2 - float(np.min(s))) if cut else width
    return Drawn(
        kind=kind,
        family=list(FAMILIES)[seed // len(CLASSES) % len(FAMILIES)],
        pixel=pixel,
        ground=ground,
        relief=ridge - depth_at,
        inside=np.abs(s) < width / 2,
        roughness=rough,
        floor_factor=rng.uniform(0.4, 1.5) if kind == "floor rougher or smoother" else 0.0,
        missing=rng.uniform(0.02, 0.2) if dirty else rng.uniform(0, 0.05),
        outliers=rng.uniform(0.0005, 0.005) if dirty else 0.0,
        groove_width=visible,
        groove_depth=float(np.max(depth_at)) if cut else depth,
        wear_volume=float(depth_at.sum()) * pixel**2,
    )


def heights(drawn: Drawn, seed: int) -> Array:
    """Heights of a drawn groove with the roughness, noise and missing pixels of a seed, NaN where missing, in m."""
    rng = np.random.default_rng([seed, 2])
    height = drawn.ground + drawn.relief
    rough = random_field(rng, height.shape, drawn.pixel, drawn.roughness, drawn.family)
    if drawn.floor_factor:
        floor = drawn.floor_factor * random_field(rng, height.shape, drawn.pixel, drawn.roughness, drawn.family)
        rough = np.where(drawn.inside, floor, rough)
    height = height + rough + drawn.roughness[5] * rng.standard_normal(height.shape)
    hit = rng.random(height.shape) < drawn.outliers
    height[hit] += rng.choice([-1, 1], int(hit.sum())) * rng.uniform(5e-6, 40e-6, int(hit.sum()))
    height[rng.random(height.shape) < drawn.missing] = np.nan
    if drawn.outliers:
        rows, columns = height.shape
        for _ in range(int(rng.integers(1, 6))):
            row, column, size = int(rng.integers(rows)), int(rng.integers(columns)), int(rng.integers(5, 25))
            height[row : row + size, column : column + size] = np.nan
    return height


def random_field(
    rng: np.random.Generator,
    shape: tuple[int, int],
    pixel: float,
    roughness: tuple[float, float, float, float, float, float],
    family: str = "self-affine, round roll-off",
) -> Array:
    """Random heights of a family, cut from a periodic map twice as large, in m."""
    sq, along, across, lay, hurst, _ = roughness
    rows, columns = (2 * n for n in shape)
    qx = 2 * math.pi * np.fft.fftfreq(columns, pixel)[None, :]
    qy = 2 * math.pi * np.fft.fftfreq(rows, pixel)[:, None]
    ahead, beside = qx * math.cos(lay) + qy * math.sin(lay), qy * math.cos(lay) - qx * math.sin(lay)
    power = FAMILIES[family]((along * ahead) ** 2 + (across * beside) ** 2, hurst)
    power[0, 0] = 0.0
    noise = np.fft.fft2(rng.standard_normal((rows, columns)))
    field = np.fft.ifft2(noise * np.sqrt(power)).real
    field /= math.sqrt(float(np.mean(power)))
    if family == _SKEWED:  # each height to that of the same rank of a Weibull distribution of depths
        depth = (-log_ndtr(field)) ** (1 / _WEIBULL)
        mean, square = math.gamma(1 + 1 / _WEIBULL), math.gamma(1 + 2 / _WEIBULL)
        field = (mean - depth) / math.sqrt(square - mean**2)
    return np.asarray(sq * field[: shape[0], : shape[1]])


def _distance(x: Array, y: Array, angle: float, rng: np.random.Generator, kind: str) -> tuple[Array, float]:
    """Distance from a line or circle through the centre, and from the centre to the field's side across it."""
    cos, sin = math.cos(angle), math.sin(angle)
    if kind == "half outside the field":  # nearly along a side, so that the other edge lies in the field
        angle = rng.integers(4) * math.pi / 2 + rng.uniform(-0.06, 0.06)
        cos, sin = math.cos(angle), math.sin(angle)
        s = y * cos - x * sin
        half = 0.5 * (abs(cos) * float(np.ptp(y)) + abs(sin) * float(np.ptp(x)))
        return s, half * rng.uniform(0.9, 1.0)
    curved = kind == "arc" or (kind != "straight" and rng.random() < 0.3)
    if not curved:
        return y * cos - x * sin, 0.0
    radius = rng.uniform(4e-3, 30e-3)
    return np.hypot(x - radius * cos, y - radius * sin) - radius, 0.0


def _section(s: Array, width: float, depth: float, rng: np.random.Generator, kind: str) -> tuple[Array, Array]:
    """Depth below the unworn surface and height of ridges at distances from the track."""
    u = np.minimum(np.abs(2 * s / width), 1.0)
    ridge = np.zeros_like(s)
    if kind == "flat floor, leaning flanks":
        flank = rng.uniform(0.15, 0.45, 2) * width
        down, up = (s + width / 2) / flank[0], (width / 2 - s) / flank[1]
        return depth * np.clip(np.minimum(down, up), 0.0, 1.0), ridge
    depth_at = depth * (1 - u ** rng.uniform(1.7, 3.0))
    if kind == "one-sided pile-up" or rng.random() < 0.2:
        sides = [1] if kind == "one-sided pile-up" else [1, -1]
        for side in sides:
            wide, high = rng.uniform(0.15, 0.3) * width, rng.uniform(0.05, 0.3) * depth
            v = np.clip((side * s - width / 2) / wide, 0.0, 1.0)
            ridge = ridge + high * 4 * v * (1 - v)
    return depth_at, ridge
