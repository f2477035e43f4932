"""What kind of motion a mode is, and its name."""

from collections import Counter
from enum import StrEnum

import numpy as np
from numpy.polynomial import legendre
from scipy import sparse

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.fem.solver.assembly import scalar_mass_matrix
from sonolube.fem.solver.mesh import Mesh
from sonolube.fem.solver.model import DIRECTIONS, Model
from sonolube.fem.solver.modes import NaturalModes

_DEGREE = 8  # of the polynomials along the axis, enough for modes of some three wavelengths
_DOMINANT = 0.5


class ModeFamily(StrEnum):
    """Kinds of motion about an axis."""

    AXIAL = "axial"
    BREATHING = "breathing"
    TORSIONAL = "torsional"
    BENDING = "bending"
    OTHER = "other"
    RIGID = "rigid"


def kinetic_energy_fractions(model: Model, modes: NaturalModes, *, axis: str) -> dict[ModeFamily, Floats]:
    """Return the share of each mode's kinetic energy in axial, breathing, torsional and bending motion.

    Parameters
    ----------
    model : Model
    modes : NaturalModes
    axis : str
        The body's axis: "x", "y" or "z".

    Returns
    -------
    dict of Motion to ndarray, shape (k,)
        Shares from 0 to 1. They need not sum to one: what is left is warping and deformation of sections.

    Notes
    -----
    Sections stay plane in all four kinds, but for breathing, in which they swell about the axis alike all round.
    A share is the kinetic energy of the mode's projection, in the metric of mass, onto fields that follow Legendre
    polynomials P(s) along the axis: axial P e_s; breathing P r; torsional P e_s x r; bending P e_t for both directions
    t across, with the tilt P t e_s of the sections. The axis passes through the centre of mass.
    """
    if axis not in DIRECTIONS or len(axis) != 1:
        raise InvalidInput(f"axis must be x, y or z, got {axis!r}")
    mass = scalar_mass_matrix(model)
    weight = np.asarray(mass.sum(axis=0))
    flat = modes.shapes.reshape(len(modes.shapes), -1)
    shares = {}
    for kind, fields in _fields(model.mesh, weight, DIRECTIONS.index(axis)).items():
        loaded = _loaded(mass, fields)
        gram, projected = fields @ loaded, flat @ loaded
        energy = np.einsum("kf,kf->k", projected, np.linalg.lstsq(gram, projected.T, rcond=1e-10)[0].T)
        shares[kind] = np.clip(energy, 0.0, 1.0)  # the shapes have unit modal mass
    return shares


def mode_names(model: Model, modes: NaturalModes, *, axis: str) -> tuple[str, ...]:
    """Return a name for each mode, such as "axial 1", numbered by frequency within its kind.

    Parameters
    ----------
    model : Model
    modes : NaturalModes
    axis : str
        The body's axis: "x", "y" or "z".

    Returns
    -------
    tuple of str
        Modes with no more than half their energy in any one kind are called "other".
    """
    shares = kinetic_energy_fractions(model, modes, axis=axis)
    kinds = list(shares)
    stacked = np.array([shares[kind] for kind in kinds])
    seen: Counter[ModeFamily] = Counter()
    names = []
    for mode in range(modes.natural_frequency.size):
        best = int(np.argmax(stacked[:, mode]))
        kind = kinds[best] if stacked[best, mode] > _DOMINANT else ModeFamily.OTHER
        kind = ModeFamily.RIGID if mode < modes.rigid_body_count else kind
        seen[kind] += 1
        names.append(f"{kind} {seen[kind]}")
    return tuple(names)


def _loaded(mass: sparse.csc_array, fields: Floats) -> Floats:
    """Return mass times fields of three directions, shape (3n, f)."""
    by_node = fields.reshape(len(fields), -1, 3).transpose(1, 2, 0)
    return np.asarray(mass @ by_node.reshape(len(by_node), -1)).reshape(-1, len(fields))


def _fields(mesh: Mesh, weight: Floats, axis: int) -> dict[ModeFamily, Floats]:
    """Return fields of each kind, shape (f, 3n)."""
    place = mesh.nodes - np.average(mesh.nodes, axis=0, weights=weight)
    half = np.ptp(place[:, axis]) / 2
    along = (mesh.nodes[:, axis] - mesh.nodes[:, axis].min()) / half - 1
    waves = legendre.legvander(along, _DEGREE).T  # (f, n)
    unit = np.eye(3)
    across = [direction for direction in range(3) if direction != axis]
    arm = place * (1 - unit[axis]) / half

    def spread(direction: Floats) -> Floats:
        return (waves[:, :, np.newaxis] * direction).reshape(len(waves), -1)

    shifts = [spread(np.broadcast_to(unit[t], place.shape)) for t in across]
    tilts = [spread(arm[:, t, np.newaxis] * unit[axis]) for t in across]
    return {
        ModeFamily.AXIAL: spread(np.broadcast_to(unit[axis], place.shape)),
        ModeFamily.BREATHING: spread(arm),
        ModeFamily.TORSIONAL: spread(np.cross(unit[axis], arm)),
        ModeFamily.BENDING: np.concatenate([*shifts, *tilts]),
    }
