"""Modes on the surface of a body: displacement and stress by mode, with nodal planes and the ratio of the ends."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from sonolube.checks import Floats, Integers
from sonolube.models.fem.mesh.mesh import Mesh
from sonolube.models.fem.results.figures import shaped_surface
from sonolube.models.fem.results.nodal_fields import nodal_stress_components, von_mises_stress
from sonolube.models.fem.results.sections import SectionMotion, mode_section_motion
from sonolube.models.fem.solver.model import Model

_LARGEST = "the largest displacement"


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SurfaceMode:
    """Mode on the surface of a body.

    Parameters
    ----------
    name : str
        Family and number, such as "axial 1".
    frequency_text : str
        Natural frequency with its error, in words.
    reference : str
        Displacement that shape and stress are stated over, in words.
    shape : ndarray, shape (n, 3)
        Displacements of the points over the reference.
    stress : ndarray, shape (n,), or None
        Equivalent stress of von Mises over the reference in Pa/m; None for a body with ceramics, whose electric fields
        have stress too.
    stress_per_displacement : float or None
        Greatest equivalent stress of the whole body over the reference; None where there is no stress. [Pa/m]
    motion : SectionMotion or None
        Of the cross-sections; None for a family that does not move these as a whole.
    """

    name: str
    frequency_text: str
    reference: str
    shape: Floats
    stress: Floats | None
    stress_per_displacement: float | None
    motion: SectionMotion | None


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SurfaceModes:
    """Triangulated surface of a body with its modes.

    Parameters
    ----------
    points : ndarray, shape (n, 3)
        Coordinates in m.
    triangles : ndarray of int, shape (t, 3)
        Points of each triangle.
    axis : str
        About which the modes are named.
    modes : tuple of SurfaceMode
    """

    points: Floats
    triangles: Integers
    axis: str
    modes: tuple[SurfaceMode, ...]


def surface_modes(
    model: Model,
    shapes: Floats,
    *,
    frequencies: Sequence[tuple[str, str]],
    axis: str,
    references: Mapping[str, tuple[str, float]] = MappingProxyType({}),
) -> SurfaceModes:
    """Modes on the surface of a model.

    `shapes` has shape (k, n, 3), and `frequencies` are the name of each mode and its frequency in words. `references`
    are displacements to state a mode over, with what they are of, by its name; by default the largest of the surface.
    """
    mesh = model.mesh
    surface = shaped_surface(mesh, shapes)
    largest = np.linalg.norm(surface.displacement, axis=-1).max(axis=-1)
    has_stress = all(medium.stress_constants is None for medium in model.media.values())
    modes = []
    for row, (name, text) in enumerate(frequencies):
        reference, over = references.get(name, (_LARGEST, float(largest[row])))
        stress = nodal_stress_components(model, shapes[row]) / abs(over) if has_stress else None
        modes.append(
            SurfaceMode(
                name=name,
                frequency_text=text,
                reference=reference,
                shape=surface.displacement[row] / over,
                stress=None if stress is None else _surface_stress(mesh, stress),
                stress_per_displacement=None if stress is None else float(von_mises_stress(stress).max()),
                motion=mode_section_motion(mesh, shapes[row], axis=axis, family=name.split()[0]),
            )
        )
    return SurfaceModes(points=surface.points, triangles=surface.triangles, axis=axis, modes=tuple(modes))


def _surface_stress(mesh: Mesh, components: Floats) -> Floats:
    """Equivalent stress at the points of the surface, from the components at the nodes."""
    on_surface = shaped_surface(mesh, np.stack([components[:, :3], components[:, 3:]])).displacement
    return von_mises_stress(np.concatenate([on_surface[0], on_surface[1]], axis=-1))
