"""Design of a friction controller for a rig: characteristic, tuning, margins, simulated run and its results."""

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from sonolube.checks import Floats, require_positive
from sonolube.design.control.closed_loop_simulation import (
    ClosedLoopRun,
    Disturbance,
    FrictionLoop,
    ThermalDrift,
    simulate_closed_loop,
)
from sonolube.design.control.controller import FrictionController, tuned_controller
from sonolube.design.control.friction_characteristic import (
    FrictionCharacteristic,
    computed_characteristic,
    efficiency_characteristic,
    friction_at_level,
    level_for_friction,
    predicted_characteristic,
)
from sonolube.design.control.performance import (
    ControlEnergy,
    StepResponseMetrics,
    control_energy,
    step_response_metrics,
)
from sonolube.design.control.process import Process, StabilityMargins, stability_margins
from sonolube.design.control.resonance_tracking import (
    Amplifier,
    FrequencyTracker,
    active_limit,
    swing_limit,
    tuned_tracker,
)
from sonolube.design.control.vibration_envelope import VibrationMode, mode_admittance, mode_at_drive
from sonolube.errors import InvalidInput, OutsideRange, UnknownName
from sonolube.facts.metrics import EfficiencyLine
from sonolube.prediction.chances import ReductionChances
from sonolube.rig import AMPLITUDE, VOLTAGE, Rig, commanded_quantity, dataset, own_level

if TYPE_CHECKING:
    import xarray as xr

FEED_FORWARD = ("model", "prediction", "efficiency", "none")
"""Characteristic of the feed-forward: by the rig's model, predicted median, efficiency line, or a straight line."""

_SLOPE_STEP = 0.01  # of the highest level, of the finite difference of the static gain
_FIRST_STEP, _SECOND_STEP = 0.1, 0.55  # of the duration, when the set-point steps
_MIN_SAMPLES, _MAX_SAMPLES = 20, 500_000


@dataclass(frozen=True, kw_only=True, slots=True)
class ControlSettings:
    """Requirements of a friction controller, and the disturbances of its simulation.

    Parameters
    ----------
    amplifier : Amplifier or None
        Limits of the voltage; None for a rig whose amplitude is commanded.
    amplitude_maximum : float or None
        Largest amplitude of a rig without a voltage; its own where it is None. [m]
    friction_force : float or None
        Target friction force; half-way between the highest and the lowest where it is None. [N]
    dead_time : float
        Dead time of the friction measurement. [s]
    sample_interval : float
        Sampling interval of the controller. [s]
    closed_loop_time : float or None
        Desired closed-loop time constant; None for the effective dead time, which the tuning rule recommends. [s]
    feed_forward : str
        One of `FEED_FORWARD`.
    tracking : bool
        Whether the frequency of a voltage tracks the resonance; a commanded amplitude needs no tracking here.
    duration : float
        Simulated time. [s]
    disturbance : Disturbance
    drift : ThermalDrift

    Raises
    ------
    InvalidInput
        If a time is not positive, or the duration is fewer than 20 or more than 500,000 intervals.
    UnknownName
        If the feed-forward is unknown.
    """

    amplifier: Amplifier | None = None
    amplitude_maximum: float | None = None
    friction_force: float | None = None
    dead_time: float = 1e-3
    sample_interval: float = 2e-4
    closed_loop_time: float | None = None
    feed_forward: str = "model"
    tracking: bool = True
    duration: float = 0.2
    disturbance: Disturbance = field(default_factory=Disturbance)
    drift: ThermalDrift = field(default_factory=ThermalDrift)

    def __post_init__(self) -> None:
        require_positive(duration=self.duration, sample_interval=self.sample_interval)
        if self.feed_forward not in FEED_FORWARD:
            raise UnknownName.among(FEED_FORWARD, kind="feed-forward", name=self.feed_forward)
        intervals = self.duration / self.sample_interval
        if not _MIN_SAMPLES <= intervals <= _MAX_SAMPLES:
            raise InvalidInput(
                f"duration {self.duration:g} s makes {intervals:.3g} intervals of {self.sample_interval:g} s; take one"
                f" that makes {_MIN_SAMPLES} to {_MAX_SAMPLES}"
            )


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ControlDesign:
    """Friction controller of a rig with its stability margins and simulated performance.

    Parameters
    ----------
    plant : FrictionCharacteristic
        Static characteristic by the rig's model.
    mode : VibrationMode
    controller : FrictionController
    tracker : FrequencyTracker or None
    plant_gain : float
        Static gain from the commanded to the actual friction force at the target, 1 for an exact characteristic. []
    margins : StabilityMargins
        At that gain.
    friction_force : float
        Target friction force. [N]
    level_maximum : float
        Largest peak-to-peak voltage within the limits of the amplifier, or largest amplitude, in V or m.
    limit : str
        Name of the limit that determines it.
    run : ClosedLoopRun
        Simulation with a step to the target after a tenth of the duration, and one to half the reduction after 0.55.
    fixed_frequency_run : ClosedLoopRun or None
        The same at a fixed drive frequency, where the resonance drifts and the drive tracks it.
    response : StepResponseMetrics
        Of the first step.
    energy : ControlEnergy
    """

    plant: FrictionCharacteristic
    mode: VibrationMode
    controller: FrictionController
    tracker: FrequencyTracker | None
    plant_gain: float
    margins: StabilityMargins
    friction_force: float
    level_maximum: float
    limit: str
    run: ClosedLoopRun
    fixed_frequency_run: ClosedLoopRun | None
    response: StepResponseMetrics
    energy: ControlEnergy

    @property
    def loop(self) -> FrictionLoop:
        """Plant, controller and resonance tracking."""
        return FrictionLoop(
            plant=self.plant,
            mode=self.mode,
            controller=self.controller,
            tracker=self.tracker,
            level_maximum=self.level_maximum,
        )


