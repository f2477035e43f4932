"""Natural modes of a part to a tolerance, and their dataset."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sonolube.models.fem.classification import mode_names
from sonolube.models.fem.mesh.geometry import Geometry
from sonolube.models.fem.mesh.mesh import Mesh
from sonolube.models.fem.mesh.meshing import generate_mesh
from sonolube.models.fem.parts.transducers import Transducer
from sonolube.models.fem.results.figures import shaped_surface
from sonolube.models.fem.results.mode_files import elastic_rows
from sonolube.models.fem.solver.convergence import ConvergedModes, converged_modes
from sonolube.models.fem.solver.medium import Medium
from sonolube.models.fem.solver.model import Electrodes, FixedSupport, Model
from sonolube.models.fem.tuning import Advance
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr

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
