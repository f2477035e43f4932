"""Natural modes of a part to a tolerance, their dataset, and the contents of their files.

The files are a VTK grid, shapes at points, the structure of a rig file and an animated GIF.
"""

import io
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.errors import InvalidInput, UnknownName
from sonolube.figure import render_figure
from sonolube.models.fem.mesh.element_order import generate_mesh
from sonolube.models.fem.mesh.geometry import Geometry
from sonolube.models.fem.mesh.mesh import DIRECTIONS, Mesh
from sonolube.models.fem.mode_analysis import mode_names
from sonolube.models.fem.parts.transducers import Transducer
from sonolube.models.fem.results.figures import MODE_COLOURS, ShapedSurface, mode_figure, shaped_surface
from sonolube.models.fem.results.nodal_fields import interpolate_at_points, vtu_text
from sonolube.models.fem.solver.model import Electrodes, FixedSupport, Medium, Model
from sonolube.models.fem.solver.modes import ConvergedModes, converged_modes
from sonolube.models.fem.solver.reduction import reduce_model
from sonolube.models.fem.solver.response import contact_structure
from sonolube.models.fem.tuning import Advance
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr

_FRAMES = 16  # of one period
_FRAME_DURATION = 60  # ms
_RESOLUTION = 90  # dots per inch


def elastic_rows(found: ConvergedModes) -> range:
    """Indices of the elastic modes among all modes, rigid motions left out."""
    return range(found.modes.rigid_body_count, len(found.natural_frequency))


def mode_title(found: ConvergedModes, names: Sequence[str], row: int) -> str:
    """Name and natural frequency of a mode with its error, such as "axial 1, 20.01 kHz ± 6 Hz"."""
    error = float(found.frequency_error[row])
    return f"{names[row]}, {frequency_text(frequency=float(found.natural_frequency[row]), relative_error=error)}"


def frequency_text(*, frequency: float, relative_error: float) -> str:
    """Natural frequency with its error and the digits that this leaves a meaning, such as "20.01 kHz ± 6 Hz"."""
    error = frequency * relative_error
    place = math.floor(math.log10(max(2 * error, 1e-9 * frequency, 1e-3)))  # power of ten of the last digit
    unit, power = ("kHz", 3) if frequency >= 1e3 else ("Hz", 0)
    number = f"{round(frequency, -place) / 10**power:.{max(0, power - place)}f} {unit}"
    scaled, error_unit = (error / 1e3, "kHz") if error >= 1e3 else (error, "Hz")
    return f"{number} ± {scaled:.1g} {error_unit}"


def modes_grid(found: ConvergedModes, names: Sequence[str]) -> str:
    """Mesh with the shapes of all elastic modes as a VTK grid (.vtu)."""
    fields = {mode_title(found, names, row): found.modes.shapes[row] for row in elastic_rows(found)}
    return vtu_text(found.model.mesh, fields=fields)


def shapes_table(found: ConvergedModes, names: Sequence[str], points: Floats, *, direction: str) -> str:
    """One component of the elastic mode shapes at given points as CSV, one mode a column, each scaled to 1.

    `points` has shape (p, 3).

    As `sonolube measure vibration --modes` reads it.
    """
    if direction not in DIRECTIONS or len(direction) != 1:
        raise InvalidInput(f"direction must be x, y or z, got {direction!r}")
    rows = list(elastic_rows(found))
    shapes = interpolate_at_points(found.model.mesh, found.modes.shapes[rows], points=points)[
        ..., DIRECTIONS.index(direction)
    ]
    text = io.StringIO()
    header = ", ".join(f"{names[row]} at {found.natural_frequency[row]:.1f} Hz" for row in rows)
    np.savetxt(text, (shapes / np.abs(shapes).max(axis=1, keepdims=True)).T, fmt="%.6g", delimiter=",", header=header)
    return text.getvalue()


