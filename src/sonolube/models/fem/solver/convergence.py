"""Natural modes to a requested accuracy by hp-refinement: rising element orders, then finer graded meshes."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.fem.mesh.element_order import change_order
from sonolube.models.fem.mesh.grading import grade_reentrant_edges
from sonolube.models.fem.solver.model import Model
from sonolube.models.fem.solver.modes import NaturalModes, NotConverged, natural_modes

_ORDERS = range(2, 7)  # of the elements on one mesh, before it is refined
_REFINEMENT = 0.62  # ratio of the element sizes of successive meshes: some four times the unknowns
_MIN_TOLERANCE = 1e-8  # below it, changes are rounding and the residual of the eigenvalue iteration
_NEEDED_ORDERS = 3  # on a mesh, before its error can be estimated
_RATIOS = (0.25, 0.6)  # least and greatest factor between successive changes assumed in the error estimate
_SINGULAR_RATIO = 1 / 3  # least such factor on bodies with re-entrant edges
_MIN_CHANGE = 0.1  # of the change before, as which an accidentally small last change counts


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ConvergedModes:
    """Natural modes on the last mesh, with frequencies extrapolated to infinite element order.

    Parameters
    ----------
    model : Model
        Finite-element model on the last mesh, with the highest element order.
    modes : NaturalModes
    natural_frequency : ndarray, shape (k,)
        Extrapolated natural frequencies, zero for rigid-body modes. [Hz]
    frequency_error : ndarray, shape (k,)
        Estimated relative error of the extrapolated frequencies. []
    nodes : tuple of int
        Number of nodes of each mesh, in order of computation.
    history : ndarray, shape (meshes, k)
        Natural frequencies in Hz on each mesh, likewise.
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
    required_modes: Callable[[Model, NaturalModes], Sequence[int]] | None = None,
    advance: Callable[[str, int, int], None] | None = None,
) -> ConvergedModes:
    """Natural modes whose estimated relative error of the frequency is within a tolerance, by hp-refinement.

    Parameters
    ----------
    model_at : callable
        From the largest element edge in m to the finite-element model on such a mesh, of any order.
    count : int
        Number of elastic modes.
    element_size : float
        Largest element edge of the first mesh; as large as the body is thick is the fastest. [m]
    relative_tolerance : float
        Largest estimated relative error of any frequency.
    most_nodes : int
        Largest admissible number of nodes.
    required_modes : callable, optional
        From model and modes to the indices of the modes that must be within the tolerance; all where absent.
    advance : callable, optional
        Progress callback, called with a description, the number of completed steps and the expected number.

    Returns
    -------
    ConvergedModes

    Raises
    ------
    InvalidInput
        If the tolerance is below 1e-8.
    NotConverged
        If the next mesh would have more than `most_nodes` nodes; the message states the error reached.

    Notes
    -----
    On one mesh the element order rises from two to six. In smooth bodies each order reduces the error by a factor of
    five to ten, and by less at re-entrant corners and where bodies are bonded. Elements of each order approximate the
    curved geometry to that order, so that the geometrical error falls likewise; next to re-entrant edges they are thin
    across them. If order six is not sufficient, the mesh is refined and graded once more.

    References
    ----------
    .. [1] I. Babuška and M. Suri, SIAM Rev. 36, 578 (1994). doi:10.1137/1036141
    """
    require_positive(element_size=element_size, relative_tolerance=relative_tolerance)
    if not relative_tolerance >= _MIN_TOLERANCE:
        raise InvalidInput(
            f"relative_tolerance must be at least {_MIN_TOLERANCE:g}, got {relative_tolerance:g}: smaller errors are "
            "hidden by rounding; no material's constants are known to better than 1e-6"
        )
    history: list[Floats] = []
    nodes: list[int] = []
    size, level, largest_error = element_size, 1, np.inf
    while True:
        base = model_at(size)
        mesh = grade_reentrant_edges(base.mesh, levels=level)
        for step, order in enumerate(_ORDERS, start=1):
            model = replace(base, mesh=change_order(mesh, order=order))
            if nodes and model.mesh.node_count > most_nodes:
                raise NotConverged(
                    f"the estimated error of the frequencies is {largest_error:.2g}, not {relative_tolerance:.2g}, "
                    f"on {nodes[-1]} nodes; the next mesh has {model.mesh.node_count}: allow more, "
                    "or request fewer modes or a larger tolerance"
                )
            modes = natural_modes(model, count=count)
            history.append(modes.natural_frequency)
            nodes.append(model.mesh.node_count)
            if advance:
                advance(f"{model.mesh.node_count} nodes", len(nodes), len(nodes) + 1)
            if step < _NEEDED_ORDERS:
                continue
            frequency, error = extrapolate_frequencies(np.array(history[-step:]), singular=mesh is not base.mesh)
            required = error[list(required_modes(model, modes))] if required_modes else error
            largest_error = float(required.max())
            if largest_error <= relative_tolerance:
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
    r"""Natural frequencies extrapolated to infinite element order, and their estimated relative errors.

    Parameters
    ----------
    history : ndarray, shape (orders, k)
        Natural frequencies in Hz at three or more successive element orders.
    singular : bool
        Whether the body has re-entrant edges.

    Returns
    -------
    frequency : ndarray, shape (k,)
        Extrapolated natural frequencies. [Hz]
    error : ndarray, shape (k,)
        Estimated relative errors.

    Raises
    ------
    InvalidInput
        If there are fewer than three orders.

    Notes
    -----
    With the last two changes, :math:`\Delta_n = f_{n-1} - f_n` and the one before, and the ratio
    :math:`r = |\Delta_n/\Delta_{n-1}|`, the changes to come are assumed to form a geometric series:

    .. math::

        f_\infty = f_n - \Delta_n \frac{r}{1 - r}, \qquad
        \epsilon = \frac{\max(|\Delta_n|,\, 0.1\, |\Delta_{n-1}|)}{f_\infty} \frac{r'}{1 - r'}

    In the error the ratio r' is at least a quarter. Near re-entrant edges, whose singularity dominates after a few
    orders, both ratios are at least a third: between orders five and six of a collar the changes fell by factors of
    0.21 to 0.31, whereas between four and five they had been 0.07 to 0.28. No ratio is taken above 0.6.
    """
    if len(history) < _NEEDED_ORDERS:
        raise InvalidInput(f"extrapolation needs three orders or more, got {len(history)}")
    before, last = np.abs(np.diff(history[-_NEEDED_ORDERS:], axis=0))
    ratio = np.divide(last, before, out=np.zeros_like(last), where=before > 0)
    least, conservative_least = (_SINGULAR_RATIO, _SINGULAR_RATIO) if singular else (0.0, _RATIOS[0])
    expected, conservative = np.clip(ratio, least, _RATIOS[1]), np.clip(ratio, conservative_least, _RATIOS[1])
    frequency = history[-1] - (history[-2] - history[-1]) * expected / (1 - expected)
    error = np.maximum(last, _MIN_CHANGE * before) * conservative / (1 - conservative)
    return frequency, np.divide(error, frequency, out=np.zeros_like(error), where=frequency > 0)
