"""Task `modes`: natural modes of a part by finite elements, with pictures, grids, shapes and animations."""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Unpack

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput, UnknownName
from sonolube.models.fem.results import part_modes as mode_files
from sonolube.models.fem.results.figures import ShapedSurface, mode_figure, shaped_surface
from sonolube.models.fem.results.mode_surfaces import SurfaceModes, surface_modes
from sonolube.models.fem.results.part_modes import PartModes, modes_dataset, part_modes
from sonolube.report import Drawing
from sonolube.report.results.parts import modes_and_impedance as results
from sonolube.tasks.answer import Answer, Block, Dataset, answer
from sonolube.tasks.files import InputFile, file_path
from sonolube.tasks.own_tables import number_table
from sonolube.tasks.parameters import File, Number, Parameter, Quantity, Sizes, Watched
from sonolube.tasks.parts import named_parts as parts
from sonolube.tasks.parts.foreign_modes import FILE_ONLY, ForeignModesAnswer, foreign_structure, typed, typed_command
from sonolube.tasks.parts.named_parts import DEFAULT_MATERIAL, supported_part
from sonolube.tasks.progress import stage
from sonolube.tasks.task import given_arguments, in_si, refuse_unused, shown, task
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_PART_ONLY = (
    *("part", "sizes", "material", "youngs_modulus", "poisson_ratio", "density", "count", "clamp", "axis", "tolerance"),
    *("points", "toward", "contact", "vtu", "animate"),
)
_CHOICES = ("count", "clamp", "tolerance", "contact", "body_mass", "body_stiffness", "body_damping")  # of the modes


