"""Roughness from a finish: a process, an ISO grade, Ra or Rz; and the summits that are typical of a height."""

import math
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files
from typing import Any

from sonolube.checks import require_positive
from sonolube.errors import InvalidInput, UnknownName


@dataclass(frozen=True, kw_only=True, slots=True)
class SurfaceFinish:
    """Range of the arithmetic mean roughness of a finish.

    Parameters
    ----------
    name : str
        Its identifier, such as "ground", "N6" or "ground N6".
    title : str
        Its name in prose.
    roughness_average_low, roughness_average_high : float
        Range of the arithmetic mean roughness Ra. [m]
    source : str
        Table from which it was read.
    note : str
        Further remarks, such as a grade that the process does not give.
    """

    name: str
    title: str
    roughness_average_low: float
    roughness_average_high: float
    source: str
    note: str = ""

    @property
    def arithmetic_mean_height(self) -> float:
        """Geometric mean of the range. [m]"""
        return math.sqrt(self.roughness_average_low * self.roughness_average_high)


@dataclass(frozen=True, kw_only=True, slots=True)
class RmsHeightEstimate:
    """Root-mean-square height estimated from another roughness parameter, with the range of the relation.

    Parameters
    ----------
    rms_height : float
        Estimate of Rq. [m]
    low, high : float
        Range of Rq over finishing processes, in metres.
    source : str
        Source of the relation and of its range.
    """

    rms_height: float
    low: float
    high: float
    source: str


@dataclass(frozen=True, kw_only=True, slots=True)
class TypicalSummits:
    """Summits of a finished surface of which only the height is known.

    Parameters
    ----------
    summit_radius : float
        Median of the mean radius of asperity summits. [m]
    summit_density : float
        Median of the areal density of asperity summits. [1/m2]
    radius_factor, density_factor : float
        Factors of the median, up and down, within which about 95 of 100 such surfaces lie: two standard deviations of
        a lognormal distribution.
    reason : str
        Why the factors are as wide as they are.
    """

    summit_radius: float
    summit_density: float
    radius_factor: float
    density_factor: float
    reason: str


def surface_finish(text: str) -> SurfaceFinish:
    """Range of roughness of a finish in words.

    Parameters
    ----------
    text : str
        A process such as "ground", a roughness grade of ISO 1302 such as "N6", or both, "ground N6", where the grade
        gives the roughness.

    Returns
    -------
    SurfaceFinish

    Raises
    ------
    UnknownName
        If it is neither a process nor a grade, with the closest name.
    InvalidInput
        If it is empty, or has two grades.

    Examples
    --------
    >>> from sonolube.models.surfaces import surface_finish
    >>> from sonolube.text.units import format_si
    >>> finish = surface_finish("N6")
    >>> format_si(finish.roughness_average_low, "m"), format_si(finish.roughness_average_high, "m")
    ('400 nm', '800 nm')
    """
    words = text.split()
    grades = [word.upper() for word in words if word.upper() in _grades()]
    process = "_".join(word.lower().replace("-", "_") for word in words if word.upper() not in _grades())
    if len(grades) > 1 or not (grades or process):
        raise InvalidInput(f'surface finish must be a process, a grade, or both, such as "ground N6"; got {text!r}')
    if process and process not in _processes():
        raise UnknownName.among(surface_finish_names(), kind="surface finish", name=process)
    if not grades:
        return _processes()[process]
    grade = _grades()[grades[0]]
    return _graded(_processes()[process], grade) if process else grade


def surface_finish_names() -> tuple[str, ...]:
    """Names of the processes in alphabetical order, then the grades from fine to rough."""
    return (*sorted({each.name for each in _processes().values()}), *_grades())


def rms_height_from_roughness_average(*, arithmetic_mean_height: float) -> RmsHeightEstimate:
    r"""Root-mean-square height from the arithmetic mean roughness of a surface of Gaussian heights.

    Parameters
    ----------
    arithmetic_mean_height : float
        Ra, also called roughness average. [m]

    Returns
    -------
    RmsHeightEstimate

    Raises
    ------
    InvalidInput
        If the roughness is not positive and finite.

    Notes
    -----
    .. math:: R_q = \sqrt{\pi/2}\,R_a

    for Gaussian heights, :math:`\pi/(2\sqrt2) = 1.11` for a sine, and more for heights with rare deep scratches.

    Examples
    --------
    >>> from sonolube.models.surfaces import rms_height_from_roughness_average
    >>> from sonolube.text.units import format_si
    >>> format_si(rms_height_from_roughness_average(arithmetic_mean_height=0.4e-6).rms_height, "m")
    '501 nm'
    """
    height = float(require_positive(arithmetic_mean_height=arithmetic_mean_height))
    least, typical, largest = _RMS_PER_AVERAGE
    return RmsHeightEstimate(
        rms_height=typical * height,
        low=least * height,
        high=largest * height,
        source=_content()["sources"]["rms_per_average"],
    )


def rms_height_from_maximum_height(*, mean_section_height: float) -> RmsHeightEstimate:
    """Root-mean-square height from the maximum height of a section, by the ratio that is usual on finished surfaces.

    Parameters
    ----------
    mean_section_height : float
        Rz: height from the deepest pit to the highest peak of a section, mean over the sections. [m]

    Returns
    -------
    RmsHeightEstimate

    Raises
    ------
    InvalidInput
        If the height is not positive and finite.
    """
    height = float(require_positive(mean_section_height=mean_section_height))
    least, typical, largest = _MAXIMUM_PER_RMS
    return RmsHeightEstimate(
        rms_height=height / typical,
        low=height / largest,
        high=height / least,
        source=_content()["sources"]["maximum_per_rms"],
    )


