"""Analyses of natural modes: families and names, frequencies with a mass on a face, trajectories of surface points.

Families about an axis follow from the kinetic energy; a rigid mass is attached by modal synthesis with residual
compliance; trajectories are ellipses with semi-axes, inclination, sense and phase.
"""

from collections import Counter
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import ArrayLike
from scipy import sparse
from scipy.linalg import eigh

from sonolube.checks import Floats, require_finite_complex, require_non_negative
from sonolube.errors import InvalidInput
from sonolube.models.fem.mesh.mesh import DIRECTIONS, Mesh
from sonolube.models.fem.solver.assembly import scalar_mass_matrix, tributary_areas
from sonolube.models.fem.solver.model import Model
from sonolube.models.fem.solver.modes import NaturalModes, spectral_shift
from sonolube.models.fem.solver.reduction import Output, output_matrix
from sonolube.models.fem.solver.system import LinearSolver, SystemMatrices

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


_MOVING = 0.05  # of the largest squared modal displacement of the face, above which a mode is coupled to the mass
_RESIDUAL_FREQUENCY = 1e3  # squared frequency of the mode that has the residual compliance, over that of the highest


def mass_loaded_frequencies(
    modes: NaturalModes, model: Model, *, face: str, along: str, tool_mass: float, residual_compliance: float
) -> Floats:
    r"""Natural frequencies with a rigid mass that follows the mean displacement of a face in one direction.

    Parameters
    ----------
    modes : NaturalModes
        Natural modes without the mass.
    model : Model
        The model that they belong to.
    face : str
        Name of the face that carries the mass.
    along : str
        Direction in which the mass is inert, "x", "y" or "z".
    tool_mass : float
        Mass. [kg]
    residual_compliance : float
        Result of `face_residual_compliance`, possibly of a coarser mesh. [m/N]

    Returns
    -------
    ndarray, shape (k,)
        In Hz, in the order of the modes.

    Raises
    ------
    InvalidInput
        If the mass is negative.

    Notes
    -----
    With the modal displacements d of the face, modes of unit mass and the attached mass m

    .. math:: \det\left[\mathrm{diag}(\omega_i^2) - \omega^2 \left(I + m\, d\, d^\mathsf{T}\right)\right] = 0

    The modes above those given are represented by one mode of high frequency with their residual compliance.
    """
    mass = float(require_non_negative(tool_mass=tool_mass))
    displacement = _face_displacement(modes, model, face, along)
    squares = (2 * np.pi * modes.natural_frequency) ** 2
    high = _RESIDUAL_FREQUENCY * squares.max()
    squares = np.append(squares, high)
    displacement = np.append(displacement, np.sqrt(max(residual_compliance, 0.0) * high))
    coupled = displacement**2 > _MOVING * np.max(displacement[:-1] ** 2)  # others keep their frequency, nearly
    own = displacement[coupled]
    squares[coupled] = eigh(np.diag(squares[coupled]), np.eye(len(own)) + mass * np.outer(own, own), eigvals_only=True)
    return np.asarray(np.sqrt(np.maximum(squares[:-1], 0.0)) / (2 * np.pi))


def face_residual_compliance(
    modes: NaturalModes, model: Model, equations: SystemMatrices, *, inverse: LinearSolver, face: str, along: str
) -> float:
    r"""Residual compliance of a face: mean displacement per distributed force, by all modes above those given.

    Parameters
    ----------
    modes : NaturalModes
    model : Model
    equations : SystemMatrices
        Those of the model.
    inverse : callable
        Result of `shift_invert_solver` for the shift of `spectral_shift`.
    face : str
        Name of the face on which the force acts.
    along : str
        Its direction, "x", "y" or "z".

    Returns
    -------
    float
        In m/N.

    Notes
    -----
    With the nodal forces f of a unit force on the face, at the spectral shift :math:`\sigma`

    .. math:: c_r = f^\mathsf{T} (K - \sigma M)^{-1} f - \sum_i \frac{d_i^2}{\omega_i^2 - \sigma}
    """
    force = output_matrix(model, equations, {"face": Output(face=face, along=along)})[0]
    squares = (2 * np.pi * modes.natural_frequency) ** 2
    modal = np.sum(_face_displacement(modes, model, face, along) ** 2 / (squares - spectral_shift(model)))
    return float(force @ inverse(force) - modal)


def _face_displacement(modes: NaturalModes, model: Model, face: str, along: str) -> Floats:
    """Mean displacement of a face in each mode of unit modal mass."""
    areas = tributary_areas(model.mesh, face)
    return np.asarray(modes.shapes[:, :, DIRECTIONS.index(along)] @ areas / areas.sum())


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class TrajectoryEllipse:
    """Elliptical trajectories of points, of any number.

    Parameters
    ----------
    major_semi_axis : ndarray, shape (...)
        Major semi-axis. [m]
    minor_semi_axis : ndarray, shape (...)
        Minor semi-axis, positive where the point rotates from the axial towards the normal direction, negative in the
        opposite sense, zero on a straight line. [m]
    inclination : ndarray, shape (...)
        Angle from the axial direction to the major axis, between -pi/2 and pi/2. [rad]
    phase : ndarray, shape (...)
        Phase lag of the normal displacement behind the axial one, between -pi and pi. [rad]
    """

    major_semi_axis: Floats
    minor_semi_axis: Floats
    inclination: Floats
    phase: Floats


def trajectory_ellipse(*, axial_displacement: ArrayLike, normal_displacement: ArrayLike) -> TrajectoryEllipse:
    r"""Ellipses described by points with the displacements Re[u exp(i omega t)] and Re[v exp(i omega t)].

    Parameters
    ----------
    axial_displacement : array_like of complex
        Complex amplitude u along the surface. [m]
    normal_displacement : array_like of complex, broadcast against `axial_displacement`
        Complex amplitude v along its normal. [m]

    Returns
    -------
    TrajectoryEllipse

    Raises
    ------
    InvalidInput
        If an amplitude is not finite.

    Notes
    -----
    The motion is the sum of two circular motions of opposite sense, whose radii give the semi-axes

    .. math:: a, b = \tfrac12 |u + i v| \pm \tfrac12 |u - i v|

    and whose phases give the inclination :math:`\psi = \tfrac12 [\arg(u + i v) - \arg(u - i v)]`.
    """
    u, v = np.broadcast_arrays(
        require_finite_complex(axial_displacement=axial_displacement),
        require_finite_complex(normal_displacement=normal_displacement),
    )
    forward, backward = (u + 1j * v) / 2, (u - 1j * v) / 2
    angle = (np.angle(forward) - np.angle(backward)) / 2
    return TrajectoryEllipse(
        major_semi_axis=np.abs(forward) + np.abs(backward),
        minor_semi_axis=np.abs(forward) - np.abs(backward),
        inclination=np.asarray((angle + np.pi / 2) % np.pi - np.pi / 2),
        phase=np.asarray(np.angle(u * v.conj())),
    )
