"""Recordings of catalogued runs: friction measured from them as a table of runs, and those made elsewhere taken in.

A run of a recording that was taken in has no protocol and refers to the files where they lie.
"""

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import pi
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.laboratory.catalogue.entry import CatalogueEntry, catalogue_entry
from sonolube.laboratory.catalogue.index import query_from, query_runs
from sonolube.laboratory.records import Run, read_run
from sonolube.laboratory.records.documents import DocumentLog
from sonolube.laboratory.records.run_folder import RESERVE, Facts, make_run_folder
from sonolube.measurement.friction.voltage_steps import VoltageStep
from sonolube.measurement.friction_analysis import (
    analyse_rotation_speed,
    analyse_voltage_steps,
    analyse_wobble,
    channel_values,
)
from sonolube.measurement.measured_runs import runs_of_rows
from sonolube.measurement.recorded_conditions import SetConditions, set_conditions
from sonolube.measurement.recordings.reader import recording_format_name
from sonolube.measurement.statistics.autocorrelation import correlated_mean
from sonolube.operating_system import remove_file

if TYPE_CHECKING:
    import xarray as xr


def take_in(parent: Path, source: Path, *, facts: Facts | None = None, title: str = "") -> Path:
    """Add a recording, or the recordings in a folder, to a folder of runs as one run without protocol.

    Parameters
    ----------
    parent : Path
        Folder of all runs.
    source : Path
        A file in any format of `sonolube.measurement.RECORDING_FORMATS`, or a folder of such files.
    facts : mapping of str to str, float, int or bool, optional
        As of `new_run`: pin_material, disc_material, normal_load, sliding_speed, tags, ...
    title : str
        Name of the source by default.

    Returns
    -------
    Path
        Folder of the run.

    Raises
    ------
    InvalidInput
        If there is no recording, or the folder cannot be written.

    Notes
    -----
    The files stay where they are: they may be large, and their owner may have other programs that expect them there.
    Their SHA-256 is kept, so that a later change is told.
    """
    paths = [path.resolve() for path in _recordings(source)]
    if not paths:
        raise InvalidInput(f"{source}: holds no recording that can be read; it needs TDMS, CSV, HDF5 or netCDF files")
    digests = {}
    for path in paths:
        with path.open("rb") as stream:
            digests[str(path)] = hashlib.file_digest(stream, "sha256").hexdigest()
    begun = min(path.stat().st_mtime for path in paths)
    folder, known = make_run_folder(
        parent, title=title or source.stem, begun=begun, texts={}, facts=facts or {}, referenced=digests
    )
    log = DocumentLog(folder)
    log.start(known)
    log.note("taken in", time=begun, sample=None, facts={"source": str(source.resolve())})
    log.stop("completed", reason="", time=begun)
    log.close()
    remove_file(folder / RESERVE)
    return folder


def _recordings(source: Path) -> list[Path]:
    """Files of a source that are recordings, by name."""
    candidates = sorted(source.iterdir()) if source.is_dir() else [source]
    found = []
    for path in candidates:
        if not path.is_file() or path.name.startswith(".") or path.suffix.lower() in _NO_RECORDINGS:
            continue
        try:
            recording_format_name(path)
        except InvalidInput:
            continue
        found.append(path)
    return found


_NO_RECORDINGS = (".toml", ".json", ".jsonl", ".md", ".tdms_index", ".html", ".png", ".pdf", ".svg")


CATALOGUE_PREFIX: Final = "catalogue:"
"""Beginning of a text that stands for a table of runs, such as catalogue:material=brass,load=5N."""

RUNS_FOLDER: Final = Path("runs")
"""Folder of runs where a query names none by `in=FOLDER`."""

_SETTLING: Final = 0.5  # s, left out at the begin of each level, as `analyse_voltage_steps` does
_FEWEST: Final = 20  # samples of a level
_SIGNIFICANT: Final = 3.0  # standard errors, from which a force counts as rising or falling
_HEADER: Final = (
    *("run", "block", "normal_load [N]", "sliding_speed [m/s]", "voltage_peak_to_peak [V]", "frequency [Hz]"),
    *("friction_force [N]", "friction_force_uncertainty [N]", "friction_reduction", "friction_reduction_uncertainty"),
    *("nominal_area [m2]", "study", "source", "note", "vibration_direction [rad]"),
    *("friction_coefficient", "friction_coefficient_uncertainty"),
)


