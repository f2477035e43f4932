"""Records of stick-slip in a friction force, and that of a part by those of its stretches."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from sonolube.checks import Floats


@dataclass(frozen=True, kw_only=True, slots=True)
class StickSlipBurst:
    """Time in which slips recur without interruption.

    Parameters
    ----------
    start_time : float
        Beginning of the stick phase before the first slip. [s]
    end_time : float
        Last slip. [s]
    force_drops : int
        Number of slips.
    """

    start_time: float
    end_time: float
    force_drops: int


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class StickSlipEstimate:
    """Stick-slip in a friction force: whether, how often, how much the force falls, and when.

    Parameters
    ----------
    detected : bool
        Whether sudden falls of the force recur more strongly than noise explains.
    resolved : bool
        Whether the sampling rate shows it: False where a line with fewer than six samples a period dominates the force,
        so that stick-slip is neither detected nor excluded.
    reason : str
        Why stick-slip was not detected, and up to which frequency it was sought; empty where it was.
    stick_slip_frequency : float
        Slips per time within the bursts; the frequency of the spectral peak where not detected. [Hz]
    spectral_frequency : float
        Frequency of the highest peak of the spectrum, in Hz.
    stick_slip_amplitude : float
        Mean fall of the force in a slip; 0 where not detected. [N]
    stick_slip_amplitude_uncertainty : float
        Its standard error. [N]
    stick_slip_amplitude_interval : tuple of two float
        Its 95 % interval. [N]
    force_drops : int
        Number of slips found.
    stick_slip_fraction : float
        Share of the time in which slips recur. []
    bursts : tuple of StickSlipBurst
        When they do.
    slip_time : ndarray, shape (force_drops,)
        Time of each slip, in s.
    """

    detected: bool = True
    resolved: bool = True
    reason: str = ""
    stick_slip_frequency: float
    spectral_frequency: float
    stick_slip_amplitude: float = 0.0
    stick_slip_amplitude_uncertainty: float = 0.0
    stick_slip_amplitude_interval: tuple[float, float] = (0.0, 0.0)
    force_drops: int = 0
    stick_slip_fraction: float = 0.0
    bursts: tuple[StickSlipBurst, ...] = ()
    slip_time: Floats = field(default_factory=lambda: np.empty(0))


def not_detected(reason: str, spectral_frequency: float, *, resolved: bool = True) -> StickSlipEstimate:
    """Estimate for a signal without recurring falls, with the reason and the frequency of its spectrum."""
    return StickSlipEstimate(
        detected=False,
        resolved=resolved,
        reason=reason,
        stick_slip_frequency=spectral_frequency,
        spectral_frequency=spectral_frequency,
    )


def combined(estimates: Sequence[StickSlipEstimate], spans: Sequence[float]) -> StickSlipEstimate:
    """Estimate of a part by those of its stretches."""
    if not estimates:
        return not_detected("too few samples follow one another without a gap", 0.0)
    longest = estimates[int(np.argmax(spans))]
    found = [one for one in estimates if one.detected]
    if len(estimates) == 1 or not found:
        return next((one for one in estimates if not one.resolved), longest)
    drops = np.array([one.force_drops for one in found])
    weights = drops / drops.sum()
    ends = weights @ np.array([one.stick_slip_amplitude_interval for one in found])
    filled = sum(one.stick_slip_fraction * span for one, span in zip(estimates, spans, strict=True))
    return StickSlipEstimate(
        stick_slip_frequency=float(weights @ [one.stick_slip_frequency for one in found]),
        spectral_frequency=longest.spectral_frequency,
        stick_slip_amplitude=float(weights @ [one.stick_slip_amplitude for one in found]),
        stick_slip_amplitude_uncertainty=float(
            np.sqrt(weights**2 @ np.square([one.stick_slip_amplitude_uncertainty for one in found]))
        ),
        stick_slip_amplitude_interval=(float(ends[0]), float(ends[1])),
        force_drops=int(drops.sum()),
        stick_slip_fraction=filled / sum(spans),
        bursts=tuple(burst for one in found for burst in one.bursts),
        slip_time=np.concatenate([one.slip_time for one in found]),
    )
