"""Nodal fields: values at points of the body, stresses, and VTK unstructured grids (.vtu)."""

import base64
from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from sonolube.checks import Floats, require_finite
from sonolube.errors import InvalidInput
from sonolube.models.fem.mesh.element_order import change_order, transfer_field
from sonolube.models.fem.mesh.mesh import Mesh, lagrange_nodes, shape_functions, simplex_quadrature
from sonolube.models.fem.solver.model import Model

_NEIGHBOURS = 24  # elements of nearest centroids among which the one that contains a point is searched
_OUTSIDE = 0.35  # negative barycentric coordinate up to which a point counts as on the surface


def interpolate_at_points(mesh: Mesh, field: ArrayLike, *, points: ArrayLike) -> Floats:
    """Nodal field interpolated at points of the body, such as those a vibrometer scans, by the shape functions.

    Parameters
    ----------
    mesh : Mesh
    field : array_like, shape (k, n, 3) or (n, 3)
        Vectors at the nodes, such as mode shapes.
    points : array_like, shape (p, 3)
        Coordinates in m, in the body or on its surface.

    Returns
    -------
    ndarray, shape (k, p, 3) or (p, 3)

    Raises
    ------
    InvalidInput
        If a point lies outside the body, or an array has another shape.

    Notes
    -----
    Element edges are taken as straight in the search of a point's barycentric coordinates. A point just outside, as on
    a curved surface, takes the value extrapolated from the nearest element.
    """
    values, coordinates = require_finite(field=field), np.atleast_2d(require_finite(points=points))
    if coordinates.shape[1] != 3 or values.shape[-2:] != (mesh.node_count, 3):
        raise InvalidInput(f"points must have shape (p, 3) and the field that of the nodes, got {coordinates.shape}")
    corner = mesh.nodes[mesh.elements[:, :4]]
    count = min(_NEIGHBOURS, len(corner))
    near = cKDTree(corner.mean(axis=1)).query(coordinates, k=count)[1].reshape(len(coordinates), count)
    edges = np.moveaxis(corner[near][:, :, 1:] - corner[near][:, :, :1], -1, -2)
    local = np.linalg.solve(edges, (coordinates[:, np.newaxis] - corner[near][:, :, 0])[..., np.newaxis])[..., 0]
    barycentric = np.concatenate([1 - local.sum(axis=-1, keepdims=True), local], axis=-1)
    best = barycentric.min(axis=-1).argmax(axis=1)
    row = np.arange(len(coordinates))
    own, element = barycentric[row, best], mesh.elements[near[row, best]]
    if own.min() < -_OUTSIDE:
        outside = coordinates[int(own.min(axis=1).argmin())]
        raise InvalidInput(f"the point {tuple(round(float(x), 6) for x in outside)} m lies outside the body")
    weights, _ = shape_functions(mesh.order, own)
    return np.asarray(np.einsum("ap,...pai->...pi", weights, values[..., element, :]))


def gauss_point_stress(model: Model, nodal_displacements: ArrayLike) -> Floats:
    r"""Elastic stress at four Gauss points of each element, without the stress of electric fields.

    Parameters
    ----------
    model : Model
    nodal_displacements : array_like, shape (n, 3)
        Displacements of the nodes in m.

    Returns
    -------
    ndarray, shape (m, 4, 6)
        In Pa, at the Gauss point nearest to each corner in turn; components xx, yy, zz, yz, xz, xy.

    Notes
    -----
    .. math::

        T = c^E S, \qquad
        S_{ij} = \frac12\left(\frac{\partial u_i}{\partial x_j} + \frac{\partial u_j}{\partial x_i}\right)

    Strains of quadratic elements are most accurate at these points; at the corners of curved elements they scatter.
    """
    points = np.full((4, 4), (5 - np.sqrt(5)) / 20)
    np.fill_diagonal(points, (5 + 3 * np.sqrt(5)) / 20)
    return _stress_at(model, require_finite(nodal_displacements=nodal_displacements), points)


