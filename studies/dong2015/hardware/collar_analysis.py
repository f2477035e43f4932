"""Finite-element analysis of the collar by symmetry: model of a quarter, modes, motion of the bore, response.

A collar is symmetric about two planes. Each mode is even or odd about either of them, so that a quarter with four sets
of boundary conditions on the planes of symmetry has all modes. A voltage excites those that are even about both.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import lru_cache

import numpy as np

from dong2015.hardware.collar import Collar, collar_geometry
from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.facts.materials import material
from sonolube.models.fem import (
    Electrodes,
    FixedSupport,
    Medium,
    Mesh,
    Model,
    Output,
    ReducedModel,
    generate_mesh,
    homogenised_stack,
    medium_from_material,
    natural_modes,
    poled_medium,
    reduce_model,
    scalar_mass_matrix,
    stack_ceramic,
    tributary_areas,
)


class BoreMotion(StrEnum):
    """Kinds of motion of a bore along z, in a body symmetric about the plane x = 0.

    In modes even about that plane the bore breathes, becomes oval along x and y or is displaced along y. In odd modes
    it rotates about its axis, becomes oval along the diagonals or is displaced along x. Both can have motion out of the
    x-y plane.
    """

    BREATHING = "breathing"
    OVAL = "oval"
    TRANSLATION_ALONG_Y = "translation along y"
    TORSIONAL = "torsional"
    DIAGONAL_OVAL = "diagonal oval"
    TRANSLATION_ALONG_X = "translation along x"
    OUT_OF_PLANE = "out of plane"


def bore_motion(
    mesh: Mesh, shapes: Floats, *, faces: Sequence[str], centre: tuple[float, float], odd_across: bool
) -> tuple[Mapping[BoreMotion, Floats], Floats]:
    r"""Fraction of the mean square displacement of a bore that is motion of each kind, and that mean square.

    Parameters
    ----------
    mesh : Mesh
        The whole body, or its half of positive x.
    shapes : ndarray, shape (k, n, 3)
        Mode shapes: displacements of the nodes.
    faces : sequence of str
        Names of the faces that form the bore.
    centre : tuple of two float
        Coordinates x and y of its axis, in m.
    odd_across : bool
        Whether the modes are odd about x = 0.

    Returns
    -------
    fractions : mapping of BoreMotion to ndarray, shape (k,)
        They sum to one except for three and more waves around the circumference, and motion that varies along the bore.
    mean_square : ndarray, shape (k,)
        In the square of the unit of the shapes.

    Notes
    -----
    With the mean :math:`\langle\cdot\rangle` over the area of the bore, the fraction of a kind with the displacement
    field w in the motion u is

    .. math:: \frac{\langle u \cdot w \rangle^2}{\langle w^2 \rangle \langle u^2 \rangle}

    With the angle a from x, the fields of even modes are :math:`e_r` (breathing),
    :math:`\cos 2a\, e_r - \tfrac12 \sin 2a\, e_t` (oval) and :math:`e_y` (translation); those of odd modes
    :math:`e_t` (torsional), :math:`\sin 2a\, e_r + \tfrac12 \cos 2a\, e_t` (diagonal oval) and :math:`e_x`. The ovals
    are inextensional bending of a ring with two waves around its circumference.

    References
    ----------
    .. [1] W. Soedel, Vibrations of Shells and Plates, 3rd ed., Marcel Dekker (2004).
    """
    areas = np.sum([tributary_areas(mesh, face) for face in faces], axis=0)
    nodes = np.flatnonzero(areas)
    weight = areas[nodes] / areas.sum()
    arm = mesh.nodes[nodes, :2] - centre
    radial = arm / np.linalg.norm(arm, axis=1, keepdims=True)
    tangential = np.column_stack([-radial[:, 1], radial[:, 0]])
    twice = 2 * np.arctan2(arm[:, 1], arm[:, 0])[:, np.newaxis]
    if odd_across:
        fields = {
            BoreMotion.TORSIONAL: tangential,
            BoreMotion.DIAGONAL_OVAL: np.sin(twice) * radial + np.cos(twice) / 2 * tangential,
            BoreMotion.TRANSLATION_ALONG_X: np.broadcast_to([1.0, 0.0], radial.shape),
        }
    else:
        fields = {
            BoreMotion.BREATHING: radial,
            BoreMotion.OVAL: np.cos(twice) * radial - np.sin(twice) / 2 * tangential,
            BoreMotion.TRANSLATION_ALONG_Y: np.broadcast_to([0.0, 1.0], radial.shape),
        }
    displacement = shapes[:, nodes]
    mean_square = np.einsum("n,knd->k", weight, displacement**2)
    fractions = {
        kind: np.einsum("n,knd,nd->k", weight, displacement[..., :2], field) ** 2
        / (np.einsum("n,nd->", weight, field**2) * mean_square)
        for kind, field in fields.items()
    }
    fractions[BoreMotion.OUT_OF_PLANE] = np.einsum("n,kn->k", weight, displacement[..., 2] ** 2) / mean_square
    return fractions, mean_square


_QUARTERS = 4
ELEMENT_SIZE = 40e-3
"""Largest element edge outside the inner ring, in m: elements are as large as the bodies allow."""

ORDER = 3
"""Element order, with which resonances are 0.2 percent too high."""

STACK_STIFFNESS = 140e6
"""Stiffness of the stack in N/m, D Table 4.7."""

STACK_LAYERS = 20
"""Number of layers of the stack: that which has the capacitance of D Table 4.7 with the permittivity there."""

METAL_LOSS = 5e-3
"""Loss tangent of the metal with bolted joints, assumed; that of the metals alone is lower."""

_CHARGE_CONSTANT_15, _SHEAR_MODULUS = 550e-12, 23.5e9  # of PIC255, a similar ceramic of the same maker


@dataclass(frozen=True, kw_only=True, slots=True)
class Parity:
    """Symmetry class of a motion about the two planes of symmetry of a collar.

    Parameters
    ----------
    odd_across : bool
        Odd about the plane of stacks and rod: the inner ring rotates or moves across the stacks.
    odd_along : bool
        Odd about the plane across the rod: the rings move out of their plane.
    """

    odd_across: bool = False
    odd_along: bool = False


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class CollarModes:
    """Elastic modes of one symmetry class and the motion of the bore in them.

    Parameters
    ----------
    natural_frequency : ndarray, shape (k,)
        Short-circuited natural frequencies. [Hz]
    motion_fractions : mapping of BoreMotion to ndarray, shape (k,)
        Fraction of the mean square displacement of the bore that is motion of each kind, by `bore_motion`.
    bore_motion_ratio : ndarray, shape (k,)
        Root mean square displacement of the bore over the mass-weighted one of the whole collar: above one where the
        inner ring moves more than the outer.
    """

    natural_frequency: Floats
    motion_fractions: Mapping[BoreMotion, Floats]
    bore_motion_ratio: Floats

    @property
    def dominant_motion(self) -> tuple[BoreMotion, ...]:
        """Kind of motion of the bore with the largest fraction, for each mode."""
        kinds = list(self.motion_fractions)
        return tuple(kinds[best] for best in np.argmax([self.motion_fractions[kind] for kind in kinds], axis=0))

    def dominant_frequency(self, kind: BoreMotion) -> float:
        """Natural frequency of the mode of a kind with the largest motion of the bore relative to the collar, in Hz.

        Parameters
        ----------
        kind : BoreMotion

        Returns
        -------
        float

        Raises
        ------
        InvalidInput
            If none of the modes is of this kind.
        """
        ratios = zip(self.dominant_motion, self.bore_motion_ratio, strict=True)
        of_kind = [ratio if dominant is kind else 0.0 for dominant, ratio in ratios]
        if not any(of_kind):
            raise InvalidInput(
                f"none of the {len(of_kind)} modes is {kind}; compute more modes, or those of the other parity"
            )
        return float(self.natural_frequency[int(np.argmax(of_kind))])


def collar_media(collar: Collar) -> Mapping[str, Medium]:
    """Media of the regions of a collar by name.

    Parameters
    ----------
    collar : Collar

    Returns
    -------
    mapping of str to Medium
        The stacks are poled towards the inner ring.

    Notes
    -----
    The stack is PIC151, whose constants are printed in D Table 4.7, softened to the stiffness printed there; its
    quality factor and loss tangent are those of the maker's data.
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
    of_frame = dict.fromkeys(("frame", "top", "bolt", "bolt2"), frame)
    return of_frame | {"saddle": ring, "ring": ring, "stack": lower, "stack2": upper}


