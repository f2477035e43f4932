"""Response curves over voltage or frequency, by pseudo-arclength continuation through folds."""

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Complexes, Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.dynamics.gap_laws.closed_form import GapLaw, force_decay_length
from sonolube.models.dynamics.harmonic_balance.equations import HarmonicBalanceEquations, pole_residue_model
from sonolube.models.dynamics.harmonic_balance.extrema import response_measures
from sonolube.models.dynamics.harmonic_balance.floquet_exponent import STABILITY_THRESHOLD, floquet_exponents
from sonolube.models.dynamics.linear import modes
from sonolube.models.dynamics.motions import Status
from sonolube.models.dynamics.steady_state_response import steady_state
from sonolube.models.dynamics.structure import Structure, with_contact_spring

_CORRECTOR_TOLERANCE = 1e-10  # last corrector step, in decay lengths of the contact
_CORRECTOR_STEPS = 8
_SHORTEST, _LONGEST = 1e-7, 0.1  # arclength steps, in decay lengths and units of the parameter
_WIDEST = 0.5  # of the parameter in one step, in its units
_UNITS = 4, 2000  # fewest and most units in the range of the parameter
_LARGEST_TURN, _SMALL_TURN = 0.95, 0.99  # cosines between successive tangents: shorten below, lengthen above


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ResponseCurve:
    """Steady vibrations along a response curve, in the order of continuation.

    Parameters
    ----------
    along : {"voltage", "frequency"}
        Continuation parameter.
    voltage_amplitude : ndarray, shape (n,)
        Amplitude of the sinusoidal drive. [V]
    frequency : ndarray, shape (n,)
        Frequency of the drive. [Hz]
    mean_displacement : ndarray, shape (n,)
        Mean displacement of the contact. [m]
    harmonics : ndarray of complex, shape (n, H)
        Harmonics of the contact's displacement, in m.
    vibration_amplitude : ndarray, shape (n,)
        Half of the peak-to-peak displacement. [m]
    stable : ndarray of bool, shape (n,)
        Whether all Floquet multipliers lie within the unit circle.
    complete : bool
        Whether the curve reached the end of its range.
    equations : HarmonicBalanceEquations
        Equations that the points of the curve satisfy.
    """

    along: Literal["voltage", "frequency"]
    voltage_amplitude: Floats
    frequency: Floats
    mean_displacement: Floats
    harmonics: Complexes
    vibration_amplitude: Floats
    stable: NDArray[np.bool_]
    complete: bool
    equations: HarmonicBalanceEquations

    @property
    def parameter(self) -> Floats:
        """Continuation parameter: voltage amplitude, in V, or frequency, in Hz."""
        return self.voltage_amplitude if self.along == "voltage" else self.frequency

    @property
    def folds(self) -> NDArray[np.intp]:
        """Indices of the folds, where the parameter reverses its direction."""
        direction = np.sign(np.diff(self.parameter))
        return 1 + np.flatnonzero(direction[1:] * direction[:-1] < 0)


