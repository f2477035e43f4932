"""Long-time response to a drive switched on from rest: marched until transients decay, classified and recorded."""

import math
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.models.dynamics.attractor import Attractors, classify_attractor
from sonolube.models.dynamics.gap_laws.closed_form import GapLaw
from sonolube.models.dynamics.kernels.contact_kernel import TABULATED
from sonolube.models.dynamics.linear import first_order_modes, poles
from sonolube.models.dynamics.motions import Trajectories, Trajectory
from sonolube.models.dynamics.structure import Structure, with_contact_spring
from sonolube.models.dynamics.time_marching.integrator import minimum_steps
from sonolube.models.dynamics.transient import NO_RAMP, march, trajectory
from sonolube.models.dynamics.waveform import StartUpRamp, Waveform

_DECAY_TIMES = 12.0  # of the slowest small motion, after which a transient has decayed to 6e-6
_MIN_PERIODS, _MAX_PERIODS = 256, 200_000  # of a transient
_MIN_STEPS, _MAX_STEPS_PER_PERIOD = 16, 1024  # steps per period to try
_RECORDED_STEPS = 128  # least number of recorded steps per period
_MAX_STEPS = 2**23  # to march with the final step, which take seconds
_TABLE_COST = 8  # of a step with a tabulated force over one with a formula
_MAX_RECORDED = 2**19  # steps
_MAX_CONTINUATIONS = 40  # marches to add while the motion still changes
_GROWING, _DECAYING = 1.02, 0.7  # ratios of the deviation of strobed samples beyond which a motion still changes
_ROUNDING = 1e-7  # deviation over the peak-to-peak displacement below which it is rounding
_BEATS = 10  # to record of a motion that does not repeat
_LONGEST = 4096  # periods to observe or to record, at most
_UNDAMPED = 1e-9  # decay rate over frequency below which a pole is undamped but for rounding


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class LongTimeResponse:
    """Long-time response of one point.

    Parameters
    ----------
    attractor : Attractors
        Classification of the motion.
    marched_time : float
        Time marched before the motion was classified, in s.
    steps_per_period : int
        Time steps per period of the record.
    record : Trajectory
        Every step of one repetition, or of ten beats and at least 256 periods of a motion that does not repeat; it
        starts at phase zero, and its last instant is the first one of the next repetition.
    amplitudes : ndarray, shape (periods,)
        Half of the peak-to-peak displacement in each period of the record, in m.
    dissipated_power : float
        Mean power dissipated by dampers and contact. [W]
    settled : bool
        Whether it was marched for as long as small motions take to decay.
    """

    attractor: Attractors
    marched_time: float
    steps_per_period: int
    record: Trajectory
    amplitudes: Floats
    dissipated_power: float
    settled: bool

    @property
    def periods(self) -> int:
        """Number of drive periods in the record."""
        return int(self.amplitudes.size)


def settling_periods(structure: Structure, gap_law: GapLaw, *, normal_load: float, frequency: float) -> int:
    r"""Number of drive periods in which small motions about equilibrium decay.

    Parameters
    ----------
    structure : Structure
    gap_law : GapLaw
    normal_load : float
        Dead load. [N]
    frequency : float
        Frequency of the drive. [Hz]

    Returns
    -------
    int
        Twelve decay times of the slowest motion, from 256 to 200 000 periods.

    Notes
    -----
    With the poles :math:`\lambda` of the structure on the linearised contact,

    .. math:: n = \frac{12 f}{\min(-\mathrm{Re}\,\lambda)} .

    Under the exponential law the mean stiffness of a contact that carries its dead load is that at equilibrium,
    whatever the vibration: slow motions decay during vibration as they do about equilibrium.
    """
    stiffness = float(gap_law.stiffness(np.zeros(1), normal_load)[0])
    rates = -poles(with_contact_spring(structure, normal_stiffness=stiffness)).real
    slowest = min((float(rate) for rate in rates if rate > _UNDAMPED * frequency), default=math.inf)
    return int(np.clip(math.ceil(_DECAY_TIMES * frequency / slowest), _MIN_PERIODS, _MAX_PERIODS))


