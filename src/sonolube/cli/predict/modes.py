"""Command `modes`: natural modes of a part by finite elements, with pictures, grids, shapes and animations."""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from sonolube.checks import Floats
from sonolube.cli.console import parts
from sonolube.cli.console.answer import Answer, deliver, si
from sonolube.cli.console.options import OUT, Json, Out, Sizes, TypedNumber, refuse_unused, si_option
from sonolube.cli.console.outputs import OutputFolder
from sonolube.cli.console.progress import progress
from sonolube.errors import InvalidInput, UnknownName
from sonolube.fem import (
    ConvergedModes,
    Electrodes,
    FixedSupport,
    Model,
    Transducer,
    converged_modes,
    generate_mesh,
    mode_names,
)
from sonolube.fem.figures import mode_figure
from sonolube.fem.mode_files import (
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
from sonolube.units import format_si
from sonolube.vocabulary import quantity

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
    ] = "stainless_steel_304",
    stiffness: Annotated[
        float | None, si_option("Pa", "Young's modulus instead of the material's.", "--young-modulus")
    ] = None,
    contraction: Annotated[
        float | None,
        typer.Option("--poisson-ratio", metavar="RATIO", help="Instead of the material's Poisson's ratio."),
    ] = None,
    mass: Annotated[float | None, si_option("kg/m3", "Density instead of the material's.", "--density")] = None,
    count: Annotated[int, typer.Option(metavar="NUMBER", help="Number of elastic modes.")] = 6,
    clamp: Annotated[list[str] | None, typer.Option(metavar="FACE", help="A face held still, such as -x.")] = None,
    axis: Annotated[str | None, typer.Option(metavar="x|y|z", help="The part's axis; its longest by default.")] = None,
    tolerance: Annotated[float, typer.Option(metavar="RATIO", help="Largest relative error of a frequency.")] = 0.005,
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
    is_transducer = part in parts.ALL_TRANSDUCERS
    if is_transducer:
        refuse_unused(context, "material", because=f"for {part}, which has its own; it is for other parts")
    if points is None:
        refuse_unused(context, "toward", because="without --points, at which the component is written")
    if contact is None:
        refuse_unused(context, "body", because="without --contact, on which it rests")
    if body is None:
        refuse_unused(context, "body_stiffness", "body_damping", because="without --body-mass, which it holds")
    transducer = parts.named_transducer(part, sizes or []) if is_transducer else None
    if contact is not None:
        _require_output(part, transducer, contact)
    held = (
        None
        if body is None
        else SupportedBody(body_mass=body, spring_stiffness=body_stiffness, viscous_damping=body_damping)
    )
    geometry = parts.named_part(part, sizes or [])
    given = dict(zip(parts.ELASTIC_PROPERTIES, (stiffness, contraction, mass), strict=True))
    properties = {name: value for name, value in given.items() if value is not None}
    media = parts.named_media(part, sizes or [], material, properties=properties)
    electrodes = Electrodes() if transducer is None else transducer.electrodes
    planes = () if transducer is None else transducer.fixed
    fixed = (*planes, *(FixedSupport(face=face) for face in clamp or ()))
    scanned = None if points is None else parts.points_in_metres(points)

    def model_at(element_size: float) -> Model:
        mesh = generate_mesh(geometry, element_size=element_size)
        return Model(mesh=mesh, media=media, fixed=fixed, electrodes=electrodes)

    with progress("meshing and solving") as advance:
        found = converged_modes(
            model_at,
            count=count,
            element_size=parts.starting_size(geometry),
            relative_tolerance=tolerance,
            advance=advance,
        )
        structure = None
        if transducer is not None and contact is not None:
            advance("reduction", len(found.nodes), len(found.nodes) + 1)
            structure = structure_modes(found, transducer, contact=contact, body=held, command=_command(context, part))
    along = axis or parts.longest_axis(found.model.mesh)
    answer = ModesAnswer(
        part=part,
        material="its own materials" if is_transducer else _described(material, properties),
        found=found,
        names=mode_names(found.model, found.modes, axis=along),
        points=scanned,
        direction=toward or along,
        with_grid=vtu,
        with_animations=animate,
        structure=structure,
    )
    deliver(answer, folder=out, as_json=json)


def _require_output(part: str, transducer: Transducer | None, contact: str) -> None:
    """Refuse a contact of a part without a drive, or at an output that it lacks."""
    if transducer is None:
        known = ", ".join(parts.ALL_TRANSDUCERS)
        raise InvalidInput(f"--contact {contact}: {part} has no drive; it is for transducers: {known}")
    if contact not in transducer.outputs:
        raise UnknownName.among(transducer.outputs, kind=f"output of {part}", name=contact)


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


def _described(material: str, properties: Mapping[str, float]) -> str:
    """Material and what replaces its properties, such as "brass with density 8.4e+03 kg/m3"."""
    replaced = [
        f"{name.replace('_', ' ')} {format_si(value, quantity(name).unit, digits=4)}"
        for name, value in properties.items()
    ]
    return material if not replaced else f"{material} with {', '.join(replaced)}"


@dataclass(frozen=True, kw_only=True)
class ModesAnswer(Answer):
    """Natural frequencies of a part with their errors, and its elastic modes as pictures and files."""

    part: str
    material: str
    found: ConvergedModes
    names: Sequence[str]
    points: Floats | None
    direction: str
    with_grid: bool
    with_animations: bool
    structure: str | None

    def lines(self) -> list[str]:
        """Name and natural frequency with its error of every elastic mode."""
        found, rigid = self.found, self.found.modes.rigid_body_count
        width = max(len(self.names[row]) for row in self._rows())
        support = f"{rigid} rigid motions, " if rigid else "held, "
        nodes = f"{found.nodes[-1]} nodes in the last of {len(found.nodes)} meshes"
        return [
            f"{self.part} of {self.material}: {support}{nodes}",
            *[f"  {self.names[row]:<{width}}  {frequency_text(found, row)}" for row in self._rows()],
        ]

    def object(self) -> dict[str, Any]:
        """Number of rigid motions, nodes of the meshes, and name, frequency and error of every elastic mode."""
        found = self.found
        return {
            "part": self.part,
            "material": self.material,
            "rigid_motions": found.modes.rigid_body_count,
            "nodes": list(found.nodes),
            **({} if self.structure is None else {"structure": tomllib.loads(self.structure)}),
            "modes": [
                {
                    "name": self.names[row],
                    "text": frequency_text(found, row),
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

    def figures(self) -> Mapping[str, Drawing]:
        """Picture of every elastic mode."""
        mesh, shapes = self.found.model.mesh, self.found.modes.shapes
        return {
            self._file_name(row): Drawing(
                draw=partial(mode_figure, mesh, shapes[row], title=mode_title(self.found, self.names, row)),
                forms=("png",),
            )
            for row in self._rows()
        }

    def files(self) -> Mapping[str, str | bytes]:
        """Shapes at points, structure for a rig file, grid and animations, as far as they are wanted."""
        files: dict[str, str | bytes] = {}
        stem = Path(self.part).stem
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
                    title = mode_title(self.found, self.names, row)
                    animation = mode_animation(self.found, self.found.modes.shapes[row], title=title)
                    files[f"{self._file_name(row)}.gif"] = animation
        return files

    def _rows(self) -> range:
        """Indices of the elastic modes."""
        return elastic_rows(self.found)

    def _file_name(self, row: int) -> str:
        """Name of the picture of a mode: part, number among the elastic modes, and name of the mode."""
        number = row - self.found.modes.rigid_body_count + 1
        return f"{Path(self.part).stem}-{number}-{self.names[row].replace(' ', '-')}"