def design_control(
    rig: Rig,
    settings: ControlSettings,
    *,
    mode: VibrationMode | None = None,
    line: EfficiencyLine | None = None,
    chances: ReductionChances | None = None,
) -> ControlDesign:
    """Friction controller tuned for a rig by the SIMC rule, its margins, and a simulation of its closed loop.

    Parameters
    ----------
    rig : Rig
        With a drive voltage, or an amplitude that is commanded.
    settings : ControlSettings
    mode : VibrationMode, optional
        Resonance that the drive excites; by default that of the rig's structure closest to the drive frequency. Of a
        rig without a voltage `amplitude_mode`.
    line : EfficiencyLine, optional
        Efficiency line for the feed-forward "efficiency".
    chances : ReductionChances, optional
        Distribution of the rig's friction ratio for the feed-forward "prediction".

    Returns
    -------
    ControlDesign

    Raises
    ------
    InvalidInput
        If the rig lacks an entry that the model needs, the phase cannot be tracked, the line or the amplifier is
        missing, or a commanded amplitude is to be fed forward by efficiency or to drift.
    OutsideRange
        If the target friction force cannot be reached.

    See Also
    --------
    tuned_controller, stability_margins, simulate_closed_loop
    """
    mode = mode_at_drive(rig) if mode is None else mode
    quantity = commanded_quantity(rig)
    if quantity is AMPLITUDE:
        _require_no_voltage(settings)
    highest, limit = _highest_level(rig, settings, mode)
    plant = computed_characteristic(rig, level_maximum=highest)
    target = settings.friction_force
    if target is None:
        target = 0.5 * (plant.highest_force + plant.lowest_force)
    level_for_friction(plant, friction_force=target)  # refuses a target out of reach
    controller = tuned_controller(
        _feed_forward_characteristic(rig, plant, settings, line, chances, highest),
        Process(
            time_constant=mode.time_constant, dead_time=settings.dead_time, sample_interval=settings.sample_interval
        ),
        level_maximum=highest,
        closed_loop_time=settings.closed_loop_time,
        feed_forward=settings.feed_forward != "none",
    )
    tracks = settings.tracking and quantity is VOLTAGE
    tracker = tuned_tracker(mode, sample_interval=settings.sample_interval) if tracks else None
    loop = FrictionLoop(plant=plant, mode=mode, controller=controller, tracker=tracker, level_maximum=highest)
    setpoint = _setpoint_history(settings, plant.highest_force, target)
    run = simulate_closed_loop(loop, setpoint=setpoint, drift=settings.drift, disturbance=settings.disturbance)
    fixed_frequency_run = None
    if tracker is not None and settings.drift.final_temperature_rise:
        fixed_frequency_run = simulate_closed_loop(
            replace(loop, tracker=None), setpoint=setpoint, drift=settings.drift, disturbance=settings.disturbance
        )
    plant_gain = _plant_gain(plant, controller, target, settings.disturbance.friction_factor)
    gains = replace(controller.gains, proportional_gain=plant_gain * controller.gains.proportional_gain)
    first_step = float(run.time[np.argmax(setpoint != setpoint[0])])
    return ControlDesign(
        plant=plant,
        mode=mode,
        controller=controller,
        tracker=tracker,
        plant_gain=plant_gain,
        margins=stability_margins(controller.process, gains),
        friction_force=float(target),
        level_maximum=highest,
        limit=limit,
        run=run,
        fixed_frequency_run=fixed_frequency_run,
        response=step_response_metrics(run, start_time=first_step),
        energy=control_energy(rig, run),
    )


def _require_no_voltage(settings: ControlSettings) -> None:
    """Refuse options of a voltage where an amplitude is commanded."""
    if settings.feed_forward == "efficiency":
        raise InvalidInput(
            "feed-forward by efficiency is over power, which a commanded amplitude has none of; take model"
        )
    if settings.drift.final_temperature_rise:
        raise InvalidInput("a commanded amplitude has no drift here: its generator holds the resonance")


