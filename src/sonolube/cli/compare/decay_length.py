"""Command `identify decay-length`: what sets the decay length of a worn contact, from a run with switched vibration."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from sonolube.cli.console.answer import Answer, aligned, deliver
from sonolube.cli.console.options import OUT, Json, Out, TypedNumber, refuse_unused, si_option
from sonolube.cli.console.outputs import OutputFolder
from sonolube.cli.console.progress import progress
from sonolube.compilation import few_points
from sonolube.errors import InvalidInput
from sonolube.identification import (
    DecayLengthDecision,
    Interval,
    SwitchConditions,
    SwitchTable,
    decide_decay_length,
    decision_dataset,
    decision_figure,
    recorded_switches,
    switch_table,
)
from sonolube.identification.decay_length.verdict import HYPOTHESES
from sonolube.input_files import open_input
from sonolube.measurement.file_format import refuse_unreadable
from sonolube.measurement.measured_runs import read_runs
from sonolube.measurement.recordings.reader import read_recording
from sonolube.report import Drawing
from sonolube.units import format_si

if TYPE_CHECKING:
    import xarray as xr

_HEAD = 4096  # bytes of a file in which a table names its columns
_FEW_DRAWS = 30.0  # effective, below which probabilities are coarse
_CAPTION = (
    "Readings at the switches of the vibration over the sliding distance, with the most probable course of each"
    " hypothesis; the zero with its smoothed course."
)


@few_points()
def decay_length(
    context: typer.Context,
    file: Annotated[
        Path,
        typer.Argument(
            metavar="FILE",
            help="Table of the switches of one run (CSV), or its recording with friction_force, voltage_peak_to_peak,"
            " normal_load, stack_current and shifts.",
        ),
    ],
    amplitude: Annotated[
        float, si_option("m", "Of the vibration along the normal, at the beginning.", "--vibration")
    ] = TypedNumber("2.3um", "m"),
    drive: Annotated[float, si_option("Hz", "Of the vibration.", "--frequency")] = TypedNumber("22kHz", "Hz"),
    speed: Annotated[float, si_option("m/s", "Sliding speed.", "--sliding-speed")] = TypedNumber("65mm/s", "m/s"),
    load: Annotated[float, si_option("N", "Normal load.", "--load")] = TypedNumber("5N", "N"),
    free: Annotated[
        float | None,
        si_option("Hz", "Of the slow mode, pin free; needed where shifts are not small.", "--free-frequency"),
    ] = None,
    mass: Annotated[
        float | None, si_option("kg", "Of the slow mode at the contact; gives contact stiffnesses.", "--modal-mass")
    ] = None,
    large: Annotated[
        float | None,
        si_option("m", "Of the slow mode at large drive; that of the vibration by default.", "--large-amplitude"),
    ] = None,
    turns: Annotated[
        float | None, si_option("1/s", "Of the disc, to remove its wobble from a recording.", "--rotation-speed")
    ] = None,
    seed: Annotated[int, typer.Option(help="Seed of the sampling; equal seeds give equal results.", min=0)] = 0,
    out: Annotated[Out, OutputFolder("{file}-decay-length.*")] = OUT,
    json: Json = False,
) -> None:
    """What sets the decay length: long sliding, a zero error, detuning or the rig, from a run with switched vibration.

    Example: sonolube identify decay-length examples/decay-length-run.csv --free-frequency 40Hz
    """
    if mass is None:
        refuse_unused(context, "load", because="without --modal-mass, which makes shifts contact stiffnesses")
    elif free is None:
        raise InvalidInput("--modal-mass needs --free-frequency, the natural frequency of that mode with the pin free")
    conditions = SwitchConditions(
        normal_load=load,
        vibration_amplitude=amplitude,
        frequency=drive,
        sliding_speed=speed,
        large_drive_amplitude=large,
        natural_frequency=free,
        modal_mass=mass,
    )
    with progress("weighing"):
        if _is_table(file):
            refuse_unused(context, "turns", because="for a table of switches; it is for recordings")
            table = switch_table(read_runs(file))
        else:
            table = recorded_switches(read_recording(file), sliding_speed=speed, rotation_speed=turns)
        decision = decide_decay_length(table, conditions, seed=seed)
    answer = DecayLengthAnswer(table=table, conditions=conditions, decision=decision, name=f"{file.stem}-decay-length")
    deliver(answer, folder=out, as_json=json)


@dataclass(frozen=True, kw_only=True)
class DecayLengthAnswer(Answer):
    """Probabilities of the hypotheses about the decay length, the changes that were found, and the verdict."""

    table: SwitchTable
    conditions: SwitchConditions
    decision: DecayLengthDecision
    name: str

    def lines(self) -> list[str]:
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
            *aligned([*probabilities, *changes]),
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
            ["--free-frequency is not stated: shifts count as small against the frequency of the mode"]
            if shifts and self.conditions.natural_frequency is None
            else []
        )
        coarse = self.decision.effective_draws < _FEW_DRAWS
        return (
            *self.table.caveats,
            *lacking,
            *small,
            *(["few effective draws: probabilities are coarse; try another --seed"] if coarse else []),
            "a zero that is off only under load is not seen with the pin lifted",
            "decay lengths rest on asperity stick-slip",
        )

    def figures(self) -> Mapping[str, Drawing]:
        """Readings over the distance with the courses of the hypotheses."""
        return {self.name: Drawing(draw=lambda: decision_figure(self.table, self.decision), caption=_CAPTION)}

    def files(self) -> "Mapping[str, xr.Dataset]":
        """Readings and courses as netCDF."""
        return {f"{self.name}.nc": decision_dataset(self.table, self.decision)}


def _is_table(file: Path) -> bool:
    """Whether a file is a table of switches: text whose head names the sliding distance and no time."""
    with refuse_unreadable(file), open_input(file) as stream:
        head = stream.read(_HEAD).split(b"\n")[0]
    return b"sliding_distance" in head and b"time" not in head


def _interval(found: Interval, unit: str) -> dict[str, Any]:
    """Interval for JSON."""
    return {"value": found.median, "lower": found.lower, "upper": found.upper, "unit": unit}


def _factor(found: Interval) -> str:
    """Factor with its 80 % interval."""
    return f"{found.median:.2f} (80 %: {found.lower:.2f} to {found.upper:.2f})"


def _length(found: Interval) -> str:
    """Length with its 80 % interval."""
    return f"{1e6 * found.median:.2f} um (80 %: {1e6 * found.lower:.2f} to {1e6 * found.upper:.2f})"
