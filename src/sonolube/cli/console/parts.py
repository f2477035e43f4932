"""Parts, horns and transducers from a name or a STEP file and sizes such as length=127mm."""

import inspect
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.checks import Floats
from sonolube.cli.console.number_table import number_table
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
    isotropic_medium,
    medium_from_material,
    poled_part,
    read_step,
)
from sonolube.materials import Material, material, piezo_ceramic_names
from sonolube.units import to_si
from sonolube.vocabulary import quantities

if TYPE_CHECKING:
    from sonolube.design.horn_shapes import TunableBody

ALL_TRANSDUCERS = {**TRANSDUCERS, **DONG_2015_TRANSDUCERS}
"""General transducers and those of the dissertation, by name."""

PART_WIRING: Mapping[str, str] = MappingProxyType({"ceramic": "pic255", "poled": "z", "drive": "+z", "ground": "-z"})
"""Ceramic, poling and electrodes of a part that is no transducer, where the options are absent."""

_LARGEST = 1e6  # m; the CAD kernel fails on larger parts with messages of its own
_ELEMENTS_ACROSS = 1.6  # of a part as thick as a cube of its volume would be
_COARSE = 0.02  # m, fine enough to show the longest axis of most parts


def named_part(part: str, sizes: Sequence[str]) -> Geometry:
    """Geometry of a part by its name and sizes, or of a STEP file.

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
    if is_step(part):
        return _step_part(part, sizes)
    if part in ALL_TRANSDUCERS:
        return named_transducer(part, sizes).geometry
    if part not in PARTS:
        raise UnknownName.among((*PARTS, *ALL_TRANSDUCERS), kind="part", name=part)
    return PARTS[part](**sizes_in_si(part, PARTS[part], sizes))


ELASTIC_PROPERTIES = ("youngs_modulus", "poisson_ratio", "density")
"""Properties of a material that its natural modes depend on."""


def named_media(
    part: str, sizes: Sequence[str], material_name: str, *, properties: Mapping[str, float] = MappingProxyType({})
) -> dict[str, Medium]:
    """Medium of each region of a part: one material, or those of a transducer.

    Parameters
    ----------
    part : str
        As in `named_part`.
    sizes : sequence of str
        As in `named_part`.
    material_name : str
        Material of a part that is no transducer.
    properties : mapping of str to float
        Of youngs_modulus, poisson_ratio and density those that replace the material's, in SI.

    Returns
    -------
    dict of str to Medium

    Raises
    ------
    InvalidInput
        If properties are given for a transducer, whose materials are its own, one of them is impossible, or the
        material is a ceramic, which has no modes before it is poled and wired.
    """
    if part in ALL_TRANSDUCERS:
        if properties:
            raise InvalidInput(f"{part} has its own materials; leave {', '.join(properties)} out")
        return dict(named_transducer(part, sizes).media)
    solid = material(material_name)
    if solid.name in piezo_ceramic_names():
        raise InvalidInput(
            f"--material {material_name}: a piezoelectric ceramic needs its poling and electrodes; take `sonolube "
            f"impedance compute {part} --ceramic {material_name}`, whose resonances are its modes, or a metal here"
        )
    if not properties:
        return dict.fromkeys(named_part(part, sizes).regions, medium_from_material(solid))
    elastic = {name: properties[name] if name in properties else solid.value(name) for name in ELASTIC_PROPERTIES}
    return dict.fromkeys(named_part(part, sizes).regions, isotropic_medium(**elastic))


def named_transducer(part: str, sizes: Sequence[str], **wiring: str | None) -> Transducer:
    """Transducer by its name and sizes, or a part or STEP file of one ceramic between two electrodes.

    Parameters
    ----------
    part : str
        A name of `ALL_TRANSDUCERS` or `PARTS`, or a path that ends in .step or .stp.
    sizes : sequence of str
        Such as "length=12mm".
    **wiring : str or None
        `ceramic`, `poled`, `drive` and `ground` of a part that is no transducer, those of `PART_WIRING` where None; of
        a transducer, those that it takes.

    Returns
    -------
    Transducer

    Raises
    ------
    InvalidInput
        If a transducer does not take an option.
    MissingProperty
        If the ceramic has no complete set of constants.
    UnknownName
        If there is no such ceramic; the closest one is suggested.
    """
    given = {option: value for option, value in wiring.items() if value is not None}
    if part not in ALL_TRANSDUCERS:
        known = {**PART_WIRING, **given}
        return poled_part(
            named_part(part, sizes),
            ceramic=known["ceramic"],
            along=known["poled"],
            driven=known["drive"],
            grounded=known["ground"],
        )
    function = ALL_TRANSDUCERS[part]
    taken = inspect.signature(function).parameters
    for option, value in given.items():
        if option not in taken:
            raise InvalidInput(f"--{option} {value}: {part} has its own; leave it out, or take another part")
    return function(**sizes_in_si(part, function, sizes), **given)


def ceramic_of(part: str, ceramic: str | None) -> str:
    """Name of the ceramic of a transducer, or of a part between two electrodes.

    Parameters
    ----------
    part : str
        As in `named_transducer`.
    ceramic : str or None
        As given; None for that of the part.

    Returns
    -------
    str
    """
    if ceramic is not None or part not in ALL_TRANSDUCERS:
        return ceramic or PART_WIRING["ceramic"]
    return str(inspect.signature(ALL_TRANSDUCERS[part]).parameters["ceramic"].default)


def named_horn(
    shape: str,
    sizes: Sequence[str],
    *,
    frequency: float,
    solid: Material,
    tune: str,
    axis: str | None,
    gain: float | None = None,
) -> "TunableBody":
    """Horn by its shape and sizes, or of a STEP file.

    Parameters
    ----------
    shape : str
        A name of `SHAPES`, or a path that ends in .step or .stp.
    sizes : sequence of str
        Such as "radius=20mm".
    frequency : float
        Target of the frequency of its mode. [Hz]
    solid : Material
    tune : str
        Size that is tuned.
    axis : str or None
        Axis of the part of a STEP file; its longest where absent.
    gain : float, optional
        Displacement gain by which the radius of the working end is chosen.

    Returns
    -------
    TunableBody
    """
    from sonolube.design.horn_shapes import body_from_geometry, horn_body

    if is_step(shape):
        geometry = _step_part(shape, sizes)
        return body_from_geometry(geometry, axis=axis or longest_axis(generate_mesh(geometry, element_size=_COARSE)))
    lengths = {name: to_si(text, unit="m", name=name) for name, text in _texts_by_name(sizes).items()}
    speed = (solid.value("youngs_modulus") / solid.value("density")) ** 0.5
    return horn_body(shape, frequency=frequency, wave_speed=speed, sizes=lengths, tune=tune, gain=gain)


def sizes_in_si(part: str, function: Callable[..., Any], sizes: Sequence[str]) -> dict[str, float]:
    """Sizes that the function of a part takes, in SI.

    Parameters
    ----------
    part : str
        Name of the part.
    function : callable
        Whose parameters that are quantities are the sizes.
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
    values = {}
    for name, text in _texts_by_name(sizes).items():
        if name not in known:
            raise UnknownName.among(known, kind=f"size of a {part}", name=name)
        values[name] = to_si(text, unit=quantities()[name].unit, name=name)
        if values[name] and not 1 / _LARGEST < abs(values[name]) < _LARGEST:
            raise InvalidInput(f"{name} {text} lies beyond any part")
    missing = [name for name, entry in known.items() if entry.default is entry.empty and name not in values]
    if missing:
        raise InvalidInput(f"a {part} needs {', '.join(missing)}; give each as --set {missing[0]}=20mm")
    return values


