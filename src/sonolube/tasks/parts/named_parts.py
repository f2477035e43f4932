"""Parts and transducers by a name or a STEP file and sizes: geometry, media, supports and the first mesh."""

import inspect
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any, Literal

from sonolube.errors import InvalidInput, UnknownName
from sonolube.facts.materials import material, piezo_ceramic_names
from sonolube.models import fem
from sonolube.models.fem import FixedSupport
from sonolube.models.fem.results.part_modes import SupportedPart
from sonolube.studies import study_transducers
from sonolube.tasks.files import InputFile, NamedBytes, file_path
from sonolube.tasks.parameters import File
from sonolube.tasks.task import shown
from sonolube.text.units import format_si, to_si
from sonolube.vocabulary import quantities, quantity

Part = Annotated[InputFile, File("A part such as block, a transducer such as stack, or a STEP file.", "PART")]
Axis = Literal["x", "y", "z"]
PartSizes = Mapping[str, str | float]
"""Sizes of a part by name, as text with units or as numbers in SI."""

PART_WIRING: Mapping[str, str] = MappingProxyType({"ceramic": "pic255", "poled": "z", "drive": "+z", "ground": "-z"})
"""Ceramic, poling and electrodes of a part that is no transducer, where the options are absent."""

_LARGEST = 1e6  # m; the CAD kernel fails on larger parts with messages of its own


def transducers() -> Mapping[str, Callable[..., fem.Transducer]]:
    """General transducers and those of studies, by name.

    Returns
    -------
    mapping of str to callable
        Of a name that both have, that of the study, whose sizes have defaults.
    """
    return {**fem.TRANSDUCERS, **study_transducers()}


def named_part(part: InputFile, sizes: PartSizes) -> fem.Geometry:
    """Geometry of a part by its name and sizes, or of a STEP file.

    Parameters
    ----------
    part : str, Path or NamedBytes
        A name of `PARTS` or of `transducers()`, or a STEP file, whose name ends in .step or .stp.
    sizes : mapping of str to str or float
        Such as {"length": "127 mm"}, or numbers in SI.

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
    name = part_name(part)
    if is_step(part):
        return step_part(part, sizes)
    if name in transducers():
        return named_transducer(part, sizes).geometry
    if name not in fem.PARTS:
        raise UnknownName.among((*fem.PARTS, *transducers()), kind="part", name=name)
    return fem.PARTS[name](**sizes_in_si(name, fem.PARTS[name], sizes))


ELASTIC_PROPERTIES = ("youngs_modulus", "poisson_ratio", "density")
"""Properties of a material that its natural modes depend on."""


def solid_medium(part: str, material_name: str, properties: Mapping[str, float]) -> fem.Medium:
    """Medium of a part of one material.

    Parameters
    ----------
    part : str
        Its name, for a refusal.
    material_name : str
    properties : mapping of str to float
        Of youngs_modulus, poisson_ratio and density those that replace the material's, in SI.

    Returns
    -------
    Medium

    Raises
    ------
    InvalidInput
        If a property is impossible, or the material is a ceramic, which has no modes before it is poled and wired.
    """
    solid = material(material_name)
    if solid.name in piezo_ceramic_names():
        raise InvalidInput(
            f"{shown('material')} {material_name}: a piezoelectric ceramic needs its poling and electrodes; take"
            f" `sonolube impedance compute {part} --ceramic {material_name}`, whose resonances are its modes, or a"
            " metal here"
        )
    if not properties:
        return fem.medium_from_material(solid)
    elastic = {name: properties[name] if name in properties else solid.value(name) for name in ELASTIC_PROPERTIES}
    return fem.isotropic_medium(**elastic)


def named_transducer(part: InputFile, sizes: PartSizes, **wiring: str | None) -> fem.Transducer:
    """Transducer by its name and sizes, or a part or STEP file of one ceramic between two electrodes.

    Parameters
    ----------
    part : str, Path or NamedBytes
        As in `named_part`.
    sizes : mapping
        As in `named_part`.
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
    name = part_name(part)
    given = {option: value for option, value in wiring.items() if value is not None}
    if name not in transducers():
        known = {**PART_WIRING, **given}
        return fem.poled_part(
            named_part(part, sizes),
            ceramic=known["ceramic"],
            along=known["poled"],
            driven=known["drive"],
            grounded=known["ground"],
        )
    function = transducers()[name]
    taken = inspect.signature(function).parameters
    for option, value in given.items():
        if option not in taken:
            raise InvalidInput(f"{shown(option)} {value}: {name} has its own; leave it out, or take another part")
    return function(**sizes_in_si(name, function, sizes), **given)


