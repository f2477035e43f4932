"""Export of meshes and nodal fields as VTK unstructured grids (.vtu), for ParaView and other viewers."""

import base64
from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.models.fem.mesh.element_order import change_order, transfer_field
from sonolube.models.fem.mesh.mesh import Mesh

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