def response_curve(
    structure: Structure,
    gap_law: GapLaw,
    *,
    normal_load: float,
    voltage_amplitude: float | tuple[float, float],
    frequency: float | tuple[float, float],
    orders: int = 12,
    most_points: int = 4000,
) -> ResponseCurve:
    r"""Steady vibration along a range of voltage or frequency, by pseudo-arclength continuation.

    Parameters
    ----------
    structure : Structure
    gap_law : GapLaw
    normal_load : float
        Dead load on the contact. [N]
    voltage_amplitude : float or pair of float
        Amplitude of the sinusoidal drive; a pair is the start and the end of the curve. [V]
    frequency : float or pair of float
        Frequency of the drive; a pair is the start and the end of the curve. [Hz]
    orders : int
        Number of harmonics of the contact.
    most_points : int
        Number of points after which the curve is left incomplete.

    Returns
    -------
    ResponseCurve

    Raises
    ------
    InvalidInput
        If not exactly one of voltage and frequency is a pair, a value is not positive, or no vibration was found at the
        start.

    See Also
    --------
    solutions_at, reached_by_ramp, steady_state

    Notes
    -----
    With the residual R of harmonic balance, the scaled unknowns and parameter y, and the unit tangent t at the last
    point :math:`y_0`, the next point solves

    .. math:: R(y) = 0, \qquad t \cdot (y - y_0) = \Delta s

    by Newton's method, which stays regular at folds [1]_. Stability is that of `floquet_exponents`.

    References
    ----------
    .. [1] H. B. Keller, in Applications of Bifurcation Theory, ed. P. H. Rabinowitz, Academic Press 1977, 359-384.
    """
    load = float(require_positive(normal_load=normal_load))
    volts, hertz = require_positive(voltage_amplitude=voltage_amplitude), require_positive(frequency=frequency)
    if sorted((volts.shape, hertz.shape)) != [(), (2,)]:
        raise InvalidInput("give a pair, start and end of the curve, for either voltage_amplitude or frequency")
    along: Literal["voltage", "frequency"] = "voltage" if volts.shape else "frequency"
    first, last = (float(values) for values in (volts if along == "voltage" else hertz))
    equations = HarmonicBalanceEquations(
        structure=structure,
        gap_law=gap_law,
        normal_load=load,
        voltage_harmonics=np.ones(1, dtype=np.complex128),
        voltage_offset=0.0,
        orders=orders,
        samples=max(8 * orders, 512) if gap_law.has_corner else 8 * orders,
    )
    start = steady_state(
        structure, gap_law, normal_load=load, frequency=hertz.flat[0], voltage_amplitude=volts.flat[0], stability=False
    )
    if start.status == Status.NOT_CONVERGED:
        raise InvalidInput(f"no vibration was found at the start of the curve; {start.reason(())}")
    path = _Path(
        equations=equations,
        along=along,
        fixed=float(hertz if along == "voltage" else volts),
        first=first,
        last=last,
        length=float(force_decay_length(gap_law, load)),
        unit=_unit(structure, gap_law, load, (first, last)) if along == "frequency" else (last - first) / _UNITS[0],
    )
    rows = list(path.follow(equations.stack(float(start.mean_displacement), start.harmonics), most_points))
    ends = abs(rows[-1][-1]), abs(rows[-1][-1] - path.end)
    return _curve(path, np.array(rows), complete=len(rows) > 1 and bool(min(ends) < 1e-9 * path.end))


def _unit(structure: Structure, gap_law: GapLaw, load: float, ends: tuple[float, float]) -> float:
    """Half of the narrowest bandwidth of the modes in contact near a range of frequency, signed as the range. [Hz]"""
    first, last = ends
    spring = load / float(force_decay_length(gap_law, load))
    found = modes(with_contact_spring(structure, normal_stiffness=spring))
    frequency, width = found.natural_frequency, found.natural_frequency * found.damping_ratio
    near = width[(frequency > min(ends) / 2) & (frequency < 2 * max(ends))]
    few, many = _UNITS
    span = abs(last - first)
    return float(np.copysign(np.clip(near.min(initial=span), span / many, span / few), last - first))


def solutions_at(curve: ResponseCurve, *, at: float) -> ResponseCurve:
    """All steady vibrations of a response curve at one value of its parameter, in the curve's order.

    Parameters
    ----------
    curve : ResponseCurve
    at : float
        Voltage amplitude, in V, or frequency, in Hz.

    Returns
    -------
    ResponseCurve
        One point for each time the curve passes the value.

    See Also
    --------
    reached_by_ramp
    """
    path = _path_of(curve)
    before, after = curve.parameter[:-1] - at, curve.parameter[1:] - at
    passed = np.flatnonzero((before * after < 0) | (before == 0))
    rows = [path.solve_at(_interpolated(curve, int(i), at), path.units(at)) for i in passed]
    if curve.parameter[-1] == at:
        rows.append(path.solve_at(_row(curve, -1), path.units(at)))
    found = [row for row in rows if row is not None]
    return _curve(path, np.array(found).reshape(len(found), 2 * curve.equations.orders + 2), complete=curve.complete)


