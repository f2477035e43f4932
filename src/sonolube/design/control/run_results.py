"""Results of a closed-loop run: dataset over time, final level and error, and whether the resonance was lost."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sonolube.design.control.closed_loop_simulation import ClosedLoopRun
from sonolube.design.control.control_design import ControlDesign
from sonolube.rig import dataset

if TYPE_CHECKING:
    import xarray as xr

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
