"""Command `measure friction`: level, fluctuation, running-in, voltage steps, stick-slip and work in recordings."""

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from sonolube.cli.console.options import Json, option_value
from sonolube.cli.measure.measured_files import (
    Files,
    Mapped,
    Report,
    Test,
    column_mapping,
    deliver_sheets,
    each_file,
    names_of,
)
from sonolube.errors import InvalidInput
from sonolube.measurement.friction.motor_current import MotorCalibration
from sonolube.report.measured.friction import FrictionSettings, friction_sheet
from sonolube.report.measured.friction_comparison import comparison_sheet
from sonolube.units import to_si


def friction(
    files: Files,
    mapping: Mapped = None,
    without: Annotated[
        list[Path] | None,
        typer.Option("--without-vibration", metavar="FILE", help="A test without vibration; may come again."),
    ] = None,
    speed: Annotated[
        str | None, typer.Option("--sliding-speed", metavar="SPEED", help="For the distance to the steady state.")
    ] = None,
    window: Annotated[str, typer.Option(metavar="TIME", help="Duration of the windows.")] = "2s",
    turns: Annotated[
        str | None, typer.Option("--rotation-speed", metavar="RATE", help="Of the disc, to remove its wobble.")
    ] = None,
    torque: Annotated[
        str | None, typer.Option("--torque-constant", metavar="QUANTITY", help="Of the motor, such as '0.5 N m/A'.")
    ] = None,
    idle: Annotated[
        str | None, typer.Option("--idle-current", metavar="CURRENT", help="Of the motor with the pin lifted.")
    ] = None,
    diameter: Annotated[
        str | None, typer.Option("--groove-diameter", metavar="LENGTH", help="Of the circle under the pin.")
    ] = None,
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
        motor = MotorCalibration(
            torque_constant=to_si(torque, unit="N m/A", name="--torque-constant"),
            idle_current=to_si(idle, unit="A", name="--idle-current"),
            groove_diameter=to_si(diameter, unit="m", name="--groove-diameter"),
        )
    settings = FrictionSettings(
        mapping=column_mapping(mapping),
        window_duration=to_si(window, unit="s", name="--window"),
        sliding_speed=option_value(speed, unit="m/s", option="--sliding-speed"),
        rotation_speed=option_value(turns, unit="1/s", option="--rotation-speed"),
        motor=motor,
    )
    measure = partial(friction_sheet, settings=settings)
    sheets, refused = each_file(files, measure, title="measuring")
    if without:
        others, others_refused = each_file(without, measure, title="measuring without vibration")
        refused |= others_refused
        compared = [comparison_sheet(sheets, others)] if sheets and others else []
        sheets = [*sheets, *others, *compared]
    options = {
        "mapping": mapping,
        "window": window,
        "sliding speed": speed,
        "rotation speed": turns,
        "torque constant": torque,
        "idle current": idle,
        "groove diameter": diameter,
        "without vibration": names_of(without),
    }
    deliver_sheets("friction", sheets, refused, settings=options, page=report, test=test, as_json=json)
