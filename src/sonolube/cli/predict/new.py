"""Command `new`: a first rig file from what is known before a test, by options or questions on a terminal."""

import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from shlex import quote
from typing import Annotated, Any, TypeVar

import typer

from sonolube.cli.console.answer import Answer, deliver, grid
from sonolube.cli.console.options import Json
from sonolube.cli.console.outputs import OutputFile
from sonolube.cli.console.questions import Question, ask, is_terminal
from sonolube.errors import InvalidInput
from sonolube.facts.materials import material
from sonolube.rig import Rig, rig_from
from sonolube.rig.new_rig.rig_text import KnownRig, LeastKnown, least_known, new_rig_text
from sonolube.rig.new_rig.stated_text import (
    StatedSpeed,
    pin_shape,
    reader,
    rotation_of,
    speed_of,
    surface_of,
    vibration_of,
)

Value = TypeVar("Value")

_PIN = Question(
    option="--pin", text="Material of the pin, such as aluminium_2024 or steel", default="stainless_steel_304"
)
_DISC = Question(option="--disc", text="Material of the disc, such as m50 or steel", default="stainless_steel_304")
_SHAPE = Question(
    option="--shape",
    text="End of the pin: flat with its diameter or ball, such as 'ball radius 5mm' or 'ball diameter 10mm'",
    default="flat 3mm",
)
_LOAD = Question(option="--load", text="Normal load, such as 5N", default="5N")
_SPEED = Question(option="--speed", text="Sliding speed, such as 0.2m/s or '100 rpm'", default="0.1m/s")
_TRACK = Question(option="--track-radius", text="Radius of the track, such as 15mm", default="20mm")
_FREQUENCY = Question(option="--frequency", text="Frequency of the vibration, such as 22kHz", default="20kHz")
_AMPLITUDE = Question(
    option="--amplitude",
    text="Vibration amplitude, zero to peak, such as 3um; or an actuator and its voltage, such as 'sa050510 50V'",
    default="1um",
)
_PIN_FINISH = Question(
    option="--pin-finish",
    text="Finish of the pin, such as turned, N7, 'ground N6' or 'Ra 0.4um', or the file of a scan",
    default="ground",
)
_DISC_FINISH = Question(
    option="--disc-finish",
    text="Finish of the disc, such as turned, N7, 'ground N6' or 'Ra 0.4um', or the file of a scan",
    default="ground",
)


