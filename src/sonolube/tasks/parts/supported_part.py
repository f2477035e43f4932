"""Part by its name and sizes with its materials and supports."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType

from sonolube.models.fem import FixedSupport
from sonolube.models.fem.results.part_modes import SupportedPart
from sonolube.tasks.files import InputFile
from sonolube.tasks.parts.named_parts import (
    ALL_TRANSDUCERS,
    PartSizes,
    named_part,
    named_transducer,
    part_name,
    solid_medium,
)
from sonolube.text.units import format_si
from sonolube.vocabulary import quantity

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
    transducer = named_transducer(part, sizes) if name in ALL_TRANSDUCERS else None
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