def starting_size(geometry: Geometry) -> float:
    """Largest edge in m of an element in the first mesh of a part."""
    return float(geometry.volume ** (1 / 3) / _ELEMENTS_ACROSS)


def longest_axis(mesh: Mesh) -> str:
    """Axis along which a mesh is longest: "x", "y" or "z"."""
    return "xyz"[int(np.argmax(np.ptp(mesh.nodes, axis=0)))]


def require_axis(**axes: str | None) -> None:
    """Raise for an axis that is none of x, y and z; each keyword is an option, not given where None."""
    for option, axis in axes.items():
        if axis is not None and axis not in ("x", "y", "z"):
            raise InvalidInput(f"--{option} must be x, y or z, got {axis!r}")


def points_in_metres(path: Path) -> Floats:
    """Points in m from a CSV table of x, y and z in mm, shape (p, 3).

    Raises
    ------
    InvalidInput
        If the file is no such table.
    """
    points = number_table(path)
    if points.shape[1] != 3 or not np.all(np.isfinite(points)):
        raise InvalidInput(f"{path}: needs the three columns x, y and z in mm, got {points.shape[1]}")
    return np.asarray(1e-3 * points)


def _texts_by_name(sizes: Sequence[str]) -> dict[str, str]:
    """Text of each size of entries NAME=VALUE."""
    texts: dict[str, str] = {}
    for entry in sizes:
        name, _, text = entry.partition("=")
        if name in texts:
            raise InvalidInput(f"--set {name} was given twice")
        texts[name] = text
    return texts


def is_step(part: str) -> bool:
    """Whether a part is given as a STEP file."""
    return Path(part).suffix.lower() in {".step", ".stp"}


def _step_part(part: str, sizes: Sequence[str]) -> Geometry:
    """Geometry of a STEP file, which takes no sizes."""
    if sizes:
        raise InvalidInput("a STEP file has its sizes; --set is for parts by name")
    return read_step(Path(part))
