r"""Control loop over the posterior of the friction of its rig: friction within reach, gain, margins, cautious tuning.

A draw of the rig has the friction force F_d over the level u, where the controller expects F. The loop settles at the
level at which F_d is the target, and its gain there is

.. math:: g_d = \frac{\mathrm d F_d/\mathrm d u}{\mathrm d F/\mathrm d u}

All margins fall with the gain. A tuning whose time constants of closed loop and delay add to g times those of another
has the other's loop at the gain g: Skogestad's rule sets the proportional gain inversely to their sum.
"""

import math
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike

from sonolube.charts import Band, Line, Part
from sonolube.checks import Floats
from sonolube.design.control.control_design import ControlDesign
from sonolube.design.control.controller import FrictionController
from sonolube.design.control.friction_characteristic import FrictionCharacteristic, drawn_forces, friction_at_level
from sonolube.design.control.process import PIGains, Process, StabilityMargins, simc_gains, stability_margins
from sonolube.prediction.chances import INTERVAL, ReductionChances
from sonolube.rig import AMPLITUDE, VOLTAGE, Rig
from sonolube.rig.datasets import PREDICTED_FORCE, labelled, labels

if TYPE_CHECKING:
    import xarray as xr

MARGINS: Final = ("gain_margin", "phase_margin", "delay_margin", "sensitivity_peak")
"""Fields of `StabilityMargins`."""

_LOOKUP = MappingProxyType({VOLTAGE.name: "lookup_voltage", AMPLITUDE.name: "lookup_amplitude"})

MIN_REACHING: Final = 0.01
"""Share of the draws with the target within reach below which no gain of the loop is stated."""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class CautiousTuning:
    """Tuning with the margins of the rule at the highest gain of the 80 % interval.

    Parameters
    ----------
    closed_loop_time : float
        Time constant of the closed loop that it takes. [s]
    gains : PIGains
    margins : StabilityMargins
        At the highest gain of the interval.
    usual_time : float
        Time constant of the closed loop for the gain 1, in s.
    given_up : float
        Share of the bandwidth of feedback, the inverse of the time constants of closed loop and delay, that is lost.
    """

    closed_loop_time: float
    gains: PIGains
    margins: StabilityMargins
    usual_time: float
    given_up: float


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class PosteriorLoop:
    """Friction within reach and gain of a loop by the prediction of its rig.

    Parameters
    ----------
    force : ndarray, shape (3, n)
        Ends of the 80 % interval and median of the friction force at each level of the plant, in N.
    target_chance : float
        That the target lies between the friction at the highest level and that without vibration. []
    gain : ndarray, shape (3,), or None
        Ends of the 80 % interval of the gain and its median, over the draws that reach the target; None where fewer
        than 1 % do.
    margins : tuple of StabilityMargins
        At these gains; empty without them.
    cautious : CautiousTuning or None
    runs : int
        Own runs that the prediction rests on.
    caveats : tuple of str
        Own runs that contradict or disagree, and own published tests that the prediction was learned from too.
    """

    force: Floats
    target_chance: float
    gain: Floats | None
    margins: tuple[StabilityMargins, ...]
    cautious: CautiousTuning | None
    runs: int
    caveats: tuple[str, ...] = ()

    @property
    def reach(self) -> tuple[float, float, float]:
        """Lower end, median and upper end of the least friction force within reach, in N."""
        low, median, high = (float(each) for each in self.force[:, -1])
        return low, median, high


def predicted_margins(found: PosteriorLoop) -> dict[str, tuple[float, float, float]]:
    """Each of `MARGINS` at the gains of a prediction, from the lowest to the highest; empty without gains.

    An unstable loop has no sensitivity peak: NaN.
    """
    if not found.margins:
        return {}
    rows = [
        [math.nan if name == "sensitivity_peak" and each.gain_margin < 1 else getattr(each, name) for name in MARGINS]
        for each in found.margins
    ]
    return {name: (low, median, high) for name, low, median, high in zip(MARGINS, *rows, strict=True)}


def predicted_forces(study: ControlDesign, found: PosteriorLoop, *, level: ArrayLike) -> Floats:
    """Ends of the 80 % interval and median of the friction force at levels, linear between those of the plant, in N.

    Parameters
    ----------
    study : ControlDesign
    found : PosteriorLoop
        Of the design.
    level : array_like, shape (n,)
        Peak-to-peak voltages, or amplitudes, in V or m.

    Returns
    -------
    ndarray, shape (3, n)
        NaN beyond the highest level of the plant.
    """
    levels = np.asarray(level, dtype=np.float64)
    return np.array([np.interp(levels, study.plant.level, row, right=np.nan) for row in found.force])