@task
def modes(
    part: Annotated[
        InputFile | None, File("A part such as block, a transducer such as stack, or a STEP file.", "PART")
    ] = None,
    *,
    sizes: Sizes = None,
    material: Annotated[str, Parameter("Material of the part; transducers have their own.", "NAME")] = DEFAULT_MATERIAL,
    youngs_modulus: Annotated[
        Number | None,
        Quantity("Young's modulus instead of the material's.", "youngs_modulus", option="--young-modulus"),
    ] = None,
    poisson_ratio: Annotated[
        Number | None, Quantity("Instead of the material's Poisson's ratio.", "poisson_ratio", kind="RATIO")
    ] = None,
    density: Annotated[Number | None, Quantity("Density instead of the material's.", "density")] = None,
    count: Annotated[int, Parameter("Number of elastic modes.", "NUMBER")] = 6,
    clamp: Annotated[Sequence[str], Parameter("A face held still, such as -x.", "FACE")] = (),
    axis: Annotated[parts.Axis | None, Parameter("The part's axis; its longest by default.")] = None,
    tolerance: Annotated[Number, Quantity("Largest relative error of a frequency.", "", kind="RATIO")] = 0.005,
    points: Annotated[
        InputFile | None, File("Points x, y, z in mm at which to write the shapes.", "POINTS.csv")
    ] = None,
    toward: Annotated[parts.Axis | None, Parameter("Component at the points; that of the axis by default.")] = None,
    contact: Annotated[
        str | None, Parameter("Write the modes for a rig file, with the contact at an output such as tip.", "OUTPUT")
    ] = None,
    body_mass: Annotated[
        Number | None, Quantity("Of a body that rests on the contact; held where absent.", "kg")
    ] = None,
    body_stiffness: Annotated[
        Number, Quantity("Of the spring that holds that body; none where absent.", "N/m")
    ] = "0N/m",
    body_damping: Annotated[Number, Quantity("Of the damper beside it.", "N s/m")] = "0N s/m",
    vtu: Annotated[bool, Parameter("Write the modes for ParaView too.")] = False,
    animate: Annotated[bool, Parameter("Draw each mode as an animated GIF too.")] = False,
    from_file: Annotated[
        InputFile | None,
        File("Modes of another program instead of a part: .unv, .uff, .frd, or a table.", "FILE", option="--from"),
    ] = None,
    tip: Annotated[
        Sequence[str], Parameter("Node or point x,y,z of the contact; the mean of several.", "NODE|POINT")
    ] = (),
    direction: Annotated[
        str | None, Parameter("From the tip to the other body, such as +z or 0,0.6,0.8.", "DIRECTION")
    ] = None,
    port: Annotated[
        Sequence[str], Parameter("Node or point at an end of the stack; both are needed.", "NODE|POINT")
    ] = (),
    force_per_volt: Annotated[
        Number | None, Quantity("Blocked force of the stack per volt, such as 12N/V.", "N/V", kind="FORCE/VOLT")
    ] = None,
    clamped_capacitance: Annotated[
        Number | None, Quantity("Of the stack with all modes of the file held.", "clamped_capacitance")
    ] = None,
    quality_factor: Annotated[
        Number | None, Quantity("Of modes whose file states no damping.", "quality_factor", kind="RATIO")
    ] = None,
    modal_mass: Annotated[
        Number | None, Quantity("Of modes whose file states none; 1kg if mass-normalised.", "kg")
    ] = None,
    static_compliance: Annotated[
        Number | None,
        Quantity(
            "Of the contact by a static analysis, without rigid motions: for modes left out.", "static_compliance"
        ),
    ] = None,
    displacement_per_volt: Annotated[
        Number | None, Quantity("Of the contact by a static analysis, beside it.", "displacement_per_volt")
    ] = None,
    length_unit: Annotated[str | None, Parameter("Of a file that states none, such as mm.", "UNIT")] = None,
    force_unit: Annotated[str | None, Parameter("Of a file that states none, such as N.", "UNIT")] = None,
    **watch: Unpack[Watched],
) -> "ModesAnswer | ForeignModesAnswer":
    """Natural modes of a part, with errors, names and pictures; or those of another program for a rig file.

    Example: sonolube modes block --set length=127mm --set width=60.96mm --set thickness=25.4mm

    Examples
    --------
    >>> import sonolube as sl
    >>> from sonolube.text.units import format_si
    >>> answer = sl.modes("block", sizes={"length": "20mm", "width": "5mm", "thickness": "5mm"})
    >>> format_si(float(answer["natural_frequency"].sel(mode="axial 1")), "Hz")  # half a wavelength on 20 mm of steel
    '124 kHz'
    """
    body = _body(body_mass, body_stiffness, body_damping)
    if body_mass is None:
        refuse_unused("body_stiffness", "body_damping", because=f"without {shown('body_mass')}, which it holds")
    if from_file is not None:
        refuse_unused(*_PART_ONLY, because=f"for {shown('from_file')}; it is for a part")
        return foreign_structure(
            from_file,
            tip=tip,
            direction=direction,
            port=port,
            force_per_volt=force_per_volt,
            clamped_capacitance=clamped_capacitance,
            quality_factor=quality_factor,
            modal_mass=modal_mass,
            units=(length_unit, force_unit),
            statics=(static_compliance, displacement_per_volt),
            body=body,
        )
    refuse_unused(*FILE_ONLY, because=f"for a part; it is for {shown('from_file')}")
    if part is None:
        raise InvalidInput(
            f"needs a part, such as block, or {shown('from_file')}, modes of another program", key="part"
        )
    name = parts.part_name(part)
    _refuse_unused(name, points=points, contact=contact)
    if contact is not None:
        _require_output(name, sizes or {}, contact)
    given = {name: in_si(name, value) for name, value in given_arguments(parts.ELASTIC_PROPERTIES).items()}
    supported = supported_part(part, sizes or {}, material=material, properties=given, clamp=clamp)
    scanned = None if points is None else _points_in_metres(points)
    with stage("meshing and solving") as advance:
        solved = part_modes(supported, count=count, axis=axis, tolerance=in_si("tolerance", tolerance), advance=advance)
        structure = None
        if supported.transducer is not None and contact is not None:
            meshes = len(solved.found.nodes)
            advance("reduction", meshes, meshes + 1)
            command = _command(name, sizes or {})
            structure = mode_files.structure_modes(
                solved.found, supported.transducer, contact=contact, body=body, command=command
            )
    return ModesAnswer(
        solved=solved,
        points=scanned,
        direction=toward or solved.axis,
        with_grid=vtu,
        with_animations=animate,
        structure=structure,
    )


def _refuse_unused(part: str, *, points: InputFile | None, contact: str | None) -> None:
    """Refuse arguments that the part and the others leave without effect."""
    if part in parts.transducers():
        own = ("material", "youngs_modulus", "poisson_ratio", "density")
        refuse_unused(*own, because=f"for {part}, which has its own; it is for other parts")
    if points is None:
        refuse_unused("toward", because=f"without {shown('points')}, at which the component is written")
    if contact is None:
        refuse_unused("body_mass", because=f"without {shown('contact')}, on which it rests")


def _require_output(part: str, sizes: parts.PartSizes, contact: str) -> None:
    """Refuse a contact of a part without a drive, or at an output that it lacks."""
    if part not in parts.transducers():
        known = ", ".join(parts.transducers())
        raise InvalidInput(f"{shown('contact')} {contact}: {part} has no drive; it is for transducers: {known}")
    outputs = parts.named_transducer(part, sizes).outputs
    if contact not in outputs:
        raise UnknownName.among(outputs, kind=f"output of {part}", name=contact)


