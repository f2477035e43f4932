"""Chart of the channels of a run over time, each as the range of its samples."""

from typing import TYPE_CHECKING, Final

from sonolube.charts import Axis, Chart, Line, Panel, envelope
from sonolube.laboratory.records.set_point_steps import SET_POINT_CHANNELS
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
