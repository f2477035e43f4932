"""Friction of catalogued runs, measured from their recordings, as a table of runs."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.errors import InvalidInput, SonolubeError
from sonolube.laboratory.catalogue.entry import CatalogueEntry
from sonolube.laboratory.catalogue.index import query_runs
from sonolube.laboratory.catalogue.query import query_from
from sonolube.laboratory.records import Run, read_run
from sonolube.measurement.friction_analysis import analyse_rotation_speed, analyse_voltage_steps, channel_values
from sonolube.measurement.measured_runs import runs_of_rows
from sonolube.measurement.statistics.autocorrelation import correlated_mean

if TYPE_CHECKING:
    import xarray as xr

CATALOGUE_PREFIX: Final = "catalogue:"
"""Beginning of a text that stands for a table of runs, such as catalogue:material=brass,load=5N."""

RUNS_FOLDER: Final = Path("runs")
"""Folder of runs where a query names none by `in=FOLDER`."""

_SETTLING: Final = 0.5  # s, left out at the begin of each level, as `analyse_voltage_steps` does
_HEADER: Final = (
    *("run", "block", "normal_load [N]", "sliding_speed [m/s]", "voltage_peak_to_peak [V]", "frequency [Hz]"),
    *("friction_force [N]", "friction_force_uncertainty [N]", "friction_reduction", "friction_reduction_uncertainty"),
    *("nominal_area [m2]", "study", "source", "note"),
)


def catalogued_runs(text: str) -> "xr.Dataset":
    r"""Measured runs that a query of the catalogue finds, as `sonolube.measurement.measured_runs.read_runs`.

    Parameters
    ----------
    text : str
        Such as ``catalogue:material=brass,load=3N..6N,in=runs``; conditions by commas, a comma within one as ``\,``.

    Returns
    -------
    xarray.Dataset
        A row for each level of the voltage in each run.

    Raises
    ------
    InvalidInput
        If the query cannot be read, finds no run, or none has friction that can be measured.
    """
    parent, values = _conditions(text)
    found = query_runs(parent, query_from(values))
    if not found.entries:
        raise InvalidInput(f"{text}: finds none of {found.of} runs in {parent}; sonolube lab runs {parent} lists them")
    rows: list[list[str]] = []
    refused = list(found.caveats)
    for entry in found.entries:
        try:
            rows += _rows(entry)
        except SonolubeError as failure:
            refused.append(f"{entry.summary.folder.name}: left out: {failure}")
    if not rows:
        raise InvalidInput(f"{text}: no friction can be measured: {refused[-1]}")
    runs = runs_of_rows(Path(text), [list(_HEADER), *rows])
    caveats = [line for line in (str(runs.attrs.get("caveats", "")), *refused) if line]
    return runs.assign_attrs(
        title=f"{text.removeprefix(CATALOGUE_PREFIX) or 'all runs'}, in %", caveats="\n".join(caveats)
    )


def _conditions(text: str) -> tuple[Path, dict[str, list[str]]]:
    """Folder and conditions of a query."""
    parent = RUNS_FOLDER
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


def _rows(entry: CatalogueEntry) -> list[list[str]]:
    """Rows of one run."""
    run = read_run(entry.summary.folder)
    run.dataset(1)  # refuses runs without a recording
    drives = [note.facts for note in run.notes if note.kind == "drive" and note.facts.get("voltage_peak_to_peak")]
    frequency = drives[-1].get("frequency", "") if drives else run.facts.get("frequency", "")
    block, area = run.facts.get("block", ""), run.facts.get("nominal_area", "")
    told = (str(area), entry.summary.title, str(entry.summary.folder), "")
    return [
        [
            *(entry.summary.folder.name, str(block), _cell(entry.normal_load), _cell(entry.sliding_speed)),
            *(_cell(voltage), str(frequency if voltage else ""), *map(_cell, numbers), *told),
        ]
        for part in range(1, len(run.recordings) + 1)
        for voltage, *numbers in _levels(run, part)
    ]


def _levels(run: Run, part: int) -> Iterator[Sequence[float | None]]:
    """Voltage, friction and its uncertainty, reduction and its uncertainty, of each level in a part of a recording."""
    recording = run.dataset(part)
    if not {"voltage_peak_to_peak", "stack_voltage"} & set(recording.variables):
        mean = correlated_mean(channel_values(recording, "friction_force"))
        yield (None if run.known.referenced else 0.0), mean.mean, mean.uncertainty, None, None
        return
    try:
        steps = analyse_voltage_steps(recording, rotation_speed=analyse_rotation_speed(recording))
    except InvalidInput:
        yield from _separate_levels(recording)
        return
    for step in steps:
        yield (
            step.voltage_peak_to_peak,
            step.friction_force,
            step.friction_force_uncertainty,
            step.friction_reduction,
            step.friction_reduction_uncertainty,
        )


def _separate_levels(recording: "xr.Dataset") -> Iterator[Sequence[float | None]]:
    """Levels of a recording whose steps do not tell a reduction, as without a part at 0 V: the mean of each voltage."""
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
