"""Modes of other programs as the structure of a rig: universal files, results of CalculiX, and tables."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.mode_shapes import formats, participation
from sonolube.models.fem.results.part_modes import SupportedBody, modes_file_text
from sonolube.operating_system import quoted
from sonolube.report.results.parts import modes_and_impedance as results
from sonolube.rig.file.modes_file import read_modes
from sonolube.tasks.answer import Answer, Block, Dataset, answer
from sonolube.tasks.files import InputFile, file_path
from sonolube.tasks.parameters import Number
from sonolube.tasks.parts.named_parts import part_name
from sonolube.tasks.task import given_arguments, in_si, refuse_unused, shown
from sonolube.text.units import format_si, to_si

SHAPES_ONLY = ("tip", "direction", "port", "quality_factor", "modal_mass", "length_unit", "force_unit")
"""Arguments without meaning for a table of modes."""

FILE_ONLY = (*SHAPES_ONLY, "force_per_volt", "clamped_capacitance", "static_compliance", "displacement_per_volt")
"""Arguments without meaning for a part."""

_UNITS = {
    **{"body_mass": "kg", "body_stiffness": "N/m", "body_damping": "N s/m"},
    **{"force_per_volt": "N/V", "clamped_capacitance": "F", "modal_mass": "kg"},
    **{"static_compliance": "m/N", "displacement_per_volt": "m/V"},
}
_TABLES = (".csv", ".toml")
_NEAR = 0.01  # of a millimetre, below which a node lies at its point


def foreign_structure(
    file: InputFile,
    *,
    tip: Sequence[str],
    direction: str | None,
    port: Sequence[str],
    force_per_volt: Number | None,
    clamped_capacitance: Number | None,
    quality_factor: Number | None,
    modal_mass: Number | None,
    units: tuple[str | None, str | None],
    statics: tuple[Number | None, Number | None],
    body: SupportedBody | None,
) -> "ForeignModesAnswer":
    """Structure of a rig from the modes in a file of another program."""
    path = file_path(file)
    force = in_si("force_per_volt", force_per_volt)
    capacitance = in_si("clamped_capacitance", clamped_capacitance)
    if path.suffix.lower() in _TABLES:
        refuse_unused(*SHAPES_ONLY, because=f"for a table of modes ({', '.join(_TABLES)}), which has all but units")
        lists, capacitance = _of_table(path, force, capacitance)
        notes: list[str] = ["table of modes"]
        caveats: tuple[str, ...] = ()
    else:
        modes = formats.read_mode_shapes(path, units=_unit_system(*units))
        tips = [participation.find_node(modes, each, name=shown("tip")) for each in _several("tip", tip)]
        ends = [participation.find_node(modes, each, name=shown("port")) for each in _several("port", port, count=2)]
        outward = participation.direction_vector(_given("direction", direction), name=shown("direction"))
        elongation = participation.port_participation(modes, (ends[0], ends[1]), name=shown("port"))
        lists = participation.modal_lists(
            modes,
            contact=participation.contact_participation(modes, tips, outward=outward),
            drive=_given("force_per_volt", force) * elongation,
            modal_mass=in_si("modal_mass", modal_mass),
            quality_factor=in_si("quality_factor", quality_factor),
        )
        places = (*(("tip", each) for each in tips), *(("port", each) for each in ends))
        notes = [modes.format_name, *(_place(what, each, modes) for what, each in places)]
        caveats = modes.caveats
    if capacitance is None:
        raise InvalidInput(f"needs {shown('clamped_capacitance')}, such as 4.2nF", key="clamped_capacitance")
    remark = _truncation(lists)
    static = in_si("static_compliance", statics[0]), in_si("displacement_per_volt", statics[1])
    if static[0] is not None and static[1] is not None:
        lists, capacitance = participation.with_static_correction(
            lists, static_compliance=static[0], displacement_per_volt=static[1], clamped_capacitance=capacitance
        )
        remark = _CORRECTED.format(format_si(float(lists["natural_frequency"][-1]), "Hz", digits=4))
    elif static != (None, None):
        raise InvalidInput(
            f"{shown('static_compliance')} and {shown('displacement_per_volt')} belong together: give both"
        )
    if body is not None:
        lists = {name: np.append(values, body.mode[name]) for name, values in lists.items()}
    return ForeignModesAnswer(
        name=part_name(file),
        lists=lists,
        clamped_capacitance=capacitance,
        taken=tuple(notes),
        remarks=(*caveats, remark),
        command=typed_command(["sonolube", "modes", "--from", part_name(file)], (*FILE_ONLY, *_UNITS)),
    )


def _of_table(path: Path, force: float | None, capacitance: float | None) -> tuple[dict[str, Floats], float | None]:
    """Columns of a table of modes, and the capacitance that it or the user states."""
    content = read_modes(path, force_per_volt=force)
    own = content.pop("clamped_capacitance", None)
    if own is not None and capacitance is not None:
        raise InvalidInput(f"{path}: states clamped_capacitance; leave out {shown('clamped_capacitance')}")
    if own is not None:
        name = f"{path}: clamped_capacitance"
        capacitance = to_si(own, unit="F", name=name) if isinstance(own, str) else float(own)
    return {name: np.array(values) for name, values in content.items()}, capacitance


def _unit_system(length: str | None, force: str | None) -> formats.UnitSystem | None:
    """Units of a file that states none."""
    if length is None and force is None:
        return None
    return formats.UnitSystem(length_unit=_given("length_unit", length), force_unit=_given("force_unit", force))


def _several(name: str, places: Sequence[str], *, count: int | None = None) -> Sequence[str]:
    """Places that were given, in Python also a single one."""
    found = [places] if isinstance(places, str) else list(places)
    if not found or (count is not None and len(found) != count):
        wanted = "a node or point" if count is None else "two nodes or points, the ends of the stack"
        raise InvalidInput(f"needs {shown(name)}, {wanted}; got {len(found)}", key=name)
    return found


_EXAMPLES = {
    "direction": "the direction from the tip to the other body, such as +z",
    "force_per_volt": "the blocked force of the stack per volt, such as 12N/V",
    "length_unit": "such as mm, beside the unit of force",
    "force_unit": "such as N, beside the unit of length",
}


def _given(name: str, value: Any) -> Any:
    """Argument that a file of shapes cannot do without."""
    if value is None:
        raise InvalidInput(f"needs {shown(name)}, {_EXAMPLES[name]}", key=name)
    return value


def _place(what: str, node: participation.FoundNode, modes: formats.ModeShapes) -> str:
    """Node that was taken, its position, and how far it lies from the point asked for."""
    position = modes.position[node.row]
    at = "" if np.isnan(position).any() else f" at {', '.join(format_si(float(each), 'm') for each in position)}"
    off = f", {format_si(node.distance, 'm')} from the point" if node.distance > 1e-3 * _NEAR else ""
    return f"{what}: node {node.number}{at}{off}"


_CORRECTED = (
    "the last mode, at {}, stands for the static share of all that the file leaves out, by the static values given; the"
    " clamped capacitance is less by its share"
)


def _truncation(lists: Mapping[str, Floats]) -> str:
    """Caveat on modes that a file lacks, with the compliance that they would add if they went on as the last ones."""
    highest = format_si(float(np.max(lists["natural_frequency"])), "Hz", digits=4)
    kept, missing = participation.kept_compliance(lists), participation.truncated_compliance(lists)
    texts = [format_si(each, "m/N", digits=2) for each in (missing, kept)]
    size = (
        "" if np.isnan(missing) else f", about {texts[0]} beside {texts[1]} if they go on as those of a slender bar do"
    )
    return (
        f"modes above {highest} are left out: their static compliance at the contact is missing{size}, and the clamped"
        " capacitance has to contain their share; the static compliance and the displacement per volt of a static"
        " analysis put it in"
    )


def typed_command(words: Sequence[str], names: Sequence[str]) -> str:
    """Command that computes the same again: its first words, and the given ones of some arguments."""
    found = list(words)
    for name, value in given_arguments(names).items():
        for each in value if isinstance(value, list | tuple) else [value]:
            found += [f"--{name.replace('_', '-')}", typed(each, _UNITS.get(name, ""))]
    return " ".join(quoted(word) if " " in word else word for word in found)


def typed(value: Number, unit: str) -> str:
    """Value as a terminal takes it."""
    return value if isinstance(value, str) else f"{value}{unit}"


@answer
class ForeignModesAnswer(Answer):
    """Modes of another program as the structure of a rig."""

    name: str
    lists: Mapping[str, Floats]
    clamped_capacitance: float
    taken: tuple[str, ...]
    remarks: tuple[str, ...]
    command: str

    def blocks(self) -> Sequence[Block]:
        """Nodes that were taken, and frequency, damping and participations of every mode."""
        count = self.lists["natural_frequency"].size
        title = f"{self.name}: {count} modes, clamped capacitance {format_si(self.clamped_capacitance, 'F', digits=4)}"
        return results.foreign_blocks(title, self.lists, self.taken)

    def object(self) -> dict[str, Any]:
        """Structure for a rig file, and every mode."""
        return {"file": self.name, "notes": list(self.taken), **results.foreign_object(self.lists, self._structure())}

    def caveats(self) -> Sequence[str]:
        """What was done to the modes in reading, and what modes are missing."""
        return self.remarks

    def files(self) -> Mapping[str, str]:
        """File of modes for the table `structure` of a rig file."""
        return {f"{Path(self.name).stem}-modes.toml": self._structure()}

    def dataset(self) -> Dataset:
        """Frequency, damping, participations and tip amplitude per volt over the number of the mode."""
        return results.foreign_dataset(self.lists).assign_attrs(self.notes())

    def _structure(self) -> str:
        """File of modes as TOML."""
        return modes_file_text(
            self.lists,
            heading="# Modes of another program for [structure] of a rig file. Shapes have a modal mass of 1 kg.",
            command=self.command,
            assumptions=(*self.taken, *self.remarks),
            clamped_capacitance=self.clamped_capacitance,
        )
