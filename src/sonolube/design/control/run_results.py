"""Results of a closed-loop run: dataset over time, final voltage and error, and whether the resonance was lost."""

from dataclasses import dataclass, fields
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
    """Voltage and tracking error over the last fifth of a closed-loop run.

    Parameters
    ----------
    voltage_peak_to_peak : float
        Mean drive voltage. [V]
    tracking_error : float
        Root mean square of friction force less reference. [N]
    """

    voltage_peak_to_peak: float
    tracking_error: float


def final_state(run: ClosedLoopRun) -> FinalState:
    """Mean voltage and root-mean-square tracking error over the last fifth of a run.

    Parameters
    ----------
    run : ClosedLoopRun

    Returns
    -------
    FinalState
    """
    last = slice(-max(run.time.size // _FINAL_FRACTION, 1), None)
    return FinalState(
        voltage_peak_to_peak=float(run.voltage_peak_to_peak[last].mean()),
        tracking_error=float(np.sqrt(np.mean((run.friction_force[last] - run.setpoint[last]) ** 2))),
    )


def lost_resonance(study: ControlDesign) -> bool:
    """Whether the tracked frequency of a run ends at an end of its band.

    Parameters
    ----------
    study : ControlDesign

    Returns
    -------
    bool
        False without tracking.
    """
    tracker, last = study.tracker, float(study.run.frequency[-1])
    return tracker is not None and not tracker.lowest_frequency < last < tracker.highest_frequency


def control_dataset(study: ControlDesign, *, title: str) -> "xr.Dataset":
    """Closed-loop run over time as a labelled dataset.

    Parameters
    ----------
    study : ControlDesign
    title : str

    Returns
    -------
    xarray.Dataset
        Over `time`.
    """
    not_shown = ("setpoint", "measured_force", "envelope")
    names = [field.name for field in fields(study.run) if field.name not in not_shown]
    return dataset({name: getattr(study.run, name) for name in names}, along="time", title=title)
