"""Task `identify decay-length`: what sets the decay length of a worn contact, from a run with switched vibration."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from sonolube.errors import InvalidInput
from sonolube.identification import (
    DecayLengthDecision,
    Interval,
    SwitchConditions,
    SwitchTable,
    decide_decay_length,
    decision_chart,
    decision_dataset,
    recorded_switches,
    switch_table,
)
from sonolube.identification.decay_length.verdict import HYPOTHESES
from sonolube.input_files import open_input
from sonolube.measurement.file_format import refuse_unreadable
from sonolube.measurement.measured_runs import read_runs
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.reader import read_recording
from sonolube.report import Drawing
from sonolube.tasks.answer import Answer, answer
from sonolube.tasks.blocks import Block, Rows
from sonolube.tasks.files import InputFile, file_path
from sonolube.tasks.own_tables import Mapped, mapping_of
from sonolube.tasks.parameters import Number, Parameter, Stop, Watch, file_stem
from sonolube.tasks.progress import stage
from sonolube.tasks.task import in_si, refuse_unused, shown, task
from sonolube.units import format_si

if TYPE_CHECKING:
    import xarray as xr

_HEAD = 4096  # bytes of a file in which a table names its columns
_UTF_16 = (b"\xff\xfe", b"\xfe\xff")
_DISTANCES = ("sliding_distance", "sliding distance", "gleitweg")
_TIMES = ("time", "zeit")
_FEW_DRAWS = 30.0  # effective, below which probabilities are coarse
_CAPTION = (
    "Readings at the switches of the vibration over the sliding distance, with the most probable course of each"
    " hypothesis; the zero with its smoothed course."
)
_FILE = Parameter(
    help="Table of the switches of one run (CSV), or its recording with friction_force, voltage_peak_to_peak,"
    " normal_load, stack_current and shifts.",
    kind="FILE",
    is_file=True,
)


@task
def decay_length(
    file: Annotated[InputFile, _FILE],
    *,
    vibration: Annotated[
        Number, Parameter(help="Of the vibration along the normal, at the beginning.", unit="m")
    ] = "2.3um",
    frequency: Annotated[Number, Parameter(help="Of the vibration.", unit="Hz", quantity="frequency")] = "22kHz",
    sliding_speed: Annotated[Number, Parameter(help="Sliding speed.", unit="m/s", quantity="sliding_speed")] = "65mm/s",
    load: Annotated[Number, Parameter(help="Normal load.", unit="N")] = "5N",
    free_frequency: Annotated[
        Number | None, Parameter(help="Of the slow mode, pin free; needed where shifts are not small.", unit="Hz")
    ] = None,
    modal_mass: Annotated[
        Number | None, Parameter(help="Of the slow mode at the contact; gives contact stiffnesses.", unit="kg")
    ] = None,
    large_amplitude: Annotated[
        Number | None, Parameter(help="Of the slow mode at large drive; that of the vibration by default.", unit="m")
    ] = None,
    rotation_speed: Annotated[
        Number | None, Parameter(help="Of the disc, to remove its wobble from a recording.", unit="1/s")
    ] = None,
    mapping: Mapped = None,
    seed: Annotated[int, Parameter(help="Seed of the sampling; equal seeds give equal results.", lowest=0)] = 0,
    progress: Watch = None,
    cancelled: Stop = None,
) -> "DecayLengthAnswer":
    """What sets the decay length: long sliding, a zero error, detuning or the rig, from a run with switched vibration.

    Example: sonolube identify decay-length examples/decay-length-run.csv --free-frequency 40Hz
    """
    if modal_mass is None:
        refuse_unused("load", because=f"without {shown('modal_mass')}, which makes shifts contact stiffnesses")
    elif free_frequency is None:
        needed = f"{shown('free_frequency')}, the natural frequency of that mode with the pin free"
        raise InvalidInput(f"{shown('modal_mass')} needs {needed}")
    conditions = SwitchConditions(
        normal_load=in_si("load", load),
        vibration_amplitude=in_si("vibration", vibration),
        frequency=in_si("frequency", frequency),
        sliding_speed=in_si("sliding_speed", sliding_speed),
        large_drive_amplitude=in_si("large_amplitude", large_amplitude),
        natural_frequency=in_si("free_frequency", free_frequency),
        modal_mass=in_si("modal_mass", modal_mass),
    )
    path, columns = file_path(file), mapping_of(mapping)
    with stage("weighing"):
        if _is_table(path, columns):
            refuse_unused("rotation_speed", because="for a table of switches; it is for recordings")
            table = switch_table(read_runs(path, mapping=columns))
        else:
            table = recorded_switches(
                read_recording(path, mapping=columns),
                sliding_speed=conditions.sliding_speed,
                rotation_speed=in_si("rotation_speed", rotation_speed),
            )
        decision = decide_decay_length(table, conditions, seed=seed)
    name = f"{file_stem(file)}-decay-length"
    return DecayLengthAnswer(table=table, conditions=conditions, decision=decision, name=name)


@answer
class DecayLengthAnswer(Answer):
    """Probabilities of the hypotheses about the decay length, the changes that were found, and the verdict."""

    table: SwitchTable
    conditions: SwitchConditions
    decision: DecayLengthDecision
    name: str

    def blocks(self) -> Sequence[Block]:
        """Verdict, advice, probabilities and changes."""
        found = self.decision
        known = self.conditions
        settings = ", ".join(
            format_si(value, unit)
            for value, unit in (
                (known.normal_load, "N"),
                (known.vibration_amplitude, "m"),
                (known.frequency, "Hz"),
                (known.sliding_speed, "m/s"),
            )
        )
        switches = self.table.sliding_distance.size
        distance = format_si(float(self.table.sliding_distance[-1]), "m")
        probabilities = [
            (HYPOTHESES[name].partition(":")[0], f"{100 * value:.1f} %")
            for name, value in sorted(found.probabilities.items(), key=lambda item: -item[1])
        ]
        changes = [
            ("decay length grows", f"by a factor of {_factor(found.growth)}"),
            ("amplitude falls", f"by a factor of {_factor(found.fall)}"),
            ("zero, if not subtracted", f"makes the decay length wrong by a factor of {_factor(found.zero_factor)}"),
            ("decay length", f"{_length(found.length_at_start)} at first, {_length(found.length_at_end)} at last"),
        ]
        return [
            found.verdict,
            *([f"repeat: {found.advice}"] if found.advice else []),
            f"{self.table.title}: {switches} switches over {distance}; {settings}",
            Rows([*probabilities, *changes]),
        ]

    def object(self) -> dict[str, Any]:
        """Verdict, advice, probabilities, changes with their 80 % intervals, and misfits."""
        found = self.decision
        return {
            "verdict": found.verdict,
            "decided": found.decided,
            "leading": found.leading,
            "advice": found.advice,
            "probabilities": dict(found.probabilities),
            "growth": _interval(found.growth, ""),
            "fall": _interval(found.fall, ""),
            "zero_factor": _interval(found.zero_factor, ""),
            "decay_length_at_start": _interval(found.length_at_start, "m"),
            "decay_length_at_end": _interval(found.length_at_end, "m"),
            "misfits": dict(found.misfits),
            "effective_draws": found.effective_draws,
            "switches": int(self.table.sliding_distance.size),
        }

    def caveats(self) -> Sequence[str]:
        """What the run lacks, and what the analysis takes for granted."""
        lacking = [f"{name} is read at fewer than eight switches and does not enter" for name in self.table.missing]
        shifts = {"small_drive_shift", "large_drive_shift"} - set(self.table.missing)
        small = (
            ["the free frequency is not stated: shifts count as small against the frequency of the mode"]
            if shifts and self.conditions.natural_frequency is None
            else []
        )
        coarse = self.decision.effective_draws < _FEW_DRAWS
        return (
            *self.table.caveats,
            *lacking,
            *small,
            *(["few effective draws: probabilities are coarse; try another seed"] if coarse else []),
            "a zero that is off only under load is not seen with the pin lifted",
            "decay lengths rest on asperity stick-slip",
        )

    def figures(self) -> Mapping[str, Drawing]:
        """Readings over the distance with the courses of the hypotheses."""
        return {self.name: Drawing(chart=lambda: decision_chart(self.table, self.decision), caption=_CAPTION)}

    def files(self) -> "Mapping[str, xr.Dataset]":
        """Readings and courses as netCDF."""
        return {f"{self.name}.nc": decision_dataset(self.table, self.decision)}


def _is_table(file: Path, mapping: RecordingMapping | None) -> bool:
    """Whether a file is a table of switches: its mapping or its head names the sliding distance and no time."""
    if mapping is not None and "sliding_distance" in mapping.channels:
        return mapping.axis is None
    with refuse_unreadable(file), open_input(file) as stream:
        head = stream.read(_HEAD)
    lines = head.decode("utf-16" if head[:2] in _UTF_16 else "latin-1", errors="ignore").splitlines()
    labels = next((line.lower() for line in lines if line.strip() and not line.startswith("#")), "")
    return any(name in labels for name in _DISTANCES) and not any(name in labels for name in _TIMES)


def _interval(found: Interval, unit: str) -> dict[str, Any]:
    """Interval for JSON."""
    return {"value": found.median, "lower": found.lower, "upper": found.upper, "unit": unit}


def _factor(found: Interval) -> str:
    """Factor with its 80 % interval."""
    return f"{found.median:.2f} (80 %: {found.lower:.2f} to {found.upper:.2f})"


def _length(found: Interval) -> str:
    """Length with its 80 % interval."""
    return f"{1e6 * found.median:.2f} um (80 %: {1e6 * found.lower:.2f} to {1e6 * found.upper:.2f})"
