"""Parts of a recording: raw blocks with set points or a netCDF file, their joined data, and a chart over time.

Raw blocks are removed once the recording was found to hold every sample.
"""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from sonolube.charts import Axis, Chart, Line, Panel, envelope
from sonolube.errors import InvalidInput
from sonolube.laboratory.block import Block
from sonolube.laboratory.records.documents import ReadDocuments, read_documents
from sonolube.laboratory.records.raw_blocks import PartClock, RawPart, part_clock, read_raw_blocks, scan_raw
from sonolube.laboratory.records.run import read_run
from sonolube.laboratory.records.run_folder import (
    PURPOSE,
    Facts,
    RunFacts,
    changed_recordings,
    raw_parts,
    raw_path,
    read_run_facts,
    recording_path,
    utc_time,
)
from sonolube.laboratory.records.set_point_steps import SET_POINT_CHANNELS, SetPointSteps, set_point_steps
from sonolube.measurement.recordings.channels_and_parts import join_recordings
from sonolube.operating_system import remove_file
from sonolube.storage.files import locked_folder
from sonolube.text.units import format_si
from sonolube.vocabulary import quantities

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]
Pieces = Iterator[tuple[Floats, list[Floats]]]
"""Time since the first sample, in s, and the columns in the order of the variables, many rows each."""

ROWS: Final = 1 << 17
"""Rows of a piece of a recording."""

WAVES: Final = frozenset({"stack_voltage", "stack_current"})
"""Quantities of which samples are values of the wave itself."""

SENSOR_ATTRIBUTES: Final = ("identifier", "calibration", "calibrated", "uncertainty", "comment")
"""Attributes of a variable that say how it was measured; the comment, that it is aliased."""

_VOLTAGE: Final = "voltage_peak_to_peak"
_SET_VOLTAGE: Final = "voltage_peak_to_peak_set"


@dataclass(frozen=True, kw_only=True)
class PartOfRecording:
    """Part of a recording, of its raw blocks or of the netCDF file into which they were converted.

    Parameters
    ----------
    path : Path
        Of the raw blocks, or of the netCDF file.
    samples, missing : int
        Of each channel.
    sample_rate : float
        [Hz]
    begun : float
        In s since 1970.
    variables : mapping of str to str
        Quantity of each variable by its name.
    units : mapping of str to str
        SI unit of each variable of a free quantity, by its name.
    clock : PartClock or None
        Where it is not that of the run.
    set_points : tuple of str
        Names of the variables that hold set points.
    lubricants : tuple of str
        Names of the lubricants 1, 2, ...
    caveats : list of str
    pieces : callable
        Yields time and columns, piece by piece.
    measured : mapping of str to (mapping of str to str or float)
        `SENSOR_ATTRIBUTES` of variables that have any, by their names.
    read_back : tuple of str
        Settings that the source of the drive was asked for, each with its time.
    run_identifier : str
        UUID of the run.
    damaged : int
        Places of the raw blocks that are no record.
    """

    path: Path
    samples: int
    missing: int
    sample_rate: float
    begun: float
    variables: Mapping[str, str]
    units: Mapping[str, str]
    clock: PartClock | None
    set_points: tuple[str, ...]
    lubricants: tuple[str, ...]
    caveats: list[str]
    pieces: Callable[[], Pieces]
    measured: Mapping[str, Mapping[str, str | float]]
    read_back: tuple[str, ...]
    run_identifier: str
    damaged: int = 0

    @property
    def clock_name(self) -> str:
        """Name of the clock; empty for the clock of the run."""
        return "" if self.clock is None else self.clock.name


def recorded_part(
    folder: Path, part: int, documents: ReadDocuments, *, facts: Facts, raw: RawPart | None = None
) -> PartOfRecording:
    """Part of the recording of a run, by its raw blocks."""
    path = raw_path(folder, part)
    found = scan_raw(path) if raw is None else raw
    own = None if found.clock is None else (found.begun, found.sample_rate)
    steps = set_point_steps(documents, part, first_sample=found.first_sample, facts=facts, own_clock=own)
    variables = _variables(found, steps)
    free = {channel.name: channel.free_unit for channel in found.channels}
    starts = documents.of("start")
    return PartOfRecording(
        path=path,
        samples=found.samples,
        missing=found.missing,
        sample_rate=found.sample_rate,
        begun=found.begun,
        variables=variables,
        units={name: free.get(name, "") for name, of in variables.items() if of not in quantities()},
        clock=found.clock,
        set_points=tuple(name for name in variables if name in steps.names),
        lubricants=tuple(steps.lubricants),
        caveats=_caveats(found, steps),
        pieces=partial(_pieces, path, found, steps, list(variables)[len(found.channels) :]),
        measured=_measured(found, steps, variables),
        read_back=tuple(_read_back(found, steps)),
        run_identifier=str(starts[0]["uid"]) if starts else "",
        damaged=found.damaged,
    )


