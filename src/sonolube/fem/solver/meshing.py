"""From geometry to mesh."""

from collections import defaultdict
from typing import Any

import numpy as np

from sonolube.checks import Floats, Integers, require_positive
from sonolube.errors import InvalidInput
from sonolube.fem.solver.cad import MILLIMETRE, cad_kernel, captured_output
from sonolube.fem.solver.element_order import change_order, untangle_nodes
from sonolube.fem.solver.geometry import Geometry
from sonolube.fem.solver.mesh import Mesh
from sonolube.fem.solver.simplex import lagrange_nodes

# From the mesher's order of nodes to ours: it turns the other way round, and has its edges in another order.
_TETRAHEDRON = [0, 2, 1, 3, 5, 7, 4, 6, 9, 8]
_TRIANGLE = [0, 1, 2, 5, 3, 4]
_ELEMENTS_TO_A_RADIUS = 1.5  # with fewer, elements fold as they are curved
_MOST_LINES = 2  # of what the mesher prints as it fails, which repeats itself


def generate_mesh(geometry: Geometry, *, element_size: float, order: int = 2) -> Mesh:
    """Return a mesh of curved tetrahedra, ten-node ones if not told otherwise.

    Parameters
    ----------
    geometry : Geometry
    element_size : float
        Largest edge of an element; edges are shorter where the geometry is finer. [m]
    order : int
        Degree of the polynomials in an element, from 2 to 8.

    Returns
    -------
    Mesh

    Raises
    ------
    InvalidInput
        If the mesher fails or its mesh does not fill the body: the geometry is open or cuts itself.

    Notes
    -----
    The same geometry and size give the same mesh, in whatever order meshes are made.
    """
    require_positive(element_size=element_size)
    fresh = geometry.shape.Move((0.0, 0.0, 0.0))  # a copy, for the kernel begins from triangles that meshing left
    printed: list[str] = []
    try:
        with captured_output() as printed:
            raw = (
                cad_kernel()
                .OCCGeometry(fresh)
                .GenerateMesh(
                    maxh=element_size / MILLIMETRE,
                    grading=0.5,
                    curvaturesafety=_ELEMENTS_TO_A_RADIUS,
                    parallel_meshing=False,  # its threads wait on each other ten times as long as they mesh
                )
            )
            straight = raw.Copy()
            raw.SecondOrder()
    except Exception as failure:  # the mesher has no narrower class
        said = "; ".join([str(failure), *printed[:_MOST_LINES]])
        raise InvalidInput(f"the body could not be meshed; is it open, or does it cut itself? ({said})") from None
    cells = raw.Elements3D().NumPy()
    if not len(cells):
        raise InvalidInput("the mesher found no volume: the geometry is open or has no thickness")
    tetrahedra = cells["nodes"][:, _TETRAHEDRON].astype(np.int64) - 1
    mesh = Mesh(
        nodes=untangle_nodes(np.asarray(raw.Coordinates(), dtype=np.float64) * MILLIMETRE, tetrahedra, order=2),
        elements=tetrahedra,
        region_of_element=cells["index"].astype(np.int64) - 1,
        regions=geometry.regions,
        faces=_faces(raw, geometry.regions),
        curves=lambda degree: _curved(straight, degree),
    )
    _require_filled(mesh, geometry)
    return change_order(mesh, order=order)


def _curved(straight: Any, order: int) -> Floats:
    """Return where the nodes of each tetrahedron stand once its straight edges follow the body."""
    straight.Curve(order)
    places = lagrange_nodes(order, corners=4)[:, [0, 2, 1]] / order  # the mesher's fourth corner is the origin
    nodes = np.zeros((len(straight.Elements3D()), len(places), 3))
    straight.CalcElementMapping(np.ascontiguousarray(places), nodes)
    return nodes * MILLIMETRE


def _faces(raw: Any, regions: tuple[str, ...]) -> dict[str, Integers]:
    triangles = raw.Elements2D().NumPy()
    nodes = triangles["nodes"][:, _TRIANGLE].astype(np.int64) - 1
    by_name = defaultdict(list)
    for number, face in enumerate(raw.FaceDescriptors(), start=1):
        sides = sorted(side - 1 for side in (face.domin, face.domout) if side > 0)
        name = "|".join(regions[side] for side in sides) if len(sides) == 2 else face.bcname
        by_name[name].append(nodes[triangles["index"] == number])
    return {name: np.concatenate(parts) for name, parts in by_name.items()}


def _require_filled(mesh: Mesh, geometry: Geometry) -> None:
    corner = mesh.nodes[mesh.elements[:, :4]]
    filled = float(np.linalg.det(corner[:, 1:] - corner[:, :1]).sum()) / 6
    if not abs(filled / geometry.volume - 1) < 0.25:  # straight sides cut the corners of curved ones
        raise InvalidInput(
            f"the mesh fills {filled:.4g} m3 of a body of {geometry.volume:.4g} m3: "
            "its faces cut each other, or the elements are far too large for its curves"
        )