def typical_summits(*, rms_height: float) -> TypicalSummits:
    r"""Likely radius and density of the summits of a finished surface of which only the rms height is known.

    Parameters
    ----------
    rms_height : float
        Root-mean-square height of the surface, Rq. [m]

    Returns
    -------
    TypicalSummits

    Raises
    ------
    InvalidInput
        If the height is not positive and finite.

    See Also
    --------
    sonolube.models.surfaces.asperities.contact_roughness : The same from a height map.

    Notes
    -----
    The mean absolute slope of a profile is taken from the height as :math:`m = 0.125\,(R_q/\mathrm{\mu m})^{0.402}`,
    one of the correlations that [2]_ reviews (coefficients from memory); the others give 0.6 to 1.2 times as much at
    1 um. With the variance of slopes :math:`m_2 = \pi m^2/2` and a roughness parameter
    :math:`\beta = \eta R_q R_s = 0.04`, from 0.03 to 0.05 for most surfaces, the isotropic Gaussian surface [1]_ has

    .. math:: \alpha = \left(16 \sqrt{3\pi}\,\beta\right)^2 , \qquad
        R_s = \frac38 \sqrt{\frac{\pi}{\alpha}}\, \frac{R_q}{m_2} , \qquad
        \eta = \frac{\beta}{R_q R_s} ,

    at a sampling interval near 1 um. The factors hold for scanned surfaces of five instruments; the dissertation prints
    1.5 um and 4.7e10 1/m2 at 6 um, far outside.

    References
    ----------
    .. [1] P. R. Nayak, J. Lubr. Technol. 93, 398 (1971). doi:10.1115/1.3451608
    .. [2] M. Bahrami, J. R. Culham, M. M. Yovanovich and G. E. Schneider, Appl. Mech. Rev. 59, 1 (2006).
        doi:10.1115/1.2110231
    """
    height = float(require_positive(rms_height=rms_height))
    slope_variance = math.pi / 2 * (_MEAN_SLOPE * (height / 1e-6) ** _SLOPE_EXPONENT) ** 2
    bandwidth = (16 * math.sqrt(3 * math.pi) * _ROUGHNESS_PARAMETER) ** 2
    radius = 3 / 8 * math.sqrt(math.pi / bandwidth) * height / slope_variance
    polished = height < _POLISHED
    factor = 30.0 if polished else 5.0
    return TypicalSummits(
        summit_radius=radius,
        summit_density=_ROUGHNESS_PARAMETER / (height * radius),
        radius_factor=factor,
        density_factor=factor,
        reason=_content()["summits"]["polished" if polished else "finished"],
    )


# least, typical and largest ratio
_RMS_PER_AVERAGE = (1.04, math.sqrt(math.pi / 2), 1.43)
_MAXIMUM_PER_RMS = (2 * math.sqrt(2), 4.5, 6.4)
# mean absolute slope of profiles at an rms height of 1 um, its exponent, and the summits of Gaussian surfaces
_MEAN_SLOPE, _SLOPE_EXPONENT = 0.125, 0.402
_ROUGHNESS_PARAMETER = 0.04
_POLISHED = 0.05e-6


def _graded(process: SurfaceFinish, grade: SurfaceFinish) -> SurfaceFinish:
    """Finish of a process held to a grade, with a note where the process does not give it."""
    apart = (
        grade.roughness_average_high < process.roughness_average_low
        or grade.roughness_average_low > process.roughness_average_high
    )
    low, high = 1e6 * process.roughness_average_low, 1e6 * process.roughness_average_high
    note = f"{process.title.lower()} surfaces have Ra {low:g} to {high:g} um in usual practice: check the grade"
    return replace(
        grade,
        name=f"{process.name} {grade.name}",
        title=f"{process.title}, grade {grade.name} of ISO 1302",
        note=note if apart else grade.note,
    )


@cache
def _content() -> Mapping[str, Any]:
    """Content of the file of finishes."""
    return tomllib.loads(files("sonolube.models.surfaces").joinpath("finishes.toml").read_text(encoding="utf-8"))


@cache
def _grades() -> Mapping[str, SurfaceFinish]:
    """Grades of ISO 1302 by name, each from half its limit to its limit."""
    content = _content()
    return {
        name: SurfaceFinish(
            name=name,
            title=f"Grade {name} of ISO 1302",
            roughness_average_low=limit / 2,
            roughness_average_high=limit,
            source=content["sources"]["iso_1302"],
            note="the grade is the upper limit; a surface below half of it has the next finer grade",
        )
        for name, limit in content["grades"].items()
    }


@cache
def _processes() -> Mapping[str, SurfaceFinish]:
    """Processes by name and alias."""
    content = _content()
    return {
        re.sub(r"[\s-]+", "_", each): SurfaceFinish(
            name=name,
            title=entry["title"],
            roughness_average_low=entry["low"],
            roughness_average_high=entry["high"],
            source=content["sources"][entry["source"]],
            note=entry.get("note", ""),
        )
        for name, entry in content["processes"].items()
        for each in (name, *entry.get("aliases", ()))
    }
