"""Curves of steady vibration over voltage or frequency, followed by their arc length through every fold."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Complexes, Floats, require_positive
from sonolube.dynamics.gap_law import ExponentialGap, GapLaw, TabulatedGap, length_of_change
from sonolube.dynamics.harmonic_balance.extrema import measure
from sonolube.dynamics.harmonic_balance.floquet_exponent import GROWTH, growth
from sonolube.dynamics.harmonic_balance.receptance import contact_port
from sonolube.dynamics.harmonic_balance.residual import PointEquations
from sonolube.dynamics.steady_state import Status, steady_state
from sonolube.dynamics.structure import Structure
from sonolube.errors import InvalidInput

_EXACT = 1e-10  # last step of a corrector, in reaches of the contact
_CORRECTIONS = 8
_SHORTEST, _LONGEST = 1e-7, 0.1  # steps, in shares of the parameter's range and reaches of the contact
_TURN = 0.95  # cosine between neighbouring tangents below which steps shorten


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ResponseCurve:
    """Steady vibrations along a curve, in the order in which it was followed.

    Parameters
    ----------
    along : {"voltage", "frequency"}
        What varies.
    voltage_amplitude : ndarray, shape (n,)
        Amplitude of the sinusoidal drive. [V]
    frequency : ndarray, shape (n,)
        Frequency of the drive. [Hz]
    mean_displacement : ndarray, shape (n,)
        Mean of the contact's displacement. [m]
    harmonics : ndarray of complex, shape (n, H)
        Harmonics of the contact's displacement, in m.
    vibration_amplitude : ndarray, shape (n,)
        Half of the displacement from peak to peak. [m]
    stable : ndarray of bool, shape (n,)
        Whether small disturbances die away.
    complete : bool
        Whether the curve was followed to the end of its range.
    equations : PointEquations
        What holds along the curve.
    """

    along: Literal["voltage", "frequency"]
    voltage_amplitude: Floats
    frequency: Floats
    mean_displacement: Floats
    harmonics: Complexes
    vibration_amplitude: Floats
    stable: NDArray[np.bool_]
    complete: bool
    equations: PointEquations

    @property
    def parameter(self) -> Floats:
        """What varies along the curve: voltage, in V, or frequency, in Hz."""
        return self.voltage_amplitude if self.along == "voltage" else self.frequency

    @property
    def folds(self) -> NDArray[np.intp]:
        """Indices at which the curve turns back."""
        ahead = np.sign(np.diff(self.parameter))
        return 1 + np.flatnonzero(ahead[1:] * ahead[:-1] < 0)


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
    """Follow the steady vibration over a range of voltage or of frequency.

    Parameters
    ----------
    structure : Structure
    gap_law : GapLaw
    normal_load : float
        Dead load on the contact. [N]
    voltage_amplitude : float or pair of float
        Amplitude of the sinusoidal drive; two for where the curve starts and ends. [V]
    frequency : float or pair of float
        Frequency of the drive; two for where the curve starts and ends. [Hz]
    orders : int
        Harmonics of the contact.
    most_points : int
        Points after which a curve is left incomplete.

    Returns
    -------
    ResponseCurve

    Raises
    ------
    InvalidInput
        If not exactly one of voltage and frequency is a pair, a value is not positive, or no vibration was found at the
        start.

    Notes
    -----
    Keller's pseudo-arclength: a step along the tangent, then Newton's method in the plane across it, which does not
    mind folds. Stability comes from the growth of disturbances, as in `sonolube.dynamics.stability`.

    References
    ----------
    .. [1] H. B. Keller, in Applications of Bifurcation Theory, ed. P. H. Rabinowitz, Academic Press 1977, 359-384.
    """
    load = float(require_positive(normal_load=normal_load))
    volts, hertz = require_positive(voltage_amplitude=voltage_amplitude), require_positive(frequency=frequency)
    if sorted((volts.shape, hertz.shape)) != [(), (2,)]:
        raise InvalidInput("give a pair, where the curve starts and ends, for either voltage_amplitude or frequency")
    along: Literal["voltage", "frequency"] = "voltage" if volts.shape else "frequency"
    first, last = (float(values) for values in (volts if along == "voltage" else hertz))
    equations = PointEquations(
        structure=structure,
        gap_law=gap_law,
        normal_load=load,
        voltage_harmonics=np.ones(1, dtype=np.complex128),
        voltage_offset=0.0,
        orders=orders,
        samples=8 * orders if isinstance(gap_law, ExponentialGap | TabulatedGap) else max(8 * orders, 512),
    )
    start = steady_state(
        structure, gap_law, normal_load=load, frequency=hertz.flat[0], voltage_amplitude=volts.flat[0], stability=False
    )
    if start.status == Status.NOT_CONVERGED:
        raise InvalidInput(f"no vibration was found where the curve should start; {start.reason(())}")
    path = _Path(
        equations=equations,
        along=along,
        fixed=float(hertz if along == "voltage" else volts),
        first=first,
        last=last,
        length=float(length_of_change(gap_law, load)),
    )
    rows = list(path.follow(equations.stack(float(start.mean_displacement), start.harmonics), most_points))
    return _curve(path, np.array(rows), complete=abs(rows[-1][-1] - 0.5) == 0.5)


def crossings(curve: ResponseCurve, *, at: float) -> ResponseCurve:
    """Return all vibrations of the curve at one value of its parameter, in the curve's order.

    Parameters
    ----------
    curve : ResponseCurve
    at : float
        Voltage amplitude, in V, or frequency, in Hz.

    Returns
    -------
    ResponseCurve
        Of as many points as the curve passes the value.
    """
    path = _path_of(curve)
    before, after = curve.parameter[:-1] - at, curve.parameter[1:] - at
    passed = np.flatnonzero((before * after < 0) | (before == 0))
    rows = [path.solve_at(_between(curve, int(i), at), path.share(at)) for i in passed]
    if curve.parameter[-1] == at:
        rows.append(path.solve_at(_row(curve, -1), path.share(at)))
    found = [row for row in rows if row is not None]
    return _curve(path, np.array(found).reshape(len(found), 2 * curve.equations.orders + 2), complete=curve.complete)


def reached_by_ramp(curve: ResponseCurve, *, at: float, backward: bool = False) -> ResponseCurve:
    """Return the one vibration that a slow change of the parameter ends at, jumping where the curve folds back.

    Parameters
    ----------
    curve : ResponseCurve
    at : float
        Voltage amplitude, in V, or frequency, in Hz, where the change ends.
    backward : bool
        Whether the change began at the curve's end rather than at its start.

    Returns
    -------
    ResponseCurve
        Of one point.

    Raises
    ------
    InvalidInput
        If the curve does not reach the value.

    Notes
    -----
    At a fold the vibration is taken to jump to where the curve next passes the fold's value.
    """
    found = crossings(curve, at=at)
    if not found.parameter.size:
        raise InvalidInput(f"the curve does not reach {curve.along} {at:.6g}")
    chosen = slice(-1, None) if backward else slice(0, 1)
    return replace(
        found,
        voltage_amplitude=found.voltage_amplitude[chosen],
        frequency=found.frequency[chosen],
        mean_displacement=found.mean_displacement[chosen],
        harmonics=found.harmonics[chosen],
        vibration_amplitude=found.vibration_amplitude[chosen],
        stable=found.stable[chosen],
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class _Path:
    """The curve in pure numbers: unknowns over the contact's reach, and the share of the range passed."""

    equations: PointEquations
    along: Literal["voltage", "frequency"]
    fixed: float  # the other parameter, in V or Hz
    first: float
    last: float
    length: float

    def share(self, parameter: float) -> float:
        return (parameter - self.first) / (self.last - self.first)

    def parameter(self, share: Floats) -> Floats:
        return self.first + share * (self.last - self.first)

    def linearise(self, y: Floats) -> tuple[Floats, Floats]:
        """Return the residual and its derivatives, the last column by the share."""
        value = float(self.parameter(y[-1]))
        volts, hertz = (value, self.fixed) if self.along == "voltage" else (self.fixed, value)
        balance = self.equations.at(y[:-1] * self.length, omega=2 * np.pi * hertz, scale=volts)
        rate = balance.by_scale if self.along == "voltage" else 2 * np.pi * balance.by_omega
        unit = np.full(y.size - 1, self.length)
        unit[0] = self.equations.normal_load
        matrix = np.column_stack([balance.jacobian * self.length, rate * (self.last - self.first)])
        return balance.residual / unit, matrix / unit[:, np.newaxis]

    def correct(self, y: Floats, across: Floats, beyond: float) -> Floats | None:
        """Return the point of the curve in the plane across . y = beyond, if Newton's method finds it."""
        for _ in range(_CORRECTIONS):
            residual, matrix = self.linearise(y)
            step = np.linalg.solve(np.vstack([matrix, across]), np.append(residual, across @ y - beyond))
            y = y - step
            if not np.all(np.isfinite(y)):
                return None
            if np.abs(step).max() < _EXACT:
                return y
        return None

    def solve_at(self, y: Floats, share: float) -> Floats | None:
        """Return the point of the curve with this share nearby."""
        across = np.zeros(y.size)
        across[-1] = 1.0
        return self.correct(y, across, share)

    def tangent(self, y: Floats, along: Floats) -> Floats:
        """Return the unit tangent that goes on along the one given."""
        _, matrix = self.linearise(y)
        ahead = np.linalg.solve(np.vstack([matrix, along]), np.append(np.zeros(y.size - 1), 1.0))
        return np.asarray(ahead / np.linalg.norm(ahead))

    def follow(self, start: Floats, most_points: int) -> Iterator[Floats]:
        """Yield the points of the curve, from share 0 until it leaves the range."""
        y = self.solve_at(np.append(start / self.length, 0.0), 0.0)
        if y is None:
            raise InvalidInput("orders are too few for the vibration where the curve starts")
        yield y
        ahead = np.zeros(y.size)
        ahead[-1] = 1.0
        ahead, step = self.tangent(y, ahead), _LONGEST / 10
        for _ in range(most_points - 1):
            found, turned, step = self._next(y, ahead, step)
            if found is None:
                return
            if not 0.0 <= found[-1] <= 1.0:
                edge = 1.0 if found[-1] > 1.0 else 0.0
                weight = (edge - y[-1]) / (found[-1] - y[-1])
                final = self.solve_at(y + weight * (found - y), edge)
                if final is not None:
                    yield final
                return
            y, ahead = found, turned
            yield y

    def _next(self, y: Floats, ahead: Floats, step: float) -> tuple[Floats | None, Floats, float]:
        """Return the next point, its tangent and the step to try from there."""
        while step > _SHORTEST:
            found = self.correct(y + step * ahead, ahead, float(ahead @ y) + step)
            if found is not None:
                turned = self.tangent(found, ahead)
                if turned @ ahead > _TURN:
                    return found, turned, min(1.5 * step, _LONGEST) if turned @ ahead > 0.99 else step
            step /= 2
        return None, ahead, step


