"""Command `new`: the task with questions on a terminal for what the options leave out, and one file to write."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Final

import typer

from sonolube.cli.console.delivery import deliver
from sonolube.cli.console.options import OutputFile, ask, is_terminal
from sonolube.cli.generated import argument, command_of
from sonolube.errors import InvalidInput
from sonolube.facts.materials import material
from sonolube.rig.new_rig.rig_text import is_soft
from sonolube.rig.new_rig.stated_text import pin_shape, reader, rotation_of, speed_of, surface_of, vibration_of
from sonolube.storage.files import expect_file
from sonolube.tasks.predict.new import DEFAULT_FINISH, DEFAULT_SHAPE, NewRig, refuse_two_of_one
from sonolube.tasks.table import task_named

_TRACK: Final = ("--track-radius", "Radius of the track, such as 15mm", "20mm")
_FINISHES: Final = "such as turned, N7, 'ground N6' or 'Ra 0.4um', or the file of a scan"
_METAL: Final = "stainless_steel_304"
_QUESTIONS: Final[tuple[tuple[str, str, str, Callable[[str], object]], ...]] = (
    ("pin", "Material of the pin, such as aluminium_2024 or steel", _METAL, material),
    ("disc", "Material of the disc, such as m50 or steel", _METAL, material),
    (
        "shape",
        "End of the pin: flat with its diameter or ball, such as 'ball radius 5mm' or 'ball diameter 10mm'",
        DEFAULT_SHAPE,
        pin_shape,
    ),
    ("load", "Normal load, such as 5N", "5N", reader("N", name="--load")),
    ("speed", "Sliding speed, such as 0.2m/s or '100 rpm'", "0.1m/s", speed_of),
    ("frequency", "Frequency of the vibration, such as 22kHz", "20kHz", reader("Hz", name="--frequency")),
    (
        "amplitude",
        "Vibration amplitude, zero to peak, such as 3um; or an actuator and its voltage: 'sa050510 50V'",
        "1um",
        vibration_of,
    ),
    ("pin_finish", f"Finish of the pin, {_FINISHES}", DEFAULT_FINISH, surface_of),
    ("disc_finish", f"Finish of the disc, {_FINISHES}", DEFAULT_FINISH, surface_of),
)
"""Each argument, in their order, with its question, the answer by default and the reader of an answer."""

_NEEDED: Final = ("pin", "disc", "load", "speed", "frequency", "amplitude")
_INSTEAD: Final = {
    "amplitude": ("actuator", "calibration"),
    "pin_finish": ("finish", "pin_scan"),
    "disc_finish": ("finish", "scan"),
}
"""Arguments that take the place of an answer."""


def _completed(given: dict[str, Any], typed: Mapping[str, Any]) -> dict[str, Any]:
    """Arguments with the answers to questions for those that are missing, where the file or folder may be written."""
    if typed["folder"] and typed["force"]:
        raise InvalidInput("--force has no meaning with --folder, which replaces nothing")
    if typed["folder"] and _place(typed).exists():
        raise InvalidInput(f"{_place(typed)}: exists; name a new folder")
    if not typed["folder"] and typed["out"].exists() and not typed["force"]:
        raise InvalidInput(f"{typed['out']}: exists; name another file, or give --force to replace it")
    refuse_two_of_one(given)
    missing = [name for name in _NEEDED if not _is_known(name, given)]
    if missing and not is_terminal():
        options = ", ".join(map(_option, missing))
        raise InvalidInput(f"missing {options}; give them, or answer the questions on a terminal")
    for name, text, default, read in _QUESTIONS:
        if missing and not _is_known(name, given):
            given[name] = ask(_option(name), text, default, _readable_speed(given) if name == "speed" else read)
        if name == "speed" and _needs_track(given):
            given["track_radius"] = ask(*_TRACK, lambda radius: speed_of(given["speed"], track_radius=radius))
    if missing and "layer_thickness" not in given and (soft := _soft(given)):
        question = f"Thickness of {soft} as a layer on a rigid base, such as 3mm"
        given["layer_thickness"] = ask("--layer-thickness", question, "3mm", reader("m", name="--layer-thickness"))
    return given


def _option(name: str) -> str:
    return f"--{name.replace('_', '-')}"


def _is_known(name: str, given: Mapping[str, Any]) -> bool:
    """Whether an argument, or one in its place, was given."""
    return any(each in given for each in (name, *_INSTEAD.get(name, ())))


def _needs_track(given: Mapping[str, Any]) -> bool:
    """Whether a rotational speed lacks its track, and somebody can be asked for it."""
    has_track = "track_radius" in given or "track_diameter" in given
    return not has_track and is_terminal() and rotation_of(str(given.get("speed", ""))) is not None


def _soft(given: Mapping[str, Any]) -> str | None:
    """Soft body whose friction is that of a layer, of a vibration along the normal; None without one."""
    if given.get("direction", "normal") != "normal":
        return None
    bodies = [material(str(given[name])) for name in ("pin", "disc") if name in given]
    return next((each.title for each in bodies if is_soft(each)), None)


def _readable_speed(given: Mapping[str, Any]) -> Callable[[str], object]:
    """Reader of a speed, of which a rotational one may wait for its track."""
    radius, diameter = given.get("track_radius"), given.get("track_diameter")

    def read(text: str) -> object:
        waits = rotation_of(text) is not None and not (radius or diameter)
        return None if waits else speed_of(text, track_radius=radius, track_diameter=diameter)

    return read


def _place(typed: Mapping[str, Any]) -> Path:
    """Path of the file, or of the folder, that is written."""
    out: Path = typed["out"]
    return out.with_suffix("") if typed["folder"] and out == _FILE else out


def _delivered(answer: NewRig, typed: Mapping[str, Any]) -> None:
    """Write the rig file or the folder of the rig, and print the answer."""
    out = _place(typed)
    if typed["folder"]:
        answer.write_folder(out)
    deliver(replace(answer, target=out), folder=out.parent, as_json=typed["json"])


@dataclass(frozen=True, slots=True)
class _FileOrFolder(OutputFile):
    """Marks the path of a file, or of a folder that is refused where the arguments are read."""

    def expect(self, path: Path, stems: Mapping[str, str]) -> None:
        """Raise InvalidInput if the file cannot be written."""
        if stems.get("folder") != str(True):
            expect_file(path)


_FILE: Final = Path("rig.toml")
_OUT: Final = Annotated[
    Path, typer.Argument(metavar="[OUT.toml]", help="File to write; with --folder the folder."), _FileOrFolder()
]
_FOLDER: Final = Annotated[
    bool,
    typer.Option(
        "--folder", help="Make a folder with the rig, a table of own runs, and places for recipes, records and answers."
    ),
]
_FORCE: Final = Annotated[bool, typer.Option("--force", help="Replace the file where it exists.")]

new = command_of(
    task_named("new"),
    more=(argument("out", _OUT, _FILE), argument("folder", _FOLDER, False), argument("force", _FORCE, False)),
    complete=_completed,
    delivery=_delivered,
)