def _body(mass: Number | None, stiffness: Number, damping: Number) -> mode_files.SupportedBody | None:
    """Body that rests on the contact; None where it is held."""
    if mass is None:
        return None
    return mode_files.SupportedBody(
        body_mass=in_si("body_mass", mass),
        spring_stiffness=in_si("body_stiffness", stiffness),
        viscous_damping=in_si("body_damping", damping),
    )


def _points_in_metres(points: InputFile) -> Floats:
    """Points in m from a CSV table of x, y and z in mm, shape (p, 3)."""
    table = number_table(file_path(points))
    if table.shape[1] != 3 or not np.all(np.isfinite(table)):
        raise InvalidInput(f"{parts.part_name(points)}: needs the three columns x, y and z in mm, got {table.shape[1]}")
    return np.asarray(1e-3 * table)


def _command(part: str, sizes: parts.PartSizes) -> str:
    """Command that computes the same modes again, without the options of its files."""
    words = ["sonolube", "modes", part]
    for name, size in sizes.items():
        words += ["--set", f"{name}={typed(size, quantity(name).unit)}"]
    return typed_command(words, _CHOICES)


@answer
class ModesAnswer(Answer):
    """Natural frequencies of a part with their errors, and its elastic modes as pictures and files."""

    solved: PartModes
    points: Floats | None
    direction: str
    with_grid: bool
    with_animations: bool
    structure: str | None

    def blocks(self) -> Sequence[Block]:
        """Name and natural frequency with its error of every elastic mode."""
        return results.modes_blocks(self.solved)

    def object(self) -> dict[str, Any]:
        """Number of rigid motions, nodes of the meshes, and name, frequency and error of every elastic mode."""
        return results.modes_object(self.solved, self.structure)

    def assumptions(self) -> Mapping[str, str]:
        """Dimensions of a transducer that no source prints."""
        return self.solved.part.assumptions

    def figures(self) -> Mapping[str, Drawing]:
        """Picture of every elastic mode."""
        return {self._file_name(row): Drawing(draw=partial(self._figure, row), forms=("png",)) for row in self._rows()}

    def files(self) -> Mapping[str, str | bytes]:
        """Shapes at points, structure for a rig file, grid and animations, as far as they are wanted."""
        files: dict[str, str | bytes] = {}
        stem = Path(self.solved.part.name).stem
        if self.points is not None:
            table = mode_files.shapes_table(self.solved.found, self.solved.names, self.points, direction=self.direction)
            files[f"{stem}-shapes.csv"] = table
        if self.structure is not None:
            files[f"{stem}-modes.toml"] = self.structure
        if self.with_grid:
            files[f"{stem}-modes.vtu"] = mode_files.modes_grid(self.solved.found, self.solved.names)
        if self.with_animations:
            with stage("animating") as advance:
                for done, row in enumerate(self._rows()):
                    advance(self.solved.names[row], done, len(self._rows()))
                    animation = mode_files.mode_animation(self._surface(row), title=self._title(row))
                    files[f"{self._file_name(row)}.gif"] = animation
        return files

    def surface_modes(self) -> SurfaceModes:
        """Elastic modes on the surface of the part."""
        found = self.solved.found
        frequencies = [(each["name"], each["text"]) for each in self.object()["modes"]]
        shapes = found.modes.shapes[list(self._rows())]
        return surface_modes(found.model, shapes, frequencies=frequencies, axis=self.solved.axis)

    def dataset(self) -> Dataset:
        """Frequencies, errors and shapes of the elastic modes, with the surface of the part."""
        return modes_dataset(self.solved).assign_attrs(self.notes())

    def _rows(self) -> range:
        """Indices of the elastic modes."""
        return mode_files.elastic_rows(self.solved.found)

    def _surface(self, row: int) -> ShapedSurface:
        """Surface of the part with the shape of a mode."""
        return shaped_surface(self.solved.found.model.mesh, self.solved.found.modes.shapes[row])

    def _figure(self, row: int) -> "Figure":
        """Picture of a mode."""
        return mode_figure(self._surface(row), title=self._title(row))

    def _title(self, row: int) -> str:
        """Name and natural frequency of a mode."""
        return mode_files.mode_title(self.solved.found, self.solved.names, row)

    def _file_name(self, row: int) -> str:
        """Name of the picture of a mode: part, number among the elastic modes, and name of the mode."""
        number = row - self.solved.found.modes.rigid_body_count + 1
        return f"{Path(self.solved.part.name).stem}-{number}-{self.solved.names[row].replace(' ', '-')}"
