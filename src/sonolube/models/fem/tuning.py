"""Resonance tuning: a named mode on converged meshes, and the length of a body at which it has a target frequency."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.fem.mesh.element_order import change_order
from sonolube.models.fem.mesh.grading import grade_reentrant_edges
from sonolube.models.fem.mode_analysis import mode_names
from sonolube.models.fem.solver.model import Model
from sonolube.models.fem.solver.modes import NaturalModes, NotConverged, converged_modes, natural_modes

Advance = Callable[[str, int, int], None]
"""Progress callback: description, number of completed steps, expected number of steps."""

_COARSE_ORDER, _FINE_ORDER = 2, 3  # element orders of the search and of its first correction
_COARSE_TOLERANCE = 3e-3  # of the frequency: reproducibility of free meshes of one element size at the coarse order
_TOLERANCE = 5e-4  # of the frequency, of the result
_MAX_STEPS = 12
_FIRST_STEP, _LARGEST_STEP = 0.05, 0.2  # of the length; the first must exceed the scatter between meshes
_DIFFERENCE = 0.06  # of the length, to either side for the slope, large against the scatter between meshes
_MAX_CORRECTIONS = 5
_FARTHEST = 10.0  # length after a correction over that before, at which the frequency hardly depends on it
_NO_LENGTH = "no length near {start:.4g} m gives {target:g} Hz; start nearer to the solution, or tune another size"


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class NamedMode:
    """Natural mode identified by its name, with the frequency converged over meshes.

    Parameters
    ----------
    model : Model
        Finite-element model on the last mesh.
    modes : NaturalModes
        Natural modes on the last mesh.
    names : tuple of str
        Their names.
    row : int
        Index of the named mode among them.
    frequency : float
        Its frequency, extrapolated to infinite element order. [Hz]
    frequency_error : float
        Estimated relative error of this. []
    """

    model: Model
    modes: NaturalModes
    names: tuple[str, ...]
    row: int
    frequency: float
    frequency_error: float

    @property
    def displacement(self) -> Floats:
        """Mode shape: displacements of the nodes, shape (n, 3), normalised to a modal mass of 1 kg."""
        return np.asarray(self.modes.shapes[self.row])


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class TunedMode:
    """Length at which a named mode has the target frequency.

    Parameters
    ----------
    length : float
        The length found. [m]
    mode : NamedMode
        The mode at that length.
    frequency_per_length : float
        Derivative of its frequency with respect to the length. [Hz/m]
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
    """Natural mode of a given name with its frequency within a tolerance, by hp-refinement.

    Parameters
    ----------
    model_at : callable
        From the largest element edge in m to the finite-element model on such a mesh.
    name : str
        Name of the mode, such as "axial 1".
    axis : str
        Axis of the body, "x", "y" or "z".
    element_size : float
        Largest element edge of the first mesh. [m]
    count : int
        Number of elastic modes to compute and name.
    relative_tolerance : float
        Largest estimated relative error of the frequency; other modes may be less accurate.
    most_nodes : int
        Largest admissible number of nodes.
    advance : callable, optional
        Progress callback, called with a description, the number of completed steps and the expected number.

    Returns
    -------
    NamedMode

    Raises
    ------
    InvalidInput
        If no mode computed has this name.
    NotConverged
        If the next mesh would have more than `most_nodes` nodes.

    See Also
    --------
    sonolube.models.fem.solver.modes.converged_modes : All modes within a tolerance.
    sonolube.models.fem.mode_analysis.mode_names : The names.
    """

    def index(model: Model, modes: NaturalModes) -> int:
        return _mode_index(mode_names(model, modes, axis=axis), name)

    found = converged_modes(
        model_at,
        count=count,
        element_size=element_size,
        relative_tolerance=relative_tolerance,
        most_nodes=most_nodes,
        required_modes=lambda model, modes: (index(model, modes),),
        advance=advance,
    )
    row = index(found.model, found.modes)
    return NamedMode(
        model=found.model,
        modes=found.modes,
        names=mode_names(found.model, found.modes, axis=axis),
        row=row,
        frequency=float(found.natural_frequency[row]),
        frequency_error=float(found.frequency_error[row]),
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
    """Length at which the mode of a given name has a target frequency, by a bracketed secant method.

    Parameters
    ----------
    model_at : callable
        From the length and the largest element edge, both in m, to the finite-element model.
    name : str
        Name of the mode, such as "axial 1".
    axis : str
        Axis of the body, "x", "y" or "z".
    frequency : float
        Target frequency. [Hz]
    length : float
        Initial length. [m]
    element_size : float
        Largest element edge of the first mesh. [m]
    count : int
        Number of elastic modes to compute and name.
    relative_tolerance : float
        Largest estimated relative error of the frequency.
    advance : callable, optional
        Progress callback, called with a description, the number of completed steps and the expected number.

    Returns
    -------
    TunedMode
        Its frequency differs from the target by at most 5e-4 of it, or by its estimated error.

    Raises
    ------
    InvalidInput
        If no mode computed has this name.
    NotConverged
        If no length near the initial one has the target frequency.

    Notes
    -----
    The secant search uses elements of order two. Its result is corrected by Newton steps with the slope found: first
    for the difference to order three on the same mesh, then for that to the converged frequency. Bodies are meshed at
    lengths of seven digits: a free mesh can change with the last bit of a length, and so with the order of summation.
    """
    require_positive(frequency=frequency, length=length, element_size=element_size)

    def frequency_at(length: float, order: int = _COARSE_ORDER) -> float:
        model = model_at(_seven_digits(length), element_size)
        model = replace(model, mesh=change_order(grade_reentrant_edges(model.mesh, levels=1), order=order))
        modes = natural_modes(model, count=count)
        if advance:
            advance(f"{length * 1e3:.2f} mm", 0, 1)
        return float(modes.natural_frequency[_mode_index(mode_names(model, modes, axis=axis), name)])

    found = _secant_length(frequency_at, frequency, length)
    shorter, longer = found * (1 - _DIFFERENCE), found * (1 + _DIFFERENCE)
    exponent = float(np.log(frequency_at(longer) / frequency_at(shorter)) / np.log(longer / shorter))
    slope = exponent * frequency / found
    found = _corrected(found, frequency_at(found, _FINE_ORDER) - frequency, slope, frequency)
    for _ in range(_MAX_CORRECTIONS):
        found = _seven_digits(found)
        mode = named_mode(
            lambda size, at=found: model_at(at, size),  # type: ignore[misc]
            name=name,
            axis=axis,
            count=count,
            element_size=element_size,
            relative_tolerance=relative_tolerance,
            advance=advance,
        )
        difference = mode.frequency - frequency
        if abs(difference) <= max(_TOLERANCE, mode.frequency_error) * frequency:
            return TunedMode(length=found, mode=mode, frequency_per_length=slope)
        found = _corrected(found, difference, slope, frequency)
    raise NotConverged(
        f"{name} came within {abs(difference):.3g} Hz of {frequency:g} Hz; request a smaller relative_tolerance"
    )


def _seven_digits(length: float) -> float:
    """Length rounded to seven significant digits."""
    return float(f"{length:.6e}")


def _corrected(length: float, difference: float, slope: float, target: float) -> float:
    """Length after a Newton step against a difference of frequency, refused where it is far from the one before."""
    corrected = length - difference / slope if slope else np.inf
    if not length / _FARTHEST < corrected < _FARTHEST * length:
        raise NotConverged(_NO_LENGTH.format(start=length, target=target))
    return corrected


def _mode_index(names: tuple[str, ...], name: str) -> int:
    """Index of a name among those of modes."""
    if name not in names:
        elastic = [name for name in names if not name.startswith("rigid")]
        raise InvalidInput(f"no mode called {name!r} among the first {len(elastic)}: {', '.join(elastic)}")
    return names.index(name)


def _secant_length(frequency_at: Callable[[float], float], target: float, start: float) -> float:
    """Length of a target frequency by the secant method within a bracket; the frequency falls with the length."""
    length, difference = start, frequency_at(start) / target - 1
    candidate = length * (1 + float(np.sign(difference) * np.clip(abs(difference), _FIRST_STEP, _LARGEST_STEP)))
    lower, upper = 0.0, np.inf  # lengths known to be too short and too long
    for _ in range(_MAX_STEPS):
        if abs(difference) < _COARSE_TOLERANCE:
            return length
        lower, upper = (max(lower, length), upper) if difference > 0 else (lower, min(upper, length))
        last_length, last_difference = length, difference
        length, difference = candidate, frequency_at(candidate) / target - 1
        slope = (difference - last_difference) / (length - last_length) if length != last_length else -1 / length
        step = -difference / slope if slope < 0 else difference * length
        candidate = length + float(np.clip(step, -_LARGEST_STEP * length, _LARGEST_STEP * length))
        low, high = (max(lower, length), upper) if difference > 0 else (lower, min(upper, length))
        candidate = candidate if low < candidate < high else (low + min(high, 2 * length)) / 2
    raise NotConverged(_NO_LENGTH.format(start=start, target=target))
