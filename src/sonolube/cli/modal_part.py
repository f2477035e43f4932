"""From what a user types to a part: its name, or a STEP file, and its sizes."""

import inspect
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.checks import Floats
from sonolube.dong2015.transducers import DONG_2015_TRANSDUCERS
from sonolube.errors import InvalidInput, UnknownName
from sonolube.fem import (
    PARTS,
    TRANSDUCERS,
    Geometry,
    Medium,
    Mesh,
    Transducer,
    generate_mesh,
    medium_from_material,
    poled_part,
    read_step,
)
from sonolube.materials import Material, piezo_ceramic_names
from sonolube.materials import material as material_of
from sonolube.units import to_si
from sonolube.vocabulary import quantities

if TYPE_CHECKING:
    from sonolube.design.horn_shapes import TunableBody

ALL_TRANSDUCERS = {**TRANSDUCERS, **DONG_2015_TRANSDUCERS}
"""General transducers and those of the dissertation, by name."""

_BEYOND_ANY_PART = 1e6  # m; the CAD kernel fails on larger ones in words of its own
_ELEMENTS_ACROSS = 1.6  # of a part as thick as a cube of its volume would be
_COARSE = 0.02  # m, coarse enough to show the axes of most parts


def named_part(part: str, sizes: Sequence[str]) -> Geometry:
    """Return the part of this name with its sizes, or that of a STEP file.

    Parameters
    ----------
    part : str
        A name of `PARTS` or `ALL_TRANSDUCERS`, or a path that ends in .step or .stp.
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
    if _is_step(part):
        return _own(part, sizes)
    if part in ALL_TRANSDUCERS:
        return transducer_of(part, sizes).geometry
    if part not in PARTS:
        raise UnknownName.among((*PARTS, *ALL_TRANSDUCERS), kind="part", name=part)
    return PARTS[part](**sizes_of(part, PARTS[part], sizes))


def named_media(part: str, sizes: Sequence[str], material: str) -> dict[str, Medium]:
    """Return what each region of a part is made of: one material, or what a transducer has of its own.

    Parameters
    ----------
    part : str
        As in `named_part`.
    sizes : sequence of str
        As in `named_part`.
    material : str
        Name of the material of a part that is no transducer.

    Returns
    -------
    dict of str to Medium

    Raises
    ------
    InvalidInput
        If the material is a ceramic, which has no modes before it is poled and wired.
    """
    if part in ALL_TRANSDUCERS:
        return dict(transducer_of(part, sizes).media)
    if material_of(material).name in piezo_ceramic_names():
        raise InvalidInput(
            f"--material {material}: a piezoelectric ceramic needs its poling and electrodes; take `sonolube impedance "
            f"compute {part} --ceramic {material}`, whose resonances are its modes, or a metal here"
        )
    return dict.fromkeys(named_part(part, sizes).regions, medium_from_material(material_of(material)))


def transducer_of(part: str, sizes: Sequence[str], **wired: str) -> Transducer:
    """Return the transducer of this name, or a part or STEP file of one ceramic between two electrodes.

    Parameters
    ----------
    part : str
        A name of `ALL_TRANSDUCERS` or `PARTS`, or a path that ends in .step or .stp.
    sizes : sequence of str
        Such as "length=12mm".
    **wired : str
        Of a part that is no transducer: `ceramic`, `along`, `driven` and `grounded`.

    Returns
    -------
    Transducer
    """
    if part not in ALL_TRANSDUCERS:
        return poled_part(named_part(part, sizes), **wired)
    function = ALL_TRANSDUCERS[part]
    return function(**sizes_of(part, function, sizes))


def horn_of(
    shape: str, sizes: Sequence[str], *, frequency: float, material: Material, tune: str, axis: str | None
) -> "TunableBody":
    """Return the horn of this shape, or that of a STEP file.

    Parameters
    ----------
    shape : str
        A name of `SHAPES`, or a path that ends in .step or .stp.
    sizes : sequence of str
        Such as "radius=20mm".
    frequency : float
        Frequency at which it shall ring. [Hz]
    material : Material
    tune : str
        Which size is tuned.
    axis : str or None
        Axis of the part of a STEP file; its longest where absent.

    Returns
    -------
    Body
    """
    from sonolube.design.horn_shapes import body_from_geometry, horn_body

    if _is_step(shape):
        geometry = _own(shape, sizes)
        return body_from_geometry(geometry, axis=axis or longest_axis(generate_mesh(geometry, element_size=_COARSE)))
    given = {}
    for entry in sizes:
        name, _, value = entry.partition("=")
        given[name] = to_si(value, unit="m", name=name)
    speed = (material.value("youngs_modulus") / material.value("density")) ** 0.5
    return horn_body(shape, frequency=frequency, wave_speed=speed, sizes=given, tune=tune)


def sizes_of(part: str, function: Callable[..., Any], sizes: Sequence[str]) -> dict[str, float]:
    """Return the sizes a part's function takes, in SI.

    Parameters
    ----------
    part : str
        Name of the part.
    function : callable
        What makes it.
    sizes : sequence of str
        Such as "length=127mm".

    Returns
    -------
    dict of str to float

    Raises
    ------
    UnknownName
        If the part has no such size.
    InvalidInput
        If a size is missing or of another unit.
    """
    parameters = inspect.signature(function).parameters
    known = {name: entry for name, entry in parameters.items() if name in quantities()}
    given = {}
    for entry in sizes:
        name, _, value = entry.partition("=")
        if name not in known:
            raise UnknownName.among(known, kind=f"size of a {part}", name=name)
        given[name] = to_si(value, unit=quantities()[name].unit, name=name)
        if given[name] and not 1 / _BEYOND_ANY_PART < abs(given[name]) < _BEYOND_ANY_PART:
            raise InvalidInput(f"{name} {value} lies beyond any part")
    missing = [name for name, entry in known.items() if entry.default is entry.empty and name not in given]
    if missing:
        raise InvalidInput(f"a {part} needs {', '.join(missing)}; give each as --set {missing[0]}=20mm")
    return given


def starting_size(geometry: Geometry) -> float:
    """Return the largest edge in m of an element in the first mesh of a part."""
    return float(geometry.volume ** (1 / 3) / _ELEMENTS_ACROSS)


def longest_axis(mesh: Mesh) -> str:
    """Return the axis along which a mesh is longest, "x", "y" or "z"."""
    return "xyz"[int(np.argmax(np.ptp(mesh.nodes, axis=0)))]


def require_axis(**axes: str | None) -> None:
    """Refuse what is given for an axis and is none; each keyword is an option, absent where None."""
    for option, axis in axes.items():
        if axis is not None and axis not in ("x", "y", "z"):
            raise InvalidInput(f"--{option} must be x, y or z, got {axis!r}")


def points_of(path: Path) -> Floats:
    """Return points in m from a table of x, y and z in mm with commas between, shape (p, 3).

    Raises
    ------
    InvalidInput
        If the file is no such table.
    """
    try:
        points = np.loadtxt(path, delimiter=",", comments="#", ndmin=2, dtype=np.float64)
    except (OSError, ValueError) as failure:
        raise InvalidInput(f"{path}: is no table of numbers with commas between: {failure}") from None
    if points.shape[1] != 3 or not np.all(np.isfinite(points)):
        raise InvalidInput(f"{path}: needs the three columns x, y and z in mm, got {points.shape[1]}")
    return np.asarray(1e-3 * points)


def _is_step(part: str) -> bool:
    return Path(part).suffix.lower() in {".step", ".stp"}


def _own(part: str, sizes: Sequence[str]) -> Geometry:
    if sizes:
        raise InvalidInput("a STEP file has its sizes; --set is for parts by name")
    return read_step(Path(part))
