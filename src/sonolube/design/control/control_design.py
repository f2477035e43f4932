"""A friction controller for a rig, from its map to its margins, and how it fares."""

from dataclasses import dataclass, field, replace

import numpy as np

from sonolube.checks import Floats, require_positive
from sonolube.design.control.amplifier import Amplifier, largest_swing, limiting
from sonolube.design.control.closed_loop import ControlRun, Disturbance, Drift, FrictionLoop, closed_loop
from sonolube.design.control.controller import FrictionController, designed_controller
from sonolube.design.control.friction_map import FrictionMap, efficiency_map, friction_at, modelled_map, voltage_for
from sonolube.design.control.process import Margins, Process, loop_margins
from sonolube.design.control.step_response import ControlEnergy, StepResponse, control_energy, step_response
from sonolube.design.control.tracking import FrequencyTracker, designed_tracker
from sonolube.design.control.vibration import VibrationMode, driven_mode, mode_admittance
from sonolube.errors import InvalidInput, OutsideRange, UnknownName
from sonolube.metrics import EfficiencyLine
from sonolube.rig import Rig

FEED_FORWARD = ("model", "efficiency", "none")
"""What a controller may look its voltages up in: the rig's model, an efficiency line, or only the ends of the map."""

_SLOPE = 0.01  # of the highest voltage, over which slopes are taken
_FIRST, _SECOND = 0.1, 0.55  # of the duration, when the reference steps
_MOST_SAMPLES = 500_000


@dataclass(frozen=True, kw_only=True, slots=True)
class ControlSettings:
    """What is asked of a friction controller, and what it has to put up with.

    Parameters
    ----------
    friction_force : float or None
        Friction wanted; half way between most and least where it is None. [N]
    amplifier : Amplifier
    dead_time : float
        Delay of the friction measurement. [s]
    sample_interval : float
        Time between decisions. [s]
    closed_loop_time : float or None
        Time constant wanted of the closed loop; as the tuning rule advises where it is None. [s]
    feed_forward : str
        One of `FEED_FORWARD`.
    tracking : bool
        Whether the drive follows the resonance.
    duration : float
        How long to run. [s]
    disturbance : Disturbance
    drift : Drift
    """

    amplifier: Amplifier
    friction_force: float | None = None
    dead_time: float = 1e-3
    sample_interval: float = 2e-4
    closed_loop_time: float | None = None
    feed_forward: str = "model"
    tracking: bool = True
    duration: float = 0.2
    disturbance: Disturbance = field(default_factory=Disturbance)
    drift: Drift = field(default_factory=Drift)

    def __post_init__(self) -> None:
        require_positive(duration=self.duration, sample_interval=self.sample_interval)
        if self.feed_forward not in FEED_FORWARD:
            raise UnknownName.among(FEED_FORWARD, kind="feed-forward", name=self.feed_forward)
        if not 20 <= self.duration / self.sample_interval <= _MOST_SAMPLES:
            raise InvalidInput(
                f"duration {self.duration:g} s makes {self.duration / self.sample_interval:.3g} intervals of"
                f" {self.sample_interval:g} s; take one that makes 20 to {_MOST_SAMPLES}"
            )


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ControlStudy:
    """A friction controller for a rig and how it fares.

    Parameters
    ----------
    plant : FrictionMap
        Friction over voltage by the rig's model.
    mode : VibrationMode
    controller : FrictionController
    tracker : FrequencyTracker or None
    loop_gain : float
        Real change of friction per change that the controller expects, at the friction wanted. []
    margins : Margins
        With that gain.
    friction_force : float
        Friction wanted. [N]
    voltage_maximum : float
        Largest swing that the amplifier keeps up. [V]
    limit : str
        Which of its limits decides that.
    run : ControlRun
        Friction is wanted at a tenth of the duration; a little after its half, half of the reduction.
    untracked : ControlRun or None
        The same with the frequency fixed, where the resonance drifts and the drive follows it.
    response : StepResponse
        To the first step.
    energy : ControlEnergy
    """

    plant: FrictionMap
    mode: VibrationMode
    controller: FrictionController
    tracker: FrequencyTracker | None
    loop_gain: float
    margins: Margins
    friction_force: float
    voltage_maximum: float
    limit: str
    run: ControlRun
    untracked: ControlRun | None
    response: StepResponse
    energy: ControlEnergy


