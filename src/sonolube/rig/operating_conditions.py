"""Drives and loads of many operating points: broadcast, checked, and grouped by the vibration that they share."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.actuator.drive import Drive
from sonolube.rig.friction_and_wear import ANY_FREQUENCY
from sonolube.rig.record import Rig

CONDITIONS = ("voltage_peak_to_peak", "voltage_offset", "frequency", "normal_load")
"""Settings of a point apart from its sliding speed, in the order of the rows that hold them."""

SETTINGS = (*CONDITIONS, "sliding_speed")
"""All settings of a point."""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class OperatingConditions:
    """Drives and loads of a batch, arrays of one axis."""

    voltage_peak_to_peak: Floats
    voltage_offset: Floats
    frequency: Floats
    normal_load: Floats

    @classmethod
    def of_columns(cls, columns: Floats) -> "OperatingConditions":
        """Return settings from their rows, in the order of the fields."""
        return cls(**dict(zip(CONDITIONS, columns, strict=True)))


def conditions_of(
    rig: Rig, given: Sequence[ArrayLike | None], *, vibration_amplitude: ArrayLike | None = None
) -> tuple[Floats, Floats]:
    """Return the settings of points as rows of `OperatingConditions` and sliding speeds, checked and broadcast.

    Given are peak-to-peak voltage, offset and frequency of the drive, load and sliding speed; None is the rig's own. A
    rig without a drive voltage has 0 V, and one without a drive any frequency. An amplitude that is commanded stands in
    the row of the voltage, which such a rig does not have.
    """
    voltage, offset, f, load, speed = given
    drive = rig.drive or Drive(frequency=ANY_FREQUENCY)
    if drive.voltage_peak_to_peak is None and not (voltage is None and offset is None):
        raise InvalidInput(f"{rig.title}: drive.voltage_peak_to_peak is missing; give it to vary the voltage")
    if vibration_amplitude is None:
        level = require_non_negative(
            voltage_peak_to_peak=(drive.voltage_peak_to_peak or 0.0) if voltage is None else voltage
        )
    elif drive.voltage_peak_to_peak is None:
        level = require_non_negative(vibration_amplitude=vibration_amplitude)
    else:
        raise InvalidInput(f"{rig.title}: its voltage sets its amplitude; vary drive.voltage_peak_to_peak instead")
    settings = (
        level,
        require_finite(voltage_offset=drive.voltage_offset if offset is None else offset),
        require_positive(frequency=drive.frequency if f is None else f),
        require_positive(normal_load=rig.normal_load if load is None else load),
        require_non_negative(sliding_speed=rig.sliding_speed if speed is None else speed),
    )
    try:
        every = np.broadcast_arrays(*settings)
    except ValueError:
        shapes = ", ".join(str(array.shape) for array in settings)
        raise InvalidInput(
            f"voltage or amplitude, offset, frequency, load and speed must have matching shapes, got {shapes}"
        ) from None
    return np.stack(every[:-1]), every[-1].copy()


def points_by_vibration(points: NDArray[np.intp], vibration: NDArray[np.intp]) -> list[NDArray[np.intp]]:
    """Return the indices of the points of each vibration, in the order of the vibrations.

    Parameters
    ----------
    points : ndarray of int, shape (k,)
    vibration : ndarray of int, shape (n,)
        Vibration of every point.

    Returns
    -------
    list of ndarray of int
    """
    if not points.size:
        return []
    order = points[np.argsort(vibration[points], kind="stable")]
    return np.split(order, np.flatnonzero(np.diff(vibration[order])) + 1)
