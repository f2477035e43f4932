"""Classification of modes into families about an axis by their kinetic energy, and names such as "axial 1"."""

from collections import Counter
from enum import StrEnum

import numpy as np
from numpy.polynomial import legendre
from scipy import sparse

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.models.fem.mesh.mesh import DIRECTIONS, Mesh
from sonolube.models.fem.solver.assembly import scalar_mass_matrix
from sonolube.models.fem.solver.model import Model
from sonolube.models.fem.solver.modes import NaturalModes

_DEGREE = 8  # of the Legendre polynomials along the axis, sufficient for modes of some three wavelengths
_DOMINANT = 0.5  # fraction of the kinetic energy above which a family names the mode


class ModeFamily(StrEnum):
    """Families of modes of a body about an axis."""

    AXIAL = "axial"
    BREATHING = "breathing"
    TORSIONAL = "torsional"
    BENDING = "bending"
    OTHER = "other"
    RIGID = "rigid"


def kinetic_energy_fractions(model: Model, modes: NaturalModes, *, axis: str) -> dict[ModeFamily, Floats]:
    r"""Fractions of each mode's kinetic energy in axial, breathing, torsional and bending motion.

    Parameters
    ----------
    model : Model
    modes : NaturalModes
    axis : str
        Axis of the body: "x", "y" or "z".

    Returns
    -------
    dict of ModeFamily to ndarray, shape (k,)
        Between 0 and 1. They need not sum to one: the remainder is warping and in-plane deformation of cross-sections.

    Raises
    ------
    InvalidInput
        If the axis is none of x, y and z.

    Notes
    -----
    The fraction of a family with the displacement fields F (columns) is the kinetic energy of the mode's projection
    onto them, orthogonal with respect to the mass matrix M; mode shapes :math:`\phi` have unit modal mass:

    .. math:: \eta = \phi^\mathsf{T} M F \left(F^\mathsf{T} M F\right)^{-1} F^\mathsf{T} M \phi

    The fields vary along the axis s, which passes through the centre of mass, as Legendre polynomials P(s). With the
    position r from the axis and the two directions t across it they are: axial :math:`P e_s`; breathing :math:`P r`, a
    uniform swelling of the cross-sections; torsional :math:`P\, e_s \times r`; bending :math:`P e_t` and the tilt
    :math:`P\, t\, e_s` of the cross-sections.
    """
    if axis not in DIRECTIONS or len(axis) != 1:
        raise InvalidInput(f"axis must be x, y or z, got {axis!r}")
    mass = scalar_mass_matrix(model)
    nodal_mass = np.asarray(mass.sum(axis=0))
    shapes = modes.shapes.reshape(len(modes.shapes), -1)
    fractions = {}
    for family, fields in _family_fields(model.mesh, nodal_mass, DIRECTIONS.index(axis)).items():
        mass_fields = _mass_times_fields(mass, fields)
        gram, projection = fields @ mass_fields, shapes @ mass_fields
        energy = np.einsum("kf,kf->k", projection, np.linalg.lstsq(gram, projection.T, rcond=1e-10)[0].T)
        fractions[family] = np.clip(energy, 0.0, 1.0)
    return fractions


def mode_names(model: Model, modes: NaturalModes, *, axis: str) -> tuple[str, ...]:
    """Name of each mode: its family and its number by frequency within it, such as "axial 1".

    Parameters
    ----------
    model : Model
    modes : NaturalModes
    axis : str
        Axis of the body: "x", "y" or "z".

    Returns
    -------
    tuple of str
        Modes without a family of more than half their kinetic energy are named "other", rigid-body modes "rigid".

    Raises
    ------
    InvalidInput
        If the axis is none of x, y and z.
    """
    by_family = kinetic_energy_fractions(model, modes, axis=axis)
    families = list(by_family)
    fractions = np.array([by_family[family] for family in families])
    numbers: Counter[ModeFamily] = Counter()
    names = []
    for mode in range(modes.natural_frequency.size):
        largest = int(np.argmax(fractions[:, mode]))
        family = families[largest] if fractions[largest, mode] > _DOMINANT else ModeFamily.OTHER
        family = ModeFamily.RIGID if mode < modes.rigid_body_count else family
        numbers[family] += 1
        names.append(f"{family} {numbers[family]}")
    return tuple(names)


def _mass_times_fields(mass: sparse.csc_array, fields: Floats) -> Floats:
    """Mass matrix times displacement fields, shape (3n, f)."""
    by_node = fields.reshape(len(fields), -1, 3).transpose(1, 2, 0)
    return np.asarray(mass @ by_node.reshape(len(by_node), -1)).reshape(-1, len(fields))


def _family_fields(mesh: Mesh, nodal_mass: Floats, axis: int) -> dict[ModeFamily, Floats]:
    """Displacement fields of each family, shape (f, 3n)."""
    position = mesh.nodes - np.average(mesh.nodes, axis=0, weights=nodal_mass)
    half_length = np.ptp(position[:, axis]) / 2
    s = (mesh.nodes[:, axis] - mesh.nodes[:, axis].min()) / half_length - 1
    polynomials = legendre.legvander(s, _DEGREE).T  # (f, n)
    unit = np.eye(3)
    across = [direction for direction in range(3) if direction != axis]
    arm = position * (1 - unit[axis]) / half_length

    def along_axis(vector: Floats) -> Floats:
        return (polynomials[:, :, np.newaxis] * vector).reshape(len(polynomials), -1)

    deflections = [along_axis(np.broadcast_to(unit[t], position.shape)) for t in across]
    tilts = [along_axis(arm[:, t, np.newaxis] * unit[axis]) for t in across]
    return {
        ModeFamily.AXIAL: along_axis(np.broadcast_to(unit[axis], position.shape)),
        ModeFamily.BREATHING: along_axis(arm),
        ModeFamily.TORSIONAL: along_axis(np.cross(unit[axis], arm)),
        ModeFamily.BENDING: np.concatenate([*deflections, *tilts]),
    }