def reached_by_ramp(curve: ResponseCurve, *, at: float, backward: bool = False) -> ResponseCurve:
    """Steady vibration at the end of a slow ramp of the parameter, with jumps at the folds.

    Parameters
    ----------
    curve : ResponseCurve
    at : float
        Voltage amplitude, in V, or frequency, in Hz, at the end of the ramp.
    backward : bool
        Whether the ramp started at the end of the curve rather than at its start.

    Returns
    -------
    ResponseCurve
        Of one point.

    Raises
    ------
    InvalidInput
        If the curve does not reach the value.

    See Also
    --------
    solutions_at

    Notes
    -----
    At a fold the vibration is assumed to jump to the next point of the curve at the same parameter.
    """
    found = solutions_at(curve, at=at)
    if not found.parameter.size:
        raise InvalidInput(f"the curve does not reach {curve.along} {at:.6g}")
    chosen = slice(-1, None) if backward else slice(0, 1)
    values: dict[str, Any] = {each.name: getattr(found, each.name) for each in fields(found)}
    points = [name for name, value in values.items() if isinstance(value, np.ndarray)]
    return replace(found, **{name: values[name][chosen] for name in points})


@dataclass(frozen=True, kw_only=True, slots=True)
class _Path:
    """Solution curve in dimensionless form: unknowns over the decay length, the parameter from its begin in units."""

    equations: HarmonicBalanceEquations
    along: Literal["voltage", "frequency"]
    fixed: float  # the other parameter, in V or Hz
    first: float
    last: float
    length: float
    unit: float

    @property
    def end(self) -> float:
        """Units from the begin to the end of the range."""
        return self.units(self.last)

    def units(self, parameter: float) -> float:
        return (parameter - self.first) / self.unit

    def parameter(self, units: Floats) -> Floats:
        return self.first + units * self.unit

    def linearise(self, y: Floats) -> tuple[Floats, Floats]:
        """Residual and its derivatives, the last column by the parameter."""
        value = float(self.parameter(y[-1]))
        volts, hertz = (value, self.fixed) if self.along == "voltage" else (self.fixed, value)
        balance = self.equations.at(y[:-1] * self.length, omega=2 * np.pi * hertz, scale=volts)
        rate = balance.by_scale if self.along == "voltage" else 2 * np.pi * balance.by_omega
        unit = np.full(y.size - 1, self.length)
        unit[0] = self.equations.normal_load
        matrix = np.column_stack([balance.jacobian * self.length, rate * self.unit])
        return balance.residual / unit, matrix / unit[:, np.newaxis]

    def correct(self, y: Floats, normal: Floats, offset: float) -> Floats | None:
        """Point of the curve in the plane normal . y = offset, or None if Newton's method fails."""
        for _ in range(_CORRECTOR_STEPS):
            residual, matrix = self.linearise(y)
            step = np.linalg.solve(np.vstack([matrix, normal]), np.append(residual, normal @ y - offset))
            y = y - step
            if not np.all(np.isfinite(y)):
                return None
            if np.abs(step).max() < _CORRECTOR_TOLERANCE:
                return y
        return None

    def solve_at(self, y: Floats, units: float) -> Floats | None:
        """Nearby point of the curve at a value of the parameter, or None if Newton's method fails."""
        return self.correct(y, np.eye(y.size)[-1], units)

    def tangent(self, y: Floats, previous: Floats) -> Floats:
        """Unit tangent at a point, in the direction of the previous one."""
        _, matrix = self.linearise(y)
        direction = np.linalg.solve(np.vstack([matrix, previous]), np.append(np.zeros(y.size - 1), 1.0))
        return np.asarray(direction / np.linalg.norm(direction))

    def follow(self, start: Floats, most_points: int) -> Iterator[Floats]:
        """Yield the points of the curve, from the begin until it leaves the range."""
        y = self.solve_at(np.append(start / self.length, 0.0), 0.0)
        if y is None:
            raise InvalidInput("orders are too few for the vibration at the start of the curve; take more")
        yield y
        tangent, step = self.tangent(y, np.eye(y.size)[-1]), _LONGEST / 10
        for _ in range(most_points - 1):
            found, turned, step = self._next(y, tangent, step)
            if found is None:
                return
            if not 0.0 <= found[-1] <= self.end:
                edge = self.end if found[-1] > self.end else 0.0
                weight = (edge - y[-1]) / (found[-1] - y[-1])
                final = self.solve_at(y + weight * (found - y), edge)
                if final is not None:
                    yield final
                return
            y, tangent = found, turned
            yield y

    def _next(self, y: Floats, tangent: Floats, step: float) -> tuple[Floats | None, Floats, float]:
        """Next point, its tangent and the arclength step to try from there."""
        step = min(step, _WIDEST / max(abs(float(tangent[-1])), _WIDEST))
        while step > _SHORTEST:
            found = self.correct(y + step * tangent, tangent, float(tangent @ y) + step)
            if found is not None:
                turned = self.tangent(found, tangent)
                if turned @ tangent > _LARGEST_TURN:
                    return found, turned, self._longer(step, turned) if turned @ tangent > _SMALL_TURN else step
            step /= 2
        return None, tangent, step

    def _longer(self, step: float, tangent: Floats) -> float:
        """Longer step that neither the vibration nor the parameter changes too much in."""
        along, vibration = abs(float(tangent[-1])), float(np.linalg.norm(tangent[:-1]))
        return min(1.5 * step, _LONGEST / max(vibration, _LONGEST), _WIDEST / max(along, _WIDEST))


