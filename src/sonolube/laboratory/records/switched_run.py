"""Recording of a run whose vibration was switched on and off, its parts joined."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.laboratory.records.run import read_run
from sonolube.measurement.recordings.joined_recording import join_recordings

if TYPE_CHECKING:
    import xarray as xr


def switched_recording(folder: Path) -> "xr.Dataset":
    """Parts of a run that recorded friction and load, one after the other without the gaps between them."""
    run = read_run(folder)
    parts = [run.dataset(number) for number in range(1, len(run.recordings) + 1)]
    chosen = [part for part in parts if "friction_force" in part and "normal_load" in part]
    if not chosen:
        raise InvalidInput(f"{folder}: no part of its recording has the channels friction_force and normal_load")
    if not any("voltage_peak_to_peak" in part for part in chosen):
        raise InvalidInput(f"{folder}: its vibration is never switched on; run the protocol decay_length_run")
    undriven = [
        part if "voltage_peak_to_peak" in part else part.assign(voltage_peak_to_peak=0 * part["normal_load_set"])
        for part in chosen
    ]
    for part in undriven:
        part["voltage_peak_to_peak"].attrs["units"] = "V"
    joined = join_recordings(undriven)
    return joined.isel(time=np.isfinite(joined["normal_load"].to_numpy()))
