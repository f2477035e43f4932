"""Modes to a stated accuracy: orders of elements raised, then meshes refined, until the error is small enough."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.fem.solver.element_order import change_order
from sonolube.fem.solver.grading import grade_reentrant_edges
from sonolube.fem.solver.model import Model
from sonolube.fem.solver.modes import NaturalModes, NotConverged, natural_modes

_ORDERS = range(2, 7)  # on one mesh; the next is a finer one
_REFINEMENT = 0.62  # of the element size from mesh to mesh: some four times the unknowns
_LEAST_TOLERANCE = 1e-8  # below it rounding, and what the eigenvalue iteration leaves, would be all that changes
_NEEDED = 3  # orders on a mesh before its error can be told
_RATIOS = (0.25, 0.6)  # between which errors are taken to fall from order to order, for the estimate of the error
_SINGULAR = 1 / 3  # least such factor where edges re-enter, whatever the last changes promise
_UNEVEN = 0.1  # of the change before, of which a change that happens to be small is taken to be


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ConvergedModes:
    """Modes of the last mesh with frequencies extrapolated to elements of any order.

    Parameters
    ----------
    model : Model
        On the last mesh, of the highest order.
    modes : NaturalModes
        On the last mesh.
    natural_frequency : ndarray, shape (k,)
        Extrapolated natural frequencies, zero for rigid motions. [Hz]
    frequency_error : ndarray, shape (k,)
        Estimated error of the extrapolated frequencies over themselves. []
    nodes : tuple of int
        Number of nodes of each mesh.
    history : ndarray, shape (meshes, k)
        Natural frequencies in Hz on each mesh, in order of computation.
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
    judged: Callable[[Model, NaturalModes], Sequence[int]] | None = None,
    advance: Callable[[str, int, int], None] | None = None,
) -> ConvergedModes:
    """Return modes whose estimated relative error in frequency is within a tolerance.

    Parameters
    ----------
    model_at : callable
        From the largest edge of an element in m to the model on such a mesh, of any order.
    count : int
        Number of elastic modes.
    element_size : float
        Largest edge of an element in the first mesh; coarse ones, as long as the body is thick, are the fastest. [m]
    relative_tolerance : float
        Largest estimated relative error of any frequency.
    most_nodes : int
        Meshes with more nodes than this are not tried.
    judged : callable, optional
        Which rows of the modes must be known so well; all where absent.
    advance : callable, optional
        Told what is being done, how many meshes are done and of how many, as far as one knows.

    Returns
    -------
    ConvergedModes

    Raises
    ------
    InvalidInput
        If the tolerance is below 1e-8.
    NotConverged
        If the next mesh would have more than `most_nodes` nodes; the message says what was reached.

    Notes
    -----
    On one mesh the order of its elements rises from two to six. In smooth bodies errors then fall by one factor after
    the other of five to ten, and more slowly at corners that re-enter and where bodies are bonded. Elements of each
    order follow the body's curves to that order, so that their error in shape falls along. Next to edges that
    re-enter elements are cut to be thin across them. Where order six is not enough the mesh is refined, and cut once
    more.

    References
    ----------
    .. [1] I. Babuška and M. Suri, SIAM Rev. 36, 578 (1994). doi:10.1137/1036141
    """
    require_positive(element_size=element_size, relative_tolerance=relative_tolerance)
    if not relative_tolerance >= _LEAST_TOLERANCE:
        raise InvalidInput(
            f"relative_tolerance must be at least {_LEAST_TOLERANCE:g}, got {relative_tolerance:g}: rounding hides "
            "less; 1e-6 is finer than any material is known"
        )
    history: list[Floats] = []
    nodes: list[int] = []
    size, level, reached = element_size, 1, np.inf
    while True:
        base = model_at(size)
        mesh = grade_reentrant_edges(base.mesh, levels=level)
        for step, order in enumerate(_ORDERS, start=1):
            model = replace(base, mesh=change_order(mesh, order=order))
            if nodes and model.mesh.node_count > most_nodes:
                raise NotConverged(
                    f"the modes are within {reached:.2g} of their frequencies, not within {relative_tolerance:.2g}, "
                    f"on {nodes[-1]} nodes; the next mesh has {model.mesh.node_count}: allow more, "
                    "or ask for fewer modes or less accuracy"
                )
            modes = natural_modes(model, count=count)
            history.append(modes.natural_frequency)
            nodes.append(model.mesh.node_count)
            if advance:
                advance(f"{model.mesh.node_count} nodes", len(nodes), len(nodes) + 1)
            if step < _NEEDED:
                continue
            frequency, error = extrapolate_frequencies(np.array(history[-step:]), singular=mesh is not base.mesh)
            reached = float(error[list(judged(model, modes))].max() if judged else error.max())
            if reached <= relative_tolerance:
                return ConvergedModes(
                    model=model,
                    modes=modes,
                    natural_frequency=frequency,
                    frequency_error=error,
                    nodes=tuple(nodes),
                    history=np.array(history),
                )
        size, level = size * _REFINEMENT, level + 1


def extrapolate_frequencies(history: Floats, *, singular: bool = False) -> tuple[Floats, Floats]:
    """Return frequencies at an order of elements beyond all bounds and their estimated relative errors.

    Parameters
    ----------
    history : ndarray, shape (orders, k)
        Natural frequencies in Hz for three successive orders or more.
    singular : bool
        Whether the body has edges that re-enter.

    Returns
    -------
    tuple of two ndarray, shape (k,)

    Notes
    -----
    The changes still to come are taken to fall as the last two did, by a constant factor; the error is their sum with
    a factor of a quarter at least, and more where the last change is smaller than a tenth of the one before. Edges that
    re-enter come to rule after a few orders: between orders five and six of a collar changes fell by factors of 0.21 to
    0.31, when those between four and five had promised 0.07 to 0.28. There no factor below a third is taken.
    """
    if len(history) < _NEEDED:
        raise InvalidInput(f"extrapolation needs three orders or more, got {len(history)}")
    before, last = np.abs(np.diff(history[-_NEEDED:], axis=0))
    ratio = np.divide(last, before, out=np.zeros_like(last), where=before > 0)
    least, cautious_least = (_SINGULAR, _SINGULAR) if singular else (0.0, _RATIOS[0])
    falling, cautious = np.clip(ratio, least, _RATIOS[1]), np.clip(ratio, cautious_least, _RATIOS[1])
    frequency = history[-1] - (history[-2] - history[-1]) * falling / (1 - falling)
    error = np.maximum(last, _UNEVEN * before) * cautious / (1 - cautious)
    return frequency, np.divide(error, frequency, out=np.zeros_like(error), where=frequency > 0)