def control_study(
    rig: Rig, settings: ControlSettings, *, mode: VibrationMode | None = None, line: EfficiencyLine | None = None
) -> ControlStudy:
    """Return a friction controller tuned for a rig, and a run of it.

    Parameters
    ----------
    rig : Rig
        With a drive voltage.
    settings : ControlSettings
    mode : VibrationMode, optional
        The resonance that the drive uses; that of the rig's structure where absent.
    line : EfficiencyLine, optional
        For feed-forward from efficiency.

    Returns
    -------
    ControlStudy

    Raises
    ------
    InvalidInput
        If the rig lacks what the model needs, the phase cannot be tracked, or the line is missing.
    OutsideRange
        If the friction wanted is out of reach.
    """
    driven = driven_mode(rig) if mode is None else mode
    admittance = mode_admittance(driven, frequency=driven.frequency)
    swing = largest_swing(settings.amplifier, admittance=admittance, frequency=driven.frequency)
    plant = modelled_map(rig, voltage_maximum=swing)
    wanted = settings.friction_force
    if wanted is None:
        wanted = 0.5 * (plant.highest_force + plant.lowest_force)
    voltage_for(plant, friction_force=wanted)
    controller = designed_controller(
        _looked_up(rig, plant, settings, line, swing),
        Process(
            time_constant=driven.time_constant,
            dead_time=settings.dead_time,
            sample_interval=settings.sample_interval,
        ),
        voltage_maximum=swing,
        closed_loop_time=settings.closed_loop_time,
        feed_forward=settings.feed_forward != "none",
    )
    tracker = designed_tracker(driven, sample_interval=settings.sample_interval) if settings.tracking else None
    loop = FrictionLoop(plant=plant, mode=driven, controller=controller, tracker=tracker, voltage_maximum=swing)
    reference = _reference(settings, plant.highest_force, wanted)
    run = closed_loop(loop, reference=reference, drift=settings.drift, disturbance=settings.disturbance)
    untracked = None
    if tracker is not None and settings.drift.final_temperature_rise:
        fixed = replace(loop, tracker=None)
        untracked = closed_loop(fixed, reference=reference, drift=settings.drift, disturbance=settings.disturbance)
    gain = _loop_gain(plant, controller, wanted, settings.disturbance.friction_factor)
    gains = replace(controller.gains, proportional_gain=gain * controller.gains.proportional_gain)
    first = float(run.time[np.argmax(reference != reference[0])])
    return ControlStudy(
        plant=plant,
        mode=driven,
        controller=controller,
        tracker=tracker,
        loop_gain=gain,
        margins=loop_margins(controller.process, gains),
        friction_force=float(wanted),
        voltage_maximum=swing,
        limit=limiting(settings.amplifier, admittance=admittance, frequency=driven.frequency),
        run=run,
        untracked=untracked,
        response=step_response(run, start_time=first),
        energy=control_energy(rig, run),
    )


def _looked_up(
    rig: Rig, plant: FrictionMap, settings: ControlSettings, line: EfficiencyLine | None, swing: float
) -> FrictionMap:
    if settings.feed_forward != "efficiency":
        return plant
    if line is None:
        raise InvalidInput("feed-forward from efficiency needs an efficiency line, calibrated for the rig")
    return efficiency_map(rig, line, voltage_maximum=swing)


def _loop_gain(plant: FrictionMap, controller: FrictionController, wanted: float, factor: float) -> float:
    """Return the slope of real friction over that of the controller's table, at the voltage that the wanted takes."""
    reached = min(max(wanted / factor, plant.lowest_force), plant.highest_force)
    volts = float(voltage_for(plant, friction_force=reached))
    table = controller.voltage_peak_to_peak
    if volts >= table[-1] and table[-1] < plant.voltage_peak_to_peak[-1]:
        least = controller.intrinsic_friction_force - controller.saved_force[-1]
        raise OutsideRange(
            f"friction_force {wanted:.4g} N takes {volts:.4g} V by the rig's model, but the controller's table ends at"
            f" {table[-1]:.4g} V, where it expects {least:.4g} N: its efficiency is higher than the model's"
        )
    step = _SLOPE * plant.voltage_peak_to_peak[-1]
    ends = np.clip([volts - step, volts + step], 0.0, min(plant.voltage_peak_to_peak[-1], table[-1]))
    real = factor * np.diff(friction_at(plant, voltage_peak_to_peak=ends))
    expected = -np.diff(np.interp(ends, table, controller.saved_force))
    return float(real[0] / expected[0])


def _reference(settings: ControlSettings, intrinsic: float, wanted: float) -> Floats:
    samples = round(settings.duration / settings.sample_interval)
    reference = np.full(samples, intrinsic)
    reference[round(_FIRST * samples) :] = wanted
    reference[round(_SECOND * samples) :] = 0.5 * (intrinsic + wanted)
    return reference