def catalogued_runs(text: str, *, place: Path = RUNS_FOLDER) -> "xr.Dataset":
    r"""Measured runs that a query of the catalogue finds, as `sonolube.measurement.measured_runs.read_runs`.

    Parameters
    ----------
    text : str
        Such as ``catalogue:material=brass,load=3N..6N,in=runs``; conditions by commas, a comma within one as ``\,``.
    place : Path
        Folder of runs where the query names none.

    Returns
    -------
    xarray.Dataset
        A row for each level of the voltage in each run.

    Raises
    ------
    InvalidInput
        If the query cannot be read, finds no run, or none has friction that can be measured.
    """
    parent, values = _conditions(text, place)
    found = query_runs(parent, query_from(values))
    if not found.entries:
        raise InvalidInput(f"{text}: finds none of {found.of} runs in {parent}; sonolube lab runs {parent} lists them")
    rows, left_out = level_rows([entry.summary.folder for entry in found.entries])
    refused = [*found.caveats, *left_out]
    if len(rows) == 1:
        raise InvalidInput(f"{text}: no friction can be measured: {refused[-1]}")
    runs = runs_of_rows(Path(text), rows)
    caveats = [line for line in (str(runs.attrs.get("caveats", "")), *refused) if line]
    return runs.assign_attrs(
        title=f"{text.removeprefix(CATALOGUE_PREFIX) or 'all runs'}, in %", caveats="\n".join(caveats)
    )


def level_rows(folders: Sequence[Path]) -> tuple[list[list[str]], list[str]]:
    """Rows of a table of runs, a row for each level of the voltage in each run, under a row of headings.

    Parameters
    ----------
    folders : sequence of Path
        Of runs.

    Returns
    -------
    list of list of str
        The headings first; cells that are not known are empty.
    list of str
        What was left out, a line each.
    """
    rows, left_out = [list(_HEADER)], list[str]()
    for folder in folders:
        try:
            rows += _rows(catalogue_entry(folder), left_out)
        except SonolubeError as failure:
            left_out.append(f"{folder.name}: left out: {failure}")
    return rows, left_out


def _conditions(text: str, place: Path = RUNS_FOLDER) -> tuple[Path, dict[str, list[str]]]:
    """Folder and conditions of a query."""
    parent = place
    values: dict[str, list[str]] = {}
    marked = text.removeprefix(CATALOGUE_PREFIX).replace("\\,", "\0")
    for condition in filter(None, (each.strip() for each in marked.split(","))):
        key, sign, value = condition.replace("\0", ",").partition("=")
        if not sign:
            raise InvalidInput(f"{text}: condition {condition!r} must be KEY=VALUE, such as material=brass")
        if key.strip() == "in":
            parent = Path(value.strip())
        else:
            values.setdefault(key.strip(), []).append(value.strip())
    return parent, values


@dataclass(frozen=True, kw_only=True, slots=True)
class _Level:
    """Friction at one setting of a run, with what was set; None where it is not known."""

    voltage: float | None
    frequency: float | None = None
    load: float | None = None
    speed: float | None = None
    friction: tuple[float | None, ...] = (None,) * 4  # force and its uncertainty, reduction and its uncertainty


