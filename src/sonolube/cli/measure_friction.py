"""The command that measures friction in recordings."""

from pathlib import Path
from typing import Annotated

import typer

from sonolube.cli.measuring import Files, Report, Test, answer, each_file, quantity
from sonolube.cli.operate import Json

Mapping = Annotated[Path | None, typer.Option(metavar="MAPPING.toml", help="What the columns of the files mean.")]


def friction(
    files: Files,
    mapping: Mapping = None,
    without: Annotated[
        list[Path] | None,
        typer.Option("--without-vibration", metavar="FILE", help="A test without vibration; may come again."),
    ] = None,
    speed: Annotated[
        str | None, typer.Option("--sliding-speed", metavar="SPEED", help="For the distance to the steady state.")
    ] = None,
    window: Annotated[str, typer.Option(metavar="TIME", help="Duration of the windows.")] = "2s",
    turns: Annotated[
        str | None, typer.Option("--rotation-speed", metavar="RATE", help="Of the disc, to take its wobble away.")
    ] = None,
    torque: Annotated[
        str | None,
        typer.Option("--torque-constant", metavar="QUANTITY", help="Of the motor, such as '0.5 N m/A'."),
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
    from functools import partial

    from sonolube.errors import InvalidInput
    from sonolube.measurement.friction.motor_current import MotorCalibration
    from sonolube.measurement.recordings.mapping import read_mapping
    from sonolube.report.measured.friction import FrictionSettings, friction_sheet
    from sonolube.report.measured.friction_comparison import comparison_sheet

    motor = None
    if torque is not None:
        if idle is None or diameter is None:
            raise InvalidInput("--torque-constant needs --idle-current and --groove-diameter")
        motor = MotorCalibration(
            torque_constant=quantity(torque, unit="N m/A", option="--torque-constant") or 0.0,
            idle_current=quantity(idle, unit="A", option="--idle-current") or 0.0,
            groove_diameter=quantity(diameter, unit="m", option="--groove-diameter") or 0.0,
        )
    settings = FrictionSettings(
        mapping=None if mapping is None else read_mapping(mapping),
        window_duration=quantity(window, unit="s", option="--window") or 0.0,
        sliding_speed=quantity(speed, unit="m/s", option="--sliding-speed"),
        rotation_speed=quantity(turns, unit="1/s", option="--rotation-speed"),
        motor=motor,
    )
    measure = partial(friction_sheet, settings=settings)
    sheets, refused = each_file(files, measure, what="measuring")
    if without:
        others, others_refused = each_file(without, measure, what="measuring without vibration")
        refused |= others_refused
        compared = [comparison_sheet(sheets, others)] if sheets and others else []
        sheets = [*sheets, *others, *compared]
    used = {
        "mapping": mapping,
        "window": window,
        "sliding speed": speed,
        "rotation speed": turns,
        "torque constant": torque,
        "idle current": idle,
        "groove diameter": diameter,
        "without vibration": ", ".join(path.name for path in without or ()) or None,
    }
    answer("friction", sheets, refused, settings=used, page=report, test=test, as_json=json)
