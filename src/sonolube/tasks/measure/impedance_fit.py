"""Task `measure impedance`: equivalent circuit of an impedance spectrum, or the stack of a rig's structure."""

from functools import partial
from typing import Annotated, Literal, Unpack

from sonolube.report.measured.impedance import ImpedanceSettings, StackInStructure, impedance_sheet
from sonolube.rig import structure_by_stack
from sonolube.tasks.measure.measured_files import Files, MeasuredFiles, TestSheet, measured
from sonolube.tasks.parameters import File, Number, OptionalRigSource, Parameter, Quantity, Watched, rig_of
from sonolube.tasks.task import in_si, refuse_unused, shown, task


@task
def impedance(
    files: Files,
    *,
    branches: Annotated[
        int | None, Parameter("Number of modes; as many as are significant by default.", lowest=1, highest=8)
    ] = None,
    residual: Annotated[
        Literal["log-complex", "log-magnitude", "linear-magnitude"], Parameter("Residual that the fit minimises.")
    ] = "log-complex",
    series_resistance: Annotated[
        Number | None, Quantity("Of the leads, such as 0.2ohm.", "series_resistance", kind="RESISTANCE")
    ] = None,
    sweep: Annotated[str | None, Parameter("Sweep of the file, such as memory.", "NAME")] = None,
    stack_of: Annotated[OptionalRigSource, File("Fit the stack of this rig's structure.", "RIG.toml")] = None,
    test_sheet: TestSheet = None,
    **watch: Unpack[Watched],
) -> MeasuredFiles:
    """Impedance: the circuit that fits a spectrum, with quality, frequencies and coupling, or the stack of a rig.

    Example: sonolube measure impedance transducer.csv --residual linear-magnitude --report transducer.html
    """
    if stack_of is not None:
        because = f"for {shown('stack_of')}; it is for an equivalent circuit"
        refuse_unused("branches", "series_resistance", because=because)
    settings = ImpedanceSettings(
        branches=branches,
        residual=residual,
        series_resistance=in_si("series_resistance", series_resistance) or 0.0,
        sweep=sweep,
        stack=None if stack_of is None else StackInStructure(*structure_by_stack(rig_of(stack_of))),
    )
    return measured("impedance", files, partial(impedance_sheet, settings=settings), test_sheet, doing="fitting")
