"""VTK grids read back by an XML parser."""

import base64
import xml.etree.ElementTree as ElementTree

import numpy as np
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.models.fem import box_mesh, vtu_text

MESH = box_mesh(length=0.1, width=0.02, thickness=0.02, divisions=(4, 1, 1))


def test_a_grid_reads_back_unchanged() -> None:
    wave = np.random.default_rng(2).standard_normal((MESH.node_count, 3))
    root = ElementTree.fromstring(vtu_text(MESH, fields={"axial & <1>": wave, "phasor": wave[:, 0] + 1j * wave[:, 1]}))
    kinds = {"Float64": "<f8", "Int64": "<i8", "UInt8": "u1"}
    arrays = {}
    for entry in root.iter("DataArray"):
        raw = base64.b64decode((entry.text or "").strip())
        assert np.frombuffer(raw[:8], dtype="<u8")[0] == len(raw) - 8
        values = np.frombuffer(raw[8:], dtype=kinds[entry.attrib["type"]])
        arrays[entry.attrib["Name"]] = values.reshape(-1, int(entry.attrib.get("NumberOfComponents", 1)))
    piece = root.find(".//Piece")
    assert piece is not None
    assert int(piece.attrib["NumberOfPoints"]) == MESH.node_count
    assert arrays["Points"] == approx(MESH.nodes)
    assert np.array_equal(arrays["connectivity"].reshape(-1, 10), MESH.elements)
    assert arrays["offsets"][-1, 0] == MESH.elements.size
    assert set(arrays["types"].ravel()) == {24}
    assert np.array_equal(arrays["axial & <1>"], wave)
    assert np.array_equal(arrays["phasor imaginary"].ravel(), wave[:, 1])
    with raises(InvalidInput, match="one value or vector per node"):
        vtu_text(MESH, fields={"wrong": np.zeros(3)})
