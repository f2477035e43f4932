"""Command `measure impedance`: equivalent circuit of an impedance spectrum, or the stack of a rig's structure."""

from enum import StrEnum
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from sonolube.cli.console.options import Json, refuse_unused, si_option
from sonolube.cli.measure.measured_files import Files, Report, Test, deliver_sheets, each_file
from sonolube.report.measured.impedance import ImpedanceSettings, StackInStructure, impedance_sheet
from sonolube.rig import structure_by_stack


class Residual(StrEnum):
    """Residual that a fit minimises."""

    LOG_COMPLEX = "log-complex"
    LOG_MAGNITUDE = "log-magnitude"
    LINEAR_MAGNITUDE = "linear-magnitude"


def impedance(
    context: typer.Context,
    files: Files,
    branches: Annotated[
        int | None, typer.Option(help="Number of modes; as many as are significant by default.", min=1, max=8)
    ] = None,
    residual: Annotated[Residual, typer.Option(help="Residual that the fit minimises.")] = Residual.LOG_COMPLEX,
    leads: Annotated[
        float | None, si_option("ohm", "Of the leads, such as 0.2ohm.", "--series-resistance", metavar="RESISTANCE")
    ] = None,
    sweep: Annotated[str | None, typer.Option(metavar="NAME", help="Sweep of the file, such as memory.")] = None,
    rig: Annotated[
        Path | None, typer.Option("--stack-of", metavar="RIG.toml", help="Fit the stack of this rig's structure.")
    ] = None,
    test: Test = None,
    report: Report = None,
    json: Json = False,
) -> None:
    """Impedance: the circuit that fits a spectrum, with quality, frequencies and coupling, or the stack of a rig.

    Example: sonolube measure impedance transducer.csv --residual linear-magnitude --report transducer.html
    """
    if rig is not None:
        refuse_unused(context, "branches", "leads", because="for --stack-of; it is for an equivalent circuit")
    settings = ImpedanceSettings(
        branches=branches,
        residual=residual.value,
        series_resistance=leads or 0.0,
        sweep=sweep,
        stack=None if rig is None else StackInStructure(*structure_by_stack(rig)),
    )
    sheets, refused = each_file(files, partial(impedance_sheet, settings=settings), title="fitting")
    deliver_sheets(context, "impedance", sheets, refused, page=report, test=test, as_json=json)
