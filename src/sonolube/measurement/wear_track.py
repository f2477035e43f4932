"""Wear of a disc from scans around its ring, and what vibration takes off it, with uncertainty."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.measurement.statistics.repeated_tests import mean_estimate, ratio_interval
from sonolube.metrics import wear_rate, wear_reduction
from sonolube.surfaces.grooves.groove import Groove, measure_groove
from sonolube.surfaces.height_map import HeightMap


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class WearTrack:
    """The worn volume of a ring.

    Parameters
    ----------
    wear_volume : float
        Volume below the unworn surface: mean section times circumference. [m3]
    wear_volume_uncertainty : float
        Standard error, from the scatter between scans. [m3]
    wear_volume_interval : tuple of float
        95 % confidence interval after Student, in m3.
    pile_up_volume : float
        Volume of ridges and projections, of the whole ring. [m3]
    wear_rate : float
        Worn volume per sliding distance. [m2]
    wear_rate_uncertainty : float
        Its standard error. [m2]
    wear_rate_interval : tuple of float
        95 % confidence interval, in m2.
    groove_diameter : float
        Diameter of the ring. [m]
    sliding_distance : float
        Distance slid on it. [m]
    cross_section_area : ndarray, shape (scans,)
        Area of the mean section in each scan, in m2.
    excluded_scans : tuple of str
        Scans that do not count, by their place, and why.
    """

    wear_volume: float
    wear_volume_uncertainty: float
    wear_volume_interval: tuple[float, float]
    pile_up_volume: float
    wear_rate: float
    wear_rate_uncertainty: float
    wear_rate_interval: tuple[float, float]
    groove_diameter: float
    sliding_distance: float
    cross_section_area: Floats
    excluded_scans: tuple[str, ...]

    @property
    def net_volume(self) -> float:
        """Volume that has left the disc, pile-up taken off. [m3]"""
        return self.wear_volume - self.pile_up_volume


@dataclass(frozen=True, kw_only=True, slots=True)
class WearReduction:
    """What vibration takes off the wear.

    Parameters
    ----------
    wear_reduction : float
        Share of the wear rate that is gone. []
    wear_reduction_uncertainty : float
        Its standard uncertainty. []
    interval : tuple of float
        95 % confidence interval after Fieller; infinite where wear without vibration may be none.
    between_specimens : bool
        Whether the uncertainty holds the scatter between specimens, or only that around single rings.
    """

    wear_reduction: float
    wear_reduction_uncertainty: float
    interval: tuple[float, float]
    between_specimens: bool


def measure_wear_track(scans: Iterable[HeightMap], *, groove_diameter: float, sliding_distance: float) -> WearTrack:
    """Measure the groove in scans around a ring.

    Parameters
    ----------
    scans : iterable of HeightMap
        As measured; eight in D. Read one at a time.
    groove_diameter : float
        Diameter of the ring. [m]
    sliding_distance : float
        Distance the pin slid on it. [m]

    Returns
    -------
    WearTrack

    Raises
    ------
    InvalidInput
        If fewer than two scans show a whole groove; the text says why.
    """
    grooves: list[Groove | str] = []
    for scan in scans:
        try:
            grooves.append(measure_groove(scan))
        except SonolubeError as refusal:
            grooves.append(str(refusal))
    return wear_track_from_grooves(grooves, groove_diameter=groove_diameter, sliding_distance=sliding_distance)


def wear_track_from_grooves(
    grooves: Sequence[Groove | str], *, groove_diameter: float, sliding_distance: float
) -> WearTrack:
    """Return the wear of a ring from the grooves of its scans.

    Parameters
    ----------
    grooves : sequence of Groove or str
        What each scan showed, or why it showed none.
    groove_diameter : float
        Diameter of the ring. [m]
    sliding_distance : float
        Distance the pin slid on it. [m]

    Returns
    -------
    WearTrack

    Raises
    ------
    InvalidInput
        If fewer than two scans show a whole groove; the text says why.

    Notes
    -----
    The volume of a ring is the area of its section times the circumference (Pappus). Scans without a groove, or with
    an edge outside the field, do not count: where wear is below what a scan can show, the mean is one of the scans
    that show it. Scatter between scans holds the uncertainty of each.

    References
    ----------
    .. [1] D 2.2 and 2.3.4; ASTM G99-17, 9.1.
    """
    require_positive(groove_diameter=groove_diameter, sliding_distance=sliding_distance)
    whole = [groove for groove in grooves if isinstance(groove, Groove) and groove.complete]
    excluded_scans = tuple(
        f"scan {place}: {groove if isinstance(groove, str) else groove.caveat}"
        for place, groove in enumerate(grooves, start=1)
        if isinstance(groove, str) or not groove.complete
    )
    if len(whole) < 2:
        reasons = "; ".join(excluded_scans) or "there are no more"
        raise InvalidInput(f"a ring needs two scans with a whole groove, got {len(whole)} ({reasons})")
    around = math.pi * groove_diameter
    area = np.array([groove.cross_section_area for groove in whole])
    piled_up = float(np.mean([groove.pile_up_volume / groove.track_length for groove in whole])) * around
    volume = mean_estimate(around * area)
    return WearTrack(
        wear_volume=volume.mean,
        wear_volume_uncertainty=volume.uncertainty,
        wear_volume_interval=(volume.lower, volume.upper),
        pile_up_volume=piled_up,
        wear_rate=float(wear_rate(wear_volume=volume.mean, sliding_distance=sliding_distance)),
        wear_rate_uncertainty=volume.uncertainty / sliding_distance,
        wear_rate_interval=(volume.lower / sliding_distance, volume.upper / sliding_distance),
        groove_diameter=groove_diameter,
        sliding_distance=sliding_distance,
        cross_section_area=area,
        excluded_scans=excluded_scans,
    )


def wear_reduction_between_tracks(without: Sequence[WearTrack], with_vibration: Sequence[WearTrack]) -> WearReduction:
    """Return the wear reduction between specimens run without and with vibration.

    Parameters
    ----------
    without : sequence of WearTrack
        One a specimen.
    with_vibration : sequence of WearTrack
        One a specimen.

    Returns
    -------
    WearReduction

    Raises
    ------
    InvalidInput
        If either is empty, or the mean wear rate without vibration is not positive.

    Notes
    -----
    Two specimens or more on each side give the scatter between specimens; otherwise it is that between the scans of
    the rings, which says nothing of another specimen. The standard uncertainty takes the relative errors of both mean
    rates in squares, the interval is that of `ratio_interval`.

    References
    ----------
    .. [1] D 2.3.
    """
    if not without or not with_vibration:
        raise InvalidInput("wear reduction needs a ring worn without vibration and one worn with it")
    between = min(len(without), len(with_vibration)) >= 2
    off, on = (_tests(rings, between) for rings in (without, with_vibration))
    ratio = ratio_interval(on, off)
    errors = [estimate.uncertainty / estimate.mean for estimate in (mean_estimate(off), mean_estimate(on))]
    return WearReduction(
        wear_reduction=float(wear_reduction(intrinsic_wear_rate=off.mean(), reduced_wear_rate=on.mean())),
        wear_reduction_uncertainty=abs(ratio.ratio) * math.hypot(*errors),
        interval=(1 - ratio.upper, 1 - ratio.lower),
        between_specimens=between,
    )


def _tests(rings: Sequence[WearTrack], between: bool) -> Floats:
    """Return the wear rate of each specimen, or of each scan, in m2."""
    if between:
        return np.array([ring.wear_rate for ring in rings])
    return np.concatenate(
        [math.pi * ring.groove_diameter / ring.sliding_distance * ring.cross_section_area for ring in rings]
    )
