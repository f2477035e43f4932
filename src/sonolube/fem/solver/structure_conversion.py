"""A piezoelectric body as dynamics takes structures: modes, their drive and their motion at one contact."""

import numpy as np

from sonolube.checks import Floats, require_positive
from sonolube.dynamics import Structure, modal_structure
from sonolube.errors import UnknownName
from sonolube.fem.solver.harmonic_analysis import ReducedModel


def contact_structure(model: ReducedModel, *, contact: str, outwards: float = 1.0) -> Structure:
    """Return the structure that touches another body at one output of a reduced model.

    Parameters
    ----------
    model : ReducedModel
    contact : str
        Name of the output at which it touches.
    outwards : float
        1 where the output's positive direction leads away from the other body, -1 where towards it.

    Returns
    -------
    Structure

    Raises
    ------
    UnknownName
        If there is no such output.

    Notes
    -----
    Damping is that of the losses at each mode's own frequency, zeta = Im k/(2 Re k); couplings by losses between modes
    and the dielectric loss are left out. The static coordinates of the reduction become modes of high frequency.
    """
    if contact not in model.outputs:
        raise UnknownName.among(model.outputs, kind="output", name=contact)
    squares, shapes = np.linalg.eigh(model.stiffness.real)
    squares = np.where(squares > 1e-9 * squares.max(), squares, 0.0)
    lost = np.einsum("ki,kl,li->i", shapes, model.stiffness.imag, shapes)
    ratios = np.divide(np.maximum(lost, 0.0), 2 * squares, out=np.zeros_like(squares), where=squares > 0)
    return modal_structure(
        frequencies=np.sqrt(squares) / (2 * np.pi),
        damping_ratios=ratios,
        drive_participation=shapes.T @ model.drive.real,
        contact_participation=outwards * shapes.T @ model.participation[model.outputs.index(contact)],
        clamped_capacitance=model.clamped_capacitance.real,
    )


def with_free_body(structure: Structure, *, body_mass: float) -> Structure:
    """Return a structure together with a rigid body that rests on its contact and is held by nothing else.

    Parameters
    ----------
    structure : Structure
        Its contact's positive direction leads away from the body.
    body_mass : float
        Mass of the body. [kg]

    Returns
    -------
    Structure
        The contact's displacement is now that of the body less that of the structure: the gap.
    """
    n = structure.coordinates
    mass = float(require_positive(body_mass=body_mass))

    def bordered(matrix: Floats, corner: float) -> Floats:
        whole = np.zeros((n + 1, n + 1))
        whole[:n, :n], whole[n, n] = matrix, corner
        return whole

    return Structure(
        mass_matrix=bordered(structure.mass_matrix, mass),
        damping_matrix=bordered(structure.damping_matrix, 0.0),
        stiffness_matrix=bordered(structure.stiffness_matrix, 0.0),
        drive_vector=np.append(structure.drive_vector, 0.0),
        contact_vector=np.append(structure.contact_vector, 1.0),
        clamped_capacitance=structure.clamped_capacitance,
    )
