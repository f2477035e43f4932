"""Evaluation of a measured profile after ISO 21920-3: form, S-filter, L-filter and section lengths by setting class."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.surfaces.form_removal import remove_form
from sonolube.models.surfaces.gaussian_filter import profile_low_pass
from sonolube.models.surfaces.height_map import HeightMap
from sonolube.models.surfaces.roughness_profile import ProfileParameters, profile_parameters

_SECTIONS = 5
_MIN_POINTS = 5  # of a cutoff, that the filter needs
_SHORTFALL = 0.01  # of a section, by which a length may fall short of whole sections


class SettingClass(NamedTuple):
    """Default settings of ISO 21920-3 for profiles up to a maximum height Rz.

    Parameters
    ----------
    name : str
        Sc1 to Sc5.
    largest_height : float
        Largest Rz of the class, in m.
    short_cutoff_length : float
        Nesting index of the S-filter. [m]
    long_cutoff_length : float
        Nesting index of the L-filter, and section length; five sections are evaluated. [m]
    """

    name: str
    largest_height: float
    short_cutoff_length: float
    long_cutoff_length: float


SETTING_CLASSES = (
    SettingClass("Sc1", 0.16e-6, 2.5e-6, 0.08e-3),
    SettingClass("Sc2", 0.8e-6, 2.5e-6, 0.25e-3),
    SettingClass("Sc3", 16e-6, 2.5e-6, 0.8e-3),
    SettingClass("Sc4", 80e-6, 8e-6, 2.5e-3),
    SettingClass("Sc5", float("inf"), 25e-6, 8e-3),
)
"""Setting classes of ISO 21920-3, by rising height."""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ProfileEvaluation:
    """Parameters of a profile with the settings they depend on.

    Parameters
    ----------
    parameters : ProfileParameters
        Of the roughness profile, or of the primary profile where no L-filter was applied.
    primary : ndarray, shape (n,)
        The whole profile without form, after the S-filter where it was applied, in m; NaN where not measured.
    evaluated : ndarray, shape (m,)
        The profile evaluated: `primary` less its waviness, over whole sections, in m.
    start : int
        Index in `primary` of the first point evaluated.
    setting_class : str
        Sc1 to Sc5 where the cutoffs are its defaults; empty otherwise.
    short_cutoff_length, long_cutoff_length : float or None
        Nesting indices of the S-filter and the L-filter; None for one that was not applied. [m]
    section_count : int
        Number of sections evaluated.
    section_length : float
        Their length. [m]
    caveats : tuple of str
        How the evaluation departs from the standard's defaults.
    """

    parameters: ProfileParameters
    primary: Floats
    evaluated: Floats
    start: int
    setting_class: str
    short_cutoff_length: float | None
    long_cutoff_length: float | None
    section_count: int
    section_length: float
    caveats: tuple[str, ...]


def evaluate_profile(
    *,
    height: ArrayLike,
    spacing: float,
    degree: int = 1,
    robust: bool = False,
    short_cutoff_length: float | None = None,
    long_cutoff_length: float | None = None,
) -> ProfileEvaluation:
    r"""Profile parameters of a measured profile with the filters and section lengths of ISO 21920-3.

    Parameters
    ----------
    height : array_like, shape (n,)
        Measured heights; NaN where not measured. [m]
    spacing : float
        Distance of neighbouring points of a profile. [m]
    degree : int
        Degree of the polynomial form that is removed: 1 tilt, 2 curvature.
    robust : bool
        Whether points far from the form lose weight.
    short_cutoff_length : float, optional
        Nesting index of the S-filter; that of the setting class by default. [m]
    long_cutoff_length : float, optional
        Nesting index of the L-filter and section length; that of the setting class by default. [m]

    Returns
    -------
    ProfileEvaluation

    Raises
    ------
    InvalidInput
        If the profile is flat or has fewer than two measured heights, or a given cutoff does not fit it.

    See Also
    --------
    profile_parameters : The parameters of a profile that is filtered already.

    Notes
    -----
    Both filters are Gaussian (ISO 16610-21). Without a given cutoff the setting class is the first of

    ===== ============ ========= =========
    class Rz up to     S-filter  L-filter
    ===== ============ ========= =========
    Sc1   0.16 um      2.5 um    0.08 mm
    Sc2   0.8 um       2.5 um    0.25 mm
    Sc3   16 um        2.5 um    0.8 mm
    Sc4   80 um        8 um      2.5 mm
    Sc5                25 um     8 mm
    ===== ============ ========= =========

    under whose settings the profile has an Rz of the class, among those of which five sections fit the profile. The
    sections lie in its middle: half a cutoff is left at each end where it has six sections or more, and where it has
    fewer the filter there averages over less than its full width. What departs from this is a caveat: fewer than five
    sections; a higher class whose five sections would not fit; no S-filter, where a point is more than a fifth of its
    cutoff from the next; no L-filter, where the profile is shorter than one section of Sc1.

    References
    ----------
    .. [1] ISO 21920-3:2021, Geometrical product specifications, surface texture: profile, part 3.
    .. [2] ISO 16610-21:2011, linear profile filters: Gaussian filters.
    """
    require_positive(spacing=spacing)
    z = np.asarray(height, dtype=np.float64)
    if z.ndim != 1:
        raise InvalidInput(f"height must be a one-dimensional array of numbers, got shape {z.shape}")
    row = HeightMap(height=z[np.newaxis], spacing_x=spacing, spacing_y=spacing)
    levelled = remove_form(row, degree=degree, robust=robust).height[0]
    if long_cutoff_length is not None:
        _check_cutoffs(z.size * spacing, spacing, short_cutoff_length, long_cutoff_length)
        return _evaluated(levelled, spacing, short_cutoff_length, long_cutoff_length)
    length = z.size * spacing
    fitting = [each for each in SETTING_CLASSES if _whole_sections(length, each.long_cutoff_length) >= _SECTIONS]
    if not fitting and _whole_sections(length, SETTING_CLASSES[0].long_cutoff_length):
        fitting = [SETTING_CLASSES[0]]
    if not fitting or fitting[0].long_cutoff_length < _MIN_POINTS * spacing:
        return _evaluated(levelled, spacing, short_cutoff_length, None)
    for settings in fitting:
        short = settings.short_cutoff_length if short_cutoff_length is None else short_cutoff_length
        found = _evaluated(levelled, spacing, short, settings.long_cutoff_length, settings)
        if found.parameters.mean_section_height <= settings.largest_height:
            break
    return found


def _check_cutoffs(length: float, spacing: float, short: float | None, long: float) -> None:
    """Refuse cutoffs that are out of order, too short to be resolved, or longer than the profile."""
    require_positive(long_cutoff_length=long)
    if short is not None and short >= long:
        raise InvalidInput(f"short_cutoff_length {short:g} m must be less than long_cutoff_length {long:g} m")
    if not _whole_sections(length, long) or long < _MIN_POINTS * spacing:
        raise InvalidInput(
            f"long_cutoff_length must be from {_MIN_POINTS} points to the length of the profile, {length:g} m,"
            f" got {long:g} m"
        )


def _whole_sections(length: float, section_length: float) -> int:
    """Number of whole sections in a length."""
    return int(length / section_length + _SHORTFALL)


def _evaluated(
    levelled: Floats, spacing: float, short: float | None, long: float | None, settings: SettingClass | None = None
) -> ProfileEvaluation:
    """Evaluation of a levelled profile with given cutoffs."""
    caveats = []
    if short is not None and short < _MIN_POINTS * spacing * (1 - 1e-9):
        caveats.append(
            f"no S-filter: steps of {_micrometres(spacing)} are too coarse for its cutoff of {_micrometres(short)}"
        )
        short = None
    primary = levelled if short is None else profile_low_pass(height=levelled, spacing_x=spacing, cutoff_length=short)
    length, start, evaluated, count = levelled.size * spacing, 0, primary, 1
    section_length = length
    if long is not None:
        roughness = primary - profile_low_pass(height=primary, spacing_x=spacing, cutoff_length=long)
        count = min(_SECTIONS, _whole_sections(length, long))
        points = min(primary.size, round(count * long / spacing))
        start = (primary.size - points) // 2
        points -= points % count
        evaluated, section_length = roughness[start : start + points], points // count * spacing
    parameters = profile_parameters(height=evaluated, spacing=spacing, section_length=section_length)
    caveats += _departures(parameters, count, long, length, settings)
    return ProfileEvaluation(
        parameters=parameters,
        primary=primary,
        evaluated=evaluated,
        start=start,
        setting_class=settings.name if settings is not None else "",
        short_cutoff_length=short,
        long_cutoff_length=long,
        section_count=count,
        section_length=section_length,
        caveats=tuple(caveats),
    )


def _departures(
    parameters: ProfileParameters, count: int, long: float | None, length: float, settings: SettingClass | None
) -> list[str]:
    """Departures of an evaluation from the standard's defaults."""
    if long is None:
        return [
            f"no L-filter: the profile of {_micrometres(length)} has less than one section of"
            f" {_micrometres(SETTING_CLASSES[0].long_cutoff_length)}, or too few points in it; the parameters are those"
            " of the primary profile (P)"
        ]
    found = []
    if count < _SECTIONS:
        found.append(f"{count} of the standard's {_SECTIONS} sections of {_micrometres(long)} fit the profile")
    elif _whole_sections(length, long) == _SECTIONS:
        found.append("within half a cutoff of its ends the profile has less than the filter's full width")
    if settings is not None and parameters.mean_section_height > settings.largest_height:
        found.append(
            f"Rz of {_micrometres(parameters.mean_section_height)} is beyond {settings.name}, the highest setting class"
            f" of which {_SECTIONS} sections fit the profile: a longer one is needed"
        )
    return found


def _micrometres(length: float) -> str:
    """Length in um or, from 1000 um on, in mm."""
    return f"{1e6 * length:.4g} um" if length < 1e-3 else f"{1e3 * length:.4g} mm"
