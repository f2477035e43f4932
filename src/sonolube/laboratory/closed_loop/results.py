"""Results of friction held in closed loop as a dataset over time."""

from typing import TYPE_CHECKING

from sonolube.laboratory.closed_loop.record import HeldFriction
from sonolube.rig import dataset

if TYPE_CHECKING:
    import xarray as xr

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
