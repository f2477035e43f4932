"""Axial stress in the cross-sections of a preloaded stack and of the rod through it, in modes of a transducer."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats, require_non_negative
from sonolube.errors import InvalidInput
from sonolube.models.fem.mesh.element_order import determinant, jacobian_matrices
from sonolube.models.fem.mesh.mesh import DIRECTIONS, shape_functions
from sonolube.models.fem.results.nodal_fields import gauss_point_stress
from sonolube.models.fem.solver.model import Model
from sonolube.models.fem.solver.reduction import Output

ROD = "rod"
"""Region of the bolt through a stack."""

_SLICES = 9  # of the stack along its axis, over each of which the stress is averaged; odd, for a node in the middle


@dataclass(frozen=True, kw_only=True, slots=True)
class StackStress:
    r"""Stresses of a stack and the rod that preloads it, at an amplitude of its working end; tension is positive.

    Parameters
    ----------
    stack_amplitude, rod_amplitude : float
        Greatest amplitude of the mean axial stress of a cross-section, in Pa; zero without a rod.
    stack_mean, rod_mean : float
        Of the preload alone, in Pa: compression of the stack, tension of the rod.
    rod_share : float
        Share of the rod in the axial dynamic force of the cross-section in which that is greatest.

    Notes
    -----
    The preload F of the rod of area :math:`A_r` compresses the stack of area :math:`A_c`, and both lengthen together:

    .. math::

        \sigma_c = -\frac{F}{A_c} \pm \hat\sigma_c, \qquad \sigma_r = \frac{F}{A_r} \pm \hat\sigma_r, \qquad
        \Phi = \frac{A_r \hat\sigma_r}{A_r \hat\sigma_r + A_c \hat\sigma_c} \approx \frac{k_r}{k_r + k_c}

    The last is that of two springs in parallel, short beside the wavelength. Bending of the rod, its thread, the
    torsion of tightening and the loss of preload with time are neglected.
    """

    stack_amplitude: float
    rod_amplitude: float
    stack_mean: float
    rod_mean: float
    rod_share: float

    @property
    def highest_stack_stress(self) -> float:
        """Greatest axial stress of the stack, in Pa; tension where positive."""
        return self.stack_mean + self.stack_amplitude

    @property
    def highest_rod_stress(self) -> float:
        """Greatest axial stress of the rod, in Pa."""
        return self.rod_mean + self.rod_amplitude


def stack_stress(
    model: Model, shape: Floats, *, working_end: Output, amplitude: float, preload: float = 0.0, copies: int = 1
) -> StackStress:
    """Stresses of the stack and the rod of a transducer in a mode, elastic part at the short-circuited resonance.

    Parameters
    ----------
    model : Model
    shape : ndarray, shape (n, 3)
        Displacements of the nodes, in any scale.
    working_end : Output
        Its mean displacement has the amplitude; the stack lies along its direction.
    amplitude : float
        In m.
    preload : float
        Tension of the rod. [N]
    copies : int
        Number of equal parts of which the model is one.

    Returns
    -------
    StackStress

    Raises
    ------
    InvalidInput
        If a value is negative, there is no ceramic, no rod for a preload, or the working end rests in this mode.
    """
    require_non_negative(amplitude=amplitude, preload=preload)
    along = DIRECTIONS.index(working_end.along)
    motion = float(np.mean(shape[model.mesh.face_nodes(working_end.face), along]))
    if abs(motion) < 1e-9 * float(np.abs(shape).max()):
        raise InvalidInput(f"{working_end.face} rests in this mode; an amplitude there says nothing of its stress")
    regions = np.array([model.media[name].stress_constants is not None for name in model.mesh.regions])
    is_stack = regions[model.mesh.region_of_element]
    if not is_stack.any():
        raise InvalidInput("the part has no piezoelectric region whose stress could be given")
    is_rod = np.array([name == ROD for name in model.mesh.regions])[model.mesh.region_of_element]
    if preload and not is_rod.any():
        raise InvalidInput("the part has no rod that could preload its stack; give rod_radius")
    stress = gauss_point_stress(model, shape)[..., along] * (amplitude / motion)
    place, volume = _gauss_points(model, along)
    nodes = model.mesh.nodes[model.mesh.elements[is_stack], along]
    edges = np.linspace(nodes.min(), nodes.max(), _SLICES + 1)
    stack_force, stack_area = _section(stress, place, volume, is_stack, edges)
    rod_force, rod_area = _section(stress, place, volume, is_rod, edges)
    most = int(np.argmax(np.abs(stack_force + rod_force)))
    return StackStress(
        stack_amplitude=float(np.abs(stack_force).max()) / stack_area,
        rod_amplitude=float(np.abs(rod_force).max()) / rod_area if rod_area else 0.0,
        stack_mean=-preload / (copies * stack_area),
        rod_mean=preload / (copies * rod_area) if rod_area else 0.0,
        rod_share=float(rod_force[most] / (stack_force + rod_force)[most]) if rod_area else 0.0,
    )


def _gauss_points(model: Model, along: int) -> tuple[Floats, Floats]:
    """Coordinate along an axis and volume of the four Gauss points of each element, of shape (m, 4)."""
    points = np.full((4, 4), (5 - np.sqrt(5)) / 20)
    np.fill_diagonal(points, (5 + 3 * np.sqrt(5)) / 20)
    weights, gradient = shape_functions(model.mesh.order, points)
    corners = model.mesh.nodes[model.mesh.elements]
    volume = determinant(jacobian_matrices(corners, gradient)) / 24
    return np.asarray(corners[..., along] @ weights), np.abs(volume)


def _section(
    stress: Floats, place: Floats, volume: Floats, chosen: NDArray[np.bool_], edges: Floats
) -> tuple[Floats, float]:
    """Axial force in each slice, and the area of the cross-section, of some elements between the ends of a stack."""
    inside = chosen[:, np.newaxis] & (place >= edges[0]) & (place <= edges[-1])
    number = np.clip(np.searchsorted(edges, place[inside], side="right") - 1, 0, _SLICES - 1)
    weight = volume[inside]
    total = np.bincount(number, weights=weight, minlength=_SLICES)
    mean = np.bincount(number, weights=weight * stress[inside], minlength=_SLICES)
    area = float(weight.sum() / (edges[-1] - edges[0]))
    return area * np.divide(mean, total, out=np.zeros(_SLICES), where=total > 0), area
