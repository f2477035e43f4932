"""Profile surface texture parameters after ISO 21920-2, of one profile and of all profiles of a height map."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.surfaces.height_map import HeightMap
from sonolube.models.surfaces.spectrum import ProfileDirection, profiles

_SECTIONS = 5
_POINTS_PER_SECTION = 10  # with fewer the height of a section depends on the sampling
_MIN_ELEMENT = 0.1  # height of the peak and depth of the pit of a profile element, over Rz


@dataclass(frozen=True, kw_only=True, slots=True)
class ProfileParameters:
    """Profile parameters of ISO 21920-2, or statistics of them over several profiles.

    Parameters
    ----------
    arithmetic_mean_height : float
        Mean absolute deviation from the mean line, Ra. [m]
    rms_height : float
        Root mean square deviation from the mean line, Rq. [m]
    maximum_peak_height : float
        Highest point above the mean line over the whole profile, Rpt. [m]
    maximum_pit_depth : float
        Lowest point below the mean line over the whole profile, Rvt, as a positive depth. [m]
    total_height : float
        Total height Rt = Rpt + Rvt. [m]
    mean_section_peak_height : float
        Mean peak height Rp: highest point of a section above the mean line, mean over the sections. [m]
    mean_section_pit_depth : float
        Mean pit depth Rv: lowest point of a section below the mean line, mean over the sections. [m]
    mean_section_height : float
        Maximum height Rz = Rp + Rv: height from the lowest to the highest point of a section, mean over the
        sections. [m]
    skewness : float
        Third moment over the cube of the root mean square, Rsk. []
    kurtosis : float
        Fourth moment over the fourth power of the root mean square, Rku. []
    mean_profile_element_spacing : float or None
        Mean profile element spacing Rsm; None where the profile has no complete element. [m]
    """

    arithmetic_mean_height: float
    rms_height: float
    maximum_peak_height: float
    maximum_pit_depth: float
    total_height: float
    mean_section_peak_height: float
    mean_section_pit_depth: float
    mean_section_height: float
    skewness: float
    kurtosis: float
    mean_profile_element_spacing: float | None


@dataclass(frozen=True, kw_only=True, slots=True)
class ProfileStatistics:
    """Mean and standard deviation of the parameters of the profiles along rows or columns of a map.

    Parameters
    ----------
    mean : ProfileParameters
        Mean over the profiles.
    standard_deviation : ProfileParameters
        Standard deviation over the profiles.
    profile_count : int
        Number of profiles evaluated.
    excluded_count : int
        Number of profiles that were flat or had fewer than two measured heights.
    """

    mean: ProfileParameters
    standard_deviation: ProfileParameters
    profile_count: int
    excluded_count: int


def profile_parameters(*, height: ArrayLike, spacing: float, section_length: float | None = None) -> ProfileParameters:
    r"""Profile parameters Ra, Rq, Rpt, Rvt, Rt, Rp, Rv, Rz, Rsk, Rku and Rsm of ISO 21920-2.

    Parameters
    ----------
    height : array_like, shape (n,)
        Heights along the profile with form removed and filtered beforehand; NaN where not measured. [m]
    spacing : float
        Distance of neighbouring points of a profile. [m]
    section_length : float, optional
        Section length for Rp, Rv and Rz. By default a profile of 50 points or more is divided into five equal
        sections; a shorter one is one section. [m]

    Returns
    -------
    ProfileParameters

    Raises
    ------
    InvalidInput
        If the profile is not a one-dimensional array of numbers, has fewer than two measured heights, is flat, or is
        shorter than the section length.

    See Also
    --------
    sonolube.models.surfaces.profile_evaluation.evaluate_profile : A measured profile, with the filters of ISO 21920-3.
    profile_statistics : Mean and standard deviation over the profiles of a height map.
    sonolube.models.surfaces.areal_parameters.height_parameters : The areal counterparts.

    Notes
    -----
    With the heights :math:`z` of the :math:`n` measured points, counted from their mean,

    .. math:: R_a = \frac1n \sum |z|, \quad R_q^2 = \frac1n \sum z^2, \quad
        R_{sk} = \frac{1}{n R_q^3} \sum z^3, \quad R_{ku} = \frac{1}{n R_q^4} \sum z^4 .

    All but Rp, Rv and Rz refer to the whole profile. Sections without a measured height are left out of these three. A
    profile element of Rsm extends from one upward crossing of the mean line to the next, or from one downward crossing
    to the next, with a peak and a pit of at least a tenth of Rz; gaps are interpolated linearly.

    References
    ----------
    .. [1] ISO 21920-2:2021, Geometrical product specifications, surface texture: profile, part 2.

    Examples
    --------
    >>> import numpy as np
    >>> from sonolube.models.surfaces import profile_parameters
    >>> wave = 1e-6 * np.sin(2 * np.pi * np.arange(500) / 50)
    >>> found = profile_parameters(height=wave, spacing=1e-6)
    >>> round(1e6 * found.arithmetic_mean_height, 2), round(1e6 * found.mean_profile_element_spacing, 3)  # 2/pi; 50 um
    (0.64, 50.0)
    """
    require_positive(spacing=spacing)
    z = np.asarray(height)
    if z.ndim != 1 or z.dtype.kind not in "fiu":
        raise InvalidInput(f"height must be a one-dimensional array of numbers, got shape {z.shape} of {z.dtype}")
    if np.isinf(z).any():
        raise InvalidInput("height must be finite, or NaN where not measured; got an infinite value")
    z = z.astype(np.float64)
    measured = np.isfinite(z)
    count = np.count_nonzero(measured)
    if count < 2 or not np.ptp(z[measured]) > 0:
        raise InvalidInput(f"height of a profile must have two different measured values, got {count} measured")
    z -= z[measured].mean()
    deviation = z[measured]
    section = _section_points(z.size, spacing, section_length)
    extremes = np.array([(part.max(), -part.min()) for part in _sections(z, section) if part.size])
    square = deviation**2
    rms = math.sqrt(square.mean())
    section_peak, section_pit = (float(value) for value in extremes.mean(axis=0))
    section_height, position = section_peak + section_pit, spacing * np.flatnonzero(measured).astype(np.float64)
    return ProfileParameters(
        arithmetic_mean_height=float(np.abs(deviation).mean()),
        rms_height=rms,
        maximum_peak_height=float(deviation.max()),
        maximum_pit_depth=float(-deviation.min()),
        total_height=float(np.ptp(deviation)),
        mean_section_peak_height=section_peak,
        mean_section_pit_depth=section_pit,
        mean_section_height=section_height,
        skewness=float((square * deviation).mean() / rms**3),
        kurtosis=float((square**2).mean() / rms**4),
        mean_profile_element_spacing=_mean_element_spacing(position, deviation, section_height),
    )


def profile_statistics(
    surface: HeightMap, *, along: ProfileDirection = "rows", section_length: float | None = None
) -> ProfileStatistics:
    """Mean and standard deviation of the parameters of all profiles along rows or columns of a height map.

    Parameters
    ----------
    surface : HeightMap
    along : {"rows", "columns"}
        Direction of the profiles.
    section_length : float, optional
        As in `profile_parameters`. [m]

    Returns
    -------
    ProfileStatistics

    Raises
    ------
    InvalidInput
        If no profile has two different measured heights, or as `profile_parameters`.

    Notes
    -----
    Each profile has its own mean line. The statistics of Rsm are over the profiles with a complete element.
    """
    lines, spacing = profiles(surface, along=along)
    usable = [line for line in lines if np.isfinite(line).sum() > 1 and np.nanmax(line) > np.nanmin(line)]
    if not usable:
        raise InvalidInput(f"none of the {len(lines)} {along} has two different measured heights")
    parameters = [profile_parameters(height=line, spacing=spacing, section_length=section_length) for line in usable]
    return ProfileStatistics(
        mean=_statistic(parameters, np.mean),
        standard_deviation=_statistic(parameters, np.std),
        profile_count=len(usable),
        excluded_count=len(lines) - len(usable),
    )


def _statistic(
    parameters: Sequence[ProfileParameters], function: Callable[[Sequence[float]], Any]
) -> ProfileParameters:
    """Statistic of each parameter over the profiles in which it is defined."""
    defined = {
        field.name: [value for one in parameters if (value := getattr(one, field.name)) is not None]
        for field in fields(ProfileParameters)
    }
    result: dict[str, Any] = {name: float(function(values)) if values else None for name, values in defined.items()}
    return ProfileParameters(**result)


def _section_points(points: int, spacing: float, section_length: float | None) -> int:
    """Number of points of a section."""
    if section_length is None:
        return points // _SECTIONS if points >= _SECTIONS * _POINTS_PER_SECTION else points
    require_positive(section_length=section_length)
    requested = round(section_length / spacing)
    if not 2 <= requested <= points:
        raise InvalidInput(
            f"section_length must lie between two points and the length of the profile, {points * spacing!r} m, "
            f"got {section_length!r} m"
        )
    return requested


def _sections(height: Floats, points: int) -> list[Floats]:
    """Measured heights of each complete section."""
    sections = [height[start : start + points] for start in range(0, height.size - points + 1, points)]
    return [part[np.isfinite(part)] for part in sections]


def _mean_element_spacing(position: Floats, deviation: Floats, section_height: float) -> float | None:
    """Mean distance of crossings of the mean line in one direction, between peaks and pits beyond the threshold."""
    beyond = np.flatnonzero(np.abs(deviation) >= _MIN_ELEMENT * section_height)
    reversals = beyond[1:][np.diff(np.sign(deviation[beyond])) != 0]
    crossings = np.flatnonzero(np.signbit(deviation[1:]) != np.signbit(deviation[:-1]))
    last = crossings[np.searchsorted(crossings, reversals, side="left") - 1]
    z0, z1 = deviation[last], deviation[last + 1]
    x = position[last] + (position[last + 1] - position[last]) * z0 / (z0 - z1)
    spacings: NDArray[np.float64] = x[2:] - x[:-2]
    return float(spacings.mean()) if spacings.size else None
