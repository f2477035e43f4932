"""Synthetic recordings written in every format and read back, against what was written."""

import random
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from reliability.study import Measure, Record, Study
from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.mapping import RecordingMapping, Selection
from sonolube.measurement.recordings.reader import read_recording

# Units as instruments write them: quantity, unit as written, SI value = gain * written value + offset
_UNITS = (
    ("friction_force", "N", 1.0, 0.0),
    ("friction_force", "mN", 1e-3, 0.0),
    ("normal_load", "kN", 1e3, 0.0),
    ("displacement", "µm", 1e-6, 0.0),
    ("temperature", "°C", 1.0, 273.15),
    ("temperature", "K", 1.0, 0.0),
    ("rotation_speed", "rpm", 1 / 60, 0.0),
    ("relative_velocity", "mm/s", 1e-3, 0.0),
    ("stack_voltage", "Volts", 1.0, 0.0),
    ("friction_coefficient", "", 1.0, 0.0),
)
_ENCODINGS = ("utf-8", "utf-8-sig", "cp1252", "utf-16")
_GRAM_FORCE = 9.80665e-3


@dataclass(frozen=True, slots=True)
class _Channel:
    """One channel as it is written, and what it means."""

    name: str
    unit: str
    gain: float
    offset: float
    values: np.ndarray

    @property
    def si(self) -> np.ndarray:
        """Values in SI."""
        return self.gain * self.values + self.offset


@dataclass(frozen=True, slots=True)
class _Truth:
    """What must be read: time and channels in SI."""

    time: np.ndarray
    channels: dict[str, np.ndarray]
    mapping: RecordingMapping | None = None
    units: Mapping[str, str] = field(default_factory=dict)  # of channels that the vocabulary does not know


Writer = Callable[[Path, random.Random], _Truth]


def _channels(rng: random.Random, rows: int, *, gaps: bool) -> list[_Channel]:
    """Channels of different quantities with six digits, some values missing."""
    chosen = {unit[0]: unit for unit in rng.sample(_UNITS, rng.randint(1, 6))}
    noise = np.random.default_rng(rng.getrandbits(32))
    channels = []
    for name, unit, gain, offset in chosen.values():
        scale = 10.0 ** rng.randint(-2, 3)
        values = np.array([float(f"{value:.6g}") for value in scale * noise.standard_normal(rows)])
        if gaps and rng.random() < 0.4:
            values[noise.random(rows) < 0.2] = np.nan
            values[0] = 1.0
        channels.append(_Channel(name, unit, gain, offset, values))
    return channels


def _times(rng: random.Random, rows: int) -> np.ndarray:
    """Even times with a rate of 1 Hz to 100 kHz, as the decimal numbers that are written."""
    step = rng.choice((1.0, 0.1, 0.0025, 1e-3, 1e-5))
    return np.array([float(f"{step * row:.10g}") for row in range(rows)])


def _number(value: float, sign: str) -> str:
    """Number as text with a decimal sign; an empty cell for a missing value."""
    return "" if np.isnan(value) else repr(float(value)).replace(".", sign)


def _csv(path: Path, rng: random.Random) -> _Truth:
    rows = rng.randint(2, 40)
    time, channels = _times(rng, rows), _channels(rng, rows, gaps=True)
    separator = rng.choice(",;\t|")
    sign = "." if separator == "," else rng.choice(".,")
    bracket = rng.choice(("{} [{}]", "{} ({})"))
    labels = [bracket.format("time", "s")] + [bracket.format(own.name, own.unit) for own in channels]
    table = [[_number(at, sign)] + [_number(own.values[row], sign) for own in channels] for row, at in enumerate(time)]
    if rng.random() < 0.3:  # a column of text
        labels.append("note")
        table = [[*cells, rng.choice(("Überlast", '"a, b"', ""))] for cells in table]
    newline = rng.choice(("\n", "\r\n"))
    text = newline.join(separator.join(cells) for cells in [labels, *table]) + newline
    path.write_bytes(text.encode(rng.choice(_ENCODINGS)))
    return _Truth(time, {own.name: own.si for own in channels})