def collar_model(
    collar: Collar,
    *,
    parity: Parity | None = None,
    clamped: bool = False,
    open_top: bool = False,
    element_size: float = ELEMENT_SIZE,
    order: int = ORDER,
) -> Model:
    """Finite-element model of a quarter of a collar with the boundary conditions of one symmetry class.

    Parameters
    ----------
    collar : Collar
    parity : Parity, optional
        Symmetry class; even about both planes, as under a voltage, where absent.
    clamped : bool
        Fix the lower face of the base.
    open_top : bool
        Without the removable top.
    element_size : float
        Largest element edge. [m]
    order : int
        Element order, from 2 to 8.

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
        # an odd motion has an odd potential, which is zero on the plane and on both electrodes
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
    """Lowest elastic modes of one symmetry class of a collar, and the motion of the bore in each.

    Parameters
    ----------
    collar : Collar
    count : int
        Number of elastic modes.
    parity : Parity, optional
        Symmetry class; even about both planes where absent.
    clamped : bool
        Fix the lower face of the base.
    open_top : bool
        Without the removable top.
    element_size : float
        Largest element edge. [m]
    order : int
        Element order, from 2 to 8.

    Returns
    -------
    CollarModes
    """
    parity = parity or Parity()
    model = collar_model(
        collar, parity=parity, clamped=clamped, open_top=open_top, element_size=element_size, order=order
    )
    found = natural_modes(model, count=count)
    fractions, mean_square = bore_motion(
        model.mesh,
        found.shapes[found.rigid_body_count :],
        faces=("saddle.bore", "ring.bore"),
        centre=(0.0, collar.bore_height),
        odd_across=parity.odd_across,
    )
    return CollarModes(
        natural_frequency=found.elastic_frequency,
        motion_fractions=fractions,
        bore_motion_ratio=np.sqrt(
            mean_square * scalar_mass_matrix(model).sum()
        ),  # at unit modal mass the whole has 1/sqrt(mass)
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
    """Reduced model of a whole collar under voltage, from that of a quarter.

    Parameters
    ----------
    collar : Collar
    clamped : bool
        Fix the lower face of the base.
    open_top : bool
        Without the removable top.
    element_size : float
        Largest element edge. [m]
    order : int
        Element order, from 2 to 8.
    count : int
        Number of elastic modes.

    Returns
    -------
    ReducedModel
        Outputs along y: "crown", the flat of the inner ring that faces the top; "saddle", the sector of the bore on
        which a rod rests; "base", the wall under the stack. With two stacks there is no crown.
    """
    faces = {"crown": "ring.+y", "saddle": "saddle.bore", "base": "frame|stack"}
    if collar.stacks == 2:
        del faces["crown"]
    model = collar_model(collar, clamped=clamped, open_top=open_top, element_size=element_size, order=order)
    quarter = reduce_model(
        model, count=count, outputs={name: Output(face=face, along="y") for name, face in faces.items()}
    )
    # the whole has the charge and the mass of four quarters at the displacement of one
    return replace(
        quarter,
        drive=np.sqrt(_QUARTERS) * quarter.drive,
        clamped_capacitance=_QUARTERS * quarter.clamped_capacitance,
        participation=quarter.participation / np.sqrt(_QUARTERS),
    )


@lru_cache(maxsize=16)
def _mesh(collar: Collar, open_top: bool, element_size: float, order: int) -> Mesh:
    """Mesh of a quarter of a collar."""
    return generate_mesh(collar_geometry(collar, open_top=open_top), element_size=element_size, order=order)
