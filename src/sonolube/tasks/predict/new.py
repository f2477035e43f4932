"""Task `new`: a first rig from what is known before a test."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

from sonolube.errors import InvalidInput
from sonolube.facts.materials import material
from sonolube.measurement.run_sheet_file import EMPTY_TABLE
from sonolube.operating_system import quoted
from sonolube.prediction.applicability import applicability
from sonolube.rig import Rig
from sonolube.rig.file.rig_folder import folder_contents
from sonolube.rig.new_rig.pin_and_vibration import KnownSurface
from sonolube.rig.new_rig.rig_text import KnownRig, LeastKnown, least_known, new_rig_text, rig_of_known
from sonolube.rig.new_rig.stated_text import direction_of, pin_shape, reader, speed_of, surface_of, vibration_of
from sonolube.storage.files import write_folder
from sonolube.tasks.answer import Answer, Block, Dataset, Table, Verbatim, answer
from sonolube.tasks.files import InputFile, file_path
from sonolube.tasks.parameters import File, Number, Parameter, Quantity
from sonolube.tasks.task import shown, task
from sonolube.vocabulary import quantity

DEFAULT_SHAPE = "flat 3mm"
"""End of the pin where none is given."""

DEFAULT_FINISH = "ground"
"""Finish of both surfaces where none is given."""

_ONE_OF = (
    ("pin_finish", "pin_scan"),
    ("disc_finish", "scan"),
    ("decay_length", "stiffness"),
    ("amplitude", "actuator"),
    ("actuator", "calibration"),
)


def _customary(text: str, name: str, *, kind: str = "") -> Quantity:
    """Meaning of a quantity of the vocabulary with the unit in which it is customarily stated."""
    return Quantity(f"{text}, usually in {quantity(name).customary_unit}.", name, kind=kind)


@task
def new(
    *,
    pin: Annotated[str, Parameter("Material of the pin, or its class: 100Cr6, 304, steel.", "MATERIAL")],
    disc: Annotated[str, Parameter("Material of the disc, or its class.", "MATERIAL")],
    load: Annotated[Number, _customary("Normal load", "normal_load")],
    speed: Annotated[Number, Quantity("Sliding speed: 0.2m/s, or '100 rpm' with the track.", "sliding_speed")],
    frequency: Annotated[Number, _customary("Frequency of the vibration", "frequency")],
    amplitude: Annotated[
        Number | None, _customary("Vibration amplitude in its direction, zero to peak", "vibration_amplitude")
    ] = None,
    direction: Annotated[
        str | None,
        Parameter(
            "Direction of the vibration: normal (default), along or across the sliding, torsional, or its angle to the"
            " sliding within the plane, such as 30deg.",
            "DIRECTION",
        ),
    ] = None,
    torsion_radius: Annotated[
        Number | None, _customary("Radius of a torsional ring, at which the amplitude holds", "torsion_radius")
    ] = None,
    actuator: Annotated[
        str | None, Parameter("Actuator by its name in sonolube actuators, in place of the amplitude.", "NAME")
    ] = None,
    voltage: Annotated[
        Number | None, _customary("Voltage of the actuator, peak to peak", "voltage_peak_to_peak")
    ] = None,
    calibration: Annotated[
        str | None,
        Parameter(
            "Voltage of the drive, peak to peak, and its amplitude, such as '25V = 2um': scales own runs by voltage.",
            "VOLTAGE=AMPLITUDE",
        ),
    ] = None,
    shape: Annotated[
        str | None,
        Parameter(
            "End of the pin: 'flat 3mm' (its diameter, default), 'ball 5mm' (its radius), 'ball radius 5mm',"
            " 'ball diameter 10mm'.",
            "SHAPE",
        ),
    ] = None,
    track_radius: Annotated[
        Number | None, _customary("Radius of the track on the disc, for a speed in rpm", "track_radius")
    ] = None,
    track_diameter: Annotated[
        Number | None, _customary("Its diameter, in place of the radius", "track_diameter")
    ] = None,
    finish: Annotated[
        str | None,
        Parameter(
            "Finish of pin and disc: 'ground' (default), N6, 'ground N6', 'Ra 0.4' (in um), 0.4um (as Ra), 'Rz 3.2um'.",
            "FINISH",
        ),
    ] = None,
    pin_finish: Annotated[str | None, Parameter("Finish of the pin.", "FINISH")] = None,
    disc_finish: Annotated[str | None, Parameter("Finish of the disc.", "FINISH")] = None,
    scan: Annotated[InputFile | None, File("Scan of the disc, in place of its finish.", "FILE")] = None,
    pin_scan: Annotated[InputFile | None, File("Scan of the pin, in place of its finish.", "FILE")] = None,
    friction: Annotated[
        Number | None,
        Quantity("Coefficient of dry friction, where it was measured; else the range of the pair.", "", kind="NUMBER"),
    ] = None,
    decay_length: Annotated[
        Number | None,
        _customary(
            "Length over which the force of the worn contact falls by a factor of e, where it is known; else that "
            "of published tests",
            "decay_length",
        ),
    ] = None,
    stiffness: Annotated[
        Number | None,
        _customary(
            "Measured normal stiffness of the contact under the load, in place of the decay length",
            "normal_stiffness",
            kind="STIFFNESS",
        ),
    ] = None,
    layer_thickness: Annotated[
        Number | None,
        _customary(
            "Thickness of the softer body, such as felt, as a layer on a rigid base: friction of a soft layer",
            "layer_thickness",
        ),
    ] = None,
) -> "NewRig":
    """A first rig file from what is known before a test: asks on a terminal for what the options leave out.

    Example: sonolube new rig.toml --pin m50 --disc m50 --load 5N --speed 0.2m/s --frequency 20kHz --amplitude 3um

    Examples
    --------
    >>> import sonolube as sl
    >>> answer = sl.new(pin="100Cr6", disc="2024", load="3N", speed="20mm/s", frequency="22kHz", amplitude="2.5um")
    >>> round(answer.rig.friction_coefficient, 3)  # middle of the range of dry steel on aluminium
    0.475
    >>> round(float(sl.friction(answer.rig)["friction_ratio"]), 2)
    0.27
    """
    every = {"amplitude": amplitude, "actuator": actuator, "voltage": voltage, "pin_finish": pin_finish}
    every |= {"calibration": calibration}
    refuse_two_of_one(every | {"pin_scan": pin_scan, "disc_finish": disc_finish, "scan": scan})
    refuse_two_of_one({"decay_length": decay_length, "stiffness": stiffness})
    if amplitude is None and actuator is None and calibration is None:
        raise InvalidInput(
            f"give {shown('amplitude')}, {shown('calibration')}, or {shown('actuator')} with its {shown('voltage')}"
        )
    sliding_speed, speed_reason = speed_of(
        _text(speed, "m/s") or "",
        track_radius=_text(track_radius, "m"),
        track_diameter=_text(track_diameter, "m"),
        name=shown("speed"),
        radius_name=shown("track_radius"),
        diameter_name=shown("track_diameter"),
    )
    known = KnownRig(
        pin=material(pin).name,
        disc=material(disc).name,
        shape=pin_shape(shape or DEFAULT_SHAPE, name=shown("shape")),
        normal_load=_read("load", load, "N"),
        sliding_speed=sliding_speed,
        speed_reason=speed_reason,
        frequency=_read("frequency", frequency, "Hz"),
        vibration=vibration_of(stated_vibration(amplitude, actuator, voltage, calibration), name=shown("amplitude")),
        pin_surface=_surface(pin_scan, pin_finish or finish),
        disc_surface=_surface(scan, disc_finish or finish),
        friction_coefficient=_read_optional("friction", friction, ""),
        decay_length=_read_optional("decay_length", decay_length, "m"),
        normal_stiffness=_read_optional("stiffness", stiffness, "N/m"),
        direction=direction_of(
            direction,
            torsion_radius=_text(torsion_radius, "m"),
            name=shown("direction"),
            radius_name=shown("torsion_radius"),
        ),
        layer_thickness=_read_optional("layer_thickness", layer_thickness, "m"),
    )
    rig = rig_of_known(known)
    return NewRig(rig=rig, rig_text=new_rig_text(known), least_known=least_known(rig))


@answer
class NewRig(Answer):
    """New rig with what it assumes, the inputs known least, and its file; `target` is where a terminal writes it."""

    rig: Rig
    rig_text: str
    least_known: Sequence[LeastKnown]
    target: Path | None = None

    def write_folder(self, path: str | Path) -> Path:
        """Make a folder of the rig, which tasks take in place of its file.

        Parameters
        ----------
        path : str or Path
            Of the folder, which must not exist.

        Returns
        -------
        Path
            With the rig file, an empty table of own runs, and folders for recipes, records and answers.

        Raises
        ------
        InvalidInput
            If it exists or cannot be written; then nothing is.
        """
        contents = folder_contents(title=self.rig.title, rig=self.rig_text, runs=EMPTY_TABLE)
        return write_folder(Path(path), contents)

    def blocks(self) -> Sequence[Block]:
        """Title, the inputs known least with how to measure them, and the next command."""
        heads = ("least known", "distribution", "to measure it")
        rows = [(one.key, one.text, one.remedy) for one in self.least_known]
        following = "friction" if applicability(self.rig).refusal else "predict"
        command = [] if self.target is None else [Verbatim(f"  next: sonolube {following} {quoted(str(self.target))}")]
        return [self.rig.title, Table(heads, rows), *command]

    def object(self) -> dict[str, Any]:
        """Title, text of the file and the inputs known least."""
        return {
            "rig": self.rig.title,
            "text": self.rig_text,
            "uncertainty": {key: law.text for key, law in self.rig.uncertainty.items()},
            "least_known": {one.key: one.remedy for one in self.least_known},
        }

    def dataset(self) -> Dataset:
        """Uncertain entries of the rig: medians and 80 % intervals in SI, and their distributions."""
        import xarray as xr

        laws, levels = self.rig.uncertainty, [0.1, 0.5, 0.9]
        return xr.Dataset(
            {
                "quantile": (("entry", "level"), [law.quantile(levels) for law in laws.values()]),
                "distribution": ("entry", [law.text for law in laws.values()]),
            },
            coords={"entry": list(laws), "level": levels},
            attrs={"title": self.rig.title, **self.notes()},
        )

    def files(self) -> Mapping[str, str]:
        """Rig file."""
        if self.target is not None and self.target.is_dir():
            return {}
        return {"rig.toml" if self.target is None else self.target.name: self.rig_text}


def refuse_two_of_one(given: Mapping[str, object]) -> None:
    """Refuse two arguments of `new` for one thing, and an actuator without its voltage.

    Parameters
    ----------
    given : mapping of str to object
        Values of arguments by name; None for what was not given.

    Raises
    ------
    InvalidInput
        For the first such pair.
    """
    for pair in _ONE_OF:
        if all(given.get(name) is not None for name in pair):
            raise InvalidInput(f"give either {' or '.join(map(shown, pair))}, got both", key=pair[1])
    if (given.get("actuator") is None) != (given.get("voltage") is None):
        raise InvalidInput(f"{shown('actuator')} and {shown('voltage')} belong together: give both or neither")


def stated_vibration(
    amplitude: Number | None, actuator: str | None, voltage: Number | None, calibration: str | None = None
) -> str:
    """Source of the vibration as one text: an amplitude, a calibration before it, or an actuator and its voltage."""
    if calibration is not None:
        return f"{calibration}; {_text(amplitude, 'm') or ''}"
    return _text(amplitude, "m") or "" if actuator is None else f"{actuator} {_text(voltage, 'V')}"


def _text(value: Number | None, unit: str) -> str | None:
    """Quantity as text; None as it is."""
    return f"{float(value)} {unit}" if isinstance(value, int | float) else value


def _read(name: str, value: Number, unit: str) -> float:
    """Positive number in SI that a rig can have."""
    return reader(unit, name=shown(name))(_text(value, unit) or "")


def _read_optional(name: str, value: Number | None, unit: str) -> float | None:
    """The same; None where nothing was given."""
    return None if value is None else _read(name, value, unit)


def _surface(scan: InputFile | None, finish: str | None) -> KnownSurface:
    """Surface by its scan or its finish."""
    return surface_of(str(file_path(scan)) if scan is not None else finish or DEFAULT_FINISH)
