"""From a good design to the best near it, by the engine's gradients, friction staying as wanted."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize

from sonolube.checks import Floats
from sonolube.design.optimisation.assessment import Assessment, assess
from sonolube.design.optimisation.screening import Task
from sonolube.design.optimisation.space import Choice, rig_of, stack_of, structure_of
from sonolube.design.optimisation.target import exact_swing, highest_swing
from sonolube.dynamics import Status
from sonolube.dynamics.sensitivities import StructureChange, steady_state_sensitivities
from sonolube.rig import steady_states
from sonolube.rig.driven_rig import DrivenRig
from sonolube.rig.friction_and_wear import friction_ratio, prescribed_sine

_STEP = 1e-4  # relative, of differences along the surface
_ROUNDS = 25
_BARRIER = 20.0  # stands for the logarithm of an objective where there is no design


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Point:
    """A choice at a frequency, under the swing that gives the friction wanted.

    Parameters
    ----------
    choice : Choice
    frequency : float
        Frequency of the drive. [Hz]
    voltage_peak_to_peak : float
        Swing of the drive. [V]
    assessment : Assessment
        Of that one drive.
    """

    choice: Choice
    frequency: float
    voltage_peak_to_peak: float
    assessment: Assessment

    def objective(self, name: str) -> float:
        """Return one of the objectives."""
        return float(self.assessment.objectives[name][0])


def point_at(task: Task, choice: Choice, *, frequency: float, near: float) -> Point | None:
    """Return a choice at a frequency, with the swing that gives the friction wanted; None where none does.

    Parameters
    ----------
    task : Task
    choice : Choice
    frequency : float
        Frequency of the drive. [Hz]
    near : float
        Swing to start from, in V.

    Returns
    -------
    Point or None
    """
    rig = rig_of(task.space, choice)
    volts = exact_swing(
        rig,
        frequency=frequency,
        friction_ratio=task.friction_ratio,
        near=near,
        highest=highest_swing(rig, task.limits),
    )
    if not np.isfinite(volts):
        return None
    found = assess(rig, task.limits, frequency=[frequency], voltage_peak_to_peak=[volts], bolt=task.space.bolt)
    return Point(choice=choice, frequency=frequency, voltage_peak_to_peak=volts, assessment=found)


def tangent(task: Task, point: Point) -> dict[str, float]:
    """Return how the swing must follow each number to choose so that friction stays as wanted.

    Parameters
    ----------
    task : Task
    point : Point

    Returns
    -------
    dict of str to float
        Derivative of the swing's logarithm by the logarithm of the frequency and of each entry of the structure.

    Notes
    -----
    d ln U/d ln x = -(R_a da/dx + R_f df/dx) x/(R_a da/d ln U): the derivatives of the amplitude a are those of the
    steady vibration, by the implicit function theorem; of the friction ratio R by a and by f, those of the rig's
    friction model under a sine. That the vibration is no pure sine bends the direction, not the designs.
    """
    rig = driven(rig_of(task.space, point.choice), point)
    states = steady_states(rig)
    if int(states.status[0]) == Status.NOT_CONVERGED:
        return dict.fromkeys(task.space.bounds, 0.0)
    changes = {name: _change(task, point.choice, name) for name in task.space.ranges}
    every = steady_state_sensitivities(states, structure_changes=changes).vibration_amplitude
    found = {name: float(values[0]) for name, values in every.items()}
    drive = rig.drive
    amplitude = float(states.vibration_amplitude[0])
    by_amplitude, by_frequency = _friction_slopes(rig, amplitude)
    by_swing = found["voltage_scale"] + drive.voltage_offset * found["voltage_offset"]
    if by_amplitude * by_swing == 0:
        return dict.fromkeys(task.space.bounds, 0.0)
    moved = {"frequency": by_amplitude * found["frequency"] + by_frequency}
    moved |= {name: by_amplitude * found[name] for name in changes}
    values = {"frequency": point.frequency, **point.choice.entries}
    return {name: -slope * values[name] / (by_amplitude * by_swing) for name, slope in moved.items()}


def descended(task: Task, start: Point, *, minimise: str, other: str | None = None, bound: float = np.inf) -> Point:
    """Return the best design near a good one, other than which no actuator or waveform is tried.

    Parameters
    ----------
    task : Task
        Its tolerances are left out.
    start : Point
    minimise : str
        What to make least, of `OBJECTIVES`.
    other : str, optional
        Another objective, which is to keep to a bound.
    bound : float
        That bound.

    Returns
    -------
    Point
        The start, where nothing better keeps to the limits.

    Notes
    -----
    Sequential quadratic programming over the logarithms of frequency and entries. The voltage follows from the friction
    wanted; objective and limits are differenced along that surface, whose direction `tangent` gives.
    """
    names = list(task.space.bounds)
    bounds = np.log(np.array(list(task.space.bounds.values())))
    search = _Search(task=task, start=start, minimise=minimise, other=other, bound=bound, seen={})
    x0 = np.clip([np.log({"frequency": start.frequency, **start.choice.entries}[name]) for name in names], *bounds.T)
    minimize(
        search.objective,
        x0,
        jac=True,
        method="SLSQP",
        bounds=bounds,
        constraints={"type": "ineq", "fun": search.margins, "jac": search.margin_slopes},
        options={"maxiter": _ROUNDS, "ftol": 1e-8},
    )
    keeping = [point for point in search.points() if point.objective(minimise) <= start.objective(minimise)]
    within = [point for point in [*keeping, start] if other is None or point.objective(other) <= bound * (1 + 1e-6)]
    return min(within or [start], key=lambda point: point.objective(minimise))


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class _Search:
    """Functions of the logarithms of what is chosen, each point worked out once."""

    task: Task
    start: Point
    minimise: str
    other: str | None
    bound: float
    seen: dict[bytes, tuple[Point | None, Floats, Floats]]

    def objective(self, x: Floats) -> tuple[float, Floats]:
        point, values, slopes = self._at(x)
        return (_BARRIER, np.zeros(x.size)) if point is None else (float(values[0]), slopes[0])

    def margins(self, x: Floats) -> Floats:
        _, values, _ = self._at(x)
        return values[1:]

    def margin_slopes(self, x: Floats) -> Floats:
        _, _, slopes = self._at(x)
        return slopes[1:]

    def points(self) -> list[Point]:
        return [point for point, _, _ in self.seen.values() if point is not None and point.assessment.most_used[0] <= 1]

    def _last(self) -> Point:
        """Return the point worked out last, whose swing the next one's is close to."""
        found = [point for point, _, _ in self.seen.values() if point is not None]
        return found[-1] if found else self.start

    def _at(self, x: Floats) -> tuple[Point | None, Floats, Floats]:
        key = x.tobytes()
        if key not in self.seen:
            self.seen[key] = self._worked_out(x)
        return self.seen[key]

    def _worked_out(self, x: Floats) -> tuple[Point | None, Floats, Floats]:
        f, choice = self._chosen(x)
        point = point_at(self.task, choice, frequency=f, near=self._last().voltage_peak_to_peak)
        if point is None or not np.isfinite(point.assessment.usage["sound"][0]):
            rows = self._row(self.start.assessment).size
            return None, np.concatenate([[_BARRIER], np.full(rows - 1, -1.0)]), np.zeros((rows, x.size))
        here = self._row(point.assessment)
        slopes = np.zeros((here.size, x.size))
        for column, slope in enumerate(tangent(self.task, point).values()):
            step = np.zeros(x.size)
            step[column] = _STEP if x[column] + _STEP < self._top(column) else -_STEP
            there_f, there = self._chosen(x + step)
            volts = point.voltage_peak_to_peak * np.exp(slope * step[column])
            rig = rig_of(self.task.space, there)
            found = assess(
                rig, self.task.limits, frequency=[there_f], voltage_peak_to_peak=[volts], bolt=self.task.space.bolt
            )
            slopes[:, column] = (self._row(found) - here) / step[column]
        return point, here, np.nan_to_num(slopes, posinf=0.0, neginf=0.0)

    def _row(self, found: Assessment) -> Floats:
        """Return the logarithm of the objective, then the margin of each limit."""
        margins = [1 - usage[0] for name, usage in found.usage.items() if name != "sound"]
        if self.other is not None:
            margins.append(np.log(self.bound / found.objectives[self.other][0]))
        return np.array([np.log(found.objectives[self.minimise][0]), *margins])

    def _chosen(self, x: Floats) -> tuple[float, Choice]:
        values = dict(zip(self.task.space.bounds, map(float, np.exp(x)), strict=True))
        f = values.pop("frequency")
        return f, replace(self.start.choice, entries=values)

    def _top(self, column: int) -> float:
        return float(np.log(list(self.task.space.bounds.values())[column][1]))


