"""The command that makes friction a commanded quantity."""

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from sonolube.cli.operate import Changes, Json, RigPath

if TYPE_CHECKING:
    from sonolube.design.control import VibrationMode
    from sonolube.metrics import EfficiencyLine
    from sonolube.rig import Rig


class FeedForward(StrEnum):
    """What the controller looks its voltages up in."""

    MODEL = "model"
    EFFICIENCY = "efficiency"
    NONE = "none"


def control(
    context: typer.Context,
    rig: RigPath,
    friction: Annotated[
        str | None, typer.Option(metavar="FORCE", help="Friction wanted; half way to the least where absent.")
    ] = None,
    feed_forward: Annotated[FeedForward, typer.Option(help="Where the voltage comes from.")] = FeedForward.MODEL,
    efficiency: Annotated[
        str | None,
        typer.Option(metavar="COEFFICIENT", help="Efficiency at the rig's speed, in m2/N, instead of the published."),
    ] = None,
    delay: Annotated[str, typer.Option(metavar="TIME", help="Delay of the friction measurement.")] = "1ms",
    rate: Annotated[str, typer.Option(metavar="FREQUENCY", help="Decisions per second.")] = "5kHz",
    noise: Annotated[str, typer.Option(metavar="FORCE", help="Standard deviation of the sensor.")] = "0N",
    factor: Annotated[float, typer.Option(help="Real friction over that of the model.", min=0.01, max=100)] = 1.0,
    closed_loop: Annotated[str | None, typer.Option(metavar="TIME", help="Time constant wanted.")] = None,
    voltage_limit: Annotated[
        str | None, typer.Option(metavar="VOLTAGE", help="Largest swing, peak to peak; the rig's own where absent.")
    ] = None,
    current_limit: Annotated[str | None, typer.Option(metavar="CURRENT", help="Largest current.")] = None,
    slew_limit: Annotated[str | None, typer.Option(metavar="V/s", help="Fastest change of voltage.")] = None,
    warming: Annotated[str, typer.Option(metavar="TEMPERATURE", help="Final rise, such as 40K.")] = "0K",
    warmed_in: Annotated[
        str | None, typer.Option("--warming-time", metavar="TIME", help="Time constant of the warming.")
    ] = None,
    track: Annotated[bool, typer.Option(help="Follow the resonance by the phase of the impedance.")] = True,
    quality: Annotated[float, typer.Option(help="Quality factor, where the rig has no structure.", min=0.6)] = 50.0,
    coupling: Annotated[float, typer.Option(help="Effective coupling, where it has none.", min=0.001, max=0.999)] = 0.2,
    stick_slip: Annotated[bool, typer.Option("--stick-slip", help="Also drag the slider until it sticks.")] = False,
    lasting: Annotated[str, typer.Option("--duration", metavar="TIME", help="How long to run.")] = "0.2s",
    changes: Changes = None,
    out: Annotated[Path, typer.Option(help="Folder for control.html, figures, netCDF, C source, table.")] = Path("out"),
    json: Json = False,
) -> None:
    """Friction control: a tuned controller, its run in closed loop, its C source and its lookup table.

    Example: sonolube control examples/rigs/tribometer.toml --friction 0.5N --factor 1.15 --warming 40K
    """
    import json as json_module
    from math import inf

    from sonolube.cli.control_output import control_lines, control_object, suppressed, write_control
    from sonolube.cli.design_page import asked_of, settings_of
    from sonolube.cli.progress import progress
    from sonolube.design.control import Amplifier, ControlSettings, Disturbance, ThermalDrift, design_control
    from sonolube.errors import InvalidInput
    from sonolube.rig import read_rig
    from sonolube.units import temperature_difference_to_si, to_si

    def si(text: str | None, unit: str, name: str, otherwise: float) -> float:
        return otherwise if text is None else to_si(text, unit=unit, name=name)

    known = read_rig(rig, changes=list(changes or ()))
    duration, per_second = to_si(lasting, unit="s", name="--duration"), to_si(rate, unit="Hz", name="--rate")
    if per_second <= 0 or duration <= 0:
        raise InvalidInput(f"--rate {rate} and --duration {lasting} must be positive")
    if to_si(delay, unit="s", name="--delay") > duration:
        raise InvalidInput(f"--delay {delay} must not exceed --duration {lasting}")
    own = known.drive.voltage_peak_to_peak if known.drive is not None else None
    amplifier = Amplifier(
        voltage_maximum=si(voltage_limit, "V", "--voltage-limit", own or 0.0),
        current_maximum=si(current_limit, "A", "--current-limit", inf),
        slew_rate_maximum=si(slew_limit, "V/s", "--slew-limit", inf),
    )
    settings = ControlSettings(
        friction_force=None if friction is None else to_si(friction, unit="N", name="--friction"),
        amplifier=amplifier,
        dead_time=to_si(delay, unit="s", name="--delay"),
        sample_interval=1 / per_second,
        closed_loop_time=None if closed_loop is None else to_si(closed_loop, unit="s", name="--closed-loop"),
        feed_forward=feed_forward.value,
        tracking=track,
        duration=duration,
        disturbance=Disturbance(
            friction_factor=factor, friction_force_deviation=to_si(noise, unit="N", name="--noise")
        ),
        drift=ThermalDrift(
            final_temperature_rise=temperature_difference_to_si(warming, name="--warming"),
            warming_time=si(warmed_in, "s", "--warming-time", duration / 4),
        ),
    )
    supposed = {} if known.structure is not None else {"resonance": _supposed(quality, coupling)}
    with progress("controlling"):
        mode = _mode(known, quality, coupling)
        line = _line(known, efficiency) if feed_forward is FeedForward.EFFICIENCY else None
        study = design_control(known, settings, mode=mode, line=line)
        belt = suppressed(known, study) if stick_slip else None
        asked = [*asked_of(context, title=known.title, source=known.source), *settings_of(known)]
        name = f"{rig.stem}-control"
        written = write_control(known, settings, study, belt, supposed, asked=asked, folder=out, name=name)
    if json:
        answer = control_object(known, settings, study, belt, supposed, written)
        typer.echo(json_module.dumps(answer, indent=2, allow_nan=False))
    else:
        typer.echo("\n".join(control_lines(known, settings, study, belt, supposed, written)))


def _mode(rig: "Rig", quality: float, coupling: float) -> "VibrationMode | None":
    from sonolube.design.control import assumed_mode

    if rig.structure is not None:
        return None
    return assumed_mode(rig, quality_factor=quality, coupling_factor=coupling)


def _supposed(quality: float, coupling: float) -> str:
    return f"at the drive's frequency, quality factor {quality:g}, coupling {coupling:g}; not measured"


def _line(rig: "Rig", efficiency: str | None) -> "EfficiencyLine":
    """Return the efficiency given, at every speed, or the line of D 4.2."""
    from sonolube.metrics import EfficiencyLine
    from sonolube.units import to_si
    from sonolube.validation.power_map import efficiency_line

    if efficiency is None:
        return efficiency_line()
    return EfficiencyLine(slope=0.0, intercept=to_si(efficiency, unit="m2/N", name="--efficiency"))