def _measured(raw: RawPart, steps: SetPointSteps, variables: Mapping[str, str]) -> dict[str, Mapping[str, str | float]]:
    """Sensors of the variables that channels measure, and whether they are aliased."""
    found: dict[str, Mapping[str, str | float]] = {}
    for name, channel in zip(variables, raw.channels, strict=False):
        told = asdict(channel.sensor)
        if channel.quantity in WAVES:
            told["comment"] = _aliasing(raw.sample_rate, steps.frequencies)
        if stated := {each: told[each] for each in SENSOR_ATTRIBUTES if told.get(each)}:
            found[name] = stated
    return found


def _aliasing(sample_rate: float, frequencies: Sequence[float]) -> str:
    """Comment on a wave that is sampled at less than twice the frequency of the drive; empty for any other."""
    above = [each for each in frequencies if 2 * each > sample_rate]
    if not above:
        return ""
    drive = " to ".join(format_si(each, "Hz", digits=6) for each in dict.fromkeys((above[0], above[-1])))
    seen = abs(above[0] - sample_rate * round(above[0] / sample_rate))
    appears = f", at which it appears at {format_si(seen, 'Hz')}" if len(above) == 1 else ""
    return (
        f"aliased: the drive at {drive} is above half of the sample rate of {format_si(sample_rate, 'Hz', digits=6)}"
        f"{appears}; the samples show neither its wave nor its peaks"
    )


def _read_back(raw: RawPart, steps: SetPointSteps) -> Iterator[str]:
    """Yield settings of the drive as they were read back, each with its time since the first sample."""
    for sample, answers in steps.read_back:
        time = 0.0 if sample is None else max(sample - raw.first_sample, 0) / raw.sample_rate
        yield f"{time:.6g} s: {answers}"


def _variables(raw: RawPart, steps: SetPointSteps) -> dict[str, str]:
    """Quantity of each variable by its name: that of the quantity; that of the channel where several share it.

    A channel whose name is its own keeps it. Set points follow what was measured. The voltage that was set is
    `voltage_peak_to_peak` too where none was measured.
    """
    measured = [channel.quantity for channel in raw.channels]
    names = {
        channel.quantity
        if channel.is_standard and measured.count(channel.quantity) == 1
        else channel.name: channel.quantity
        for channel in raw.channels
    }
    set_points = {name: name for name in steps.names if name not in names}
    return names | ({_VOLTAGE: _VOLTAGE} if _tells_voltage(raw, steps) else {}) | set_points


def _tells_voltage(raw: RawPart, steps: SetPointSteps) -> bool:
    """Whether the voltage that was set stands for one that was not measured."""
    return steps.drives and all(channel.quantity != _VOLTAGE for channel in raw.channels)


def _caveats(raw: RawPart, steps: SetPointSteps) -> list[str]:
    """Caveats of the recording."""
    found = []
    if raw.gaps:
        at = (raw.gaps[0].sample - raw.first_sample) / raw.sample_rate
        gaps = f"{len(raw.gaps)} gaps" if len(raw.gaps) > 1 else "a gap"
        found.append(f"{raw.missing} samples are missing in {gaps}, the first at {at:.6g} s")
    if raw.damaged:
        found.append(f"the raw blocks are damaged at {raw.damaged} places, whose samples are left out")
    if _tells_voltage(raw, steps):
        found.append("voltage_peak_to_peak is the voltage that was set, not measured")
    if raw.clock is not None:
        found.append(_clock_caveat(raw.clock))
    return found


def _clock_caveat(clock: PartClock) -> str:
    """Offset of the times of a part with a clock of its own, and its uncertainty, in one line."""
    offset, within = f"{clock.offset:.4g}", format_si(clock.uncertainty, "s", digits=2)
    return (
        f"clock {clock.name}: time 0 is {offset} s after that of part {clock.part} of the recording, within {within};"
        " the clocks drift apart, and set points are placed by the clock of the computer"
    )


def _pieces(path: Path, raw: RawPart, steps: SetPointSteps, beside: list[str]) -> Pieces:
    """Pieces of raw blocks: time, channels, and the set points beside them."""
    blocks: list[Block] = []
    rows = 0
    for block in read_raw_blocks(path):
        blocks.append(block)
        rows += block.samples
        if rows >= ROWS:
            yield _piece(blocks, raw, steps, beside)
            blocks, rows = [], 0
    if blocks:
        yield _piece(blocks, raw, steps, beside)


def _piece(blocks: list[Block], raw: RawPart, steps: SetPointSteps, beside: list[str]) -> tuple[Floats, list[Floats]]:
    """Time and columns of consecutive blocks."""
    numbers = np.concatenate([np.arange(block.first_sample, block.next_sample) for block in blocks])
    values = np.concatenate([block.values for block in blocks])
    columns = [np.ascontiguousarray(values[:, column]) for column in range(values.shape[1])]
    columns += [steps.at(_SET_VOLTAGE if name == _VOLTAGE else name, numbers) for name in beside]
    return (numbers - raw.first_sample) / raw.sample_rate, columns


