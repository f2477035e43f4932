"""Task `simulate`: steady vibration of a rig's drive, structure and contact, with the friction and wear under it."""

from typing import Unpack

from sonolube import rig as rigs
from sonolube.report import Drawing
from sonolube.report.results.measured_on_rig import measured_on
from sonolube.rig.figures import simulation_chart
from sonolube.rig.result_datasets import simulation_arrays
from sonolube.tasks.parameters import RigFile, Watched, rig_of
from sonolube.tasks.predict.rig_record import RigRecord
from sonolube.tasks.progress import stage
from sonolube.tasks.task import task


@task
def simulate(rig: RigFile, **watch: Unpack[Watched]) -> RigRecord:
    """Multi-scale model: drive, structure and contact in one steady vibration, and the friction and wear under it.

    Example: sonolube simulate examples/rigs/tribometer.toml --set drive.voltage_peak_to_peak=25.9V

    Examples
    --------
    >>> import sonolube as sl
    >>> from sonolube.text.units import format_si
    >>> answer = sl.simulate("examples/rigs/tribometer.toml")
    >>> format_si(float(answer["mean_displacement"]), "m", digits=2)
    '720 nm'
    """
    known = rig_of(rig)
    with stage("simulating"):
        result = rigs.simulate(known)
    name, labelled = f"{known.name}-simulation", simulation_arrays(known, result)
    return RigRecord(
        rig=known,
        result=result,
        measured=measured_on(known, vibration_amplitude=result.vibration.vibration_amplitude),
        drawings={name: Drawing(chart=lambda: simulation_chart(labelled))},
        datasets={f"{name}.nc": labelled},
    )