@dataclass(frozen=True, kw_only=True, slots=True)
class SupportedBody:
    """Rigid body that rests on a contact, on a spring and damper of its own, such as the hand that holds it.

    Parameters
    ----------
    body_mass : float
        Mass. [kg]
    spring_stiffness : float
        Stiffness of its support; zero for a free body. [N/m]
    viscous_damping : float
        Damping of its support, which needs a spring. [N s/m]

    Raises
    ------
    InvalidInput
        If the mass is not positive, a value negative, or damping given without a spring.
    """

    body_mass: float
    spring_stiffness: float = 0.0
    viscous_damping: float = 0.0

    def __post_init__(self) -> None:
        require_positive(body_mass=self.body_mass)
        require_non_negative(spring_stiffness=self.spring_stiffness, viscous_damping=self.viscous_damping)
        if self.viscous_damping and not self.spring_stiffness:
            raise InvalidInput("viscous_damping of a body without a spring has no damping ratio; give spring_stiffness")

    @property
    def mode(self) -> Mapping[str, float]:
        """Its mode, by the columns of a file of modes."""
        critical = 2 * math.sqrt(self.spring_stiffness * self.body_mass)
        return {
            "natural_frequency": math.sqrt(self.spring_stiffness / self.body_mass) / (2 * math.pi),
            "damping_ratio": self.viscous_damping / critical if critical else 0.0,
            "drive_participation": 0.0,
            "contact_participation": 1 / math.sqrt(self.body_mass),
        }


def structure_modes(
    found: ConvergedModes, transducer: Transducer, *, contact: str, body: SupportedBody | None, command: str
) -> str:
    """Modes of a transducer with static correction, as TOML for the table `structure` of a rig file.

    As `sonolube.rig` reads it.
    """
    if contact not in transducer.outputs:
        raise UnknownName.among(transducer.outputs, kind="output", name=contact)
    output, rows = transducer.outputs[contact], list(elastic_rows(found))
    reduced = transducer.whole(reduce_model(found.model, count=len(rows), outputs={contact: output}))
    # the face's normal points to the other body; faces of negative normal end in "-x", "-y" or "-z"
    structure = contact_structure(
        reduced, contact=contact, outwards=1.0 if output.face.endswith(f"-{output.along}") else -1.0
    )
    omega = np.sqrt(np.diag(structure.stiffness_matrix))
    doubled = np.diag(structure.damping_matrix)
    columns = {
        "natural_frequency": omega / (2 * np.pi),
        "damping_ratio": np.divide(doubled, 2 * omega, out=np.zeros_like(omega), where=omega > 0),
        "drive_participation": structure.drive_vector,
        "contact_participation": structure.contact_vector,
    }
    if body is not None:
        columns = {name: np.append(values, body.mode[name]) for name, values in columns.items()}
    change = np.abs(found.modes.natural_frequency[rows] / found.natural_frequency[rows] - 1)
    error = float((found.frequency_error[rows] + change).max())
    assumptions = [
        f"damping is that of the assumed loss tangents of the materials; {found.nodes[-1]} nodes",
        *(f"{size.name}: {size.source}" for size in transducer.dimensions if not size.printed),
    ]
    heading = (
        f"# Modes for [structure] of a rig file: {len(rows)} elastic ones, those without deformation, and the\n"
        "# static correction for all others. Shapes have a modal mass of 1 kg."
    )
    return modes_file_text(
        columns,
        heading=heading,
        command=command,
        frequency_error=error,
        assumptions=assumptions,
        clamped_capacitance=structure.clamped_capacitance,
    )


def modes_file_text(
    columns: Mapping[str, Floats],
    *,
    heading: str,
    command: str,
    assumptions: Sequence[str],
    clamped_capacitance: float,
    frequency_error: float | None = None,
) -> str:
    """File of modes as TOML, from its columns by name."""
    return "\n".join(
        [
            heading,
            f"command = {json.dumps(command)}",
            *([] if frequency_error is None else [f"frequency_error = {frequency_error:.2g}"]),
            "assumptions = [",
            *(f"  {json.dumps(text, ensure_ascii=False)}," for text in assumptions),
            "]",
            f"clamped_capacitance = {json.dumps(f'{clamped_capacitance:.9g} F')}",
            *(f"{name} = [{', '.join(f'{value:.9g}' for value in values)}]" for name, values in columns.items()),
            "",
        ]
    )


def mode_animation(surface: ShapedSurface, *, title: str) -> bytes:
    """One period of a mode as an animated GIF."""
    from PIL import Image

    palette = Image.new("P", (1, 1))
    palette.putpalette(_palette())
    frames = []
    for phase in 2 * np.pi * np.arange(_FRAMES) / _FRAMES:
        figure = mode_figure(surface, title=title, amplitude=float(np.cos(phase)))
        picture = io.BytesIO(render_figure(figure, "png", resolution=_RESOLUTION))
        frames.append(Image.open(picture).convert("RGB").quantize(palette=palette, dither=Image.Dither.NONE))
    content = io.BytesIO()
    frames[0].save(content, format="GIF", save_all=True, append_images=frames[1:], duration=_FRAME_DURATION, loop=0)
    return content.getvalue()


