"""Modes to a stated accuracy: meshes refined until the estimated error is small enough."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.fem.model import Model
from sonolube.fem.modes import NaturalModes, NotConverged, natural_modes

_REFINEMENT = 0.62  # of the element size from mesh to mesh: some four times the unknowns
_SMOOTH_ORDER = 4.0  # at which frequencies converge with quadratic elements in smooth bodies
_ORDERS = (1.0, 3.0)  # taken for the error: the lowest is that of corners that re-enter, where stress is singular
_ORDER_UNMEASURED = 2.0  # with two meshes only


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ConvergedModes:
    """Modes of the finest mesh with frequencies extrapolated to vanishing element size.

    Parameters
    ----------
    model : Model
        On the finest mesh.
    modes : NaturalModes
        On the finest mesh.
    natural_frequency : ndarray, shape (k,)
        Extrapolated natural frequencies, zero for rigid motions. [Hz]
    frequency_error : ndarray, shape (k,)
        Estimated error of the extrapolated frequencies over themselves. []
    nodes : tuple of int
        Number of nodes of each mesh.
    history : ndarray, shape (meshes, k)
        Natural frequencies in Hz on each mesh, in order of refinement.
    """

    model: Model
    modes: NaturalModes
    natural_frequency: Floats
    frequency_error: Floats
    nodes: tuple[int, ...]
    history: Floats


def converged_modes(
    model_at: Callable[[float], Model],
    *,
    count: int,
    element_size: float,
    relative_tolerance: float = 1e-3,
    most_nodes: int = 60_000,
    advance: Callable[[str, int, int], None] | None = None,
) -> ConvergedModes:
    """Return modes whose estimated relative error in frequency is within a tolerance.

    Parameters
    ----------
    model_at : callable
        From the largest edge of an element in m to the model on such a mesh.
    count : int
        Number of elastic modes.
    element_size : float
        Largest edge of an element in the first mesh. [m]
    relative_tolerance : float
        Largest estimated relative error of any frequency.
    most_nodes : int
        Meshes with more nodes than this are not tried.
    advance : callable, optional
        Told what is being done, how many meshes are done and of how many, as far as one knows.

    Returns
    -------
    ConvergedModes

    Raises
    ------
    NotConverged
        If the next mesh would have more than `most_nodes` nodes; the message says what was reached.

    Notes
    -----
    Frequencies on each mesh lie above the true ones where the geometry is met exactly, and fall to them as the element
    size to the power of four in smooth bodies, of less at corners that re-enter. Richardson's extrapolation with a
    power of four takes out the smooth part. The error is the last change of frequency extrapolated with the power
    measured on the last three meshes, held between one and three: free meshes change unevenly, so it is cautious.

    References
    ----------
    .. [1] P. J. Roache, J. Fluids Eng. 116, 405 (1994). doi:10.1115/1.2910291
    """
    require_positive(element_size=element_size, relative_tolerance=relative_tolerance)
    history: list[Floats] = []
    nodes: list[int] = []
    size, reached = element_size, np.inf
    while True:
        model = model_at(size)
        if nodes and model.mesh.size <= nodes[-1]:  # the geometry, not the size, sets this mesh
            size *= _REFINEMENT
            continue
        if nodes and model.mesh.size > most_nodes:
            raise NotConverged(
                f"the modes are within {reached:.2g} of their frequencies, not within {relative_tolerance:.2g}, on "
                f"{nodes[-1]} nodes; the next mesh has {model.mesh.size}: allow more, "
                "or ask for fewer modes or less accuracy"
            )
        modes = natural_modes(model, count=count)
        history.append(modes.natural_frequency)
        nodes.append(model.mesh.size)
        if advance:
            advance(f"{model.mesh.size} nodes", len(nodes), len(nodes) + 1)
        if len(nodes) > 1:
            frequency, error = extrapolated(np.array(history), nodes=tuple(nodes))
            reached = float(error.max())
            if reached <= relative_tolerance:
                return ConvergedModes(
                    model=model,
                    modes=modes,
                    natural_frequency=frequency,
                    frequency_error=error,
                    nodes=tuple(nodes),
                    history=np.array(history),
                )
        size *= _REFINEMENT


def extrapolated(history: Floats, *, nodes: tuple[int, ...]) -> tuple[Floats, Floats]:
    """Return frequencies at vanishing element size and their estimated relative errors.

    Parameters
    ----------
    history : ndarray, shape (meshes, k)
        Natural frequencies in Hz on two meshes or more, in order of refinement.
    nodes : tuple of int
        Number of nodes of each mesh, the inverse cube of its element size.

    Returns
    -------
    tuple of two ndarray, shape (k,)
    """
    if len(history) < 2 or len(history) != len(nodes):
        raise InvalidInput(f"extrapolation needs two meshes or more, got {len(history)}")
    size = np.asarray(nodes, dtype=np.float64) ** (-1 / 3)
    ratio = size[-2] / size[-1]
    change = history[-2] - history[-1]
    frequency = history[-1] - change / (ratio**_SMOOTH_ORDER - 1)
    error = np.abs(change) / (ratio ** _measured_order(history, size) - 1)
    return frequency, np.divide(error, frequency, out=np.zeros_like(error), where=frequency > 0)


def _measured_order(history: Floats, size: Floats) -> Floats:
    """Return the order of convergence at which the last two changes of frequency agree, held within its bounds."""
    if len(history) < 3:
        return np.full(history.shape[1], _ORDER_UNMEASURED)
    coarse, middle, fine = size[-3:]
    orders = np.linspace(*_ORDERS, 41)[:, np.newaxis]
    expected = (coarse**orders - middle**orders) / (middle**orders - fine**orders)
    first, second = np.abs(np.diff(history[-3:], axis=0))
    ratio = np.divide(first, second, out=np.full_like(second, np.inf), where=second > 0)
    return np.asarray(orders[np.argmin(np.abs(expected - np.minimum(ratio, 1e9)), axis=0), 0])
