"""Command `modes`: natural modes of a part by finite elements, with pictures, grids, shapes and animations."""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from sonolube.checks import Floats
from sonolube.cli.console import parts
from sonolube.cli.console.answer import Answer, deliver, si
from sonolube.cli.console.options import OUT, Json, Out, Sizes, TypedNumber, refuse_unused, si_option
from sonolube.cli.console.outputs import OutputFolder
from sonolube.cli.console.progress import progress
from sonolube.errors import InvalidInput, UnknownName
from sonolube.models.fem import ConvergedModes
from sonolube.models.fem.figures import ShapedSurface, mode_figure, shaped_surface
from sonolube.models.fem.mode_files import (
    SupportedBody,
    elastic_rows,
    frequency_text,
    mode_animation,
    mode_title,
    modes_grid,
    shapes_table,
    structure_modes,
)
from sonolube.report import Drawing
from sonolube.workbench.named_parts import ALL_TRANSDUCERS, ELASTIC_PROPERTIES, named_transducer
from sonolube.workbench.part_modes import (
    DEFAULT_MATERIAL,
    MODE_COUNT,
    MODE_TOLERANCE,
    PartModes,
    part_modes,
    supported_part,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_OF_STRUCTURE = ("sizes", "count", "clamp", "tolerance", "contact", "body", "body_stiffness", "body_damping")
# arguments that change the modes of a structure


def modes(
    context: typer.Context,
    part: Annotated[
        str, typer.Argument(metavar="PART", help="A part such as block, a transducer such as stack, or a STEP file.")
    ],
    sizes: Sizes = None,
    material: Annotated[
        str, typer.Option(metavar="NAME", help="Material of the part; transducers have their own.")
    ] = DEFAULT_MATERIAL,
    stiffness: Annotated[
        float | None, si_option("Pa", "Young's modulus instead of the material's.", "--young-modulus")
    ] = None,
    contraction: Annotated[
        float | None,
        typer.Option("--poisson-ratio", metavar="RATIO", help="Instead of the material's Poisson's ratio."),
    ] = None,
    mass: Annotated[float | None, si_option("kg/m3", "Density instead of the material's.", "--density")] = None,
    count: Annotated[int, typer.Option(metavar="NUMBER", help="Number of elastic modes.")] = MODE_COUNT,
    clamp: Annotated[list[str] | None, typer.Option(metavar="FACE", help="A face held still, such as -x.")] = None,
    axis: Annotated[str | None, typer.Option(metavar="x|y|z", help="The part's axis; its longest by default.")] = None,
    tolerance: Annotated[
        float, typer.Option(metavar="RATIO", help="Largest relative error of a frequency.")
    ] = MODE_TOLERANCE,
    points: Annotated[
        Path | None, typer.Option(metavar="POINTS.csv", help="Points x, y, z in mm at which to write the shapes.")
    ] = None,
    toward: Annotated[
        str | None, typer.Option(metavar="x|y|z", help="Component at the points; that of the axis by default.")
    ] = None,
    contact: Annotated[
        str | None,
        typer.Option(
            metavar="OUTPUT", help="Write the modes for a rig file, with the contact at an output such as tip."
        ),
    ] = None,
    body: Annotated[
        float | None, si_option("kg", "Of a body that rests on the contact; held where absent.", "--body-mass")
    ] = None,
    body_stiffness: Annotated[
        float, si_option("N/m", "Of the spring that holds that body; none where absent.", "--body-stiffness")
    ] = TypedNumber("0N/m", "N/m"),
    body_damping: Annotated[float, si_option("N s/m", "Of the damper beside it.", "--body-damping")] = TypedNumber(
        "0N s/m", "N s/m"
    ),
    vtu: Annotated[bool, typer.Option("--vtu", help="Write the modes for ParaView too.")] = False,
    animate: Annotated[bool, typer.Option("--animate", help="Draw each mode as an animated GIF too.")] = False,
    out: Annotated[Out, OutputFolder("{part}-*.png {part}-*.gif {part}-shapes.csv {part}-modes.*")] = OUT,
    json: Json = False,
) -> None:
    """Natural modes of a part: frequencies with their errors, names and pictures.

    Example: sonolube modes block --set length=127mm --set width=60.96mm --set thickness=25.4mm
    """
    parts.require_axis(axis=axis, toward=toward)
    if part in ALL_TRANSDUCERS:
        refuse_unused(context, "material", because=f"for {part}, which has its own; it is for other parts")
    if points is None:
        refuse_unused(context, "toward", because="without --points, at which the component is written")
    if contact is None:
        refuse_unused(context, "body", because="without --contact, on which it rests")
    if body is None:
        refuse_unused(context, "body_stiffness", "body_damping", because="without --body-mass, which it holds")
    texts = parts.sizes_by_name(sizes or [])
    if contact is not None:
        _require_output(part, texts, contact)
    given = dict(zip(ELASTIC_PROPERTIES, (stiffness, contraction, mass), strict=True))
    supported = supported_part(
        part,
        texts,
        material=material,
        properties={name: value for name, value in given.items() if value is not None},
        clamp=clamp or (),
        entries=(parts.SIZE_ENTRY, "--material"),
    )
    transducer = supported.transducer
    held = (
        None
        if body is None
        else SupportedBody(body_mass=body, spring_stiffness=body_stiffness, viscous_damping=body_damping)
    )
    scanned = None if points is None else parts.points_in_metres(points)
    with progress("meshing and solving") as advance:
        solved = part_modes(supported, count=count, axis=axis, tolerance=tolerance, advance=advance)
        structure = None
        if transducer is not None and contact is not None:
            meshes = len(solved.found.nodes)
            advance("reduction", meshes, meshes + 1)
            command = _command(context, part)
            structure = structure_modes(solved.found, transducer, contact=contact, body=held, command=command)
    answer = ModesAnswer(
        solved=solved,
        points=scanned,
        direction=toward or solved.axis,
        with_grid=vtu,
        with_animations=animate,
        structure=structure,
    )
    deliver(answer, folder=out, as_json=json)


def _require_output(part: str, sizes: Mapping[str, str], contact: str) -> None:
    """Refuse a contact of a part without a drive, or at an output that it lacks."""
    if part not in ALL_TRANSDUCERS:
        known = ", ".join(ALL_TRANSDUCERS)
        raise InvalidInput(f"--contact {contact}: {part} has no drive; it is for transducers: {known}")
    outputs = named_transducer(part, sizes, entry=parts.SIZE_ENTRY).outputs
    if contact not in outputs:
        raise UnknownName.among(outputs, kind=f"output of {part}", name=contact)


def _command(context: typer.Context, part: str) -> str:
    """Command that computes the same modes again, without the options of its files."""
    given = [
        (option.opts[0], context.params[option.name])
        for option in context.command.params
        if option.name in _OF_STRUCTURE
        and getattr(context.get_parameter_source(option.name), "name", "DEFAULT") != "DEFAULT"
    ]
    words = [f"{name} {each}" for name, value in given for each in (value if isinstance(value, list) else [value])]
    return " ".join(["sonolube modes", part, *words])


@dataclass(frozen=True, kw_only=True)
class ModesAnswer(Answer):
    """Natural frequencies of a part with their errors, and its elastic modes as pictures and files."""

    solved: PartModes
    points: Floats | None
    direction: str
    with_grid: bool
    with_animations: bool
    structure: str | None

    @property
    def found(self) -> ConvergedModes:
        """Modes on the last mesh."""
        return self.solved.found

    @property
    def names(self) -> Sequence[str]:
        """Names of all modes."""
        return self.solved.names

    def lines(self) -> list[str]:
        """Name and natural frequency with its error of every elastic mode."""
        found, rigid = self.found, self.found.modes.rigid_body_count
        width = max(len(self.names[row]) for row in self._rows())
        support = f"{rigid} rigid motions, " if rigid else "held, "
        nodes = f"{found.nodes[-1]} nodes in the last of {len(found.nodes)} meshes"
        return [
            f"{self.solved.part.name} of {self.solved.part.material}: {support}{nodes}",
            *[f"  {self.names[row]:<{width}}  {self._frequency(row)}" for row in self._rows()],
        ]

    def object(self) -> dict[str, Any]:
        """Number of rigid motions, nodes of the meshes, and name, frequency and error of every elastic mode."""
        found = self.found
        return {
            "part": self.solved.part.name,
            "material": self.solved.part.material,
            "rigid_motions": found.modes.rigid_body_count,
            "nodes": list(found.nodes),
            **({} if self.structure is None else {"structure": tomllib.loads(self.structure)}),
            "modes": [
                {
                    "name": self.names[row],
                    "text": self._frequency(row),
                    "uncertainty": {
                        "value": float(found.natural_frequency[row] * found.frequency_error[row]),
                        "unit": "Hz",
                    },
                    **si(
                        {
                            "natural_frequency": float(found.natural_frequency[row]),
                            "frequency_error": float(found.frequency_error[row]),
                        }
                    ),
                }
                for row in self._rows()
            ],
        }

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
            table = shapes_table(self.found, self.names, self.points, direction=self.direction)
            files[f"{stem}-shapes.csv"] = table
        if self.structure is not None:
            files[f"{stem}-modes.toml"] = self.structure
        if self.with_grid:
            files[f"{stem}-modes.vtu"] = modes_grid(self.found, self.names)
        if self.with_animations:
            with progress("animating") as advance:
                for done, row in enumerate(self._rows()):
                    advance(self.names[row], done, len(self._rows()))
                    animation = mode_animation(self._surface(row), title=self._title(row))
                    files[f"{self._file_name(row)}.gif"] = animation
        return files

    def _rows(self) -> range:
        """Indices of the elastic modes."""
        return elastic_rows(self.found)

    def _surface(self, row: int) -> ShapedSurface:
        """Surface of the part with the shape of a mode."""
        return shaped_surface(self.found.model.mesh, self.found.modes.shapes[row])

    def _figure(self, row: int) -> "Figure":
        """Picture of a mode."""
        return mode_figure(self._surface(row), title=self._title(row))

    def _title(self, row: int) -> str:
        """Name and natural frequency of a mode."""
        return mode_title(self.found, self.names, row)

    def _frequency(self, row: int) -> str:
        """Natural frequency of a mode with its error."""
        found = self.found
        return frequency_text(
            frequency=float(found.natural_frequency[row]), relative_error=float(found.frequency_error[row])
        )

    def _file_name(self, row: int) -> str:
        """Name of the picture of a mode: part, number among the elastic modes, and name of the mode."""
        number = row - self.found.modes.rigid_body_count + 1
        return f"{Path(self.solved.part.name).stem}-{number}-{self.names[row].replace(' ', '-')}"