def _lvm(path: Path, rng: random.Random) -> _Truth:
    columns = rng.choice(("No", "One", "Multi"))
    sign, separator = rng.choice(((".", "\t"), (",", "\t"), (".", ",")))
    step = rng.choice((1.0, 0.1, 0.0025, 1e-3))
    lengths = [rng.randint(2, 25) for _ in range(rng.randint(1, 3))]
    channels = _channels(rng, sum(lengths), gaps=True)
    header = {"Writer_Version": "2", "Separator": "Comma" if separator == "," else "Tab", "Decimal_Separator": sign}
    header |= {"Multi_Headings": "Yes", "X_Columns": columns, "Date": "2016/03/04", "Time": "14:10:11"}
    lines = [f"LabVIEW Measurement{separator}"]
    lines += [f"{key}{separator}{value}" for key, value in header.items()] + [f"***End_of_Header***{separator}", ""]
    gap = separator * (2 if columns == "Multi" and rng.random() < 0.8 else 1)
    times, first, at = [], 0, 0.0
    for length in lengths:
        keys = {
            "Samples": [str(length)] * len(channels),
            "Date": ["2016/03/04"] * len(channels),
            "Time": [f"14:10:{11 + int(at):02}.{round(at % 1 * 10)}"] * len(channels),
            "Y_Unit_Label": [own.unit for own in channels],
            "X_Dimension": ["Time"] * len(channels),
            "X0": [_number(0.0, sign)] * len(channels),
            "Delta_X": [_number(step, sign)] * len(channels),
        }
        lines += [f"Channels{separator}{len(channels)}"]
        lines += [key + separator + gap.join(cells) + separator for key, cells in keys.items()]
        lines += ["***End_of_Header***"]
        names = [own.name for own in channels]
        if columns == "Multi":
            lines += [separator.join(f"X_Value{separator}{name}" for name in names) + f"{separator}Comment"]
        else:
            lines += [separator.join(["X_Value", *names, "Comment"])]
        for row in range(length):
            own_time = "" if columns == "No" else _number(float(f"{step * row:.10g}"), sign)
            values = [_number(own.values[first + row], sign) for own in channels]
            cells = [own_time, *values] if columns != "Multi" else [c for value in values for c in (own_time, value)]
            lines.append(separator.join(cells) + (f"{separator}Größe" if rng.random() < 0.1 else ""))
        lines.append("")
        times.append(at + np.array([float(f"{step * row:.10g}") for row in range(length)]))
        first, at = first + length, round(at + np.ceil(length * step) + rng.randint(0, 3), 1)
    if at > 40:  # the clock in the headers would pass its minute
        return _lvm(path, rng)
    path.write_bytes("\r\n".join(lines).encode(rng.choice(_ENCODINGS[:3])))
    return _Truth(np.concatenate(times), {own.name: own.si for own in channels})


def _lvm_of_two_rates(path: Path, rng: random.Random) -> _Truth:
    """Channels with a time column and a length of their own, of which one is read."""
    sign = rng.choice(".,")
    steps, lengths = rng.sample((1.0, 0.1, 0.0025), 2), rng.sample(range(2, 30), 2)
    channels = [_channels(rng, length, gaps=False)[0] for length in lengths]
    names = ["fast", "slow"]
    spaced = "\t" if rng.random() < 0.5 else "\t\t"
    keys = {
        "Samples": [str(length) for length in lengths],
        "Y_Unit_Label": [own.unit for own in channels],
        "X_Dimension": ["Time", "Time"],
        "X0": [_number(0.0, sign)] * 2,
        "Delta_X": [_number(step, sign) for step in steps],
    }
    lines = ["LabVIEW Measurement\t", "Writer_Version\t2", "Separator\tTab", f"Decimal_Separator\t{sign}"]
    lines += ["Multi_Headings\tYes", "X_Columns\tMulti", "***End_of_Header***\t", "", "Channels\t2"]
    lines += [f"{key}\t{spaced.join(cells)}\t" for key, cells in keys.items()]
    lines += ["***End_of_Header***\t", "X_Value\tfast\tX_Value\tslow\tComment"]
    for row in range(max(lengths)):
        pairs = [
            [_number(float(f"{step * row:.10g}"), sign), _number(own.values[row], sign)] if row < length else ["", ""]
            for step, own, length in zip(steps, channels, lengths, strict=True)
        ]
        lines.append("\t".join(pairs[0] + pairs[1]))
    path.write_bytes("\r\n".join([*lines, "", ""]).encode("cp1252"))
    index = rng.randrange(2)
    time = np.array([float(f"{steps[index] * row:.10g}") for row in range(lengths[index])])
    mapping = RecordingMapping(channels={}, selection=Selection(channels=(names[index],)))
    own = channels[index]
    return _Truth(time, {names[index]: own.values}, mapping, {names[index]: own.unit or "1"})


def _groups(rng: random.Random) -> dict[str, tuple[float, list[_Channel]]]:
    """One to three groups of different lengths, each with its interval and channels."""
    names = rng.sample(("fast", "slow", "Messung Ü", "g"), rng.randint(1, 3))
    lengths = rng.sample(range(2, 60), len(names))
    return {
        name: (rng.choice((1.0, 0.1, 0.0025)), _channels(rng, length, gaps=False))
        for name, length in zip(names, lengths, strict=True)
    }