def _highest_level(rig: Rig, settings: ControlSettings, mode: VibrationMode) -> tuple[float, str]:
    """Largest voltage or amplitude, and the name of the limit that determines it."""
    if commanded_quantity(rig) is AMPLITUDE:
        given = settings.amplitude_maximum
        return own_level(rig) if given is None else float(require_positive(amplitude_maximum=given)), AMPLITUDE.word
    if settings.amplifier is None:
        raise InvalidInput(f"{rig.title}: a drive voltage needs the limits of its amplifier")
    f, admittance = mode.frequency, mode_admittance(mode, frequency=mode.frequency)
    swing = swing_limit(settings.amplifier, admittance=admittance, frequency=f)
    return swing, active_limit(settings.amplifier, admittance=admittance, frequency=f)


def _feed_forward_characteristic(
    rig: Rig,
    plant: FrictionCharacteristic,
    settings: ControlSettings,
    line: EfficiencyLine | None,
    chances: ReductionChances | None,
    swing: float,
) -> FrictionCharacteristic:
    """Characteristic whose inverse the controller uses."""
    if settings.feed_forward == "prediction":
        if chances is None:
            raise InvalidInput("feed-forward by prediction needs a distribution of the friction ratio")
        return predicted_characteristic(rig, plant, chances)
    if settings.feed_forward != "efficiency":
        return plant
    if line is None:
        raise InvalidInput("feed-forward by efficiency needs an efficiency line that is calibrated for the rig")
    return efficiency_characteristic(rig, line, voltage_maximum=swing)


def _plant_gain(
    plant: FrictionCharacteristic, controller: FrictionController, target: float, friction_factor: float
) -> float:
    """Slope of the actual friction over that of the controller's characteristic, at the target."""
    reachable = min(max(target / friction_factor, plant.lowest_force), plant.highest_force)
    level = float(level_for_friction(plant, friction_force=reachable))
    table = controller.level
    if level >= table[-1] and table[-1] < plant.level[-1]:
        lowest = controller.intrinsic_friction_force - controller.force_reduction[-1]
        raise OutsideRange(
            f"friction_force {target:.4g} N needs {level:.4g} V by the rig's model, but the efficiency line predicts"
            f" {lowest:.4g} N at {table[-1]:.4g} V, where the controller's characteristic ends: recalibrate the"
            " efficiency, or take feed-forward by the model"
        )
    step = _SLOPE_STEP * plant.level[-1]
    ends = np.clip([level - step, level + step], 0.0, min(plant.level[-1], table[-1]))
    actual = friction_factor * np.diff(friction_at_level(plant, level=ends))
    expected = -np.diff(np.interp(ends, table, controller.force_reduction))
    return float(actual[0] / expected[0])


def _setpoint_history(settings: ControlSettings, intrinsic: float, target: float) -> Floats:
    """Set-point of each interval: friction without vibration, the target, then half of the reduction."""
    samples = round(settings.duration / settings.sample_interval)
    setpoint = np.full(samples, intrinsic)
    setpoint[round(_FIRST_STEP * samples) :] = target
    setpoint[round(_SECOND_STEP * samples) :] = 0.5 * (intrinsic + target)
    return setpoint


_FINAL_FRACTION = 5  # the last fifth of a run counts as its end


@dataclass(frozen=True, kw_only=True, slots=True)
class FinalState:
    """Drive and tracking error over the last fifth of a closed-loop run.

    Parameters
    ----------
    level : float
        Mean drive voltage, or commanded amplitude, in V or m.
    tracking_error : float
        Root mean square of friction force less reference. [N]
    """

    level: float
    tracking_error: float


def final_state(run: ClosedLoopRun) -> FinalState:
    """Mean voltage or amplitude, and root-mean-square tracking error over the last fifth of a run."""
    last = slice(-max(run.time.size // _FINAL_FRACTION, 1), None)
    return FinalState(
        level=float(run.level[last].mean()),
        tracking_error=float(np.sqrt(np.mean((run.friction_force[last] - run.setpoint[last]) ** 2))),
    )


def lost_resonance(study: ControlDesign) -> bool:
    """Whether the tracked frequency of a run ends at an end of its band; false without tracking."""
    tracker, last = study.tracker, float(study.run.frequency[-1])
    return tracker is not None and not tracker.lowest_frequency < last < tracker.highest_frequency


def control_dataset(study: ControlDesign, *, title: str) -> "xr.Dataset":
    """Closed-loop run over time as a labelled dataset.

    Over `time`; of a commanded amplitude without the resonance and its electrical quantities.
    """
    run, quantity = study.run, study.plant.quantity
    values = {"time": run.time, "friction_force": run.friction_force, quantity.name: run.level}
    if run.phase is not None and run.electrical_energy is not None:
        values |= {
            "frequency": run.frequency,
            "resonance_frequency": run.resonance_frequency,
            "phase": run.phase,
            "electrical_energy": run.electrical_energy,
        }
    return dataset(values, along="time", title=title)
