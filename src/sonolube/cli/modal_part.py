"""From what a user types to a part: its name, or a STEP file, and its sizes."""

import inspect
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from sonolube.errors import InvalidInput, UnknownName
from sonolube.fem import PARTS, Geometry, Mesh, read_step
from sonolube.units import to_si
from sonolube.vocabulary import quantities

_ELEMENTS_ACROSS = 1.6  # of a part as thick as a cube of its volume would be


def named_part(part: str, sizes: Sequence[str]) -> Geometry:
    """Return the part of this name with its sizes, or that of a STEP file.

    Parameters
    ----------
    part : str
        A name of `PARTS`, or a path that ends in .step or .stp.
    sizes : sequence of str
        Such as "length=127mm".

    Returns
    -------
    Geometry

    Raises
    ------
    UnknownName
        If the part or a size of it is unknown.
    InvalidInput
        If a size is missing or not a length.
    """
    if Path(part).suffix.lower() in {".step", ".stp"}:
        if sizes:
            raise InvalidInput("a STEP file has its sizes; --set is for parts by name")
        return read_step(Path(part))
    if part not in PARTS:
        raise UnknownName.among(PARTS, kind="part", name=part)
    parameters = inspect.signature(PARTS[part]).parameters
    known = {name: entry for name, entry in parameters.items() if name in quantities()}
    given = {}
    for entry in sizes:
        name, _, value = entry.partition("=")
        if name not in known:
            raise UnknownName.among(known, kind=f"size of a {part}", name=name)
        given[name] = to_si(value, unit=quantities()[name].unit, name=name)
    missing = [name for name, entry in known.items() if entry.default is entry.empty and name not in given]
    if missing:
        raise InvalidInput(f"a {part} needs {', '.join(missing)}; give each as --set {missing[0]}=20mm")
    return PARTS[part](**given)


def starting_size(geometry: Geometry) -> float:
    """Return the largest edge in m of an element in the first mesh of a part."""
    return float(geometry.volume ** (1 / 3) / _ELEMENTS_ACROSS)


def longest_axis(mesh: Mesh) -> str:
    """Return the axis along which a mesh is longest, "x", "y" or "z"."""
    return "xyz"[int(np.argmax(np.ptp(mesh.nodes, axis=0)))]
