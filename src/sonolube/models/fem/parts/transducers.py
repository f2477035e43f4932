"""Piezoelectric transducers: bare or bolted multilayer stacks, and single poled parts.

Stacks stand along z with the working end up. A stack of N layers is meshed as a few rings of alternating poling between
electrodes connected in parallel. Each ring stands for its share of the layers and has the homogenised medium of
`homogenised_stack`. The bolt is a solid rod through the bore, free of its wall and bonded to the bodies at both ends: a
spring with mass in parallel with the stack. Its thread, its preload and the compliance of the joints are neglected.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from itertools import pairwise
from types import MappingProxyType

import numpy as np

from sonolube.checks import require_non_negative, require_positive
from sonolube.errors import InvalidInput
from sonolube.facts.materials import material, piezo_ceramic
from sonolube.models.fem.mesh.geometry import Geometry, bond, translate
from sonolube.models.fem.mesh.mesh import DIRECTIONS, Mesh
from sonolube.models.fem.parts.bodies import cylinder, ring
from sonolube.models.fem.parts.stack_material import homogenised_stack
from sonolube.models.fem.solver.model import Electrodes, FixedSupport, Medium, Model, medium_from_material, poled_medium
from sonolube.models.fem.solver.reduction import Output, ReducedModel

_RINGS = 8  # even, so that both ends of a stack are grounded; 0.5 % in frequency for a quarter wave
_METAL_LOSS = 1 / 300  # loss tangent assumed for metal with bolted joints; that of metals alone is far lower


@dataclass(frozen=True, kw_only=True, slots=True)
class SourcedDimension:
    """Dimension of a transducer described in the literature, with its source.

    Parameters
    ----------
    name : str
        Parameter of the function that builds the transducer.
    value : float
        Value in SI units.
    source : str
        Where it is printed, or from what it is inferred.
    printed : bool
        Whether the value is printed in the source; assumed where not.
    """

    name: str
    value: float
    source: str
    printed: bool = False


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Transducer:
    """Piezoelectric transducer: bodies, their media, electrodes and outputs.

    Parameters
    ----------
    geometry : Geometry
        The bonded bodies.
    media : mapping of str to Medium
        Medium of each region.
    electrodes : Electrodes
        Driven and grounded faces.
    outputs : mapping of str to Output
        Displacements of interest: "tip", the working end, and "back".
    fixed : tuple of FixedSupport
        Planes of symmetry, where the geometry is a part of the whole; only modes even about them are found.
    copies : int
        Number of equal parts that make up the whole.
    dimensions : tuple of SourcedDimension
        Sources of the default dimensions; empty for transducers without a published description.
    """

    geometry: Geometry
    media: Mapping[str, Medium]
    electrodes: Electrodes
    outputs: Mapping[str, Output]
    fixed: tuple[FixedSupport, ...] = ()
    copies: int = 1
    dimensions: tuple[SourcedDimension, ...] = field(default=())

    def model(self, mesh: Mesh, *, fixed: tuple[FixedSupport, ...] = ()) -> Model:
        """Finite-element model of the transducer on a mesh of its geometry.

        Parameters
        ----------
        mesh : Mesh
        fixed : tuple of FixedSupport
            Displacement boundary conditions besides the planes of symmetry.

        Returns
        -------
        Model
        """
        return Model(mesh=mesh, media=self.media, electrodes=self.electrodes, fixed=(*self.fixed, *fixed))

    def whole(self, part: ReducedModel) -> ReducedModel:
        """Reduced model of the whole, from that of the part that the geometry is.

        Parameters
        ----------
        part : ReducedModel

        Returns
        -------
        ReducedModel
            The whole has the charge and the mass of all copies at the displacement of one.
        """
        return replace(
            part,
            drive=np.sqrt(self.copies) * part.drive,
            clamped_capacitance=self.copies * part.clamped_capacitance,
            participation=part.participation / np.sqrt(self.copies),
        )


def stack_transducer(
    *,
    outer_radius: float,
    inner_radius: float = 0.0,
    length: float,
    stack_layers: float = 1.0,
    rod_radius: float = 0.0,
    back_length: float = 0.0,
    front_length: float = 0.0,
    ceramic: str,
    metal: str,
) -> Transducer:
    """Multilayer stack of rings or discs, bare or bolted between two end masses.

    Parameters
    ----------
    outer_radius, inner_radius : float
        Radii of the layers; the inner is zero for discs. [m]
    length : float
        Total length of the layers. [m]
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
    Layers shorter than the acoustic wavelength are equivalent: their number determines stroke and capacitance, not the
    resonances.

    See Also
    --------
    stack_bodies : The bodies alone, with washers and a tip.
    stack_from_bodies : The transducer of given bodies.
    """
    bodies = stack_bodies(
        outer_radius=outer_radius,
        inner_radius=inner_radius,
        length=length,
        rod_radius=rod_radius,
        back_length=back_length,
        front_length=front_length,
    )
    return stack_from_bodies(bodies, stack_layers=stack_layers, ceramic=ceramic, metal=metal)


def poled_part(geometry: Geometry, *, ceramic: str, along: str, driven: str, grounded: str) -> Transducer:
    """Single body of piezoelectric ceramic with electrodes on two of its faces.

    Parameters
    ----------
    geometry : Geometry
        One body.
    ceramic : str
        Name of the ceramic.
    along : str
        Direction of poling: "x", "y" or "z".
    driven, grounded : str
        Names of the faces with electrodes.

    Returns
    -------
    Transducer
        Its outputs are the mean displacements of both electrodes along the poling: "tip", the driven one, and "back".

    Raises
    ------
    InvalidInput
        If the direction is none of x, y and z, or the geometry not one body.
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
    """Bodies of a stack by name: rings from z = 0 to its length, the rod, the end masses and a tip.

    Parameters
    ----------
    outer_radius, inner_radius : float
        Radii of the layers. [m]
    length : float
        Total length of the layers. [m]
    rod_radius : float
        Radius of the rod, zero for none. [m]
    back_length, front_length : float
        Lengths of the end masses, zero for none. [m]
    washer_radius : float, optional
        Radius of the end masses; that of the stack where absent. [m]
    tip : Geometry, optional
        Body on the front mass, with its foot at z = 0.

    Returns
    -------
    dict of str to Geometry
        Names "ring1" to "ring8", "rod", "back", "front" and "tip".

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
    height = length / _RINGS
    layer = (
        ring(outer_radius=outer_radius, inner_radius=inner_radius, length=height)
        if inner_radius > 0
        else cylinder(radius=outer_radius, length=height)
    )
    bodies = {f"ring{k + 1}": translate(layer, by=(0.0, 0.0, k * height)) for k in range(_RINGS)}
    if rod_radius:
        bodies["rod"] = cylinder(radius=rod_radius, length=length)
    for name, size, foot in (("back", back_length, -back_length), ("front", front_length, length)):
        if size:
            mass = cylinder(radius=outer_radius if washer_radius is None else washer_radius, length=size)
            bodies[name] = translate(mass, by=(0.0, 0.0, foot))
    if tip is not None:
        bodies["tip"] = translate(tip, by=(0.0, 0.0, length + front_length))
    return bodies


def stack_from_bodies(bodies: Mapping[str, Geometry], *, stack_layers: float, ceramic: str, metal: str) -> Transducer:
    """Transducer of the bonded bodies of a stack, with alternately grounded and driven joints between its rings.

    Parameters
    ----------
    bodies : mapping of str to Geometry
        Result of `stack_bodies`.
    stack_layers : float
        Number of layers. []
    ceramic, metal : str
        Names of the materials.

    Returns
    -------
    Transducer
    """
    geometry = bond(bodies)
    rings = [f"ring{k + 1}" for k in range(_RINGS)]
    joints = [
        _joint(geometry, "back", rings[0], "-z"),
        *[_joint(geometry, below, above, "+z") for below, above in pairwise(rings)],
        _joint(geometry, "front", rings[-1], "+z"),
    ]
    solid = medium_from_material(material(metal), elastic_loss=_METAL_LOSS)
    media = dict.fromkeys(geometry.regions, solid)
    for k, name in enumerate(rings):
        layer = poled_medium(piezo_ceramic(ceramic), along=(0.0, 0.0, 1.0 if k % 2 == 0 else -1.0))
        media[name] = homogenised_stack(layer, stack_layers=stack_layers / _RINGS)
    top = next(name for name in ("tip", "front", rings[-1]) if name in bodies)
    bottom = "back" if "back" in bodies else rings[0]
    return Transducer(
        geometry=geometry,
        media=media,
        electrodes=Electrodes(driven=tuple(joints[1::2]), grounded=tuple(joints[::2])),
        outputs={"tip": Output(face=f"{top}.+z", along="z"), "back": Output(face=f"{bottom}.-z", along="z")},
    )


def _joint(geometry: Geometry, one: str, other: str, end: str) -> str:
    """Name of the face between two bodies, or of the free end of the second where there is no first."""
    if one not in geometry.regions:
        return f"{other}.{end}"
    return "|".join(sorted((one, other), key=geometry.regions.index))


TRANSDUCERS: Mapping[str, Callable[..., Transducer]] = MappingProxyType({"stack": stack_transducer})
"""Parametric transducers by name; `sonolube.studies` finds those of studies."""
