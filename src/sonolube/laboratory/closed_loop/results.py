"""Results of friction held in closed loop: figures of merit between changes of speed, dataset and chart over time."""

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from sonolube.charts import Axis, Band, Chart, Line, Panel, Rule
from sonolube.errors import InvalidInput
from sonolube.laboratory.closed_loop.plan import HeldFriction
from sonolube.rig import dataset

if TYPE_CHECKING:
    import xarray as xr

_SETTLED = 2.0  # deviations of the scatter
_FINAL_FRACTION = 2  # the last half of a phase is its steady part


@dataclass(frozen=True, kw_only=True, slots=True)
class HoldMetrics:
    """Figures of merit of friction held at one sliding speed.

    Parameters
    ----------
    start_time : float
        When the speed was set. [s]
    sliding_speed : float
        [m/s]
    friction_force : float
        Mean over the last half of the phase. [N]
    tracking_error : float
        Root mean square of friction less reference over that half. [N]
    scatter : float
        Standard deviation of the friction over that half, in N.
    settling_time : float or None
        After which the friction stays within two deviations of the scatter of its reference, but for one interval in
        twenty; None where it does not. [s]
    voltage_peak_to_peak : float
        Mean over the last half. [V]
    saturated_fraction : float
        Share of the intervals of the phase at the highest voltage or at none.
    """

    start_time: float
    sliding_speed: float
    friction_force: float
    tracking_error: float
    scatter: float
    settling_time: float | None
    voltage_peak_to_peak: float
    saturated_fraction: float


def hold_metrics(record: HeldFriction) -> tuple[HoldMetrics, ...]:
    """Figures of merit from one change of speed to the next.

    Parameters
    ----------
    record : HeldFriction

    Returns
    -------
    tuple of HoldMetrics
        One for each speed that was reached.

    Raises
    ------
    InvalidInput
        If the controller never took over.
    """
    if record.time.size == 0:
        raise InvalidInput(f"the controller never took over: {record.reason}")
    changes = np.flatnonzero(np.diff(record.sliding_speed)) + 1
    edges = [0, *changes.tolist(), record.time.size]
    return tuple(_phase(record, slice(a, b)) for a, b in pairwise(edges))


def _phase(record: HeldFriction, part: slice) -> HoldMetrics:
    """Figures of merit of one phase."""
    force, volts = record.friction_force[part], record.voltage_peak_to_peak[part]
    time, error = record.time[part], force - record.setpoint[part]
    last = slice(-max(force.size // _FINAL_FRACTION, 1), None)
    scatter = float(np.std(force[last]))
    saturated = (volts >= record.hold.controller.level_maximum * (1 - 1e-9)) | (volts <= 0)
    return HoldMetrics(
        start_time=float(time[0]),
        sliding_speed=float(record.sliding_speed[part][0]),
        friction_force=float(np.mean(force[last])),
        tracking_error=float(np.sqrt(np.mean(error[last] ** 2))),
        scatter=scatter,
        settling_time=_settling_time(time - time[0], np.abs(error) > _SETTLED * scatter),
        voltage_peak_to_peak=float(np.mean(volts[last])),
        saturated_fraction=float(np.mean(saturated)),
    )


def _settling_time(time: "np.ndarray", outside: "np.ndarray") -> float | None:
    """First time from which on at most one entry in twenty lies outside."""
    later = np.cumsum(outside[::-1])[::-1]
    remaining = np.arange(time.size, 0, -1)
    settled = np.flatnonzero(~outside & (later <= np.maximum(remaining / 20, 1)) & (remaining >= 5))
    return float(time[settled[0]]) if settled.size else None


_COLUMNS = ("time", "friction_force", "friction_force_deviation", "voltage_peak_to_peak", "sliding_speed")


def held_friction_dataset(record: HeldFriction, *, title: str) -> "xr.Dataset":
    """Friction, voltage and speed of each interval of the controller as a labelled dataset.

    Parameters
    ----------
    record : HeldFriction
    title : str

    Returns
    -------
    xarray.Dataset
        Over `time` since the controller took over; reference, intrinsic friction, outcome and reason are attributes.
    """
    found = dataset({name: getattr(record, name) for name in _COLUMNS}, along="time", title=title)
    return found.assign_attrs(
        reference_friction_force=record.hold.friction_force,
        intrinsic_friction_force=record.intrinsic_friction_force,
        outcome=record.outcome,
        reason=record.reason,
    )


_SIZE = (6.85, 5.2)  # inches: 174 mm


def held_friction_chart(record: HeldFriction, *, simulated: bool) -> Chart:
    """Friction force with its reference, drive voltage and sliding speed over time.

    Parameters
    ----------
    record : HeldFriction
    simulated : bool
        Whether no hardware moved.

    Returns
    -------
    Chart
        Friction as means over the intervals, with the deviation of the samples within each as a band.
    """
    time, force, band = record.time, record.friction_force, record.friction_force_deviation
    intrinsic, highest = record.intrinsic_friction_force, record.hold.controller.level_maximum
    source = "simulated" if simulated else "measured"
    friction = (
        Band(x=time, low=force - band, high=force + band, label="±1 deviation of samples", colour=5, opacity=0.5),
        Line(x=time, y=force, label=f"friction, {source}"),
        Line(x=time, y=record.setpoint, label="reference", colour=6, dash=1, weight=0.85),
        Rule(value=intrinsic, along="y", label="without vibration, before", colour=1, dash=3),
    )
    drive = (
        Line(x=time, y=record.voltage_peak_to_peak, colour=1, is_stepped=True),
        Rule(value=highest, along="y", label="highest of the controller", colour="0.45", dash=2),
    )
    speed = (Line(x=time, y=1e3 * record.sliding_speed, is_stepped=True),)
    greatest = float(np.nanmax([*(force + band), *record.setpoint, intrinsic]))
    fastest = 1.15e3 * float(record.sliding_speed.max(initial=0.0)) or 1.0
    x = Axis(label="Time under control", unit="s", lowest=float(time[0]), highest=float(time[-1]))
    panels = (
        Panel(x=x, y=Axis(label="Friction force", unit="N", lowest=0.0, highest=1.1 * greatest), parts=friction),
        Panel(x=x, y=Axis(label="Drive, peak to peak", unit="V", lowest=0.0, highest=1.35 * highest), parts=drive),
        Panel(x=x, y=Axis(label="Sliding speed", unit="mm/s", lowest=0.0, highest=fastest), parts=speed),
    )
    return Chart(panels=panels, size=_SIZE, heights=(2, 1, 1), legend="top", legend_columns=4, shares_x=True)
