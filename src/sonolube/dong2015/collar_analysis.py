"""The collar as finite elements: a quarter of it, since it is alike on both sides of two planes.

Each mode of such a body is even or odd about either plane, so that quarters with four sets of conditions on the planes
have all modes between them, and a voltage moves those that are even about both.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from sonolube.checks import Floats
from sonolube.dong2015.bore import BoreMotion, bore_motion
from sonolube.dong2015.collar import Collar, collar_geometry
from sonolube.errors import InvalidInput
from sonolube.fem.parts.stack_material import homogenised_stack, stack_ceramic
from sonolube.fem.solver.harmonic_analysis import Output, ReducedModel, reduce_model
from sonolube.fem.solver.medium import Medium, medium_from_material, poled_medium
from sonolube.fem.solver.mesh import Mesh
from sonolube.fem.solver.meshing import generate_mesh
from sonolube.fem.solver.model import Electrodes, FixedSupport, Model
from sonolube.fem.solver.modes import natural_modes
from sonolube.fem.solver.simplex import shape_functions, simplex_quadrature
from sonolube.materials import material

_QUARTERS = 4
ELEMENT_SIZE = 40e-3
"""Largest edge of an element outside the inner ring, in m: edges are as long as the parts allow."""

ORDER = 3
"""Degree of the polynomials in an element, with which resonances are 0.2 percent too high."""

STACK_STIFFNESS = 140e6  # N/m, Table 4.7
STACK_LAYERS = 20  # the number that with the permittivity of Table 4.7 gives its capacitance
METAL_LOSS = 5e-3  # assumed: of bolted joints, above that of the metals alone
_CHARGE_CONSTANT_15, _SHEAR_MODULUS = 550e-12, 23.5e9  # of PIC255, a like ceramic of the same maker


@dataclass(frozen=True, kw_only=True, slots=True)
class Parity:
    """How a motion behaves about the planes in which a collar is alike.

    Parameters
    ----------
    odd_across : bool
        About the plane of stacks and rod: odd where the inner ring turns or sways.
    odd_along : bool
        About the plane across the rod: odd where it leaves the rings' plane.
    """

    odd_across: bool = False
    odd_along: bool = False


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class CollarModes:
    """Modes of one parity.

    Parameters
    ----------
    natural_frequency : ndarray, shape (k,)
        Natural frequencies of the elastic modes, short-circuited. [Hz]
    shares : mapping of BoreMotion to ndarray, shape (k,)
        Share of the bore's mean square motion of each kind; what is left is none of them.
    prominence : ndarray, shape (k,)
        Root mean square motion of the bore over that of the whole collar by mass: above one where the inner ring moves
        more than the outer.
    """

    natural_frequency: Floats
    shares: Mapping[BoreMotion, Floats]
    prominence: Floats

    @property
    def names(self) -> tuple[BoreMotion, ...]:
        """Kind of motion with the largest share in each mode."""
        kinds = list(self.shares)
        return tuple(kinds[best] for best in np.argmax([self.shares[kind] for kind in kinds], axis=0))

    def dominant_frequency(self, kind: BoreMotion) -> float:
        """Return the frequency of the mode of a kind in which the bore moves most beside the rest, in Hz.

        Raises
        ------
        InvalidInput
            If none of the modes is of this kind.
        """
        prominence = [rms if name is kind else 0.0 for name, rms in zip(self.names, self.prominence, strict=True)]
        if not any(prominence):
            raise InvalidInput(f"none of the {len(prominence)} modes is {kind}; ask for more, or for the other parity")
        return float(self.natural_frequency[int(np.argmax(prominence))])


def collar_media(collar: Collar) -> Mapping[str, Medium]:
    """Return what the parts of a collar are made of, by the names of their regions.

    Parameters
    ----------
    collar : Collar

    Returns
    -------
    mapping of str to Medium
        The stacks poled towards the inner ring.

    Notes
    -----
    The stack is PIC151, whose constants Table 4.7 prints, softened to the printed stiffness; its quality factor and
    loss tangent are those of the maker's table.
    """
    section = np.pi / 4 * (collar.stack_outer_diameter**2 - collar.stack_inner_diameter**2)
    ceramic = stack_ceramic(
        material("pic151"),
        youngs_modulus=STACK_STIFFNESS * collar.stack_length / section,
        charge_constant_15=_CHARGE_CONSTANT_15,
        shear_modulus=_SHEAR_MODULUS,
    )
    frame, ring = (
        medium_from_material(material(name), elastic_loss=METAL_LOSS)
        for name in (collar.frame_material, collar.ring_material)
    )
    lower, upper = (
        homogenised_stack(poled_medium(ceramic, along=(0.0, up, 0.0)), stack_layers=STACK_LAYERS) for up in (1.0, -1.0)
    )
    return {
        "frame": frame,
        "top": frame,
        "bolt": frame,
        "bolt2": frame,
        "saddle": ring,
        "ring": ring,
        "stack": lower,
        "stack2": upper,
    }


def collar_model(
    collar: Collar,
    *,
    parity: Parity | None = None,
    clamped: bool = False,
    open_top: bool = False,
    element_size: float = ELEMENT_SIZE,
    order: int = ORDER,
) -> Model:
    """Return a quarter of a collar with the conditions of a parity on the planes that cut it.

    Parameters
    ----------
    collar : Collar
    parity : Parity, optional
        Even about both planes where absent, as under a voltage.
    clamped : bool
        Hold the lower face of the base.
    open_top : bool
        Take off the top.
    element_size : float
        Largest edge of an element. [m]
    order : int
        Degree of the polynomials in an element, from 2 to 8.

    Returns
    -------
    Model
    """
    parity = parity or Parity()
    mesh = _mesh(collar, open_top, element_size, order)
    planes = (("-x", "x", "yz", parity.odd_across), ("-z", "z", "xy", parity.odd_along))
    fixed = [FixedSupport(face="frame.-y")] if clamped else []
    fixed += [
        FixedSupport(face=f"{region}.{plane}", along=odd if is_odd else even)
        for plane, even, odd, is_odd in planes
        for region in mesh.regions
    ]
    stacks = [region for region in mesh.regions if region.startswith("stack")]
    ends = [name for name in mesh.faces for stack in stacks if "|" in name and stack in name.split("|")]
    outer = tuple(name for name in ends if {"frame", "top"} & set(name.split("|")))
    inner = tuple(name for name in ends if {"saddle", "ring"} & set(name.split("|")))
    cut = tuple(f"{stack}.{plane}" for plane, _, _, is_odd in planes if is_odd for stack in stacks)
    return Model(
        mesh=mesh,
        media={region: medium for region, medium in collar_media(collar).items() if region in mesh.regions},
        fixed=tuple(fixed),
        # an odd motion makes an odd potential, which vanishes on the plane and on both electrodes
        electrodes=Electrodes(grounded=(*outer, *inner, *cut)) if cut else Electrodes(driven=outer, grounded=inner),
    )


def collar_modes(
    collar: Collar,
    *,
    count: int,
    parity: Parity | None = None,
    clamped: bool = False,
    open_top: bool = False,
    element_size: float = ELEMENT_SIZE,
    order: int = ORDER,
) -> CollarModes:
    """Return the lowest elastic modes of a parity, and how the bore moves in each.

    Parameters
    ----------
    collar : Collar
    count : int
        Number of elastic modes.
    parity : Parity, optional
        Even about both planes where absent.
    clamped : bool
        Hold the lower face of the base.
    open_top : bool
        Take off the top.
    element_size : float
        Largest edge of an element. [m]
    order : int
        Degree of the polynomials in an element, from 2 to 8.

    Returns
    -------
    CollarModes
    """
    parity = parity or Parity()
    model = collar_model(
        collar, parity=parity, clamped=clamped, open_top=open_top, element_size=element_size, order=order
    )
    found = natural_modes(model, count=count)
    shares, mean_square = bore_motion(
        model.mesh,
        found.shapes[found.rigid_body_count :],
        faces=("saddle.bore", "ring.bore"),
        middle=(0.0, collar.middle),
        odd_across=parity.odd_across,
    )
    return CollarModes(
        natural_frequency=found.elastic_frequency,
        shares=shares,
        prominence=np.sqrt(mean_square * _mass(model)),  # of unit modal mass, the whole moves by 1/sqrt(mass)
    )


def reduced_collar_model(
    collar: Collar,
    *,
    clamped: bool = False,
    open_top: bool = False,
    element_size: float = ELEMENT_SIZE,
    order: int = ORDER,
    count: int = 12,
) -> ReducedModel:
    """Return a collar under voltage in few coordinates, as a whole.

    Parameters
    ----------
    collar : Collar
    clamped : bool
        Hold the lower face of the base.
    open_top : bool
        Take off the top.
    element_size : float
        Largest edge of an element. [m]
    order : int
        Degree of the polynomials in an element, from 2 to 8.
    count : int
        Number of elastic modes.

    Returns
    -------
    ReducedModel
        Outputs along y: "crown", the flat of the inner ring that faces the top; "saddle", the quarter of the bore on
        which a rod rests; "base", the wall under the stack. With two stacks there is no crown.
    """
    faces = {"crown": "ring.+y", "saddle": "saddle.bore", "base": "frame|stack"}
    if collar.stacks == 2:
        del faces["crown"]
    model = collar_model(collar, clamped=clamped, open_top=open_top, element_size=element_size, order=order)
    quarter = reduce_model(
        model, count=count, outputs={name: Output(face=face, along="y") for name, face in faces.items()}
    )
    # the whole takes the charge and has the mass of all quarters at the displacement of one
    return replace(
        quarter,
        drive=np.sqrt(_QUARTERS) * quarter.drive,
        clamped_capacitance=_QUARTERS * quarter.clamped_capacitance,
        participation=quarter.participation / np.sqrt(_QUARTERS),
    )


@lru_cache(maxsize=16)
def _mesh(collar: Collar, open_top: bool, element_size: float, order: int) -> Mesh:
    return generate_mesh(collar_geometry(collar, open_top=open_top), element_size=element_size, order=order)


def _mass(model: Model) -> float:
    mesh = model.mesh
    places, weights = simplex_quadrature(2 * mesh.order, corners=4)
    _, slopes = shape_functions(mesh.order, places)
    volume = np.linalg.det(np.einsum("eax,adq->eqdx", mesh.nodes[mesh.elements], slopes, optimize=True)) @ weights
    density = np.array([model.media[region].density for region in mesh.regions])
    return float(density[mesh.region_of_element] @ volume)
