"""Command `measure friction`: level, fluctuation, running-in, voltage steps, stick-slip and work in recordings."""

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from sonolube.cli.console.options import Json, TypedNumber, refuse_unused, si_option
from sonolube.cli.measure.measured_files import (
    Channels,
    Files,
    Group,
    Mapped,
    Report,
    Sections,
    Test,
    column_mapping,
    deliver_sheets,
    each_file,
    files_of,
)
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.measurement.friction.motor_current import MotorCalibration
from sonolube.report.measured.friction import FrictionSettings, friction_sheet
from sonolube.report.measured.friction_comparison import comparison_sheet
from sonolube.report.measured.joined_friction import joined_friction_sheet


def friction(
    context: typer.Context,
    files: Files,
    mapping: Mapped = None,
    group: Group = None,
    channels: Channels = None,
    sections: Sections = None,
    join: Annotated[
        bool, typer.Option("--join", help="The files are one test, in this order: measure it too.")
    ] = False,
    without: Annotated[
        list[Path] | None,
        typer.Option("--without-vibration", metavar="FILE", help="A test without vibration; may come again."),
    ] = None,
    speed: Annotated[float | None, si_option("m/s", "For the distance to the steady state.", "--sliding-speed")] = None,
    window: Annotated[float, si_option("s", "Duration of the windows.")] = TypedNumber("2s", "s"),
    turns: Annotated[
        float | None,
        si_option("1/s", "Of the disc, to remove its wobble; without it found at voltage steps.", "--rotation-speed"),
    ] = None,
    torque: Annotated[
        float | None, si_option("N m/A", "Of the motor, such as '0.5 N m/A'.", "--torque-constant", metavar="QUANTITY")
    ] = None,
    idle: Annotated[
        float | None, si_option("A", "Of the motor with the pin lifted.", "--idle-current", metavar="CURRENT")
    ] = None,
    diameter: Annotated[float | None, si_option("m", "Of the circle under the pin.", "--groove-diameter")] = None,
    test: Test = None,
    report: Report = None,
    json: Json = False,
) -> None:
    """Friction in recordings: level, fluctuation, running-in, steps of the voltage, stick-slip, work.

    Example: sonolube measure friction test.csv --sliding-speed 20.3mm/s --report test.html
    """
    motor = None
    if torque is not None:
        if idle is None or diameter is None:
            raise InvalidInput("--torque-constant needs --idle-current and --groove-diameter")
        motor = MotorCalibration(torque_constant=torque, idle_current=idle, groove_diameter=diameter)
    else:
        refuse_unused(context, "idle", "diameter", because="without --torque-constant, for the force by the current")
    settings = FrictionSettings(
        mapping=column_mapping(mapping, group=group, channels=channels, sections=sections),
        window_duration=window,
        sliding_speed=speed,
        rotation_speed=turns,
        motor=motor,
    )
    measure = partial(friction_sheet, settings=settings)
    sheets, refused = each_file(files, measure, title="measuring")
    joined = []
    if join and not refused:
        try:
            joined = [joined_friction_sheet(files_of(files), settings=settings)]
        except SonolubeError as failure:
            refused["all files as one test"] = " ".join(str(failure).split())
    if without:
        others, others_refused = each_file(without, measure, title="measuring without vibration")
        refused |= others_refused
        compared = [comparison_sheet(joined or sheets, others)] if sheets and others else []
        sheets = [*sheets, *joined, *others, *compared]
    else:
        sheets += joined
    deliver_sheets(context, "friction", sheets, refused, page=report, test=test, as_json=json)
