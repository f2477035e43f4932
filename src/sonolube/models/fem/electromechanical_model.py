"""Electromechanical model of a driven body on meshes refined until its coupled resonances converge."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import count as count_up

import numpy as np

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.fem.mesh.element_order import change_order
from sonolube.models.fem.mode_analysis import mode_names
from sonolube.models.fem.solver.model import Model
from sonolube.models.fem.solver.modes import NaturalModes, NotConverged
from sonolube.models.fem.solver.reduction import Output, ReducedModel, krylov_reduction
from sonolube.models.fem.solver.response import coupled_resonances

_REFINEMENT = 0.62  # ratio of the element sizes of successive meshes
_ORDERS = range(2, 6)  # of the elements on one mesh, before it is refined
_FAINTER = 0.3  # of the least coupling factor, from which a mode of the model before may be the same mode
_MIN_REPORTED = 0.01  # coupling factor from which a mode counts as driven


@dataclass(frozen=True, kw_only=True, slots=True)
class ElectromechanicalMode:
    """Natural mode of a driven body: its series and parallel resonance and effective coupling factor.

    Parameters
    ----------
    name : str
        Such as "axial 1".
    series_frequency : float
        Natural frequency, short-circuited. [Hz]
    parallel_frequency : float
        Natural frequency, open-circuited. [Hz]
    coupling_factor : float
        Effective coupling factor, sqrt(1 - (f_s/f_p)^2). []
    """

    name: str
    series_frequency: float
    parallel_frequency: float
    coupling_factor: float


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ElectromechanicalModel:
    """Reduced model of a driven body and its electromechanical modes.

    Parameters
    ----------
    model : Model
        Finite-element model on the last mesh.
    reduction : ReducedModel
        Its reduction to few coordinates.
    modes : tuple of ElectromechanicalMode
        Modes in the frequency range that the drive excites, by frequency; their names are numbered among these alone.
    shapes : ndarray, shape (k, n, 3)
        Their mode shapes: displacements of the nodes, normalised to a modal mass of 1 kg.
    frequency_error : float
        Largest relative change of a coupled series frequency with the last rise of the element order. []
    """

    model: Model
    reduction: ReducedModel
    modes: tuple[ElectromechanicalMode, ...]
    shapes: Floats
    frequency_error: float


def converged_electromechanical_model(
    model_at: Callable[[float], Model],
    *,
    outputs: Mapping[str, Output],
    axis: str,
    highest_frequency: float,
    element_size: float,
    relative_tolerance: float = 0.01,
    least_coupling: float = 0.05,
    most_nodes: int = 60_000,
    advance: Callable[[str, int, int], None] | None = None,
) -> ElectromechanicalModel:
    """Electromechanical model of a driven body, refined until its coupled resonances change within a tolerance.

    Parameters
    ----------
    model_at : callable
        From the largest element edge in m to the finite-element model on such a mesh.
    outputs : mapping of str to Output
        Displacements to observe and points of application of forces.
    axis : str
        Axis of the body, "x", "y" or "z", for the names of modes.
    highest_frequency : float
        Highest frequency of interest. [Hz]
    element_size : float
        Largest element edge of the first mesh. [m]
    relative_tolerance : float
        Largest relative change of a coupled series frequency from one element order to the next.
    least_coupling : float
        Effective coupling factor from which a mode counts as coupled.
    most_nodes : int
        Largest admissible number of nodes.
    advance : callable, optional
        Progress callback, called with a description, the number of completed steps and the expected number.

    Returns
    -------
    ElectromechanicalModel

    Raises
    ------
    InvalidInput
        If no mode in the range is coupled to the drive.
    NotConverged
        If the next mesh would have more than `most_nodes` nodes.

    Notes
    -----
    On each mesh the element order rises from two to five; then the mesh is refined. The electrical port is given by
    the reduction's drive vector and clamped capacitance.

    See Also
    --------
    sonolube.models.fem.solver.response.harmonic_response : Admittance of the reduction over frequency.
    """
    require_positive(highest_frequency=highest_frequency, element_size=element_size)
    before: Floats | None = None
    error = np.inf
    for model in _refined_models(model_at, element_size):
        if model.mesh.node_count > most_nodes:
            raise NotConverged(
                f"coupled resonances still change by {error:.2g} of their frequency; the next mesh has "
                f"{model.mesh.node_count} nodes: allow more of them, or a larger change"
            )
        reduction, coordinates = krylov_reduction(model, outputs=outputs, highest_frequency=highest_frequency)
        if advance:
            advance(f"{model.mesh.node_count} nodes", 1, 2)
        now = _coupled_frequencies(reduction, highest_frequency, least_coupling)
        if not now.size:
            raise InvalidInput(
                f"no mode below {highest_frequency:g} Hz is coupled to the drive; raise the highest frequency"
            )
        if before is not None and before.size:
            error = float(np.abs(before / now[:, np.newaxis] - 1).min(axis=1).max())
            if error <= relative_tolerance:
                return _electromechanical_model(model, reduction, coordinates, axis, highest_frequency, error)
        before = _coupled_frequencies(reduction, highest_frequency, least_coupling * _FAINTER)
    raise AssertionError("the sequence of models is infinite")


def _refined_models(model_at: Callable[[float], Model], element_size: float) -> Iterator[Model]:
    """Infinite sequence of models: rising element orders on one mesh, then on a finer one."""
    for refinement in count_up():
        base = model_at(element_size * _REFINEMENT**refinement)
        for order in _ORDERS:
            yield replace(base, mesh=change_order(base.mesh, order=order))


def _coupled_frequencies(reduction: ReducedModel, highest_frequency: float, least_coupling: float) -> Floats:
    """Series frequencies in Hz of the coupled modes below a frequency."""
    series, _, coupling = coupled_resonances(reduction)
    return np.asarray(series[(coupling > least_coupling) & (series < highest_frequency)])


def _electromechanical_model(
    model: Model, reduction: ReducedModel, coordinates: Floats, axis: str, highest_frequency: float, error: float
) -> ElectromechanicalModel:
    """Electromechanical model with the named modes of a reduction."""
    series, parallel, coupling = coupled_resonances(reduction)
    reported = np.flatnonzero((coupling > _MIN_REPORTED) & (series < highest_frequency))
    _, vectors = np.linalg.eigh(reduction.stiffness.real)
    shapes = np.tensordot(vectors[:, reported].T, coordinates, axes=1)
    natural = NaturalModes(natural_frequency=series[reported], shapes=shapes, rigid_body_count=0)
    names = mode_names(model, natural, axis=axis)
    columns = (series[reported].tolist(), parallel[reported].tolist(), coupling[reported].tolist())
    return ElectromechanicalModel(
        model=model,
        reduction=reduction,
        modes=tuple(
            ElectromechanicalMode(name=name, series_frequency=fs, parallel_frequency=fp, coupling_factor=k)
            for name, fs, fp, k in zip(names, *columns, strict=True)
        ),
        shapes=shapes,
        frequency_error=error,
    )