def _path_of(curve: ResponseCurve) -> _Path:
    other = curve.frequency if curve.along == "voltage" else curve.voltage_amplitude
    return _Path(
        equations=curve.equations,
        along=curve.along,
        fixed=float(other[0]),
        first=float(curve.parameter[0]),
        last=float(curve.parameter[-1]),
        length=float(length_of_change(curve.equations.gap_law, curve.equations.normal_load)),
    )


def _row(curve: ResponseCurve, index: int) -> Floats:
    path = _path_of(curve)
    unknowns = curve.equations.stack(float(curve.mean_displacement[index]), curve.harmonics[index])
    return np.append(unknowns / path.length, path.share(float(curve.parameter[index])))


def _between(curve: ResponseCurve, index: int, at: float) -> Floats:
    before, after = curve.parameter[index], curve.parameter[index + 1]
    weight = (at - before) / (after - before)
    return (1 - weight) * _row(curve, index) + weight * _row(curve, index + 1)  # type: ignore[no-any-return]


def _curve(path: _Path, rows: Floats, *, complete: bool) -> ResponseCurve:
    own = path.equations
    mean, parameter = rows[:, 0] * path.length, path.parameter(rows[:, -1])
    harmonics = (rows[:, 1 : own.orders + 1] + 1j * rows[:, own.orders + 1 : -1]) * path.length
    other = np.full(mean.shape, path.fixed)
    volts, hertz = (parameter, other) if path.along == "voltage" else (other, parameter)
    loads, counts = np.full(mean.shape, own.normal_load), np.full(mean.shape, own.orders)
    motion = (own.gap_law, 2 * np.pi * hertz, loads, mean, harmonics, counts)
    measures = measure(*motion)  # type: ignore[arg-type]
    rates = growth(contact_port(own.structure), *motion, 4 * counts)  # type: ignore[arg-type]
    return ResponseCurve(
        along=path.along,
        voltage_amplitude=volts,
        frequency=hertz,
        mean_displacement=mean,
        harmonics=harmonics,  # type: ignore[arg-type]
        vibration_amplitude=measures.amplitude,
        stable=rates <= GROWTH,
        complete=complete,
        equations=own,
    )
