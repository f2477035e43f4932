"""Mesh generation: curved tetrahedra of any order from CAD geometry, by netgen."""

from collections import defaultdict
from typing import Any

import numpy as np

from sonolube.checks import Floats, Integers, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.fem.mesh.cad import MILLIMETRE, cad_kernel, captured_output
from sonolube.models.fem.mesh.element_order import change_order, untangle_nodes
from sonolube.models.fem.mesh.geometry import Geometry
from sonolube.models.fem.mesh.mesh import Mesh
from sonolube.models.fem.mesh.simplex import lagrange_nodes

# Node numbering of netgen to that of `Mesh`: opposite orientation, other sequence of the edges.
_TETRAHEDRON = [0, 2, 1, 3, 5, 7, 4, 6, 9, 8]
_TRIANGLE = [0, 1, 2, 5, 3, 4]
_ELEMENTS_PER_RADIUS = 1.5  # of curvature; with fewer, curved elements become tangled
_MAX_LINES = 2  # of the output quoted when meshing fails; later lines repeat


def generate_mesh(geometry: Geometry, *, element_size: float, order: int = 2) -> Mesh:
    """Mesh of isoparametric tetrahedra whose nodes lie on the geometry.

    Parameters
    ----------
    geometry : Geometry
    element_size : float
        Largest edge of an element; edges are shorter where the geometry is finer. [m]
    order : int
        Polynomial degree of the elements, from 2 to 8.

    Returns
    -------
    Mesh

    Raises
    ------
    InvalidInput
        If netgen fails or its mesh does not fill the body: the geometry is open or intersects itself.

    Notes
    -----
    Meshing is deterministic: the same geometry and element size give the same mesh, whatever was meshed before.

    References
    ----------
    .. [1] J. Schöberl, Comput. Vis. Sci. 1, 41 (1997). doi:10.1007/s007910050004
    """
    require_positive(element_size=element_size)
    fresh = geometry.shape.Move((0.0, 0.0, 0.0))  # a copy: the kernel would reuse triangles of an earlier meshing
    printed: list[str] = []
    try:
        with captured_output() as printed:
            raw = (
                cad_kernel()
                .OCCGeometry(fresh)
                .GenerateMesh(
                    maxh=element_size / MILLIMETRE,
                    grading=0.5,
                    curvaturesafety=_ELEMENTS_PER_RADIUS,
                    parallel_meshing=False,  # contention of its threads makes it ten times slower
                )
            )
            straight = raw.Copy()
            raw.SecondOrder()
    except Exception as failure:  # netgen raises no narrower class
        reason = "; ".join([str(failure), *printed[:_MAX_LINES]])
        raise InvalidInput(f"the body could not be meshed; is it open, or does it cut itself? ({reason})") from None
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
        curved_nodes=lambda degree: _curved_nodes(straight, degree),
    )
    _require_filled(mesh, geometry)
    return change_order(mesh, order=order)


def _curved_nodes(straight: Any, order: int) -> Floats:
    """Coordinates in m of the nodes of each tetrahedron of an order, by netgen's projection onto the geometry."""
    straight.Curve(order)
    points = lagrange_nodes(order, corners=4)[:, [0, 2, 1]] / order  # the fourth corner is netgen's origin
    nodes = np.zeros((len(straight.Elements3D()), len(points), 3))
    straight.CalcElementMapping(np.ascontiguousarray(points), nodes)
    return nodes * MILLIMETRE


def _faces(raw: Any, regions: tuple[str, ...]) -> dict[str, Integers]:
    """Triangles of each named face; faces between two regions are named after both."""
    triangles = raw.Elements2D().NumPy()
    nodes = triangles["nodes"][:, _TRIANGLE].astype(np.int64) - 1
    by_name = defaultdict(list)
    for number, face in enumerate(raw.FaceDescriptors(), start=1):
        sides = sorted(side - 1 for side in (face.domin, face.domout) if side > 0)
        name = "|".join(regions[side] for side in sides) if len(sides) == 2 else face.bcname
        by_name[name].append(nodes[triangles["index"] == number])
    return {name: np.concatenate(parts) for name, parts in by_name.items()}


def _require_filled(mesh: Mesh, geometry: Geometry) -> None:
    """Refuse a mesh whose volume differs from that of the geometry by a quarter or more."""
    corner = mesh.nodes[mesh.elements[:, :4]]
    filled = float(np.linalg.det(corner[:, 1:] - corner[:, :1]).sum()) / 6
    if not abs(filled / geometry.volume - 1) < 0.25:  # elements with straight sides miss part of curved bodies
        raise InvalidInput(
            f"the mesh fills {filled:.4g} m3 of a body of {geometry.volume:.4g} m3: "
            "its faces cut each other, or the elements are far too large for its curves"
        )