def sizes_in_si(part: str, function: Callable[..., Any], sizes: PartSizes) -> dict[str, float]:
    """Sizes that the function of a part takes, in SI.

    Parameters
    ----------
    part : str
        Name of the part.
    function : callable
        Whose parameters that are quantities are the sizes.
    sizes : mapping
        As in `named_part`.

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
    for name, size in sizes.items():
        if name not in known:
            raise UnknownName.among(known, kind=f"size of a {part}", name=name)
        values[name] = float(to_si(size, unit=quantities()[name].unit, name=name) if isinstance(size, str) else size)
        if values[name] and not 1 / _LARGEST < abs(values[name]) < _LARGEST:
            raise InvalidInput(f"{name} {size} lies beyond any part")
    missing = [name for name, entry in known.items() if entry.default is entry.empty and name not in values]
    if missing:
        raise InvalidInput(
            f"a {part} needs {', '.join(missing)}; give each by {shown('sizes')}, such as {missing[0]}=20mm"
        )
    return values


def part_name(part: InputFile) -> str:
    """Name of a part, or of its STEP file as it was given."""
    return part.name if isinstance(part, NamedBytes) else str(part)


def is_step(part: InputFile) -> bool:
    """Whether a part is given as a STEP file."""
    return Path(part_name(part)).suffix.lower() in {".step", ".stp"}


def step_part(part: InputFile, sizes: PartSizes) -> fem.Geometry:
    """Geometry of a STEP file, which takes no sizes."""
    if sizes:
        raise InvalidInput(f"{part_name(part)} has its sizes, and takes no other: leave {', '.join(sizes)} out")
    return fem.read_step(file_path(part))


DEFAULT_MATERIAL = "stainless_steel_304"
"""Material of a part that has none of its own."""


def supported_part(
    part: InputFile,
    sizes: PartSizes,
    *,
    material: str,
    properties: Mapping[str, float] = MappingProxyType({}),
    clamp: Sequence[str] = (),
) -> SupportedPart:
    """Part by its name and sizes, with its materials and supports.

    Parameters
    ----------
    part : str, Path or NamedBytes
        A part such as "block", a transducer such as "stack", or a STEP file.
    sizes : mapping of str to str or float
    material : str
        Of a part that is no transducer; those of a transducer are its own.
    properties : mapping of str to float
        Of youngs_modulus, poisson_ratio and density those that replace the material's, in SI.
    clamp : sequence of str
        Faces that are held still.

    Returns
    -------
    SupportedPart

    Raises
    ------
    UnknownName
        If the part, a size of it or the material is unknown.
    InvalidInput
        If a size is missing or the material is one without modes of its own.
    """
    name = part_name(part)
    transducer = named_transducer(part, sizes) if name in transducers() else None
    geometry = named_part(part, sizes) if transducer is None else transducer.geometry
    own = None if transducer is None else transducer.media
    planes = () if transducer is None else transducer.fixed
    return SupportedPart(
        name=name,
        material="its own materials" if transducer is not None else _described(material, properties),
        geometry=geometry,
        media=own or dict.fromkeys(geometry.regions, solid_medium(name, material, properties)),
        fixed=(*planes, *(FixedSupport(face=face) for face in clamp)),
        transducer=transducer,
    )


def _described(material: str, properties: Mapping[str, float]) -> str:
    """Material and what replaces its properties, such as "brass with density 8.4e+03 kg/m3"."""
    replaced = [
        f"{name.replace('_', ' ')} {format_si(value, quantity(name).unit, digits=4)}"
        for name, value in properties.items()
    ]
    return material if not replaced else f"{material} with {', '.join(replaced)}"