def _stress_at(model: Model, nodal: Floats, points: Floats) -> Floats:
    """Elastic stress at points of each element, shape (m, q, 6), by their barycentric coordinates, shape (q, 4)."""
    mesh = model.mesh
    _, local_gradient = shape_functions(mesh.order, points)  # (a, d, q)
    jacobian = np.einsum("eax,adq->eqdx", mesh.nodes[mesh.elements], local_gradient, optimize=True)
    derivative = np.einsum("eai,adq->eqdi", nodal[mesh.elements], local_gradient, optimize=True)
    gradient = np.linalg.solve(jacobian, derivative)  # du_i/dx_k as (e, q, k, i)
    strain = gradient + np.swapaxes(gradient, -1, -2)
    pairs = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
    voigt = np.stack([strain[..., k, i] / (2 if k == i else 1) for k, i in pairs], axis=-1)
    stiffness = np.array([model.media[region].elastic_stiffness for region in mesh.regions])
    return np.asarray(np.einsum("eij,eqj->eqi", stiffness[mesh.region_of_element], voigt, optimize=True))


def von_mises_stress(stress: ArrayLike) -> Floats:
    r"""Equivalent stress of von Mises.

    Parameters
    ----------
    stress : array_like, shape (..., 6)
        Components xx, yy, zz, yz, xz, xy.

    Returns
    -------
    ndarray, shape (...)
        In the unit of the stress.

    Notes
    -----
    .. math::

        \sigma_v = \sqrt{\tfrac12\left[(\sigma_{xx} - \sigma_{yy})^2 + (\sigma_{yy} - \sigma_{zz})^2
        + (\sigma_{zz} - \sigma_{xx})^2\right] + 3\left(\sigma_{yz}^2 + \sigma_{xz}^2 + \sigma_{xy}^2\right)}
    """
    s = require_finite(stress=stress)
    normal, shear = s[..., :3], s[..., 3:]
    difference = normal - np.roll(normal, 1, axis=-1)
    return np.asarray(np.sqrt(0.5 * np.sum(difference**2, axis=-1) + 3 * np.sum(shear**2, axis=-1)))


def nodal_stress(model: Model, shape: ArrayLike) -> Floats:
    """Equivalent stress of von Mises at the nodes.

    Parameters
    ----------
    model : Model
    shape : array_like, shape (n, 3)
        Displacements of the nodes in m.

    Returns
    -------
    ndarray, shape (n,)
        In Pa.

    See Also
    --------
    gauss_point_stress
    """
    return von_mises_stress(nodal_stress_components(model, require_finite(shape=shape)))


def nodal_stress_components(model: Model, shape: Floats) -> Floats:
    """Stress components xx, yy, zz, yz, xz, xy at the nodes, shape (n, 6), averaged over the adjacent elements.

    In each element the polynomial of least squares, one degree below that of the displacements, continues the stress
    to its nodes: the derivatives themselves scatter there where the element is curved, and the values inside an element
    miss the peak on the surface.
    """
    mesh = model.mesh
    degree = mesh.order - 1
    points, weights = simplex_quadrature(2 * degree, corners=4)
    inside, _ = shape_functions(degree, points)
    at_nodes, _ = shape_functions(degree, lagrange_nodes(mesh.order, corners=4) / mesh.order)
    continued = at_nodes.T @ np.linalg.solve((inside * weights) @ inside.T, inside * weights)
    total, count = np.zeros((mesh.node_count, 6)), np.zeros(mesh.node_count)
    np.add.at(total, mesh.elements, continued @ _stress_at(model, shape, points))
    np.add.at(count, mesh.elements, 1.0)
    return total / count[:, np.newaxis]


_QUADRATIC_TETRA = 24  # VTK's cell type, with the same node numbering as `Mesh`
_TYPES = {"f": "Float64", "i": "Int64", "u": "UInt8"}


