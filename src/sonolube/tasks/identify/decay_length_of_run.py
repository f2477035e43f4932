"""Task `identify decay-length`: what sets the decay length of a worn contact, from a run with switched vibration."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Unpack

from sonolube import identification
from sonolube.errors import InvalidInput
from sonolube.identification.decay_length.switch_table import is_switch_table
from sonolube.laboratory.records.recorded_part import switched_recording
from sonolube.measurement.measured_runs import read_runs
from sonolube.measurement.recordings.reader import read_recording
from sonolube.report import Drawing
from sonolube.report.results import identification as results
from sonolube.tasks.answer import Answer, Block, Dataset, Rows, answer
from sonolube.tasks.files import InputFile, file_path
from sonolube.tasks.own_tables import Mapped, mapping_of
from sonolube.tasks.parameters import File, Number, Parameter, Quantity, Watched, file_stem
from sonolube.tasks.progress import stage
from sonolube.tasks.task import in_si, refuse_unused, shown, task

_CAPTION = (
    "Readings at the switches of the vibration over the sliding distance, with the most probable course of each"
    " hypothesis; the zero with its smoothed course."
)
_FILE = File(
    "Table of the switches of one run (CSV), the folder of a run of decay_length_run, or a recording with"
    " friction_force, voltage_peak_to_peak, normal_load, stack_current and shifts.",
    "FILE",
)


@task
def decay_length(
    file: Annotated[InputFile, _FILE],
    *,
    vibration: Annotated[Number, Quantity("Of the vibration along the normal, at the beginning.", "m")] = "2.3um",
    frequency: Annotated[Number, Quantity("Of the vibration.", "frequency")] = "22kHz",
    sliding_speed: Annotated[Number, Quantity("Sliding speed.", "sliding_speed")] = "65mm/s",
    load: Annotated[Number, Quantity("Normal load.", "N")] = "5N",
    free_frequency: Annotated[
        Number | None, Quantity("Of the slow mode, pin free; needed where shifts are not small.", "Hz")
    ] = None,
    modal_mass: Annotated[
        Number | None, Quantity("Of the slow mode at the contact; gives contact stiffnesses.", "kg")
    ] = None,
    large_amplitude: Annotated[
        Number | None, Quantity("Of the slow mode at large drive; that of the vibration by default.", "m")
    ] = None,
    rotation_speed: Annotated[
        Number | None, Quantity("Of the disc, to remove its wobble from a recording.", "1/s")
    ] = None,
    mapping: Mapped = None,
    seed: Annotated[int, Parameter("Seed of the sampling; equal seeds give equal results.", lowest=0)] = 0,
    **watch: Unpack[Watched],
) -> "DecayLengthAnswer":
    """What sets the decay length: long sliding, a zero error, detuning or the rig, from a run with switched vibration.

    Example: sonolube identify decay-length examples/decay-length-run.csv --free-frequency 40Hz
    """
    if modal_mass is None:
        refuse_unused("load", because=f"without {shown('modal_mass')}, which makes shifts contact stiffnesses")
    elif free_frequency is None:
        needed = f"{shown('free_frequency')}, the natural frequency of that mode with the pin free"
        raise InvalidInput(f"{shown('modal_mass')} needs {needed}")
    conditions = identification.SwitchConditions(
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
        if not path.is_dir() and is_switch_table(path, columns):
            refuse_unused("rotation_speed", because="for a table of switches; it is for recordings")
            table = identification.switch_table(read_runs(path, mapping=columns))
        else:
            table = identification.recorded_switches(
                switched_recording(path) if path.is_dir() else read_recording(path, mapping=columns),
                sliding_speed=conditions.sliding_speed,
                rotation_speed=in_si("rotation_speed", rotation_speed),
            )
        decision = identification.decide_decay_length(table, conditions, seed=seed)
    name = f"{file_stem(file)}-decay-length"
    return DecayLengthAnswer(table=table, conditions=conditions, decision=decision, name=name)


@answer
class DecayLengthAnswer(Answer):
    """Probabilities of the hypotheses about the decay length, the changes that were found, and the verdict."""

    table: identification.SwitchTable
    conditions: identification.SwitchConditions
    decision: identification.DecayLengthDecision
    name: str

    def blocks(self) -> Sequence[Block]:
        """Verdict, advice, probabilities and changes."""
        found = self.decision
        return [
            found.verdict,
            *([f"repeat: {found.advice}"] if found.advice else []),
            results.run_line(self.table, self.conditions),
            Rows(results.rows(found)),
        ]

    def object(self) -> dict[str, Any]:
        """Verdict, advice, probabilities, changes with their 80 % intervals, and misfits."""
        return results.decision_object(self.decision, self.table)

    def caveats(self) -> Sequence[str]:
        """Data that the run lacks, and assumptions of the analysis."""
        return results.decision_caveats(self.table, self.conditions, self.decision)

    def figures(self) -> Mapping[str, Drawing]:
        """Readings over the distance with the courses of the hypotheses."""
        return {
            self.name: Drawing(chart=lambda: identification.decision_chart(self.table, self.decision), caption=_CAPTION)
        }

    def files(self) -> Mapping[str, Dataset]:
        """Readings and courses as netCDF."""
        return {f"{self.name}.nc": identification.decision_dataset(self.table, self.decision)}