def march_until_settled(
    structure: Structure,
    gap_law: GapLaw,
    *,
    normal_load: float,
    frequency: float,
    voltage_peak_to_peak: float,
    voltage_offset: float = 0.0,
    waveform: Waveform | None = None,
    ramp: StartUpRamp = NO_RAMP,
) -> LongTimeResponse:
    """Long-time response of one point: march it from rest until transients decay, then classify it.

    Parameters
    ----------
    structure : Structure
    gap_law : GapLaw
    normal_load : float
        Dead load. [N]
    frequency : float
        Frequency of the drive. [Hz]
    voltage_peak_to_peak : float
        Peak-to-peak drive voltage. [V]
    voltage_offset : float
        Mean drive voltage. [V]
    waveform : Waveform or None
        Waveform of the voltage; a sine if None.
    ramp : StartUpRamp
        Ramp of amplitude and offset of the voltage, which decides where several motions coexist.

    Returns
    -------
    LongTimeResponse

    Raises
    ------
    InvalidInput
        As `march`, or if the solution diverges even with 1024 steps per period.

    See Also
    --------
    classify_attractor, march

    Notes
    -----
    The step is halved until it resolves the contact, up to 1024 steps per period; if these are too coarse, the
    attractor's description states so. A motion whose Poincare samples still diverge or converge is marched on, forty
    times at most, since the departure from an unstable vibration can be slow. At most 8 million steps are marched, one
    million with a tabulated contact law: where these are fewer than the transient requires, `settled` is false.
    """
    settling = settling_periods(structure, gap_law, normal_load=normal_load, frequency=frequency)
    # a decay time holds several cycles of a weakly damped mode
    observed = _multiple_of_sixteen(settling / _DECAY_TIMES)
    point: dict[str, Any] = {
        "normal_load": normal_load,
        "frequency": frequency,
        "voltage_peak_to_peak": voltage_peak_to_peak,
        "voltage_offset": voltage_offset,
        "waveform": waveform,
    }
    run = partial(march, structure, gap_law, **point, strobed_periods=settling)
    most = _MAX_STEPS // (_TABLE_COST if gap_law.kind == TABULATED else 1)
    ramped, steps = math.ceil(ramp.duration * frequency), _first_steps(structure, frequency)
    if ramped * steps > most:
        raise InvalidInput(f"a ramp of {ramp.duration:g} s is {ramped} periods of the drive, too many to march")
    with np.errstate(over="ignore", invalid="ignore"):  # of coarse steps that diverge
        for periods in (ramped + min(settling, _MIN_PERIODS), ramped + settling):  # divergence occurs early
            while True:
                periods = min(periods, most // steps)
                marched = run(periods=periods, ramp=ramp, steps_per_period=steps)
                if marched.status == "marched" or steps >= _MAX_STEPS_PER_PERIOD:
                    break
                steps *= 2
    if marched.status == "diverged":
        raise InvalidInput(f"the march diverged at {frequency:.6g} Hz under {normal_load:.4g} N: {marched.advice}")
    for _ in range(_MAX_CONTINUATIONS):
        if (periods + settling) * steps > most:
            break
        earlier = marched
        marched = run(periods=settling, initial_state=earlier.final_state, steps_per_period=steps)
        periods += settling
        if not _changes(earlier, marched):
            break
    attractor = classify_attractor(
        structure, gap_law, **point, initial_state=marched.final_state, periods=observed, steps_per_period=steps
    )
    slow = float(attractor.beat_frequency)
    recorded = int(attractor.order) or _multiple_of_sixteen(_BEATS * (frequency / slow) if slow > 0 else 0.0)
    finer = max(steps, _RECORDED_STEPS)
    recorded = min(recorded, _MAX_RECORDED // finer)
    record = trajectory(
        structure, gap_law, **point, initial_state=attractor.final_state, periods=recorded, steps_per_period=finer
    )
    each = record.contact.displacement[:-1].reshape(recorded, finer)
    return LongTimeResponse(
        attractor=attractor,
        marched_time=periods / frequency,
        steps_per_period=finer,
        record=record,
        amplitudes=np.ptp(each, axis=1) / 2,
        dissipated_power=_dissipated_power(structure, gap_law, record, normal_load),
        settled=periods - ramped >= settling,
    )


def _first_steps(structure: Structure, frequency: float) -> int:
    """Number of steps per period to try first: 16 times a power of two."""
    fewest = minimum_steps(first_order_modes(structure), frequency=frequency)
    doublings = max(math.ceil(math.log2(fewest / _MIN_STEPS)), 0)
    return int(min(_MIN_STEPS * 2**doublings, _MAX_STEPS_PER_PERIOD))


def _changes(earlier: Trajectories, later: Trajectories) -> bool:
    """Whether the deviation of the strobed samples still grows or decays from one march to the next."""
    before, now = (float(np.std(each.strobed.displacement)) for each in (earlier, later))
    rounding = _ROUNDING * float(np.ptp(later.last_periods.displacement))
    return max(before, now) > rounding and not _DECAYING * before <= now <= _GROWING * before


def _multiple_of_sixteen(periods: float) -> int:
    """Number of periods rounded up to a multiple of 16, from 256 to 4096."""
    return int(np.clip(16 * math.ceil(periods / 16), _MIN_PERIODS, _LONGEST))


def _dissipated_power(structure: Structure, gap_law: GapLaw, record: Trajectory, load: float) -> float:
    r"""Mean power dissipated by dampers and contact, in W.

    Notes
    -----
    .. math:: P = \left\langle \dot x^T C \dot x \right\rangle + \left\langle (F - F_n)\,v \right\rangle
    """
    velocities, contact = record.states.velocities[:-1], record.contact
    dampers = np.einsum("ti,ij,tj->t", velocities, structure.damping_matrix, velocities)
    damping_power = (gap_law.force(contact.displacement, load) - contact.normal_force) * contact.velocity
    return float(np.mean(dampers) + np.mean(damping_power[:-1]))
