"""Bodies as the CAD kernel holds them: bonded together, moved, read from STEP files.

The CAD kernel works in mm, as its tolerances expect; all else is in m. Faces that close a body along an axis are named
"-x", "+x", "-y", "+y", "-z" and "+z", all others "side".
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.fem.solver.cad import MILLIMETRE, cad_kernel, captured_output

_AXES = "xyz"
_LEAST_FILLED = 1e-9  # of the box around a body


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Geometry:
    """Solid bodies that share the faces at which they touch.

    Parameters
    ----------
    shape : netgen.occ.TopoDS_Shape
        The bodies, in mm.
    regions : tuple of str
        Their names, in the order of the shape's solids.
    """

    shape: Any
    regions: tuple[str, ...]

    @property
    def volume(self) -> float:
        """Volume of all bodies, in m3."""
        return float(sum(solid.mass for solid in self.shape.solids)) * MILLIMETRE**3


def read_step(path: Path) -> Geometry:
    """Return the solids of a STEP file, called by their names in it where they have one.

    Raises
    ------
    InvalidInput
        If the file cannot be read, or holds no closed solid.
    """
    if not path.is_file():
        raise InvalidInput(f"{path}: no such file")
    occ = cad_kernel()
    try:
        with captured_output():
            shape = occ.OCCGeometry(str(path)).shape
    except Exception as failure:  # the kernel has no narrower class
        raise InvalidInput(f"{path}: not a STEP file that can be read: {failure}") from None
    solids = list(shape.solids)
    if not solids:
        raise InvalidInput(f"{path}: no closed solid in it; sew its surfaces into one before exporting")
    parts = {
        solid.name or f"body{k}": single_body(solid, solid.name or f"body{k}") for k, solid in enumerate(solids, 1)
    }
    return bond(parts) if len(parts) > 1 else next(iter(parts.values()))


def translate(geometry: Geometry, *, by: tuple[float, float, float]) -> Geometry:
    """Return the geometry translate by a vector in m."""
    shift = tuple(component / MILLIMETRE for component in by)
    return Geometry(shape=geometry.shape.Move(shift), regions=geometry.regions)


def bond(parts: Mapping[str, Geometry]) -> Geometry:
    """Return bodies bonded where they touch; their faces are called "part.+z" and, between two parts, "one|other".

    Parameters
    ----------
    parts : mapping of str to Geometry
        One body each, by the name its region gets.

    Returns
    -------
    Geometry

    Raises
    ------
    InvalidInput
        If bodies overlap, or a part is not one body.
    """
    occ, shapes = cad_kernel(), []
    for name, part in parts.items():
        if len(part.regions) != 1:
            raise InvalidInput(f"{name} must be one body, got {len(part.regions)}")
        solid = part.shape.solids[0]
        for face in solid.faces:
            face.name = f"{name}.{face.name or 'side'}"
        shapes.append(solid.mat(name))
    glued = occ.Glue(shapes)
    names = [solid.name for solid in glued.solids]
    separate = sum(shape.mass for shape in shapes)
    together = sum(solid.mass for solid in glued.solids)
    if sorted(names) != sorted(parts) or abs(together - separate) > 1e-6 * separate:
        raise InvalidInput(f"the bodies {', '.join(parts)} overlap; move them apart until they only touch")
    return Geometry(shape=glued, regions=tuple(names))


def single_body(shape: Any, name: str) -> Geometry:
    """Return a geometry of one closed body, its end faces named.

    Parameters
    ----------
    shape : netgen.occ.TopoDS_Shape
        The body, in mm.
    name : str
        What to call it.

    Returns
    -------
    Geometry

    Raises
    ------
    InvalidInput
        If the shape is open, empty or in several pieces.
    """
    solids = list(shape.solids)
    if len(solids) != 1:
        raise InvalidInput(f"{name} must be one closed body with a volume, got {len(solids)} solids")
    solid = solids[0]
    low, high = (np.array([corner.x, corner.y, corner.z]) for corner in solid.bounding_box)
    if not solid.mass > _LEAST_FILLED * np.prod(high - low):
        raise InvalidInput(f"{name} must be one closed body with a volume: it has no thickness, or its faces cut it")
    for face in solid.faces:
        centre = np.array([face.center.x, face.center.y, face.center.z])
        ends = [(axis, end) for axis in range(3) for end in (low, high) if _at(centre, end, high - low, axis)]
        face.name = ("+" if ends[0][1] is high else "-") + _AXES[ends[0][0]] if ends else "side"
    return Geometry(shape=solid.mat(name), regions=(name,))


def _at(centre: Any, end: Any, extent: Any, axis: int) -> bool:
    # The kernel pads the box around curved bodies by a few thousandths of its size.
    return bool(abs(centre[axis] - end[axis]) < 0.008 * extent[axis])
