"""What a drive switched on from rest ends in: marched until transients are gone, named, and recorded."""

import math
from dataclasses import dataclass
from functools import partial

import numpy as np

from sonolube.checks import Floats
from sonolube.dynamics.attractor import Attractors, describe
from sonolube.dynamics.first_order_modes import state_pairs
from sonolube.dynamics.gap_law import GapLaw, TabulatedGap
from sonolube.dynamics.linear import poles
from sonolube.dynamics.structure import Structure, with_contact_spring
from sonolube.dynamics.time_marching.integrator import fewest_steps
from sonolube.dynamics.time_marching.records import Trajectories, Trajectory
from sonolube.dynamics.transient import AT_ONCE, march, trajectory
from sonolube.dynamics.waveform import StartUpRamp, Waveform
from sonolube.errors import InvalidInput

_DECAYS = 12.0  # of the slowest small motion, after which a transient is 6e-6 of itself
_FEWEST, _MOST = 256, 200_000  # periods to march
_COARSEST, _FINEST = 16, 1024  # steps a period to try
_RECORDED = 128  # steps a period recorded at least
_MOST_STEPS = 20_000_000  # to march, which take seconds
_MOST_STEPS = 2**23  # marched with steps that follow, which take seconds
_TABLE_COSTS = 8  # times as much a step as a force with a formula
_MOST_RECORDED = 2**19  # steps
_PATIENCE = 40  # times to march on where the motion still changes
_GROWS, _SHRINKS = 1.02, 0.7  # ratios of the spread of strobed instants beyond which a motion still changes
_AT_REST = 1e-7  # spread over the peak-to-peak displacement below which it is nothing but rounding
_BEATS = 10  # recorded of a motion that does not repeat
_LONGEST = 4096  # periods watched or recorded at most
_STILL = 1e-9  # decay rate over frequency of a motion below which rounding made it


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Attained:
    """The motion that a point ends in.

    Parameters
    ----------
    attractor : Attractors
        What it is, of one point.
    marched_time : float
        How long it was marched before it was looked at, in s.
    steps_per_period : int
        Steps of the record.
    record : Trajectory
        Each step of one repetition, or of ten beats and 256 periods at least of a motion without one; it starts
        at phase zero, and the last instant belongs to what follows.
    amplitudes : ndarray, shape (periods,)
        Half of the displacement from peak to peak in each period of the record, in m.
    dissipated_power : float
        Mean power that dampers and contact turn to heat. [W]
    settled : bool
        Whether it was marched for as long as small motions take to die out.
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
        """Periods of the drive in the record."""
        return int(self.amplitudes.size)


def settling_periods(structure: Structure, gap_law: GapLaw, *, normal_load: float, frequency: float) -> int:
    """Return the periods of the drive in which small motions about rest have died out.

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
    Under the exponential law the mean stiffness of a contact that carries its dead load is that at rest, whatever the
    vibration: slow motions decay beside it as they do about rest.
    """
    stiffness = float(gap_law.stiffness(np.zeros(1), normal_load)[0])
    rates = -poles(with_contact_spring(structure, normal_stiffness=stiffness)).real
    slowest = min((float(rate) for rate in rates if rate > _STILL * frequency), default=math.inf)
    return int(np.clip(math.ceil(_DECAYS * frequency / slowest), _FEWEST, _MOST))


def attained_motion(
    structure: Structure,
    gap_law: GapLaw,
    *,
    normal_load: float,
    frequency: float,
    voltage_peak_to_peak: float,
    voltage_offset: float = 0.0,
    waveform: Waveform | None = None,
    ramp: StartUpRamp = AT_ONCE,
) -> Attained:
    """March one point from rest until its transients are gone, and say what it does then.

    Parameters
    ----------
    structure : Structure
    gap_law : GapLaw
    normal_load : float
        Dead load. [N]
    frequency : float
        Frequency of the drive. [Hz]
    voltage_peak_to_peak : float
        Drive voltage, peak to peak. [V]
    voltage_offset : float
        Its mean. [V]
    waveform : Waveform or None
        Shape of the voltage; a sine if None.
    ramp : StartUpRamp
        How voltage and offset come up, which decides where several motions are possible.

    Returns
    -------
    Attained

    Raises
    ------
    InvalidInput
        As `march` does, or if the march runs away even at 1024 steps a period.

    Notes
    -----
    Steps are halved until they follow the contact, or 1024 a period do not, which the attractor's description then
    tells. A motion whose instants, seen once a period, still draw apart or together is marched on, forty times at most:
    what leaves an unstable vibration can take long to show. Some 8 million steps are all that it gets, a million on a
    table: where these are fewer than transients need, `settled` is false.
    """
    settling = settling_periods(structure, gap_law, normal_load=normal_load, frequency=frequency)
    watched = _sixteens(settling / _DECAYS)  # a decay time holds several turns of a motion that is hardly damped
    go = partial(
        march,
        structure,
        gap_law,
        normal_load=normal_load,
        frequency=frequency,
        voltage_peak_to_peak=voltage_peak_to_peak,
        voltage_offset=voltage_offset,
        waveform=waveform,
        strobed_periods=settling,
    )
    most = _MOST_STEPS // (_TABLE_COSTS if isinstance(gap_law, TabulatedGap) else 1)
    rising, steps = math.ceil(ramp.duration * frequency), _first_steps(structure, frequency)
    if rising * steps > most:
        raise InvalidInput(f"a ramp of {ramp.duration:g} s is {rising} periods of the drive, too many to march")
    with np.errstate(over="ignore", invalid="ignore"):  # of steps too coarse to follow
        for periods in (rising + min(settling, _FEWEST), rising + settling):  # what runs away does so soon
            while True:
                periods = min(periods, most // steps)
                marched = go(periods=periods, ramp=ramp, steps_per_period=steps)
                if marched.status == "marched" or steps >= _FINEST:
                    break
                steps *= 2
    if marched.status == "diverged":
        raise InvalidInput(f"no motion to follow at {frequency:.6g} Hz under {normal_load:.4g} N: {marched.advice}")
    for _ in range(_PATIENCE):
        if (periods + settling) * steps > most:
            break
        earlier = marched
        marched = go(periods=settling, initial_state=earlier.final_state, steps_per_period=steps)
        periods += settling
        if not _changes(earlier, marched):
            break
    attractor = describe(
        structure,
        gap_law,
        normal_load=normal_load,
        frequency=frequency,
        voltage_peak_to_peak=voltage_peak_to_peak,
        voltage_offset=voltage_offset,
        waveform=waveform,
        initial_state=marched.final_state,
        periods=watched,
        steps_per_period=steps,
    )
    recorded = int(attractor.order) or _sixteens(_BEATS * _per_beat(attractor, frequency))
    finer = max(steps, _RECORDED)
    recorded = min(recorded, _MOST_RECORDED // finer)
    record = trajectory(
        structure,
        gap_law,
        normal_load=normal_load,
        frequency=frequency,
        voltage_peak_to_peak=voltage_peak_to_peak,
        voltage_offset=voltage_offset,
        waveform=waveform,
        initial_state=attractor.state,
        periods=recorded,
        steps_per_period=finer,
    )
    each = record.contact.displacement[:-1].reshape(recorded, finer)
    return Attained(
        attractor=attractor,
        marched_time=periods / frequency,
        steps_per_period=finer,
        record=record,
        amplitudes=np.ptp(each, axis=1) / 2,
        dissipated_power=_dissipated(structure, gap_law, record, normal_load),
        settled=periods - rising >= settling,
    )


def _first_steps(structure: Structure, frequency: float) -> int:
    fewest = fewest_steps(state_pairs(structure), frequency=frequency)
    return int(min(_COARSEST * 2 ** max(math.ceil(math.log2(fewest / _COARSEST)), 0), _FINEST))


def _changes(earlier: Trajectories, later: Trajectories) -> bool:
    before, now = (float(np.std(each.strobed.displacement)) for each in (earlier, later))
    rounding = _AT_REST * float(np.ptp(later.last_periods.displacement))
    return max(before, now) > rounding and not _SHRINKS * before <= now <= _GROWS * before


def _sixteens(periods: float) -> int:
    return int(np.clip(16 * math.ceil(periods / 16), _FEWEST, _LONGEST))


def _per_beat(attractor: Attractors, frequency: float) -> float:
    slow = float(attractor.beat_frequency)
    return frequency / slow if slow > 0 else 0.0


def _dissipated(structure: Structure, gap_law: GapLaw, record: Trajectory, load: float) -> float:
    """Return the mean of v.C.v, and of what the contact takes by pushing less while it opens."""
    rates, contact = record.states.rates[:-1], record.contact
    dampers = np.einsum("ti,ij,tj->t", rates, structure.damping_matrix, rates)
    lag = (gap_law.force(contact.displacement, load) - contact.normal_force) * contact.velocity
    return float(np.mean(dampers) + np.mean(lag[:-1]))
