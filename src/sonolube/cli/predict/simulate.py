"""Command `simulate`: steady vibration of a rig's drive, structure and contact, with the friction and wear under it."""

from typing import Annotated

from sonolube import rig as rigs
from sonolube.cli.console.answer import deliver
from sonolube.cli.console.options import OUT, Amplitude, Changes, Json, Load, Out, RigPath, loaded_rig
from sonolube.cli.console.outputs import OutputFolder
from sonolube.cli.console.progress import progress
from sonolube.cli.predict.measured import measured_on
from sonolube.cli.predict.rig_record import RigRecord
from sonolube.compilation import few_points
from sonolube.report import Drawing
from sonolube.rig.figures import simulation_figure
from sonolube.rig.result_datasets import simulation_arrays


@few_points()
def simulate(
    rig: RigPath,
    load: Load = None,
    amplitude: Amplitude = None,
    changes: Changes = None,
    out: Annotated[Out, OutputFolder("{rig}-simulation.*")] = OUT,
    json: Json = False,
) -> None:
    """Multi-scale model: drive, structure and contact in one steady vibration, and the friction and wear under it.

    Example: sonolube simulate examples/rigs/tribometer.toml --set drive.voltage_peak_to_peak=25.9V
    """
    known = loaded_rig(rig, load=load, changes=changes, amplitude=amplitude)
    with progress("simulating"):
        result = rigs.simulate(known)
    name, labelled = f"{rig.stem}-simulation", simulation_arrays(known, result)
    answer = RigRecord(
        rig=known,
        result=result,
        measured=measured_on(known, vibration_amplitude=result.vibration.vibration_amplitude),
        drawings={name: Drawing(draw=lambda: simulation_figure(labelled))},
        datasets={f"{name}.nc": labelled},
    )
    deliver(answer, folder=out, as_json=json)