def _rows(entry: CatalogueEntry, left_out: list[str]) -> list[list[str]]:
    """Rows of one run; of levels that are left out, a line."""
    run = read_run(entry.summary.folder)
    run.dataset(1)  # refuses runs without a recording
    block, area = run.facts.get("block", ""), run.facts.get("nominal_area", "")
    direction = run.facts.get("vibration_direction", "")
    told = (str(area), entry.summary.title, str(entry.summary.folder), "", str(direction))
    rows = []
    lubricated = list[str]()
    for part in range(1, len(run.recordings) + 1):
        recording, has_load = _with_force(run.dataset(part), run)
        for level in _levels(run, part, recording, left_out, lubricated):
            setting = (level.load, level.speed, level.voltage, level.frequency if level.voltage else None)
            unknown, both = (None, None), level.friction[:2]
            force, coefficient = (both, unknown) if has_load else (unknown, both)
            numbers = map(_cell, (*setting, *force, *level.friction[2:]))
            rows.append([entry.summary.folder.name, str(block), *numbers, *told, *map(_cell, coefficient)])
    if lubricated:
        parts = "part " if len(lubricated) == 1 else "parts "
        left_out.append(
            f"{entry.summary.folder.name}: {parts}{', '.join(lubricated)} of the recording left out: lubricated, and"
            " models of friction are of dry contacts"
        )
    return rows


def _levels(
    run: Run, part: int, recording: "xr.Dataset", left_out: list[str], lubricated: list[str]
) -> Iterator[_Level]:
    """Friction at each dry setting of a part of a recording; of a part without friction a line, a lubricated one."""
    conditions = set_conditions(recording)
    if not conditions:
        entry = catalogue_entry(run.folder)
        if part == 1 and (len(entry.sliding_speeds) > 1 or len(entry.normal_loads) > 1):
            left_out.append(f"{run.folder.name}: has no set points, so that load or speed of its rows is not known")
        yield from _levels_of_protocol(run, recording)
        return
    if "friction_force" not in recording:
        left_out.append(
            f"{run.folder.name}: part {part} is left out: it has no channel friction_force, nor friction_coefficient"
        )
        return
    if any(stretch.slides and stretch.lubricant for stretch in conditions):
        lubricated.append(str(part))
    for stretch in conditions:
        if stretch.slides and not stretch.lubricant:
            yield from _levels_of_stretch(run, recording, stretch)


def _with_force(recording: "xr.Dataset", run: Run) -> tuple["xr.Dataset", bool]:
    """Recording with the friction force, and whether it is one.

    Of a recording that has the coefficient alone it is that under its load; under 1 N, and so the coefficient, where
    the load is not known.
    """
    if "friction_force" in recording or "friction_coefficient" not in recording:
        return recording, True
    load = recording["normal_load"] if "normal_load" in recording else catalogue_entry(run.folder).normal_load
    force = recording["friction_coefficient"] * (1.0 if load is None else load)
    force = force.assign_attrs(units="N", long_name="Friction force")
    return recording.assign(friction_force=force), load is not None


def _levels_of_stretch(run: Run, recording: "xr.Dataset", stretch: SetConditions) -> Iterator[_Level]:
    """Friction at each voltage of a stretch at constant speed and load."""
    piece = recording.isel(time=stretch.samples)
    frequencies = {round(voltage, 9): frequency for _, voltage, frequency in stretch.levels}
    turns = _rotation_speed(run, stretch)
    known = {"load": _known(stretch.normal_load), "speed": _known(stretch.sliding_speed)}
    if len(stretch.levels) > 1:
        try:
            steps = analyse_voltage_steps(piece, rotation_speed=turns or analyse_rotation_speed(piece))
        except InvalidInput:
            steps = ()
        for step in steps:
            voltage = min(frequencies, key=lambda each: abs(each - step.voltage_peak_to_peak))
            yield _Level(voltage=voltage, frequency=frequencies[voltage], friction=_friction(step), **known)
        if steps:
            return
    for samples, voltage, frequency in stretch.levels:
        mean = _mean_of(recording.isel(time=samples), turns)
        if mean is not None:
            yield _Level(voltage=voltage, frequency=frequency, friction=(*mean, None, None), **known)


