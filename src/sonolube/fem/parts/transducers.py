"""Piezoelectric bodies ready to be driven: stacks of layers, bare or bolted, and single poled parts.

Stacks stand along z, the working end up. A stack of N layers is meshed as few rings that alternate in poling and lie
between electrodes wired in parallel, each ring standing for its share of n layers: field and charge are n-fold, so
that stress constants are n and permittivity n^2 times those of the ceramic. The bolt is a solid rod through the bore,
free of its wall and bonded to the bodies at both ends: a spring beside the stack that has mass. Its thread, its preload
and the softness of the joints are left out.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from types import MappingProxyType

from sonolube.checks import require_non_negative, require_positive
from sonolube.errors import InvalidInput
from sonolube.fem.parts.bodies import cylinder, ring
from sonolube.fem.parts.stack_material import homogenised_stack
from sonolube.fem.solver.geometry import Geometry, bond, translate
from sonolube.fem.solver.harmonic_analysis import Output
from sonolube.fem.solver.medium import Medium, medium_from_material, poled_medium
from sonolube.fem.solver.mesh import Mesh
from sonolube.fem.solver.model import DIRECTIONS, Electrodes, FixedSupport, Model
from sonolube.materials import material, piezo_ceramic

_RINGS = 8  # even, so that both ends of a stack are grounded; 0.5 % in frequency for a quarter wave
_METAL_LOSS = 1 / 300  # assumed of bolted joints and metal together; that of the metals alone is far less


@dataclass(frozen=True, kw_only=True, slots=True)
class SourcedDimension:
    """A size of a part that a paper describes, and where it comes from.

    Parameters
    ----------
    name : str
        Parameter of the part's function.
    value : float
        In SI.
    printed : bool
        Whether it is printed; assumed where not.
    source : str
        Where it is printed, or from what it is assumed.
    """

    name: str
    value: float
    printed: bool
    source: str


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Transducer:
    """Bodies, what they are made of, and where they are wired and watched.

    Parameters
    ----------
    geometry : Geometry
    media : mapping of str to Medium
        Of each region.
    electrodes : Electrodes
    outputs : mapping of str to Output
        "tip", the working end, and "back".
    dimensions : tuple of Dimension
        Where the default sizes come from; empty for parts that no paper describes.
    """

    geometry: Geometry
    media: Mapping[str, Medium]
    electrodes: Electrodes
    outputs: Mapping[str, Output]
    dimensions: tuple[SourcedDimension, ...] = field(default=())

    def model(self, mesh: Mesh, *, fixed: tuple[FixedSupport, ...] = ()) -> Model:
        """Return it on a mesh, held where asked.

        Parameters
        ----------
        mesh : Mesh
        fixed : tuple of Fixed

        Returns
        -------
        Model
        """
        return Model(mesh=mesh, media=self.media, electrodes=self.electrodes, fixed=fixed)


def stack_transducer(
    *,
    outer_radius: float = 5e-3,
    inner_radius: float = 2.5e-3,
    length: float = 12e-3,
    stack_layers: float = 1.0,
    rod_radius: float = 0.0,
    back_length: float = 0.0,
    front_length: float = 0.0,
    ceramic: str = "pic255",
    metal: str = "stainless_steel_304",
) -> Transducer:
    """Return a stack of ring layers, bare or bolted between two end masses.

    Parameters
    ----------
    outer_radius, inner_radius : float
        Radii of the layers; the inner is zero for discs. [m]
    length : float
        Length of all layers together. [m]
    stack_layers : float
        Number of layers. []
    rod_radius : float
        Radius of the rod through the bore, zero for none. [m]
    back_length, front_length : float
        Lengths of the end masses, zero for none; a rod needs both. [m]
    ceramic, metal : str
        Names of the materials.

    Returns
    -------
    Transducer

    Raises
    ------
    InvalidInput
        If a size does not fit.

    Notes
    -----
    The default is the size of the ring stack of D Table 4.7. Layers that are shorter than the sound that runs through
    them are all alike: their number sets stroke and capacitance, not resonances.
    """
    parts = stack_bodies(
        outer_radius=outer_radius,
        inner_radius=inner_radius,
        length=length,
        rod_radius=rod_radius,
        back_length=back_length,
        front_length=front_length,
    )
    return stack_from_bodies(parts, stack_layers=stack_layers, ceramic=ceramic, metal=metal)


def poled_part(geometry: Geometry, *, ceramic: str, along: str, driven: str, grounded: str) -> Transducer:
    """Return a body of one ceramic between two of its faces.

    Parameters
    ----------
    geometry : Geometry
        One body.
    ceramic : str
        Name of the ceramic.
    along : str
        Axis of poling: "x", "y" or "z".
    driven, grounded : str
        Names of the faces that are electrodes.

    Returns
    -------
    Transducer
        Its outputs are the mean motions of both electrodes along the poling: "tip", the driven one, and "back".

    Raises
    ------
    InvalidInput
        If the axis is none or the body is not one.
    """
    if along not in DIRECTIONS or len(along) != 1 or len(geometry.regions) != 1:
        raise InvalidInput(f"one body poled along x, y or z is needed, got {len(geometry.regions)} along {along!r}")
    axis = (float(along == "x"), float(along == "y"), float(along == "z"))
    return Transducer(
        geometry=geometry,
        media={geometry.regions[0]: poled_medium(piezo_ceramic(ceramic), along=axis)},
        electrodes=Electrodes(driven=(driven,), grounded=(grounded,)),
        outputs={"tip": Output(face=driven, along=along), "back": Output(face=grounded, along=along)},
    )


def stack_bodies(
    *,
    outer_radius: float,
    inner_radius: float,
    length: float,
    rod_radius: float,
    back_length: float,
    front_length: float,
    washer_radius: float | None = None,
    tip: Geometry | None = None,
) -> dict[str, Geometry]:
    """Return the bodies of a stack: rings from z = 0 to its length, a rod in them, masses at its ends, a tip on them.

    Parameters
    ----------
    outer_radius, inner_radius : float
        Radii of the layers. [m]
    length : float
        Length of all layers together. [m]
    rod_radius : float
        Radius of the rod, zero for none. [m]
    back_length, front_length : float
        Lengths of the end masses, zero for none. [m]
    washer_radius : float, optional
        Radius of the end masses; that of the stack where absent. [m]
    tip : Geometry, optional
        What stands on the front mass, its foot at z = 0.

    Returns
    -------
    dict of str to Geometry

    Raises
    ------
    InvalidInput
        If a size does not fit.
    """
    require_positive(outer_radius=outer_radius, length=length)
    require_non_negative(
        inner_radius=inner_radius, rod_radius=rod_radius, back_length=back_length, front_length=front_length
    )
    if rod_radius and not (back_length and front_length):
        raise InvalidInput("a rod is bonded to both end masses: give back_length and front_length")
    if rod_radius and rod_radius >= inner_radius:
        raise InvalidInput(f"the rod must pass the bore: rod_radius {rod_radius!r} m, inner_radius {inner_radius!r} m")
    high = length / _RINGS
    hollow = inner_radius > 0
    one = (
        ring(outer_radius=outer_radius, inner_radius=inner_radius, length=high)
        if hollow
        else cylinder(radius=outer_radius, length=high)
    )
    parts = {f"ring{k + 1}": translate(one, by=(0.0, 0.0, k * high)) for k in range(_RINGS)}
    if rod_radius:
        parts["rod"] = cylinder(radius=rod_radius, length=length)
    for name, size, place in (("back", back_length, -back_length), ("front", front_length, length)):
        if size:
            body = cylinder(radius=outer_radius if washer_radius is None else washer_radius, length=size)
            parts[name] = translate(body, by=(0.0, 0.0, place))
    if tip is not None:
        parts["tip"] = translate(tip, by=(0.0, 0.0, length + front_length))
    return parts


def stack_from_bodies(parts: Mapping[str, Geometry], *, stack_layers: float, ceramic: str, metal: str) -> Transducer:
    """Return the bodies of a stack bonded, each second joint of its rings driven and the others grounded.

    Parameters
    ----------
    parts : mapping of str to Geometry
        Those of `stack_bodies`.
    stack_layers : float
        Number of layers. []
    ceramic, metal : str
        Names of the materials.

    Returns
    -------
    Transducer
    """
    geometry = bond(parts)
    rings = [f"ring{k + 1}" for k in range(_RINGS)]
    joints = [
        _joint(geometry, "back", rings[0], "-z"),
        *[_joint(geometry, below, above, "+z") for below, above in pairwise(rings)],
        _joint(geometry, "front", rings[-1], "+z"),
    ]
    solid = medium_from_material(material(metal), elastic_loss=_METAL_LOSS)
    media = dict.fromkeys(geometry.regions, solid)
    for k, name in enumerate(rings):
        one = poled_medium(piezo_ceramic(ceramic), along=(0.0, 0.0, 1.0 if k % 2 == 0 else -1.0))
        media[name] = homogenised_stack(one, stack_layers=stack_layers / _RINGS)
    top = next(name for name in ("tip", "front", rings[-1]) if name in parts)
    bottom = "back" if "back" in parts else rings[0]
    return Transducer(
        geometry=geometry,
        media=media,
        electrodes=Electrodes(driven=tuple(joints[1::2]), grounded=tuple(joints[::2])),
        outputs={"tip": Output(face=f"{top}.+z", along="z"), "back": Output(face=f"{bottom}.-z", along="z")},
    )


def _joint(geometry: Geometry, one: str, other: str, end: str) -> str:
    """Return the name of the face between two bodies, or of the free end of the second where there is no first."""
    if one not in geometry.regions:
        return f"{other}.{end}"
    return "|".join(sorted((one, other), key=geometry.regions.index))


TRANSDUCERS: Mapping[str, Callable[..., Transducer]] = MappingProxyType({"stack": stack_transducer})
"""The parametric transducers by name."""