def _truth_of_group(groups: dict[str, tuple[float, list[_Channel]]], rng: random.Random, *, units: bool) -> _Truth:
    """Truth of one of the groups, with the mapping that selects it."""
    name = rng.choice(sorted(groups))
    interval, channels = groups[name]
    mapping = None if len(groups) == 1 else RecordingMapping(channels={}, selection=Selection(group=name))
    time = interval * np.arange(channels[0].values.size)
    return _Truth(time, {own.name: own.si if units else own.values for own in channels}, mapping)


def _tdms(path: Path, rng: random.Random) -> _Truth:
    from nptdms import ChannelObject, TdmsWriter

    groups = _groups(rng)
    parts = rng.randint(1, 3)
    with TdmsWriter(path) as writer:
        for part in range(parts):
            objects = [
                ChannelObject(group, own.name, pieces[part], {"wf_increment": interval, "unit_string": own.unit})
                for group, (interval, channels) in groups.items()
                for own in channels
                if (pieces := np.array_split(own.values, parts))[part].size
            ]
            writer.write_segment(objects)
    return _truth_of_group(groups, rng, units=True)


def _hdf5(path: Path, rng: random.Random) -> _Truth:
    import h5py

    groups = _groups(rng)
    with h5py.File(path, "w") as file:
        for group, (interval, channels) in groups.items():
            place = file if len(groups) == 1 else file.create_group(group)
            for own in channels:
                place[own.name] = own.values
                place[own.name].attrs["units"] = own.unit or "1"
                place[own.name].attrs["sample_rate"] = 1 / interval
    return _truth_of_group(groups, rng, units=True)


def _matlab(path: Path, rng: random.Random) -> _Truth:
    import scipy.io

    groups = {name.replace(" Ü", "_u"): group for name, group in _groups(rng).items()}
    content = {
        name: {"time": interval * np.arange(channels[0].values.size), **{own.name: own.values for own in channels}}
        for name, (interval, channels) in groups.items()
    }
    scipy.io.savemat(path, content if len(groups) > 1 else next(iter(content.values())))
    return _truth_of_group(groups, rng, units=False)  # MATLAB files hold no units: taken as SI


def _umt(path: Path, rng: random.Random) -> _Truth:
    unit, factor = rng.choice((("g", _GRAM_FORCE), ("N", 1.0), ("kg", 1e3 * _GRAM_FORCE)))
    lines = [
        "Created by CETR Data Viewer ver.2",
        "Created by CETR UMT ver.1",
        "Total number of runs - 1",
        "",
        "Run # 1",
    ]
    noise = np.random.default_rng(rng.getrandbits(32))
    steps = rng.randint(1, 4)
    parts: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []
    at = 0.0
    for number in range(1, steps + 1):
        rows = rng.randint(2, 30)
        time = np.round(0.02 * np.arange(rows), 4)
        force, load = np.round(100 * noise.random(rows), 6), np.round(50 + 100 * noise.random(rows), 6)
        lines += [f"Step No. {number}", "", "Step Type Code: 0", f"Data Count   = {rows}"]
        lines += [
            f"Started at: 12:21:{at + 10:06.3f} 12 May 2022",
            "",
            "Fx,Fz,Z,T,Ff,COF",
            f"{unit},{unit},mm,sec,{unit},",
        ]
        lines.append("")
        table = zip(force, load, time, strict=True)
        lines += [f"{-f:.6f},{-load:.6f},-0.69,{t:.4f},{f:.6f},{f / load:.6f}" for f, load, t in table]
        lines += ["", ""]
        parts.append((at + time, force, load))
        at = round(at + time[-1] + 0.02 + rng.random(), 3)
    if rng.random() < 0.3:
        lines += ["Statistics", "mean,max", "0.3,0.5"]
    path.write_bytes((rng.choice(("\n", "\r\n"))).join([*lines, ""]).encode())
    wanted = sorted(rng.sample(range(steps), rng.randint(1, steps)))
    chosen = [parts[index] for index in wanted]
    time, force, load = (np.concatenate(column) for column in zip(*chosen, strict=True))
    mapping = None
    if len(wanted) < steps:
        names = tuple(rng.choice((f"{index + 1}", f"Step No. {index + 1}")) for index in wanted)
        mapping = RecordingMapping(channels={}, selection=Selection(sections=names))
    return _Truth(time - time[0], {"friction_force": factor * force, "normal_load": factor * load}, mapping)