def _mean_of(level: "xr.Dataset", rotation_speed: float | None) -> tuple[float, float] | None:
    """Mean friction force of a level and its standard uncertainty, settling and wobble removed; None of too few.

    The zero of the gauge holds at the beginning. Where the force rises or falls steadily, the gauge may have drifted,
    and half of that change counts as uncertainty of the mean.
    """
    time = channel_values(level, "time")
    settled = level.isel(time=slice(int(np.searchsorted(time, time[0] + _SETTLING)), None))
    if settled.sizes["time"] < _FEWEST:
        return None
    force = channel_values(settled, "friction_force")
    span = float(time[-1] - time[0]) - _SETTLING
    if rotation_speed is not None and rotation_speed * span > 1:
        force = analyse_wobble(settled, rotation_speed=rotation_speed, harmonics=2).friction_force
    mean, (half, residual) = correlated_mean(force), _steady_change(force)
    scatter = correlated_mean(residual).uncertainty
    is_steady = half > _SIGNIFICANT * np.sqrt(3) * scatter  # the standard error of half a change, by even samples
    return mean.mean, float(np.hypot(scatter, half)) if is_steady else mean.uncertainty


def _steady_change(force: Floats) -> tuple[float, Floats]:
    """Half of the change along the line of least squares, as a magnitude, and the force without that line."""
    place = np.linspace(-1.0, 1.0, force.size)
    half = float(place @ (force - force.mean()) / (place @ place))
    return abs(half), force - half * place


def _rotation_speed(run: Run, stretch: SetConditions) -> float | None:
    """Speed of the disc; None where the groove is not known. [1/s]"""
    diameter = run.facts.get("groove_diameter")
    if isinstance(diameter, int | float) and diameter > 0 and stretch.sliding_speed > 0:
        return stretch.sliding_speed / (pi * diameter)
    return None


def _known(value: float) -> float | None:
    """Value; None where it is NaN."""
    return None if np.isnan(value) else value


def _levels_of_protocol(run: Run, recording: "xr.Dataset") -> Iterator[_Level]:
    """Friction at each voltage of a recording without set points, at the load and speed of its facts or protocol."""
    entry = catalogue_entry(run.folder)
    drives = [note.facts for note in run.notes if note.kind == "drive" and note.facts.get("voltage_peak_to_peak")]
    stated = drives[-1].get("frequency") if drives else run.facts.get("frequency")
    known = {
        "frequency": float(stated) if isinstance(stated, int | float) else None,
        "load": entry.normal_load,
        "speed": entry.sliding_speed,
    }
    if not {"voltage_peak_to_peak", "stack_voltage"} & set(recording.variables):
        mean = correlated_mean(channel_values(recording, "friction_force"))
        unvibrated = None if run.known.referenced else 0.0
        yield _Level(voltage=unvibrated, friction=(mean.mean, mean.uncertainty, None, None), **known)
        return
    try:
        steps = analyse_voltage_steps(recording, rotation_speed=analyse_rotation_speed(recording))
    except InvalidInput:
        for voltage, *mean_and_more in _separate_levels(recording):
            yield _Level(voltage=voltage, friction=tuple(mean_and_more), **known)
        return
    for step in steps:
        yield _Level(voltage=step.voltage_peak_to_peak, friction=_friction(step), **known)


def _friction(step: VoltageStep) -> tuple[float | None, ...]:
    """Friction force and reduction of a step of the voltage, each with its uncertainty."""
    return (
        *(step.friction_force, step.friction_force_uncertainty),
        *(step.friction_reduction, step.friction_reduction_uncertainty),
    )


def _separate_levels(recording: "xr.Dataset") -> Iterator[Sequence[float | None]]:
    """Levels of a recording whose steps give no reduction, as without a part at 0 V: the mean of each voltage."""
    if "voltage_peak_to_peak" not in recording:
        raise InvalidInput("its voltage has no levels")
    time, force = channel_values(recording, "time"), channel_values(recording, "friction_force")
    voltage = channel_values(recording, "voltage_peak_to_peak")
    changes = np.flatnonzero(np.diff(voltage)) + 1
    for begin, end in zip([0, *changes], [*changes, voltage.size], strict=True):
        settled = slice(begin + np.searchsorted(time[begin:end], time[begin] + _SETTLING), end)
        if force[settled].size > 1:
            mean = correlated_mean(force[settled])
            yield float(voltage[begin]), mean.mean, mean.uncertainty, None, None


def _cell(value: float | None) -> str:
    """Number as a cell; empty where it is not known."""
    return "" if value is None or not np.isfinite(value) else repr(float(value))
