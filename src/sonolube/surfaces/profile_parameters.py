"""Parameters of a profile after ISO 21920-2, and of all the profiles of a height map."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.surfaces.height_map import HeightMap
from sonolube.surfaces.spectrum import ProfileDirection, profiles

_SECTIONS = 5
_POINTS_PER_SECTION = 10  # fewer would make the height of a section a matter of sampling
_LEAST_ELEMENT = 0.1  # height of an element's peak and valley, as a share of Rz


@dataclass(frozen=True, kw_only=True, slots=True)
class ProfileParameters:
    """Numbers of one profile, or of several taken together.

    Parameters
    ----------
    arithmetic_mean_height : float
        Arithmetic mean deviation, Ra. [m]
    rms_height : float
        Standard deviation, Rq. [m]
    maximum_peak_height : float
        Highest point above the mean line, Rp. [m]
    maximum_pit_depth : float
        Deepest point below the mean line, Rv. [m]
    total_height : float
        Highest to deepest point of the whole profile, Rt. [m]
    mean_section_height : float
        Highest to deepest point of a section, the mean over the sections, Rz. [m]
    skewness : float
        Third moment over the cube of the standard deviation, Rsk. []
    kurtosis : float
        Fourth moment over the fourth power of the standard deviation, Rku. []
    mean_profile_element_spacing : float or None
        Mean width of a peak and its valley, RSm; None where the profile holds no whole element. [m]
    """

    arithmetic_mean_height: float
    rms_height: float
    maximum_peak_height: float
    maximum_pit_depth: float
    total_height: float
    mean_section_height: float
    skewness: float
    kurtosis: float
    mean_profile_element_spacing: float | None


@dataclass(frozen=True, kw_only=True, slots=True)
class ProfileStatistics:
    """Parameters of the profiles along the rows or columns of a map.

    Parameters
    ----------
    mean : ProfileParameters
        Mean over the profiles.
    standard_deviation : ProfileParameters
        Standard deviation over the profiles.
    profile_count : int
        Profiles taken.
    excluded_count : int
        Profiles with fewer than two measured heights, or flat ones.
    """

    mean: ProfileParameters
    standard_deviation: ProfileParameters
    profile_count: int
    excluded_count: int


def profile_parameters(*, height: ArrayLike, spacing: float, section_length: float | None = None) -> ProfileParameters:
    """Return Ra, Rq, Rp, Rv, Rt, Rz, Rsk, Rku and RSm.

    Parameters
    ----------
    height : array_like, shape (n,)
        Heights along the profile, NaN where missing; levelled and filtered as wanted. [m]
    spacing : float
        Distance of neighbouring points of a profile. [m]
    section_length : float, optional
        Length of a section for Rz. Without it a profile of 50 points or more is cut into five equal sections, a
        shorter one into none. [m]

    Returns
    -------
    ProfileParameters

    Raises
    ------
    InvalidInput
        If the profile is no line of numbers, has fewer than two measured heights, is flat, or is shorter than the
        sampling length.

    Notes
    -----
    Only the mean is removed. All but Rz refer to the whole profile, so that Rt = Rp + Rv; ISO 21920-2 calls these two
    Rpt and Rvt, and ISO 4287 took means over five sampling lengths. Sections without a measured height are left out.
    An element of RSm runs from one rise through the mean line to the next, or from fall to fall, over peaks and valleys
    that reach a tenth of Rz from the line; gaps are bridged straight.

    References
    ----------
    .. [1] ISO 21920-2:2021, Geometrical product specifications, surface texture: profile, part 2.
    """
    require_positive(spacing=spacing)
    z = np.asarray(height)
    if z.ndim != 1 or z.dtype.kind not in "fiu":
        raise InvalidInput(f"height of a profile must be a line of numbers, got shape {z.shape} of {z.dtype}")
    if np.isinf(z).any():
        raise InvalidInput("height must be finite, or NaN where it was not measured; got an infinite value")
    z = z.astype(np.float64)
    measured = np.isfinite(z)
    if np.count_nonzero(measured) < 2 or not np.ptp(z[measured]) > 0:
        raise InvalidInput(
            f"height of a profile must hold two measured values that differ, got {np.count_nonzero(measured)} measured"
        )
    z -= z[measured].mean()
    deviation = z[measured]
    section = _section_points(z.size, spacing, section_length)
    heights = [np.ptp(part) for part in _sections(z, section) if part.size]
    square = deviation**2
    rms = math.sqrt(square.mean())
    intersection_height = float(np.mean(heights))
    return ProfileParameters(
        arithmetic_mean_height=float(np.abs(deviation).mean()),
        rms_height=rms,
        maximum_peak_height=float(deviation.max()),
        maximum_pit_depth=float(-deviation.min()),
        total_height=float(np.ptp(deviation)),
        mean_section_height=intersection_height,
        skewness=float((square * deviation).mean() / rms**3),
        kurtosis=float((square**2).mean() / rms**4),
        mean_profile_element_spacing=_element_width(
            spacing * np.flatnonzero(measured).astype(np.float64), deviation, intersection_height
        ),
    )


def profile_statistics(
    surface: HeightMap, *, along: ProfileDirection = "rows", section_length: float | None = None
) -> ProfileStatistics:
    """Return mean and spread of the parameters of all profiles along rows or columns.

    Parameters
    ----------
    surface : HeightMap
    along : {"rows", "columns"}
        Which way the profiles run.
    section_length : float, optional
        As in `profile_parameters`. [m]

    Returns
    -------
    ProfileStatistics

    Raises
    ------
    InvalidInput
        If no profile has two measured heights that differ, or as by `profile_parameters`.

    Notes
    -----
    Each profile has its own mean line. Mean and spread of RSm are over the profiles that hold a whole element.
    """
    lines, spacing = profiles(surface, along=along)
    usable = [line for line in lines if np.isfinite(line).sum() > 1 and np.nanmax(line) > np.nanmin(line)]
    if not usable:
        raise InvalidInput(f"none of the {len(lines)} {along} holds two measured heights that differ")
    each = [profile_parameters(height=line, spacing=spacing, section_length=section_length) for line in usable]
    return ProfileStatistics(
        mean=_over(each, np.mean),
        standard_deviation=_over(each, np.std),
        profile_count=len(usable),
        excluded_count=len(lines) - len(usable),
    )


def _over(each: Sequence[ProfileParameters], measure: Callable[[Sequence[float]], Any]) -> ProfileParameters:
    known = {
        field.name: [value for one in each if (value := getattr(one, field.name)) is not None]
        for field in fields(ProfileParameters)
    }
    found: dict[str, Any] = {name: float(measure(values)) if values else None for name, values in known.items()}
    return ProfileParameters(**found)


def _section_points(points: int, spacing: float, section_length: float | None) -> int:
    if section_length is None:
        return points // _SECTIONS if points >= _SECTIONS * _POINTS_PER_SECTION else points
    require_positive(section_length=section_length)
    wanted = round(section_length / spacing)
    if not 2 <= wanted <= points:
        raise InvalidInput(
            f"section_length must lie between two points and the profile's {points * spacing!r} m, "
            f"got {section_length!r} m"
        )
    return wanted


def _sections(height: Floats, points: int) -> list[Floats]:
    sections = [height[start : start + points] for start in range(0, height.size - points + 1, points)]
    return [part[np.isfinite(part)] for part in sections]


def _element_width(position: Floats, deviation: Floats, intersection_height: float) -> float | None:
    side = np.flatnonzero(np.abs(deviation) >= _LEAST_ELEMENT * intersection_height)
    arrives = side[1:][np.diff(np.sign(deviation[side])) != 0]
    crossings = np.flatnonzero(np.signbit(deviation[1:]) != np.signbit(deviation[:-1]))
    last = crossings[np.searchsorted(crossings, arrives, side="left") - 1]
    z0, z1 = deviation[last], deviation[last + 1]
    x = position[last] + (position[last + 1] - position[last]) * z0 / (z0 - z1)
    widths: NDArray[np.float64] = x[2:] - x[:-2]
    return float(widths.mean()) if widths.size else None
