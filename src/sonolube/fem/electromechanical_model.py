"""A piezoelectric body seen from its wires: its electrical modes, on meshes refined until they stand still."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import count as count_up

import numpy as np

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.fem.classification import mode_names
from sonolube.fem.solver.element_order import change_order
from sonolube.fem.solver.harmonic_analysis import Output, ReducedModel
from sonolube.fem.solver.krylov import krylov_reduction
from sonolube.fem.solver.model import Model
from sonolube.fem.solver.modes import NaturalModes, NotConverged

_REFINEMENT = 0.62  # of the element size from mesh to mesh
_ORDERS = range(2, 6)  # on one mesh; the next is a finer one
_FAINTER = 0.3  # of the coupling factor asked for, from which a mode on the mesh before may be the same
_LEAST_TOLD = 0.01  # coupling factor from which a mode counts as driven
_RIGID = 1e-9  # square of frequency over the largest, below which a motion is rigid
_UNDRIVEN = 1e-3  # square of the coupling factor below which a mode is not paired


@dataclass(frozen=True, kw_only=True, slots=True)
class ElectromechanicalMode:
    """A mode between its two frequencies.

    Parameters
    ----------
    name : str
        Such as "axial 1".
    series_frequency : float
        Resonance, short-circuited. [Hz]
    parallel_frequency : float
        Resonance, open-circuited. [Hz]
    coupling_factor : float
        Effective coupling factor, sqrt(1 - (f_s/f_p)^2). []
    """

    name: str
    series_frequency: float
    parallel_frequency: float
    coupling_factor: float


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ElectromechanicalModel:
    """A body in few coordinates, and its electrical modes.

    Parameters
    ----------
    model : Model
        On the finest mesh.
    reduction : ReducedModel
    modes : tuple of ElectromechanicalMode
        Modes in the range that the drive moves, by frequency; their names count these alone.
    shapes : ndarray, shape (k, n, 3)
        Displacements of the nodes in each of them, of a modal mass of 1 kg.
    frequency_error : float
        Relative change of the series frequencies of the coupled modes with the last rise of order, the largest. []
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
    """Return a driven body on a mesh that refinement no longer changes by more than a tolerance.

    Parameters
    ----------
    model_at : callable
        From the largest edge of an element in m to the model on such a mesh.
    outputs : mapping of str to Output
        What to observe.
    axis : str
        The body's axis, for the names of modes.
    highest_frequency : float
        Highest frequency at which the reduction is asked. [Hz]
    element_size : float
        Largest edge of an element in the first mesh. [m]
    relative_tolerance : float
        Largest change of a coupled mode's frequency from order to order.
    least_coupling : float
        Effective coupling factor from which a mode counts as coupled.
    most_nodes : int
        Meshes with more nodes than this are not tried.
    advance : callable, optional
        Told what is being done, how many meshes are done and of how many, as far as one knows.

    Returns
    -------
    Port

    Raises
    ------
    InvalidInput
        If no mode in the range is coupled to the drive.
    NotConverged
        If the next mesh would have more than `most_nodes` nodes.
    """
    require_positive(highest_frequency=highest_frequency, element_size=element_size)
    before: Floats | None = None
    error = np.inf
    for model in _finer_and_finer(model_at, element_size):
        if model.mesh.node_count > most_nodes:
            raise NotConverged(
                f"coupled modes still move by {error:.2g} of their frequency; the next mesh has "
                f"{model.mesh.node_count} nodes: allow more of them, or a larger change"
            )
        reduction, coordinates = krylov_reduction(model, outputs=outputs, highest_frequency=highest_frequency)
        if advance:
            advance(f"{model.mesh.node_count} nodes", 1, 2)
        now = _coupled(reduction, highest_frequency, least_coupling)
        if not now.size:
            raise InvalidInput(f"no mode below {highest_frequency:g} Hz is coupled to the drive; look higher")
        if before is not None and before.size:
            error = float(np.abs(before / now[:, np.newaxis] - 1).min(axis=1).max())
            if error <= relative_tolerance:
                return _port(model, reduction, coordinates, axis, highest_frequency, error)
        before = _coupled(reduction, highest_frequency, least_coupling * _FAINTER)
    raise AssertionError("models never end")


def _finer_and_finer(model_at: Callable[[float], Model], element_size: float) -> Iterator[Model]:
    """Yield models of rising order on one mesh, and then on a finer one, without end."""
    for refinement in count_up():
        base = model_at(element_size * _REFINEMENT**refinement)
        for order in _ORDERS:
            yield replace(base, mesh=change_order(base.mesh, order=order))


def coupled_resonances(model: ReducedModel) -> tuple[Floats, Floats, Floats]:
    """Return series and parallel resonances in Hz and effective coupling factors, idle modes kept out of the pairs.

    Parameters
    ----------
    model : ReducedModel

    Returns
    -------
    tuple of three ndarray, shape (k,)
        As `resonances_of` gives them, but for modes that the voltage does not drive: they stay where they are, though
        they lie between the two frequencies of one that it drives.
    """
    squares, shapes = np.linalg.eigh(model.stiffness.real)
    drive = shapes.T @ model.drive.real
    capacitance = model.clamped_capacitance.real
    squares = np.where(squares > _RIGID * squares.max(), squares, 0.0)
    driven = drive**2 > _UNDRIVEN * capacitance * squares
    driven &= squares > 0
    own = drive[driven]
    opened = squares.copy()
    opened[driven] = np.linalg.eigvalsh(np.diag(squares[driven]) + np.outer(own, own) / capacitance)
    ratio = np.divide(squares, opened, out=np.ones_like(opened), where=opened > 0)
    coupling = np.sqrt(np.clip(1 - ratio, 0.0, 1.0))
    return np.sqrt(squares) / (2 * np.pi), np.sqrt(opened) / (2 * np.pi), coupling


def _coupled(reduction: ReducedModel, highest_frequency: float, least_coupling: float) -> Floats:
    """Return the series frequencies of the coupled modes below a frequency."""
    series, _, coupling = coupled_resonances(reduction)
    return np.asarray(series[(coupling > least_coupling) & (series < highest_frequency)])


def _port(
    model: Model, reduction: ReducedModel, coordinates: Floats, axis: str, highest_frequency: float, error: float
) -> ElectromechanicalModel:
    series, parallel, coupling = coupled_resonances(reduction)
    told = np.flatnonzero((coupling > _LEAST_TOLD) & (series < highest_frequency))
    _, mixtures = np.linalg.eigh(reduction.stiffness.real)
    shapes = np.tensordot(mixtures[:, told].T, coordinates, axes=1)
    names = mode_names(
        model, NaturalModes(natural_frequency=series[told], shapes=shapes, rigid_body_count=0), axis=axis
    )
    modes = zip(names, series[told].tolist(), parallel[told].tolist(), coupling[told].tolist(), strict=True)
    return ElectromechanicalModel(
        model=model,
        reduction=reduction,
        modes=tuple(
            ElectromechanicalMode(name=name, series_frequency=fs, parallel_frequency=fp, coupling_factor=k)
            for name, fs, fp, k in modes
        ),
        shapes=shapes,
        frequency_error=error,
    )