def with_posterior(run: "xr.Dataset", study: ControlDesign, found: PosteriorLoop | str) -> "xr.Dataset":
    """Dataset of a closed-loop run with lookup table, friction within reach, gain and margins by the prediction.

    Parameters
    ----------
    run : xarray.Dataset
        By `control_dataset`.
    study : ControlDesign
    found : PosteriorLoop or str
        By `posterior_loop`, or why there is no prediction.

    Returns
    -------
    xarray.Dataset
        Lookup table over its voltage or amplitude; of a prediction also its forces there, and over
        `predicted_quantile`, 10, 50 and 90 %, the least friction within reach, the gain of the loop, and its margins at
        that gain.
    """
    controller = study.controller
    along = _LOOKUP[study.plant.quantity.name]
    level = np.array(controller.level)
    table = {"model_friction_force": friction_at_level(study.plant, level=level)}
    if isinstance(found, str):
        told = labelled({along: level, **table}, along=along, title=run.title).dataset()
        return run.merge(told).assign_attrs(run.attrs, prediction=found)
    table |= dict(zip(PREDICTED_FORCE, predicted_forces(study, found, level=level), strict=True))
    within = {"predicted_quantile": np.array(INTERVAL), "least_friction_force": found.force[:, -1]}
    if found.gain is not None:
        within |= {"plant_gain": found.gain, **{name: np.array(row) for name, row in predicted_margins(found).items()}}
    merged = run
    for values, axis in (({along: level, **table}, along), (within, "predicted_quantile")):
        merged = merged.merge(labelled(values, along=axis, title=run.title).dataset())
    merged["target_chance"] = ((), found.target_chance, labels("target_chance"))
    for name in set(MARGINS) & set(within):
        merged[name].attrs["long_name"] += " at this quantile of the gain"
    return merged.assign_attrs(run.attrs, prediction_runs=found.runs)


def drawn_gains(
    forces: Floats, plant: FrictionCharacteristic, controller: FrictionController, *, friction_force: float
) -> Floats:
    """Gain of the loop of each draw where its friction first falls to a target; NaN where the target is out of reach.

    Parameters
    ----------
    forces : ndarray, shape (draws, n)
        Friction force of each draw at the levels of the plant, linear between them, in N.
    plant : FrictionCharacteristic
    controller : FrictionController
    friction_force : float
        Target. [N]

    Returns
    -------
    ndarray, shape (draws,)
        Ratio of slopes of the draw and of the controller's characteristic between the two levels about the target.
    """
    fallen = forces <= friction_force
    end = np.argmax(fallen, axis=1)
    reached = fallen.any(axis=1) & (end > 0)
    end = np.maximum(end, 1)
    rows = np.arange(len(forces))
    actual = forces[rows, end - 1] - forces[rows, end]
    table = np.interp(plant.level, controller.level, controller.force_reduction)
    expected = table[end] - table[end - 1]
    within = reached & (plant.level[end] <= controller.level[-1] * (1 + 1e-9)) & (expected > 0)
    return np.where(within, actual / np.where(expected > 0, expected, 1.0), np.nan)


def posterior_loop(
    rig: Rig, study: ControlDesign, chances: ReductionChances, *, closed_loop_time: float | None = None
) -> PosteriorLoop:
    """Friction within reach, gain and margins of a control loop over the posterior of its rig.

    Parameters
    ----------
    rig : Rig
    study : ControlDesign
    chances : ReductionChances
        Of the rig.
    closed_loop_time : float, optional
        Time constant of the closed loop by which the tuning for the gain 1 is made; the effective dead time by default.
        [s]

    Returns
    -------
    PosteriorLoop

    See Also
    --------
    design_control, stability_margins
    """
    plant, controller = study.plant, study.controller
    forces = drawn_forces(rig, plant, chances)
    gains = drawn_gains(forces, plant, controller, friction_force=study.friction_force)
    known = gains[np.isfinite(gains)]
    chance = known.size / gains.size
    margins: tuple[StabilityMargins, ...] = ()
    gain, cautious = None, None
    if chance >= MIN_REACHING:
        process, gain = controller.process, np.quantile(known, INTERVAL)
        margins = tuple(margins_at_gain(process, controller.gains, gain=float(each)) for each in gain)
        cautious = _cautious_tuning(process, float(gain[-1]), closed_loop_time)
    return PosteriorLoop(
        force=np.quantile(forces, INTERVAL, axis=0),
        target_chance=chance,
        gain=gain,
        margins=margins,
        cautious=cautious,
        runs=chances.runs,
        caveats=(*filter(None, [chances.contradiction]), *chances.run_caveats, *chances.caveats),
    )


def margins_at_gain(process: Process, gains: PIGains, *, gain: float) -> StabilityMargins:
    """Stability margins of a loop whose plant has a static gain.

    Parameters
    ----------
    process : Process
    gains : PIGains
    gain : float
        From the commanded to the actual friction force.

    Returns
    -------
    StabilityMargins
    """
    return stability_margins(process, replace(gains, proportional_gain=gain * gains.proportional_gain))


def _cautious_tuning(process: Process, highest_gain: float, closed_loop_time: float | None) -> CautiousTuning:
    """Tuning with the margins of the rule at the highest gain, not quicker than that for the gain 1."""
    delay = process.effective_dead_time
    usual = delay if closed_loop_time is None else closed_loop_time
    factor = max(highest_gain, 1.0)
    slower = factor * (usual + delay) - delay
    gains = simc_gains(process, closed_loop_time=slower)
    return CautiousTuning(
        closed_loop_time=slower,
        gains=gains,
        margins=margins_at_gain(process, gains, gain=highest_gain),
        usual_time=usual,
        given_up=1 - 1 / factor,
    )


def predicted_force_parts(study: ControlDesign, found: PosteriorLoop) -> tuple[Part, ...]:
    """80 % interval and median of the friction force over the level, for the chart of the design."""
    plant = study.plant
    low, median, high = found.force
    level = plant.quantity.axis_scale * plant.level
    return (
        Band(x=level, low=low, high=high, label="predicted, 80 %", opacity=0.2),
        Line(x=level, y=median, label="predicted median", dash=3, weight=0.7),
    )