def _palette() -> list[int]:
    """Colours of all frames: those of the displacement scale, and greys for axes and text."""
    from matplotlib import colormaps

    scale = np.round(255 * colormaps[MODE_COLOURS](np.linspace(0, 1, 192))[:, :3])
    greys = np.repeat(np.round(np.linspace(0, 255, 64))[:, np.newaxis], 3, axis=1)
    return [int(value) for value in np.concatenate([scale, greys]).ravel()]


_ELEMENTS_ACROSS = 1.6  # of a part as thick as a cube of its volume would be


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SupportedPart:
    """Part with its materials and supports.

    Parameters
    ----------
    name : str
        Of the part, or the path of its STEP file.
    material : str
        In words.
    geometry : Geometry
    media : mapping of str to Medium
        By region.
    fixed : tuple of FixedSupport
    transducer : Transducer or None
        None for a part without a drive.
    """

    name: str
    material: str
    geometry: Geometry
    media: Mapping[str, Medium]
    fixed: tuple[FixedSupport, ...]
    transducer: Transducer | None

    @property
    def assumptions(self) -> dict[str, str]:
        """Dimensions of a transducer that no source prints, with the reason for each."""
        known = () if self.transducer is None else self.transducer.dimensions
        return {size.name: size.source for size in known if not size.printed}

    def model_at(self, element_size: float) -> Model:
        """Model on a mesh of a largest element edge in m."""
        mesh = generate_mesh(self.geometry, element_size=element_size)
        electrodes = Electrodes() if self.transducer is None else self.transducer.electrodes
        return Model(mesh=mesh, media=self.media, fixed=self.fixed, electrodes=electrodes)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class PartModes:
    """Natural modes of a part.

    Parameters
    ----------
    part : SupportedPart
    found : ConvergedModes
    names : tuple of str
        Of all modes, rigid motions included.
    axis : str
        About which they are named: "x", "y" or "z".
    """

    part: SupportedPart
    found: ConvergedModes
    names: tuple[str, ...]
    axis: str


def part_modes(part: SupportedPart, *, count: int, axis: str | None, tolerance: float, advance: Advance) -> PartModes:
    """Natural modes of a part to a tolerance."""
    found = converged_modes(
        part.model_at,
        count=count,
        element_size=starting_size(part.geometry),
        relative_tolerance=tolerance,
        advance=advance,
    )
    along = axis or longest_axis(found.model.mesh)
    return PartModes(part=part, found=found, names=mode_names(found.model, found.modes, axis=along), axis=along)


def modes_dataset(solved: PartModes) -> "xr.Dataset":
    """Natural modes of a part with their shapes.

    Over `mode`, by its name such as "axial 1": natural frequency and its relative error, and the shape at the points of
    the surface, of modal mass 1 kg; the points and triangles of that surface.
    """
    import xarray as xr

    found, part = solved.found, solved.part
    rows = list(elastic_rows(found))
    surface = shaped_surface(found.model.mesh, found.modes.shapes[rows])
    about = {"units": "m", "long_name": "Coordinates of a point of the surface"}
    shape = {"units": "kg**-0.5", "long_name": "Displacement of a point of the surface at a modal mass of 1 kg"}
    corners = {"units": "1", "long_name": "Points of a triangle of the surface"}
    return xr.Dataset(
        {
            "natural_frequency": ("mode", found.natural_frequency[rows], _attributes("natural_frequency")),
            "frequency_error": ("mode", found.frequency_error[rows], _attributes("frequency_error")),
            "mode_shape": (("mode", "point", "direction"), surface.displacement, shape),
            "surface_point": (("point", "direction"), surface.points, about),
            "surface_triangle": (("triangle", "corner"), surface.triangles, corners),
        },
        coords={"mode": [solved.names[row] for row in rows], "direction": list("xyz")},
        attrs={
            "title": f"Natural modes of {part.name}",
            "result": "modes",
            "part": part.name,
            "material": part.material,
            "axis": solved.axis,
            "rigid_motions": found.modes.rigid_body_count,
            "nodes": np.array(found.nodes),
        },
    )


def _attributes(name: str) -> dict[str, str]:
    """Unit and meaning of a quantity of the vocabulary."""
    entry = quantity(name)
    return {"units": entry.unit or "1", "long_name": entry.meaning}


def starting_size(geometry: Geometry) -> float:
    """Largest edge in m of an element in the first mesh of a part."""
    return float(geometry.volume ** (1 / 3) / _ELEMENTS_ACROSS)


def longest_axis(mesh: Mesh) -> str:
    """Axis along which a mesh is longest: "x", "y" or "z"."""
    return "xyz"[int(np.argmax(np.ptp(mesh.nodes, axis=0)))]