def _anton_paar(path: Path, rng: random.Random) -> _Truth:
    nano = rng.random() < 0.5
    noise, rows, sign = np.random.default_rng(rng.getrandbits(32)), rng.randint(2, 40), rng.choice(".,")
    labels = (
        "Time [s]\tDistance [m]\tlaps\tSequence ID\tCycle ID\tMax linear speed [m/s]\tNominal Load [mN]\tµ\tAngle [°]\t"
        "Normal force [mN]\tFriction force [mN]\tPenetration depth [µm]"
        if nano
        else "Time [s]\tDistance [m]\tLaps\tSequence ID\tCycle ID\tMax Linear Speed [m/s]\tNominal Load [N]\tµ\t"
        "Angle [°]\t"
        "Friction Force [N]\tTemperature [°C]\tHumidity [%]\tPenetration Depth [µm]"
    ).split("\t")
    values = np.round(10 * noise.random((rows, len(labels))), 5)
    values[:, 0] = np.round(rng.choice((0.1, 0.0025, 1.0)) * np.arange(rows), 6)
    preamble = ["Tribometer", "Operator\tÜmit", "Single-way mode", ""][: rng.randint(0, 4)]
    lines = [*preamble, "\t".join(labels), *("\t".join(_number(value, sign) for value in row) for row in values), ""]
    path.write_bytes(rng.choice(("\n", "\r\n")).join(lines).encode(rng.choice(_ENCODINGS)))
    column = dict(zip(labels, values.T, strict=True))
    truth = {"friction_coefficient": column["µ"], "sliding_distance": column["Distance [m]"]}
    if nano:
        truth |= {
            "friction_force": 1e-3 * column["Friction force [mN]"],
            "normal_load": 1e-3 * column["Normal force [mN]"],
        }
    else:
        truth |= {"friction_force": column["Friction Force [N]"], "normal_load": column["Nominal Load [N]"]}
        truth["temperature"] = column["Temperature [°C]"] + 273.15
    return _Truth(column["Time [s]"], truth)


_WRITERS: dict[str, tuple[str, Writer]] = {
    "CSV": (".csv", _csv),
    "LVM": (".lvm", _lvm),
    "LVM of two rates": (".lvm", _lvm_of_two_rates),
    "TDMS": (".tdms", _tdms),
    "HDF5": (".h5", _hdf5),
    "MATLAB": (".mat", _matlab),
    "UMT": (".csv", _umt),
    "Anton Paar": (".txt", _anton_paar),
}


def _trial(seed: int) -> Record:
    rng = random.Random(seed)
    name = sorted(_WRITERS)[seed % len(_WRITERS)]
    suffix, write = _WRITERS[name]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"recording{suffix}"
        truth = write(path, rng)
        try:
            recording = read_recording(path, mapping=truth.mapping)
        except InvalidInput as refused:
            return {"format": name, "outcome": "refused", "why": str(refused).removeprefix(str(path))}
    wrong = [] if _equal(recording["time"].to_numpy(), truth.time) else ["time"]
    for channel, values in truth.channels.items():
        if channel not in recording or not _equal(recording[channel].to_numpy(), values):
            wrong.append(channel)
    wrong += [f"unit of {name}" for name, unit in truth.units.items() if recording[name].attrs["units"] != unit]
    return {"format": name, "outcome": "wrong" if wrong else "right", "why": ", ".join(wrong)}


def _equal(values: np.ndarray, truth: np.ndarray) -> bool:
    """Whether values are as written, missing ones missing, but for the rounding of conversions."""
    scale = float(np.nanmax(np.abs(truth), initial=1e-300))
    return values.shape == truth.shape and np.allclose(values, truth, rtol=1e-9, atol=1e-9 * scale, equal_nan=True)


def _measures(records: Sequence[Record]) -> list[Measure]:
    measures = []
    for outcome, label in (
        ("wrong", "files read with a wrong value, unit or time"),
        ("refused", "valid files refused"),
    ):
        found = [record for record in records if record["outcome"] == outcome]
        first = f", the first at seed {found[0]['seed']} ({found[0]['format']}: {found[0]['why']})" if found else ""
        measures.append(Measure(label=label, value=f"{len(found)} of {len(records)}{first}", bar="0", holds=not found))
    return measures


STUDY = Study(
    title="Recordings of every format",
    question=(
        "Files with random channels, units, rates, encodings, decimal signs, separators, missing values, groups,"
        " segments and sections, as LabVIEW, MATLAB, HDF5 and the software of tribometers write them, are read with the"
        " values, units and times they were written with."
    ),
    sources=(
        "measurement/recordings/*.py",
        "measurement/recordings/instruments/*.toml",
        "measurement/measured_files.py",
    ),
    trials=1000,
    sample=80,
    trial=_trial,
    measures=_measures,
)
