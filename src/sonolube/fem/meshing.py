"""From geometry to mesh."""

from collections import defaultdict
from typing import Any

import numpy as np

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.fem.assembly import QUADRATURE_DEGREE
from sonolube.fem.geometry import Geometry
from sonolube.fem.kernel import MILLIMETRE, cad, elements
from sonolube.fem.mesh import EDGES, Integers, Mesh

# From the mesher's order of nodes to ours: it turns the other way round, and has its edges in another order.
_TETRAHEDRON = [0, 2, 1, 3, 5, 7, 4, 6, 9, 8]
_TRIANGLE = [0, 1, 2, 5, 3, 4]
_FOLDED = 1e-3  # smallest over mean volume per unit of an element that is taken as it is
_UNTANGLING = 3  # straightening an element can fold a neighbour


def mesh_of(geometry: Geometry, *, element_size: float) -> Mesh:
    """Return a mesh of curved ten-node tetrahedra.

    Parameters
    ----------
    geometry : Geometry
    element_size : float
        Largest edge of an element; edges are shorter where the geometry is finer. [m]

    Returns
    -------
    Mesh

    Raises
    ------
    InvalidInput
        If the mesher fails or its mesh does not fill the body: the geometry is open or cuts itself.
    """
    require_positive(element_size=element_size)
    try:
        raw = (
            cad()
            .OCCGeometry(geometry.shape)
            .GenerateMesh(maxh=element_size / MILLIMETRE, grading=0.5, curvaturesafety=1.0)
        )
        raw.SecondOrder()
    except Exception as failure:  # the mesher has no narrower class
        raise InvalidInput(f"the body could not be meshed; is it open, or does it cut itself? ({failure})") from None
    cells = raw.Elements3D().NumPy()
    if not len(cells):
        raise InvalidInput("the mesher found no volume: the geometry is open or has no thickness")
    tetrahedra = cells["nodes"][:, _TETRAHEDRON].astype(np.int64) - 1
    mesh = Mesh(
        nodes=_untangled(np.asarray(raw.Coordinates(), dtype=np.float64) * MILLIMETRE, tetrahedra),
        elements=tetrahedra,
        region_of_element=cells["index"].astype(np.int64) - 1,
        regions=geometry.regions,
        faces=_faces(raw, geometry.regions),
    )
    _require_filled(mesh, geometry)
    return mesh


def _faces(raw: Any, regions: tuple[str, ...]) -> dict[str, Integers]:
    triangles = raw.Elements2D().NumPy()
    nodes = triangles["nodes"][:, _TRIANGLE].astype(np.int64) - 1
    by_name = defaultdict(list)
    for number, face in enumerate(raw.FaceDescriptors(), start=1):
        sides = sorted(side - 1 for side in (face.domin, face.domout) if side > 0)
        name = "|".join(regions[side] for side in sides) if len(sides) == 2 else face.bcname
        by_name[name].append(nodes[triangles["index"] == number])
    return {name: np.concatenate(parts) for name, parts in by_name.items()}


def _untangled(nodes: Floats, tetrahedra: Integers) -> Floats:
    """Return the nodes with the edges of elements straight where curving them has folded the element."""
    fem = elements()
    points, _ = fem.quadrature.get_quadrature(fem.ElementTetP2.refdom, QUADRATURE_DEGREE)
    slope = np.array([fem.ElementTetP2().lbasis(points, a)[1] for a in range(10)])
    straightened = nodes.copy()
    for _ in range(_UNTANGLING):
        volume = np.linalg.det(np.einsum("eax,adq->eqdx", straightened[tetrahedra], slope, optimize=True))
        folded = tetrahedra[volume.min(axis=1) < _FOLDED * np.abs(volume).mean(axis=1)]
        for k, (a, b) in enumerate(EDGES):
            straightened[folded[:, 4 + k]] = (straightened[folded[:, a]] + straightened[folded[:, b]]) / 2
    return straightened


def _require_filled(mesh: Mesh, geometry: Geometry) -> None:
    corner = mesh.nodes[mesh.elements[:, :4]]
    filled = float(np.linalg.det(corner[:, 1:] - corner[:, :1]).sum()) / 6
    if not abs(filled / geometry.volume - 1) < 0.25:  # straight sides cut the corners of curved ones
        raise InvalidInput(
            f"the mesh fills {filled:.4g} m3 of a body of {geometry.volume:.4g} m3: "
            "its faces cut each other, or the elements are far too large for its curves"
        )