def driven(rig: DrivenRig, point: Point) -> DrivenRig:
    """Return a rig under the drive of a point, its offset in the rig's own proportion."""
    swing = point.voltage_peak_to_peak
    drive = replace(
        rig.drive,
        frequency=point.frequency,
        voltage_peak_to_peak=swing,
        voltage_offset=rig.drive.offset_ratio * swing,
    )
    return replace(rig, drive=drive)


def _friction_slopes(rig: DrivenRig, amplitude: float) -> tuple[float, float]:
    """Return the derivatives of the friction ratio under a sine by its amplitude and its frequency."""
    drive = rig.drive

    def ratio(a: float, f: float) -> float:
        at = replace(rig, vibration_amplitude=a, drive=replace(drive, frequency=f))
        return friction_ratio(at, prescribed_sine(at))

    h = 1e-3
    a, f = amplitude, drive.frequency
    by_amplitude = (ratio(a * (1 + h), f) - ratio(a * (1 - h), f)) / (2 * h * a)
    return by_amplitude, (ratio(a, f * (1 + h)) - ratio(a, f * (1 - h))) / (2 * h * f)


def _change(task: Task, choice: Choice, name: str) -> StructureChange:
    """Return the derivative of the structure by one of its entries, on which its matrices depend linearly."""
    stack = stack_of(task.space, choice.actuator)
    value = choice.entries[name]
    (_, here), (_, there) = (
        structure_of(task.space, stack, {**choice.entries, name: scale * value}) for scale in (1.0, 2.0)
    )
    return StructureChange(
        mass_matrix=(there.mass_matrix - here.mass_matrix) / value,
        damping_matrix=(there.damping_matrix - here.damping_matrix) / value,
        stiffness_matrix=(there.stiffness_matrix - here.stiffness_matrix) / value,
    )
