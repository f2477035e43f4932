"""Natural modes of a part by finite elements: solved as the command does, and as a labelled result."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.models.fem import (
    ConvergedModes,
    Electrodes,
    FixedSupport,
    Geometry,
    Medium,
    Model,
    Transducer,
    converged_modes,
    generate_mesh,
    mode_names,
)
from sonolube.models.fem.figures import shaped_surface
from sonolube.models.fem.mode_files import elastic_rows
from sonolube.units import format_si
from sonolube.vocabulary import quantity
from sonolube.workbench.named_parts import (
    ALL_TRANSDUCERS,
    ELASTIC_PROPERTIES,
    Sizes,
    longest_axis,
    named_media,
    named_part,
    named_transducer,
    starting_size,
)

if TYPE_CHECKING:
    import xarray as xr

DEFAULT_MATERIAL = "stainless_steel_304"
"""Material of a part that has none of its own."""

MODE_COUNT = 6
"""Number of elastic modes where none is asked for."""

MODE_TOLERANCE = 0.005
"""Largest relative error of a frequency where none is asked for."""


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
        """Return the model on a mesh of a largest element edge in m."""
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


def supported_part(
    part: str,
    sizes: Sizes,
    *,
    material: str,
    properties: Mapping[str, float] = MappingProxyType({}),
    clamp: Sequence[str] = (),
    entries: tuple[str, str] = ("in sizes, such as ", "material"),
) -> SupportedPart:
    """Part by its name and sizes, with its materials and supports.

    Parameters
    ----------
    part : str
        A part such as "block", a transducer such as "stack", or the path of a STEP file.
    sizes : mapping of str to str or float
    material : str
        Of a part that is no transducer.
    properties : mapping of str to float
        Of youngs_modulus, poisson_ratio and density those that replace the material's, in SI.
    clamp : sequence of str
        Faces that are held still.
    entries : tuple of str
        How a refusal tells to give a size, and how it calls the material.

    Returns
    -------
    SupportedPart

    Raises
    ------
    UnknownName
        If the part, a size of it or the material is unknown.
    InvalidInput
        If a size is missing or the material is one without modes of its own.
    """
    entry, option = entries
    transducer = named_transducer(part, sizes, entry=entry) if part in ALL_TRANSDUCERS else None
    geometry = named_part(part, sizes, entry=entry) if transducer is None else transducer.geometry
    planes = () if transducer is None else transducer.fixed
    return SupportedPart(
        name=part,
        material="its own materials" if transducer is not None else _described(material, properties),
        geometry=geometry,
        media=named_media(part, sizes, material, properties=properties, option=option),
        fixed=(*planes, *(FixedSupport(face=face) for face in clamp)),
        transducer=transducer,
    )


def part_modes(
    part: SupportedPart,
    *,
    count: int = MODE_COUNT,
    axis: str | None = None,
    tolerance: float = MODE_TOLERANCE,
    advance: Callable[[str, int, int], None] | None = None,
) -> PartModes:
    """Natural modes of a part to a tolerance.

    Parameters
    ----------
    part : SupportedPart
    count : int
        Number of elastic modes.
    axis : str, optional
        About which they are named; the longest where absent.
    tolerance : float
        Largest relative error of a frequency.
    advance : callable, optional
        As of `sonolube.models.fem.converged_modes`.

    Returns
    -------
    PartModes

    Raises
    ------
    InvalidInput
        If the axis is none of x, y and z, or a number is out of its range.
    NotConverged
        If the tolerance is not reached within the largest admissible mesh.
    """
    if axis is not None and axis not in ("x", "y", "z"):
        raise InvalidInput(f"axis must be x, y or z, got {axis!r}")
    found = converged_modes(
        part.model_at,
        count=count,
        element_size=starting_size(part.geometry),
        relative_tolerance=tolerance,
        advance=advance,
    )
    along = axis or longest_axis(found.model.mesh)
    return PartModes(part=part, found=found, names=mode_names(found.model, found.modes, axis=along), axis=along)


def modes(
    part: str,
    *,
    sizes: Sizes = MappingProxyType({}),
    material: str = DEFAULT_MATERIAL,
    youngs_modulus: float | None = None,
    poisson_ratio: float | None = None,
    density: float | None = None,
    count: int = MODE_COUNT,
    clamp: Sequence[str] = (),
    axis: str | None = None,
    tolerance: float = MODE_TOLERANCE,
) -> "xr.Dataset":
    """Natural modes of a part by finite elements: frequencies with their errors, names and shapes.

    Parameters
    ----------
    part : str
        A part such as "block", a transducer such as "stack", or the path of a STEP file.
    sizes : mapping of str to str or float
        Such as {"length": "127 mm"}, or numbers in SI.
    material : str
        Of the catalogue; transducers have their own.
    youngs_modulus : float, optional
        Instead of the material's. [Pa]
    poisson_ratio : float, optional
        Instead of the material's. []
    density : float, optional
        Instead of the material's. [kg/m3]
    count : int
        Number of elastic modes.
    clamp : sequence of str
        Faces that are held still, such as "-x".
    axis : str, optional
        Axis of the part, "x", "y" or "z"; its longest where absent.
    tolerance : float
        Largest relative error of a frequency.

    Returns
    -------
    xarray.Dataset
        Over `mode`, by its name such as "axial 1": natural frequency and its relative error, and the shape at the
        points of the surface, of modal mass 1 kg; the points and triangles of that surface. `plot` draws the first
        mode, or the one whose name is its `title`.

    Raises
    ------
    InvalidInput
        If a size is missing or impossible, or a transducer is given a material.
    MissingPackage
        If the mesher is not installed.
    UnknownName
        If the part, a size of it, a face or the material is unknown.
    """
    if part in ALL_TRANSDUCERS and material != DEFAULT_MATERIAL:
        raise InvalidInput(f"{part} has its own materials; leave material={material!r} out")
    given = dict(zip(ELASTIC_PROPERTIES, (youngs_modulus, poisson_ratio, density), strict=True))
    properties = {name: value for name, value in given.items() if value is not None}
    supported = supported_part(part, sizes, material=material, properties=properties, clamp=clamp)
    return modes_dataset(part_modes(supported, count=count, axis=axis, tolerance=tolerance))


def modes_dataset(solved: PartModes) -> "xr.Dataset":
    """Natural modes of a part as a labelled result.

    Parameters
    ----------
    solved : PartModes

    Returns
    -------
    xarray.Dataset
        As `modes` returns it.
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
            "caveats": "",
            "assumptions": "\n".join(f"{name}: {reason}" for name, reason in part.assumptions.items()),
        },
    )


def _attributes(name: str) -> dict[str, str]:
    """Unit and meaning of a quantity of the vocabulary."""
    entry = quantity(name)
    return {"units": entry.unit or "1", "long_name": entry.meaning}


def _described(material: str, properties: Mapping[str, float]) -> str:
    """Material and what replaces its properties, such as "brass with density 8.4e+03 kg/m3"."""
    replaced = [
        f"{name.replace('_', ' ')} {format_si(value, quantity(name).unit, digits=4)}"
        for name, value in properties.items()
    ]
    return material if not replaced else f"{material} with {', '.join(replaced)}"
