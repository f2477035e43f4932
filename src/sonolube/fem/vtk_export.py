"""Meshes with their fields as VTK unstructured grids, for ParaView and its like."""

import base64
from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.fem.solver.element_order import change_order, transfer_field
from sonolube.fem.solver.mesh import Mesh

_QUADRATIC_TETRA = 24  # VTK's number; its nodes come in the order of ours
_TYPES = {"f": "Float64", "i": "Int64", "u": "UInt8"}


def vtu_text(mesh: Mesh, *, fields: Mapping[str, ArrayLike]) -> str:
    """Return a mesh and its fields as the text of a .vtu file.

    Parameters
    ----------
    mesh : Mesh
    fields : mapping of str to array_like, shape (n,) or (n, 3)
        Values at the nodes, by name; complex ones become two, "name real" and "name imaginary".

    Returns
    -------
    str

    Raises
    ------
    InvalidInput
        If a field has not one value or vector a node.

    Notes
    -----
    Elements of a higher order are written as ten-node ones with the values at their corners and edges' middles. Arrays
    are binary in base 64, little-endian, not compressed. Elements carry the number of their region.

    References
    ----------
    .. [1] VTK File Formats, XML formats, section UnstructuredGrid.
    """
    cells = len(mesh.elements)
    points = "".join(_array(name, values) for name, values in _on_ten_nodes(mesh, _checked(mesh, fields)).items())
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


def _on_ten_nodes(mesh: Mesh, fields: Mapping[str, Floats]) -> dict[str, Floats]:
    target = change_order(mesh, order=2)
    if target is mesh:
        return dict(fields)
    vectors = {name: values if values.ndim == 2 else values[:, np.newaxis] for name, values in fields.items()}
    moved = {name: transfer_field(values, source=mesh, target=target) for name, values in vectors.items()}
    return {name: values.reshape(target.node_count, *fields[name].shape[1:]) for name, values in moved.items()}


def _checked(mesh: Mesh, fields: Mapping[str, ArrayLike]) -> dict[str, Floats]:
    checked: dict[str, Floats] = {}
    for name, given in fields.items():
        values = np.asarray(given)
        if values.shape not in {(mesh.node_count,), (mesh.node_count, 3)}:
            raise InvalidInput(f"the field {name!r} must have one value or vector a node, got shape {values.shape}")
        if np.iscomplexobj(values):
            checked |= {f"{name} real": values.real, f"{name} imaginary": values.imag}
        else:
            checked[name] = values
    return checked


def _array(name: str, values: NDArray[np.generic]) -> str:
    wide = values if values.dtype.kind == "u" else values.astype("<f8" if values.dtype.kind == "f" else "<i8")
    data = wide.tobytes()
    code = base64.b64encode(np.array([len(data)], dtype="<u8").tobytes() + data).decode()
    parts = f' NumberOfComponents="{values.shape[1]}"' if values.ndim == 2 else ""
    title = name.replace("&", "&amp;").replace('"', "&quot;").replace("<", "&lt;")
    return f'<DataArray type="{_TYPES[values.dtype.kind]}" Name="{title}"{parts} format="binary">{code}</DataArray>\n'
