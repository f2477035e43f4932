"""A length tuned until a named mode rings at a frequency, and what a mass on a face does to it."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import eigh

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.errors import InvalidInput
from sonolube.fem.classification import mode_names
from sonolube.fem.solver.assembly import tributary_areas
from sonolube.fem.solver.convergence import converged_modes
from sonolube.fem.solver.element_order import change_order
from sonolube.fem.solver.grading import grade_reentrant_edges
from sonolube.fem.solver.harmonic_analysis import Output, output_matrix
from sonolube.fem.solver.model import DIRECTIONS, Model
from sonolube.fem.solver.modes import NaturalModes, NotConverged, natural_modes, spectral_shift
from sonolube.fem.solver.system import LinearSolver, SystemMatrices, assemble_system, shift_invert_solver

Advance = Callable[[str, int, int], None]

_COARSE_ORDER, _BETTER_ORDER = 2, 3
_COARSE = 3e-3  # of the frequency: as far as free meshes of one size agree at the lower order
_ON_TARGET = 5e-4
_STEPS = 12
_FIRST_STEP, _LARGEST_STEP = 0.05, 0.2  # of the length; the first must stand out from the meshes' scatter
_APART = 0.06  # of the length, at which lengths on both sides tell the slope in spite of the scatter
_CORRECTIONS = 5
_UNMOVED = 0.05  # square of the face's motion over the greatest, below which a mode is mixed at most
_FAR = 1e3  # square of the frequency that stands for all modes above, over the last's


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class NamedMode:
    """A mode of a name, followed over meshes until its frequency is known.

    Parameters
    ----------
    model : Model
        On the finest mesh.
    modes : NaturalModes
        On the finest mesh.
    names : tuple of str
        Their names.
    row : int
        Which of them it is.
    frequency : float
        Its frequency, extrapolated to elements of any order. [Hz]
    frequency_error : float
        Estimated error of that over itself. []
    """

    model: Model
    modes: NaturalModes
    names: tuple[str, ...]
    row: int
    frequency: float
    frequency_error: float

    @property
    def displacement(self) -> Floats:
        """Displacements of the nodes in the mode, shape (n, 3), of a modal mass of 1 kg."""
        return np.asarray(self.modes.shapes[self.row])


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class TunedMode:
    """A length at which a mode rings at a wanted frequency.

    Parameters
    ----------
    length : float
        The length found. [m]
    mode : NamedMode
        The mode at that length.
    frequency_per_length : float
        Change of its frequency with the length. [Hz/m]
    """

    length: float
    mode: NamedMode
    frequency_per_length: float


def named_mode(
    model_at: Callable[[float], Model],
    *,
    name: str,
    axis: str,
    element_size: float,
    count: int = 12,
    relative_tolerance: float = 3e-3,
    most_nodes: int = 60_000,
    advance: Advance | None = None,
) -> NamedMode:
    """Return the mode of a name as well known as asked; other modes may be less well known.

    Parameters
    ----------
    model_at : callable
        From the largest edge of an element in m to the model on such a mesh.
    name : str
        Such as "axial 1".
    axis : str
        The body's axis.
    element_size : float
        Largest edge of an element in the first mesh. [m]
    count : int
        Number of elastic modes to look at.
    relative_tolerance : float
        Largest estimated relative error of the frequency.
    most_nodes : int
        Meshes with more nodes than this are not tried.
    advance : callable, optional
        Told what is being done, how many meshes are done and of how many, as far as one knows.

    Returns
    -------
    NamedMode

    Raises
    ------
    InvalidInput
        If there is no mode of this name.
    NotConverged
        If the next mesh would have more than `most_nodes` nodes.
    """

    def row(model: Model, modes: NaturalModes) -> int:
        return _row(mode_names(model, modes, axis=axis), name)

    found = converged_modes(
        model_at,
        count=count,
        element_size=element_size,
        relative_tolerance=relative_tolerance,
        most_nodes=most_nodes,
        judged=lambda model, modes: (row(model, modes),),
        advance=advance,
    )
    own = row(found.model, found.modes)
    return NamedMode(
        model=found.model,
        modes=found.modes,
        names=mode_names(found.model, found.modes, axis=axis),
        row=own,
        frequency=float(found.natural_frequency[own]),
        frequency_error=float(found.frequency_error[own]),
    )


def tuned_mode(
    model_at: Callable[[float, float], Model],
    *,
    name: str,
    axis: str,
    frequency: float,
    length: float,
    element_size: float,
    count: int = 12,
    relative_tolerance: float = 3e-3,
    advance: Advance | None = None,
) -> TunedMode:
    """Return the length at which the mode of a name has a frequency.

    Parameters
    ----------
    model_at : callable
        From the length and the largest edge of an element, both in m, to the model.
    name : str
        Such as "axial 1".
    axis : str
        The body's axis.
    frequency : float
        Frequency wanted. [Hz]
    length : float
        Length to start from. [m]
    element_size : float
        Largest edge of an element in the first mesh. [m]
    count : int
        Number of elastic modes to look at.
    relative_tolerance : float
        Largest estimated relative error of the frequency.
    advance : callable, optional
        Told what is being done, how many steps are done and of how many, as far as one knows.

    Returns
    -------
    TunedMode
        Its frequency is within 5e-4 of the one wanted, or within its error.

    Raises
    ------
    InvalidInput
        If there is no mode of this name.
    NotConverged
        If no length near the start gives the frequency.

    Notes
    -----
    The secant method, kept in the bracket once there is one, with elements of order two. Order three tells by how much
    these are off, and the length is corrected for that and last for what the refined mesh says.
    """
    require_positive(frequency=frequency, length=length, element_size=element_size)

    def at_order(at: float, order: int) -> float:
        model = model_at(at, element_size)
        model = replace(model, mesh=change_order(grade_reentrant_edges(model.mesh, levels=1), order=order))
        modes = natural_modes(model, count=count)
        if advance:
            advance(f"{at * 1e3:.2f} mm", 0, 1)
        return float(modes.natural_frequency[_row(mode_names(model, modes, axis=axis), name)])

    def coarse(at: float) -> float:
        return at_order(at, _COARSE_ORDER)

    place = _secant(coarse, frequency, length)
    shorter, longer = place * (1 - _APART), place * (1 + _APART)
    slope = float(np.log(coarse(longer) / coarse(shorter)) / np.log(longer / shorter)) * frequency / place
    place -= (at_order(place, _BETTER_ORDER) - frequency) / slope
    for _ in range(_CORRECTIONS):
        mode = named_mode(
            lambda size, at=place: model_at(at, size),  # type: ignore[misc]
            name=name,
            axis=axis,
            count=count,
            element_size=element_size,
            relative_tolerance=relative_tolerance,
            advance=advance,
        )
        missed = mode.frequency - frequency
        if abs(missed) <= max(_ON_TARGET, mode.frequency_error) * frequency:
            return TunedMode(length=place, mode=mode, frequency_per_length=slope)
        place -= missed / slope
    raise NotConverged(f"{name} came within {abs(missed):.3g} Hz of {frequency:g} Hz; allow less error of the meshes")


def mass_loaded_frequencies(
    modes: NaturalModes,
    model: Model,
    *,
    face: str,
    along: str,
    tool_mass: float,
    residual_compliance: float | None = None,
) -> Floats:
    """Return natural frequencies in Hz with a rigid mass on a face that moves with its mean in one direction.

    Parameters
    ----------
    modes : NaturalModes
    model : Model
        Whose modes they are.
    face : str
        Where the mass sits.
    along : str
        Direction in which it counts, "x", "y" or "z".
    tool_mass : float
        Mass. [kg]
    residual_compliance : float, optional
        What `face_residual_compliance` returns, on a coarser mesh perhaps; found where absent. [m/N]

    Returns
    -------
    ndarray, shape (k,)
        In the order of the modes.

    Notes
    -----
    What the modes above those given yield to the mass is one static solution, taken as one more mode far above.
    """
    mass = float(require_non_negative(tool_mass=tool_mass))
    moves = _face_moves(modes, model, face, along)
    squares = (2 * np.pi * modes.natural_frequency) ** 2
    if residual_compliance is None:
        equations = assemble_system(model)
        inverse = shift_invert_solver(model, equations, shift=spectral_shift(model))
        residual_compliance = face_residual_compliance(modes, model, equations, inverse=inverse, face=face, along=along)
    above = _FAR * squares.max()
    squares, moves = np.append(squares, above), np.append(moves, np.sqrt(max(residual_compliance, 0.0) * above))
    yielding = moves**2 > _UNMOVED * np.max(moves[:-1] ** 2)  # a mass lowers these without changing their order
    own = moves[yielding]
    squares[yielding] = eigh(
        np.diag(squares[yielding]), np.eye(len(own)) + mass * np.outer(own, own), eigvals_only=True
    )
    return np.asarray(np.sqrt(np.maximum(squares[:-1], 0.0)) / (2 * np.pi))


def face_residual_compliance(
    modes: NaturalModes, model: Model, equations: SystemMatrices, *, inverse: LinearSolver, face: str, along: str
) -> float:
    """Return how far a face yields to a force spread over it by all modes above those given.

    Parameters
    ----------
    modes : NaturalModes
    model : Model
    equations : System
    inverse : callable
        What `shift_invert_solver` returns for the shift of `spectral_shift`.
    face : str
        Where the force acts.
    along : str
        Its direction, "x", "y" or "z".

    Returns
    -------
    float
        In m/N.
    """
    pull = output_matrix(model, equations, {"face": Output(face=face, along=along)})[0]
    squares = (2 * np.pi * modes.natural_frequency) ** 2
    known = np.sum(_face_moves(modes, model, face, along) ** 2 / (squares - spectral_shift(model)))
    return float(pull @ inverse(pull) - known)


def _face_moves(modes: NaturalModes, model: Model, face: str, along: str) -> Floats:
    """Return the mean displacement of a face in each mode."""
    weights = tributary_areas(model.mesh, face)
    return np.asarray(modes.shapes[:, :, DIRECTIONS.index(along)] @ weights / weights.sum())


def _row(names: tuple[str, ...], mode: str) -> int:
    if mode not in names:
        elastic = [name for name in names if not name.startswith("rigid")]
        raise InvalidInput(f"no mode called {mode!r} among the first {len(elastic)}: {', '.join(elastic)}")
    return names.index(mode)


def _secant(frequency_at: Callable[[float], float], wanted: float, start: float) -> float:
    """Return a length at which the frequency is the one wanted; frequencies fall as the length grows."""
    place, missed = start, frequency_at(start) / wanted - 1
    other = place * (1 + float(np.sign(missed) * np.clip(abs(missed), _FIRST_STEP, _LARGEST_STEP)))
    below, above = 0.0, np.inf  # lengths known to be too short and too long
    for _ in range(_STEPS):
        if abs(missed) < _COARSE:
            return place
        below, above = (max(below, place), above) if missed > 0 else (below, min(above, place))
        last, last_missed = place, missed
        place, missed = other, frequency_at(other) / wanted - 1
        slope = (missed - last_missed) / (place - last) if place != last else -1 / place
        step = -missed / slope if slope < 0 else missed * place
        other = place + float(np.clip(step, -_LARGEST_STEP * place, _LARGEST_STEP * place))
        low, high = (max(below, place), above) if missed > 0 else (below, min(above, place))
        other = other if low < other < high else (low + min(high, 2 * place)) / 2
    raise NotConverged(f"no length near {start:.4g} m rings at {wanted:g} Hz; start nearer, or change another size")