def vtu_text(mesh: Mesh, *, fields: Mapping[str, ArrayLike]) -> str:
    """Text of a .vtu file of a mesh and its nodal fields, in ten-node tetrahedra.

    Parameters
    ----------
    mesh : Mesh
    fields : mapping of str to array_like, shape (n,) or (n, 3)
        Nodal values by name; complex ones become two fields, "name real" and "name imaginary".

    Returns
    -------
    str

    Raises
    ------
    InvalidInput
        If a field does not have one value or vector for each node.

    Notes
    -----
    Elements of higher order are written as ten-node ones with the values at their corners and midpoints of edges.
    Arrays are binary in base 64, little-endian, uncompressed. The cell field "region" is the index of the region.

    References
    ----------
    .. [1] VTK File Formats, XML formats, section UnstructuredGrid.
    """
    cells = len(mesh.elements)
    nodal = _at_order_two(mesh, _real_fields(mesh, fields))
    points = "".join(_array(name, values) for name, values in nodal.items())
    mesh = change_order(mesh, order=2)
    layout: dict[str, NDArray[np.generic]] = {
        "connectivity": mesh.elements.ravel(),
        "offsets": 10 * np.arange(1, cells + 1),
        "types": np.full(cells, _QUADRATIC_TETRA, dtype=np.uint8),
    }
    return (
        '<?xml version="1.0"?>\n'
        '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">\n'
        f'<UnstructuredGrid><Piece NumberOfPoints="{mesh.node_count}" NumberOfCells="{cells}">\n'
        f"<Points>\n{_array('Points', mesh.nodes)}</Points>\n"
        f"<Cells>\n{''.join(_array(name, values) for name, values in layout.items())}</Cells>\n"
        f"<PointData>\n{points}</PointData>\n"
        f"<CellData>\n{_array('region', mesh.region_of_element)}</CellData>\n"
        "</Piece></UnstructuredGrid>\n</VTKFile>\n"
    )


def _at_order_two(mesh: Mesh, fields: Mapping[str, Floats]) -> dict[str, Floats]:
    """Nodal fields interpolated to elements of order two."""
    target = change_order(mesh, order=2)
    if target is mesh:
        return dict(fields)
    vectors = {name: values if values.ndim == 2 else values[:, np.newaxis] for name, values in fields.items()}
    transferred = {name: transfer_field(values, source=mesh, target=target) for name, values in vectors.items()}
    return {name: values.reshape(target.node_count, *fields[name].shape[1:]) for name, values in transferred.items()}


def _real_fields(mesh: Mesh, fields: Mapping[str, ArrayLike]) -> dict[str, Floats]:
    """Fields checked for their shape, complex ones split into real and imaginary part."""
    real: dict[str, Floats] = {}
    for name, given in fields.items():
        values = np.asarray(given)
        if values.shape not in {(mesh.node_count,), (mesh.node_count, 3)}:
            raise InvalidInput(f"the field {name!r} must have one value or vector per node, got shape {values.shape}")
        if np.iscomplexobj(values):
            real |= {f"{name} real": values.real, f"{name} imaginary": values.imag}
        else:
            real[name] = values
    return real


def _array(name: str, values: NDArray[np.generic]) -> str:
    """XML element of an array of two dimensions or one, in VTK's binary encoding."""
    wide = values if values.dtype.kind == "u" else values.astype("<f8" if values.dtype.kind == "f" else "<i8")
    data = wide.tobytes()
    code = base64.b64encode(np.array([len(data)], dtype="<u8").tobytes() + data).decode()
    parts = f' NumberOfComponents="{values.shape[1]}"' if values.ndim == 2 else ""
    title = name.replace("&", "&amp;").replace('"', "&quot;").replace("<", "&lt;")
    return f'<DataArray type="{_TYPES[values.dtype.kind]}" Name="{title}"{parts} format="binary">{code}</DataArray>\n'
