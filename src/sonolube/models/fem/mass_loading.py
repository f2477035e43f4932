"""Natural frequencies of a body with a rigid mass attached to a face, by modal synthesis with residual compliance."""

import numpy as np
from scipy.linalg import eigh

from sonolube.checks import Floats, require_non_negative
from sonolube.models.fem.mesh.mesh import DIRECTIONS
from sonolube.models.fem.solver.assembly import tributary_areas
from sonolube.models.fem.solver.model import Model
from sonolube.models.fem.solver.modes import NaturalModes, spectral_shift
from sonolube.models.fem.solver.reduction import Output, output_matrix
from sonolube.models.fem.solver.system import LinearSolver, SystemMatrices

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
