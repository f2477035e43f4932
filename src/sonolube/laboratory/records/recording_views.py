"""Views of the recording of a run: a chart of its channels over time, and parts with and without vibration joined."""

from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.charts import Axis, Chart, Line, Panel, envelope
from sonolube.errors import InvalidInput
from sonolube.laboratory.records.run import read_run
from sonolube.laboratory.records.set_point_steps import SET_POINT_CHANNELS
from sonolube.measurement.recordings.channels_and_parts import join_recordings
from sonolube.vocabulary import quantities

if TYPE_CHECKING:
    import xarray as xr

_WIDTH: Final = 7.0  # inch
_HEIGHT: Final = 1.4  # inch, of a channel


def channels_chart(recording: "xr.Dataset") -> Chart:
    """Chart of the channels of a recording, one below the other; of set points only a voltage that was not measured."""
    panels = []
    for name in (str(each) for each in recording.data_vars if each not in SET_POINT_CHANNELS):
        time, values = envelope(recording["time"].to_numpy(), recording[name].to_numpy())
        known = quantities().get(name)
        label = name.replace("_", " ") if known is None else known.meaning.split(",")[0]
        y = Axis(label=label[:1].upper() + label[1:], unit=str(recording[name].attrs.get("units", "1")))
        line = Line(x=time, y=values, weight=0.6, is_stepped=True)
        panels.append(Panel(x=Axis(label="Time", unit="s"), y=y, parts=(line,)))
    return Chart(panels=tuple(panels), size=(_WIDTH, 0.6 + _HEIGHT * len(panels)), shares_x=True)


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