def converted_part(path: Path) -> PartOfRecording:
    """Part of a recording by its netCDF file."""
    import h5netcdf

    try:
        with h5netcdf.File(path, "r") as file:
            attributes: dict[str, Any] = dict(file.attrs)
            time = file["time"]
            rate, samples = float(attributes["sample_rate"]), int(time.shape[0])
            spanned = round(float(time[-1]) * rate) + 1 if samples else 0
            measured = {name: str(variable.attrs.get("quantity", name)) for name, variable in file.variables.items()}
            units = {name: str(file[name].attrs["units"]) for name, of in measured.items() if of not in quantities()}
            clock = _clock(attributes)
            told = {
                name: {each: file[name].attrs[each] for each in SENSOR_ATTRIBUTES if each in file[name].attrs}
                for name in measured
            }
            begun = utc_time(str(attributes["begun"]))
    except (OSError, KeyError, ValueError) as failure:
        raise InvalidInput(f"{path}: is no recording of a run: {failure}") from None
    measured.pop("time")
    return PartOfRecording(
        path=path,
        samples=samples,
        missing=spanned - samples,
        sample_rate=rate,
        begun=begun,
        variables=measured,
        units={name: "" if unit == "1" else unit for name, unit in units.items()},
        clock=clock,
        set_points=tuple(name for name in measured if name in SET_POINT_CHANNELS),
        lubricants=tuple(json.loads(str(attributes.get("lubricants", "[]")))),
        caveats=str(attributes.get("caveats", "")).splitlines(),
        pieces=partial(_pieces_of_file, path, samples, list(measured)),
        measured={name: each for name, each in told.items() if each},
        read_back=tuple(str(attributes.get("drive_read_back", "")).splitlines()),
        run_identifier=str(attributes.get("id", "")),
    )


def _pieces_of_file(path: Path, samples: int, names: list[str]) -> Pieces:
    """Pieces of the netCDF file of a part."""
    import h5netcdf

    with h5netcdf.File(path, "r") as file:
        for first in range(0, samples, ROWS):
            rows = slice(first, first + ROWS)
            yield file["time"][rows], [file[name][rows] for name in names]


def _clock(attributes: Mapping[str, Any]) -> PartClock | None:
    """Clock of a part by the attributes of its file; None for that of the run."""
    if "clock_name" not in attributes:
        return None
    return part_clock({name: attributes[f"clock_{name}"] for name in PartClock.__slots__})


def drop_raw_blocks(folder: Path) -> tuple[str, ...]:
    """Remove the raw blocks of a run that has ended, each part once its recording was found to hold every sample.

    Parameters
    ----------
    folder : Path

    Returns
    -------
    tuple of str
        What was removed, a line a part.

    Raises
    ------
    InvalidInput
        If the run is at work or was not recovered, or a recording is missing, was changed or differs from its blocks.
    """
    known, documents = read_run_facts(folder), read_documents(folder)
    with locked_folder(folder, purpose=PURPOSE):
        if not documents.of("stop"):
            raise InvalidInput(f"{folder}: has not ended in order; run sonolube lab recover first")
        parts = {number: recorded_part(folder, number, documents, facts=known.facts) for number in raw_parts(folder)}
        for number, part in parts.items():
            _require_converted(folder, number, part, known)
        done = []
        for number in parts:
            size = raw_path(folder, number).stat().st_size
            remove_file(raw_path(folder, number))
            done.append(f"{raw_path(folder, number).name} removed, {size / 1e6:.3g} MB")
    return tuple(done)


def _require_converted(folder: Path, number: int, part: PartOfRecording, known: RunFacts) -> None:
    """Raise unless the recording of a part holds every sample of its raw blocks, bit for bit, and none is damaged."""
    path = recording_path(folder, number, part.clock_name)
    if not part.samples:
        return
    if not path.is_file() or path.name not in known.recordings:
        raise InvalidInput(f"{folder}: {path.name} is missing or has no SHA-256; run sonolube lab recover first")
    if path.name in changed_recordings(folder, known):
        raise InvalidInput(f"{path}: was changed after the run wrote it; its raw blocks are kept")
    if part.damaged:
        raise InvalidInput(f"{part.path}: is damaged at {part.damaged} places, and is kept")
    import h5netcdf

    first = 0
    with h5netcdf.File(path, "r") as file:
        for time, columns in part.pieces():
            rows = slice(first, first + time.size)
            for name, values in zip(("time", *part.variables), (time, *columns), strict=True):
                if name not in file.variables or not np.array_equal(file[name][rows], values, equal_nan=True):
                    raise InvalidInput(f"{path}: {name} differs from the raw blocks, which are kept")
            first = rows.stop
        if file["time"].shape[0] != first:
            raise InvalidInput(f"{path}: has other samples than the raw blocks, which are kept")


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
        part if _VOLTAGE in part else part.assign({_VOLTAGE: ("time", np.zeros(part.sizes["time"]))}) for part in chosen
    ]
    for part in undriven:
        part["voltage_peak_to_peak"].attrs["units"] = "V"
    joined = join_recordings(undriven)
    return joined.isel(time=np.isfinite(joined["normal_load"].to_numpy()))