def new(
    out: Annotated[Path, typer.Argument(metavar="[OUT.toml]", help="File to write."), OutputFile()] = Path("rig.toml"),
    pin: Annotated[
        str | None, typer.Option(metavar="MATERIAL", help="Material of the pin, or its class: 100Cr6, 304, steel.")
    ] = None,
    disc: Annotated[str | None, typer.Option(metavar="MATERIAL", help="Material of the disc, or its class.")] = None,
    shape: Annotated[
        str | None,
        typer.Option(
            metavar="SHAPE",
            help="End of the pin: 'flat 3mm' (its diameter, default), 'ball 5mm' (its radius), 'ball radius 5mm',"
            " 'ball diameter 10mm'.",
        ),
    ] = None,
    load: Annotated[str | None, typer.Option(metavar="FORCE", help="Normal load.")] = None,
    speed: Annotated[
        str | None, typer.Option(metavar="SPEED", help="Sliding speed: 0.2m/s, or '100 rpm' with the track.")
    ] = None,
    by_radius: Annotated[
        str | None,
        typer.Option("--track-radius", metavar="LENGTH", help="Radius of the track on the disc, for a speed in rpm."),
    ] = None,
    by_diameter: Annotated[
        str | None, typer.Option("--track-diameter", metavar="LENGTH", help="Its diameter, in place of the radius.")
    ] = None,
    at: Annotated[
        str | None, typer.Option("--frequency", metavar="FREQUENCY", help="Frequency of the vibration.")
    ] = None,
    amplitude: Annotated[
        str | None, typer.Option(metavar="LENGTH", help="Vibration amplitude normal to the contact, zero to peak.")
    ] = None,
    actuator: Annotated[
        str | None, typer.Option(metavar="NAME", help="Actuator of `sonolube actuators`, in place of the amplitude.")
    ] = None,
    voltage: Annotated[
        str | None, typer.Option(metavar="VOLTAGE", help="Voltage of the actuator, peak to peak.")
    ] = None,
    finish: Annotated[
        str | None,
        typer.Option(
            metavar="FINISH",
            help="Finish of pin and disc: 'ground' (default), N6, 'ground N6', 'Ra 0.4' (in um), 0.4um (as Ra),"
            " 'Rz 3.2um'.",
        ),
    ] = None,
    pin_finish: Annotated[str | None, typer.Option(metavar="FINISH", help="Finish of the pin.")] = None,
    disc_finish: Annotated[str | None, typer.Option(metavar="FINISH", help="Finish of the disc.")] = None,
    scan: Annotated[Path | None, typer.Option(metavar="FILE", help="Scan of the disc, in place of its finish.")] = None,
    pin_scan: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Scan of the pin, in place of its finish.")
    ] = None,
    friction: Annotated[
        str | None,
        typer.Option(
            metavar="NUMBER", help="Coefficient of dry friction, where it was measured; else the range of the pair."
        ),
    ] = None,
    decaying_over: Annotated[
        str | None,
        typer.Option(
            "--decay-length",
            metavar="LENGTH",
            help="Length over which the force of the worn contact falls by a factor of e, where it is known; else that "
            "of published tests.",
        ),
    ] = None,
    stiffness: Annotated[
        str | None,
        typer.Option(
            metavar="STIFFNESS",
            help="Measured normal stiffness of the contact under the load, such as 1.5MN/m, in place of the decay "
            "length.",
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace the file where it exists.")] = False,
    json: Json = False,
) -> None:
    """A first rig file from what is known before a test: asks on a terminal for what the options leave out.

    Example: sonolube new rig.toml --pin m50 --disc m50 --load 5N --speed 0.2m/s --frequency 20kHz --amplitude 3um
    """
    if out.exists() and not force:
        raise InvalidInput(f"{out}: exists; name another file, or give --force to replace it")
    _refuse_two({"--pin-finish": pin_finish, "--pin-scan": pin_scan})
    _refuse_two({"--disc-finish": disc_finish, "--scan": scan})
    _refuse_two({"--decay-length": decaying_over, "--stiffness": stiffness})
    driven = _driven(amplitude, actuator, voltage)
    given = {_PIN: pin, _DISC: disc, _LOAD: load, _SPEED: speed, _FREQUENCY: at, _AMPLITUDE: driven}
    asks = _asks(given)
    materials = _value(_PIN, pin, _material, asks=asks), _value(_DISC, disc, _material, asks=asks)
    stated_shape = _value(_SHAPE, shape, pin_shape, asks=asks)
    normal_load = _value(_LOAD, load, reader("N", name="--load"), asks=asks)
    sliding = _sliding_speed(speed, by_radius, by_diameter, asks=asks)
    known = KnownRig(
        pin=materials[0],
        disc=materials[1],
        shape=stated_shape,
        normal_load=normal_load,
        sliding_speed=sliding.sliding_speed,
        speed_reason=sliding.reason,
        frequency=_value(_FREQUENCY, at, reader("Hz", name="--frequency"), asks=asks),
        vibration=_value(_AMPLITUDE, driven, vibration_of, asks=asks),
        pin_surface=_value(_PIN_FINISH, _text(pin_scan) or pin_finish or finish, surface_of, asks=asks),
        disc_surface=_value(_DISC_FINISH, _text(scan) or disc_finish or finish, surface_of, asks=asks),
        friction_coefficient=None if friction is None else reader("", name="--friction")(friction),
        decay_length=None if decaying_over is None else reader("m", name="--decay-length")(decaying_over),
        normal_stiffness=None if stiffness is None else reader("N/m", name="--stiffness")(stiffness),
    )
    text = new_rig_text(known)
    rig = rig_from(tomllib.loads(text))
    answer = NewRigAnswer(rig=rig, text=text, least_known=least_known(rig), path=out)
    deliver(answer, folder=out.parent, as_json=json)


@dataclass(frozen=True, kw_only=True)
class NewRigAnswer(Answer):
    """New rig file with what it assumes, the inputs known least, and the next command."""

    rig: Rig
    text: str
    least_known: Sequence[LeastKnown]
    path: Path

    def lines(self) -> list[str]:
        """Title, the inputs known least with how to measure them, and the next command."""
        rows = [[f"  {one.key}", one.text, one.remedy] for one in self.least_known]
        return [
            self.rig.title,
            *grid([["  least known", "distribution", "to measure it"], *rows]),
            f"  next: sonolube predict {quote(str(self.path))}",
        ]

    def object(self) -> dict[str, Any]:
        """Title, text of the file and the inputs known least."""
        return {
            "rig": self.rig.title,
            "text": self.text,
            "uncertainty": {key: law.text for key, law in self.rig.uncertainty.items()},
            "least_known": {one.key: one.remedy for one in self.least_known},
        }

    def files(self) -> Mapping[str, str]:
        """Rig file."""
        return {self.path.name: self.text}


def _asks(given: Mapping[Question, str | None]) -> bool:
    """Whether to ask for what the options leave out; refuse missing ones where nobody can be asked."""
    missing = [question.option for question, text in given.items() if text is None]
    if missing and not is_terminal():
        raise InvalidInput(f"missing {', '.join(missing)}; give them, or answer the questions on a terminal")
    return bool(missing)


def _refuse_two(given: Mapping[str, object]) -> None:
    """Refuse two options for one thing."""
    both = [option for option, value in given.items() if value is not None]
    if len(both) > 1:
        raise InvalidInput(f"give either {' or '.join(both)}, got both")


def _value(question: Question, text: str | None, read: Callable[[str], Value], *, asks: bool) -> Value:
    """Value of an option, or of the answer to its question; of its default where nothing is asked."""
    if text is not None:
        return read(text)
    return ask(question, read) if asks else read(question.default)


def _driven(amplitude: str | None, actuator: str | None, voltage: str | None) -> str | None:
    """What vibrates the contact as one text, from the options for it."""
    _refuse_two({"--amplitude": amplitude, "--actuator": actuator})
    if (actuator is None) != (voltage is None):
        raise InvalidInput("--actuator and --voltage belong together: give both or neither")
    return amplitude if actuator is None else f"{actuator} {voltage}"


def _material(text: str) -> str:
    """Name of a material of the catalogue."""
    return material(text).name


def _sliding_speed(
    text: str | None, track_radius: str | None, track_diameter: str | None, *, asks: bool
) -> StatedSpeed:
    """Sliding speed of the options or answers; a rotational speed without a track has its radius asked for too."""
    is_open = track_radius is None and track_diameter is None and is_terminal()
    if text is None and asks:
        text = ask(_SPEED, lambda answer: _readable_speed(answer, track_radius, track_diameter))
    stated = _SPEED.default if text is None else text
    if is_open and rotation_of(stated) is not None:
        return ask(_TRACK, lambda radius: speed_of(stated, track_radius=radius))
    return speed_of(stated, track_radius=track_radius, track_diameter=track_diameter)


def _readable_speed(text: str, track_radius: str | None, track_diameter: str | None) -> str:
    """Return an answer that is a speed; a rotational one may wait for its track."""
    if rotation_of(text) is None or track_radius or track_diameter:
        speed_of(text, track_radius=track_radius, track_diameter=track_diameter)
    return text


def _text(path: Path | None) -> str | None:
    return None if path is None else str(path)
