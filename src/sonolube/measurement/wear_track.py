"""Wear volume and wear rate of a wear track from scans around it, and wear reduction by vibration, with uncertainty."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.facts.metrics import wear_rate, wear_reduction
from sonolube.measurement.statistics.repeated_tests import mean_estimate, ratio_interval
from sonolube.models.surfaces.grooves.groove import Groove, measure_groove
from sonolube.models.surfaces.height_map import HeightMap


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class WearTrack:
    """Wear volume and wear rate of a circular wear track.

    Parameters
    ----------
    wear_volume : float
        Volume below the unworn surface: mean cross-section area times circumference. [m3]
    wear_volume_uncertainty : float
        Standard error, from the scatter between scans. [m3]
    wear_volume_interval : tuple of float
        Student's 95 % confidence interval, in m3.
    pile_up_volume : float
        Volume of ridges and projections of the whole track. [m3]
    wear_rate : float
        Wear volume per sliding distance. [m2]
    wear_rate_uncertainty : float
        Its standard error. [m2]
    wear_rate_interval : tuple of float
        95 % confidence interval, in m2.
    groove_diameter : float
        Diameter of the track. [m]
    sliding_distance : float
        Sliding distance on it. [m]
    cross_section_area : ndarray, shape (scans,)
        Area of the mean cross section of each scan. [m2]
    excluded_scans : tuple of str
        Scans that do not count, by their number, with the reason.
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
        """Wear volume less pile-up volume: volume removed from the disc. [m3]"""
        return self.wear_volume - self.pile_up_volume


@dataclass(frozen=True, kw_only=True, slots=True)
class WearReduction:
    """Wear reduction by vibration with its uncertainty and confidence interval.

    Parameters
    ----------
    wear_reduction : float
        Reduction relative to the intrinsic wear rate. []
    wear_reduction_uncertainty : float
        Its standard uncertainty. []
    interval : tuple of float
        Fieller's 95 % confidence interval; infinite where the wear rate without vibration may be zero.
    between_specimens : bool
        Whether the uncertainty includes the scatter between specimens, or only that between scans of single tracks.
    """

    wear_reduction: float
    wear_reduction_uncertainty: float
    interval: tuple[float, float]
    between_specimens: bool


def measure_wear_track(scans: Iterable[HeightMap], *, groove_diameter: float, sliding_distance: float) -> WearTrack:
    """Wear of a track from the grooves in scans around it.

    Parameters
    ----------
    scans : iterable of HeightMap
        As measured; eight in D. Processed one at a time.
    groove_diameter : float
        Diameter of the track. [m]
    sliding_distance : float
        Sliding distance of the pin on it. [m]

    Returns
    -------
    WearTrack

    Raises
    ------
    InvalidInput
        If fewer than two scans show a whole groove, with the reasons.

    See Also
    --------
    wear_track_from_grooves : from grooves that are already measured.
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
    r"""Wear of a track from the measured grooves of its scans.

    Parameters
    ----------
    grooves : sequence of Groove or str
        Groove of each scan, or the reason why it shows none.
    groove_diameter : float
        Diameter of the track. [m]
    sliding_distance : float
        Sliding distance of the pin on it. [m]

    Returns
    -------
    WearTrack

    Raises
    ------
    InvalidInput
        If fewer than two scans show a whole groove, with the reasons.

    Notes
    -----
    By Pappus's theorem, with the mean :math:`\bar A` of the cross-section areas and the diameter :math:`D_g`,

    .. math:: V = \pi D_g \bar A , \qquad W = \frac{V}{D} \qquad \text{(D 2.2)} .

    Scans without a groove, or with an edge outside the field, do not count: where the wear is below the resolution of a
    scan, the mean is that of the scans that show it. The scatter between scans includes the uncertainty of each.

    References
    ----------
    .. [1] D 2.2 and 2.3.4; ASTM G99-17, 9.1.
    """
    require_positive(groove_diameter=groove_diameter, sliding_distance=sliding_distance)
    whole = [groove for groove in grooves if isinstance(groove, Groove) and groove.complete]
    excluded_scans = tuple(
        f"scan {number}: {groove if isinstance(groove, str) else groove.caveat}"
        for number, groove in enumerate(grooves, start=1)
        if isinstance(groove, str) or not groove.complete
    )
    if len(whole) < 2:
        reasons = "; ".join(excluded_scans) or "there are no more"
        raise InvalidInput(f"a wear track needs two scans with a whole groove, got {len(whole)} ({reasons})")
    circumference = math.pi * groove_diameter
    area = np.array([groove.cross_section_area for groove in whole])
    pile_up = float(np.mean([groove.pile_up_volume / groove.track_length for groove in whole])) * circumference
    volume = mean_estimate(circumference * area)
    return WearTrack(
        wear_volume=volume.mean,
        wear_volume_uncertainty=volume.uncertainty,
        wear_volume_interval=(volume.lower, volume.upper),
        pile_up_volume=pile_up,
        wear_rate=float(wear_rate(wear_volume=volume.mean, sliding_distance=sliding_distance)),
        wear_rate_uncertainty=volume.uncertainty / sliding_distance,
        wear_rate_interval=(volume.lower / sliding_distance, volume.upper / sliding_distance),
        groove_diameter=groove_diameter,
        sliding_distance=sliding_distance,
        cross_section_area=area,
        excluded_scans=excluded_scans,
    )


def wear_reduction_between_tracks(without: Sequence[WearTrack], with_vibration: Sequence[WearTrack]) -> WearReduction:
    r"""Wear reduction between tracks worn without and with vibration, with Fieller's interval.

    Parameters
    ----------
    without : sequence of WearTrack
        One per specimen.
    with_vibration : sequence of WearTrack
        One per specimen.

    Returns
    -------
    WearReduction

    Raises
    ------
    InvalidInput
        If either is empty, or the mean wear rate without vibration is not positive.

    See Also
    --------
    ratio_interval : Fieller's interval of a ratio of means.

    Notes
    -----
    Two specimens or more on each side give the scatter between specimens; otherwise it is that between the scans of
    the tracks, which does not extend to other specimens. With the mean rates and their standard errors,

    .. math::

        P_w = 1 - \frac{W_1}{W_0} \quad \text{(D 2.3)} , \qquad
        u_P = \frac{W_1}{W_0} \sqrt{\left( \frac{u_0}{W_0} \right)^2 + \left( \frac{u_1}{W_1} \right)^2} .

    References
    ----------
    .. [1] D 2.3.
    """
    if not without or not with_vibration:
        raise InvalidInput("wear reduction needs a track worn without vibration and one worn with it")
    between = min(len(without), len(with_vibration)) >= 2
    off, on = (_wear_rates(tracks, between) for tracks in (without, with_vibration))
    ratio = ratio_interval(on, off)
    relative_errors = [estimate.uncertainty / estimate.mean for estimate in (mean_estimate(off), mean_estimate(on))]
    return WearReduction(
        wear_reduction=float(wear_reduction(intrinsic_wear_rate=off.mean(), reduced_wear_rate=on.mean())),
        wear_reduction_uncertainty=abs(ratio.ratio) * math.hypot(*relative_errors),
        interval=(1 - ratio.upper, 1 - ratio.lower),
        between_specimens=between,
    )


def _wear_rates(tracks: Sequence[WearTrack], between: bool) -> Floats:
    """Wear rate of each specimen, or of each scan, in m2."""
    if between:
        return np.array([track.wear_rate for track in tracks])
    return np.concatenate(
        [math.pi * track.groove_diameter / track.sliding_distance * track.cross_section_area for track in tracks]
    )
