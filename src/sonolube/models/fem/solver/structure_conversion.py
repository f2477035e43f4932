"""Conversion of a reduced piezoelectric body to a structure with one contact, as `sonolube.models.dynamics` takes."""

import numpy as np

from sonolube.checks import Floats, require_positive
from sonolube.errors import UnknownName
from sonolube.models.dynamics import Structure, modal_structure
from sonolube.models.fem.solver.reduction import ReducedModel
from sonolube.models.fem.solver.resonances import undamped_modes


def contact_structure(model: ReducedModel, *, contact: str, outwards: float = 1.0) -> Structure:
    r"""Modal structure of a reduced model that touches another body at one of its outputs.

    Parameters
    ----------
    model : ReducedModel
    contact : str
        Name of the output at the contact.
    outwards : float
        1 where the positive direction of the output leads away from the other body, -1 where towards it.

    Returns
    -------
    Structure

    Raises
    ------
    UnknownName
        If there is no such output.

    Notes
    -----
    With the eigenvalues and eigenvectors of the real part of the stiffness, the modal damping ratio is that of the
    hysteretic losses at the mode's own frequency,

    .. math:: \zeta_i = \frac{\phi_i^\mathsf{T}\, \mathrm{Im} K\, \phi_i}{2 \omega_i^2}

    Coupling of modes by losses and the dielectric loss are neglected. The coordinates of the static correction become
    modes of high frequency.
    """
    if contact not in model.outputs:
        raise UnknownName.among(model.outputs, kind="output", name=contact)
    squares, shapes = undamped_modes(model)
    loss = np.einsum("ki,kl,li->i", shapes, model.stiffness.imag, shapes)
    ratios = np.divide(np.maximum(loss, 0.0), 2 * squares, out=np.zeros_like(squares), where=squares > 0)
    return modal_structure(
        frequencies=np.sqrt(squares) / (2 * np.pi),
        damping_ratios=ratios,
        drive_participation=shapes.T @ model.drive.real,
        contact_participation=outwards * shapes.T @ model.participation[model.outputs.index(contact)],
        clamped_capacitance=model.clamped_capacitance.real,
    )


def with_free_body(structure: Structure, *, body_mass: float) -> Structure:
    """Structure extended by a rigid body that rests on its contact and is otherwise free.

    Parameters
    ----------
    structure : Structure
        The positive direction of its contact leads away from the body.
    body_mass : float
        Mass of the body. [kg]

    Returns
    -------
    Structure
        Its contact displacement is that of the body less that of the given structure: the change of the gap.

    Raises
    ------
    InvalidInput
        If the mass is not positive.
    """
    n = structure.coordinates
    mass = float(require_positive(body_mass=body_mass))

    def bordered(matrix: Floats, corner: float) -> Floats:
        extended = np.zeros((n + 1, n + 1))
        extended[:n, :n], extended[n, n] = matrix, corner
        return extended

    return Structure(
        mass_matrix=bordered(structure.mass_matrix, mass),
        damping_matrix=bordered(structure.damping_matrix, 0.0),
        stiffness_matrix=bordered(structure.stiffness_matrix, 0.0),
        drive_vector=np.append(structure.drive_vector, 0.0),
        contact_vector=np.append(structure.contact_vector, 1.0),
        clamped_capacitance=structure.clamped_capacitance,
    )