def _path_of(curve: ResponseCurve) -> _Path:
    """Dimensionless form of a response curve."""
    other = curve.frequency if curve.along == "voltage" else curve.voltage_amplitude
    return _Path(
        equations=curve.equations,
        along=curve.along,
        fixed=float(other[0]),
        first=float(curve.parameter[0]),
        last=float(curve.parameter[-1]),
        length=float(force_decay_length(curve.equations.gap_law, curve.equations.normal_load)),
        unit=float(curve.parameter[-1] - curve.parameter[0]) or 1.0,
    )


def _row(curve: ResponseCurve, index: int) -> Floats:
    """One point of a response curve in dimensionless form."""
    path = _path_of(curve)
    unknowns = curve.equations.stack(float(curve.mean_displacement[index]), curve.harmonics[index])
    return np.append(unknowns / path.length, path.units(float(curve.parameter[index])))


def _interpolated(curve: ResponseCurve, index: int, at: float) -> Floats:
    """Linear interpolation between a point and its successor at one value of the parameter."""
    before, after = curve.parameter[index], curve.parameter[index + 1]
    weight = (at - before) / (after - before)
    return (1 - weight) * _row(curve, index) + weight * _row(curve, index + 1)  # type: ignore[no-any-return]


def _curve(path: _Path, rows: Floats, *, complete: bool) -> ResponseCurve:
    """Response curve of points in dimensionless form, with their measures and stability."""
    own = path.equations
    mean, parameter = rows[:, 0] * path.length, path.parameter(rows[:, -1])
    harmonics = (rows[:, 1 : own.orders + 1] + 1j * rows[:, own.orders + 1 : -1]) * path.length
    other = np.full(mean.shape, path.fixed)
    volts, hertz = (parameter, other) if path.along == "voltage" else (other, parameter)
    loads, counts = np.full(mean.shape, own.normal_load), np.full(mean.shape, own.orders)
    motion = (own.gap_law, 2 * np.pi * hertz, loads, mean, harmonics, counts)
    measures = response_measures(*motion)  # type: ignore[arg-type]
    exponents = floquet_exponents(pole_residue_model(own.structure), *motion, 4 * counts)  # type: ignore[arg-type]
    return ResponseCurve(
        along=path.along,
        voltage_amplitude=volts,
        frequency=hertz,
        mean_displacement=mean,
        harmonics=harmonics,  # type: ignore[arg-type]
        vibration_amplitude=measures.vibration_amplitude,
        stable=exponents <= STABILITY_THRESHOLD,
        complete=complete,
        equations=own,
    )
