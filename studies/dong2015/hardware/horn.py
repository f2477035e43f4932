"""Poisson horn of D 2.1 on an ultrasonic transducer: a quarter of it, symmetric about the middles of its faces.

D prints the three sizes of the horn and the frequency and amplitude of the welder (Dukane 220) that drives it. The
taper and the solids of the horn are those with which it has the printed frequencies of its first axial mode; the
transducer is a bolted stack between two steel cylinders, of common sizes, as long as gives the whole the frequency of
the welder. Block and pads press on opposite faces, so that bending is left out.
"""

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any, Final

from dong2015.hardware.sizes import sized, sourced_dimensions
from sonolube.errors import UnknownName
from sonolube.models.fem import (
    MILLIMETRE,
    FixedSupport,
    Geometry,
    Medium,
    Output,
    Transducer,
    cad_kernel,
    extruded_polygon,
    isotropic_medium,
    single_body,
    stack_bodies,
    stack_from_bodies,
)

_FAR: Final = 1e3  # mm, beyond any horn
_PAD: Final = 5e-3  # m, half the edge of the patch that the block touches, 1 cm2 in the rigs
_LOSS: Final = 1e-3  # loss tangent of the horns, assumed: a quality factor of 1000

POISSON_HORN_SOLIDS: Final[Mapping[str, Medium]] = MappingProxyType(
    {
        "aluminium": isotropic_medium(youngs_modulus=70e9, poisson_ratio=0.33, density=2700.0, elastic_loss=_LOSS),
        "steel": isotropic_medium(youngs_modulus=205e9, poisson_ratio=0.28, density=7850.0, elastic_loss=_LOSS),
    }
)
"""Solids of both horns: handbook constants, with which they have the printed frequencies."""

POISSON_HORN_DIMENSIONS: Final = sourced_dimensions("poisson_horn")
"""Sizes of horn and transducer with their sources."""


@sized(POISSON_HORN_DIMENSIONS)
def poisson_horn(
    sizes: Mapping[str, Any], *, solid: str, ceramic: str = "pzt4", metal: str = "stainless_steel_304"
) -> Transducer:
    """Poisson horn of D 2.1 on a bolted stack between two cylinders, its axis along z.

    Parameters
    ----------
    solid : str
        Name of the horn's solid in `POISSON_HORN_SOLIDS`.
    length, width, thickness : float
        Extent of the horn along z, x and y. [m]
    taper_length : float
        Length of either end over which the thickness falls symmetrically. [m]
    end_thickness : float
        Thickness of both ends. [m]
    outer_radius, inner_radius : float
        Radii of the rings of ceramic; the outer one is that of both cylinders. [m]
    stack_length : float
        Total length of the rings. [m]
    stack_layers : float
        Number of rings. []
    rod_radius : float
        Radius of the rod through the rings. [m]
    back_length, front_length : float
        Lengths of both cylinders. [m]
    ceramic, metal : str
        Names of the materials of rings and cylinders.

    Returns
    -------
    Transducer
        A quarter of the whole, of positive x and y. Outputs: "tip", the free end of the horn; "back", that of the
        transducer; "contact", a patch of 1 cm2 in the middle of the sliding face, along its normal y.

    Raises
    ------
    InvalidInput
        If a size does not fit.
    UnknownName
        If there is no such solid.

    References
    ----------
    .. [1] D 2.1.2 and 2.1.3.
    """
    if solid not in POISSON_HORN_SOLIDS:
        raise UnknownName.among(POISSON_HORN_SOLIDS, kind="solid of a Poisson horn", name=solid)
    names = ("outer_radius", "inner_radius", "rod_radius", "back_length", "front_length")
    bodies = stack_bodies(**{name: sizes[name] for name in names}, length=sizes["stack_length"])
    length, width, thickness, taper_length, end_thickness = (
        sizes[name] for name in ("length", "width", "thickness", "taper_length", "end_thickness")
    )
    foot = sizes["stack_length"] + sizes["front_length"]
    sections = [
        ("entry", 0.0, taper_length, (end_thickness, thickness)),
        ("lower", taper_length, length / 2 - _PAD, (thickness, thickness)),
        ("middle", length / 2 - _PAD, length / 2 + _PAD, (thickness, thickness)),
        ("upper", length / 2 + _PAD, length - taper_length, (thickness, thickness)),
        ("tip", length - taper_length, length, (thickness, end_thickness)),
    ]
    prisms = {name: _prism(foot + start, foot + end, ends, width) for name, start, end, ends in sections}
    patch = _within(_PAD / MILLIMETRE)
    pieces = {"pad": prisms["middle"] * patch, "beside": prisms.pop("middle") - patch, **prisms}
    shapes = {name: body.shape for name, body in bodies.items()} | pieces
    made = stack_from_bodies(
        {name: _quarter(shape, name) for name, shape in shapes.items()},
        stack_layers=sizes["stack_layers"],
        ceramic=ceramic,
        metal=metal,
    )
    return replace(
        made,
        media={**made.media, **dict.fromkeys(pieces, POISSON_HORN_SOLIDS[solid])},
        outputs={**made.outputs, "contact": Output(face="pad.+y", along="y")},
        fixed=tuple(
            FixedSupport(face=f"{region}.-{plane}", along=plane)
            for region in made.geometry.regions
            for plane in ("y" if region == "beside" else "xy")
        ),
        copies=4,
        dimensions=tuple(
            replace(size, value=sizes["front_length"]) if size.name == "front_length" else size
            for size in POISSON_HORN_DIMENSIONS
        ),
    )


def _within(reach: float) -> Any:
    """Box of the CAD kernel within a distance of the plane x = 0; in mm."""
    return cad_kernel().Box((-reach, -_FAR, -_FAR), (reach, _FAR, _FAR))


def _prism(foot: float, top: float, thickness: tuple[float, float], width: float) -> Any:
    """Section of the horn along z whose thickness along y changes linearly; all in m."""
    occ = cad_kernel()
    low, high = (size / 2 / MILLIMETRE for size in thickness)
    z, end, half = (size / MILLIMETRE for size in (foot, top, width / 2))
    outline = [(-low, z), (low, z), (high, end), (-high, end)]
    # drawn in the plane x-y and extruded along z, then turned: x, y, z become y, z, x
    return (
        extruded_polygon(outline, foot=-half, top=half)
        .Rotate(occ.Axis(occ.Pnt(0, 0, 0), occ.X), 90)
        .Rotate(occ.Axis(occ.Pnt(0, 0, 0), occ.Z), 90)
    )


def _quarter(shape: Any, name: str) -> Geometry:
    """Quarter of a body, of positive x and y."""
    return single_body(shape * cad_kernel().Box((0, 0, -_FAR), (_FAR, _FAR, _FAR)), name)
