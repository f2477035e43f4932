"""Local search for the best design near a feasible one, by sequential quadratic programming at constant friction."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize

from sonolube.checks import Floats
from sonolube.design.optimisation.evaluation import Evaluation
from sonolube.design.optimisation.requirements import Aim
from sonolube.design.optimisation.screening import DesignProblem
from sonolube.design.optimisation.space import Candidate, candidate_rig, candidate_stack, candidate_structure
from sonolube.models.dynamics import Status
from sonolube.models.dynamics.sensitivities import StructureChange, steady_state_sensitivities
from sonolube.rig import steady_states
from sonolube.rig.driven_rig import DrivenRig
from sonolube.rig.friction_and_wear import friction_ratios, prescribed_sine

_STEP = 1e-4  # relative, of the finite differences along the surface of constant friction
_FRICTION_STEP = 1e-3  # relative, of the finite differences of the friction ratio
_MAX_ITERATIONS = 25
_BARRIER = 20.0  # replaces the logarithm of the objective where there is no admissible design


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class DesignPoint:
    """Candidate at a drive frequency, with the voltage for the target friction ratio.

    Parameters
    ----------
    candidate : Candidate
    frequency : float
        Drive frequency. [Hz]
    voltage_peak_to_peak : float
        Peak-to-peak drive voltage. [V]
    evaluation : Evaluation
        Of this one drive.
    """

    candidate: Candidate
    frequency: float
    voltage_peak_to_peak: float
    evaluation: Evaluation

    def objective(self, name: str) -> float:
        """Value of an objective of `OBJECTIVES`."""
        return float(self.evaluation.objectives[name][0])


def design_point_at(
    problem: DesignProblem, candidate: Candidate, *, frequency: float, near: float
) -> DesignPoint | None:
    """Design point of a candidate at a drive frequency, its voltage found by root finding.

    Parameters
    ----------
    problem : DesignProblem
        Of which the tolerance is not used.
    candidate : Candidate
    frequency : float
        Drive frequency. [Hz]
    near : float
        Initial estimate of the peak-to-peak voltage, in V.

    Returns
    -------
    DesignPoint or None
        None where no voltage reaches the target.

    See Also
    --------
    refine_swing
    """
    rig = candidate_rig(problem.space, candidate)
    volts = problem.required_swing(rig, frequency=frequency, near=near)
    if not np.isfinite(volts):
        return None
    evaluation = problem.evaluated(rig, frequency=[frequency], voltage_peak_to_peak=[volts])
    return DesignPoint(candidate=candidate, frequency=frequency, voltage_peak_to_peak=volts, evaluation=evaluation)


def swing_sensitivities(problem: DesignProblem, point: DesignPoint) -> dict[str, float]:
    r"""Logarithmic derivatives of the voltage by the design variables at constant friction ratio.

    Parameters
    ----------
    problem : DesignProblem
    point : DesignPoint

    Returns
    -------
    dict of str to float
        Derivative of the logarithm of the voltage by the logarithm of the frequency and of each entry of the structure.

    Notes
    -----
    On the surface :math:`R(a, f) = \text{const}` of the friction ratio, with the vibration amplitude
    :math:`a(x, U)`, a design variable :math:`x` and the voltage :math:`U`,

    .. math::

        \frac{d \ln U}{d \ln x} = -x\,
            \frac{R_a\, \partial a/\partial x + R_f\, \partial f/\partial x}{R_a\, \partial a/\partial \ln U}

    The derivatives of the amplitude follow from the steady vibration by the implicit function theorem, those of the
    friction ratio by finite differences of the rig's friction model under a sine. Harmonics of the vibration are thus
    neglected in this direction, but not in the designs.
    """
    rig = rig_at_design_point(candidate_rig(problem.space, point.candidate), point)
    states = steady_states(rig)
    if int(states.status[0]) == Status.NOT_CONVERGED:
        return dict.fromkeys(problem.space.bounds, 0.0)
    changes = {name: _structure_derivative(problem, point.candidate, name) for name in problem.space.ranges}
    derivatives = steady_state_sensitivities(states, structure_changes=changes).vibration_amplitude
    by_parameter = {name: float(values[0]) for name, values in derivatives.items()}
    amplitude = float(states.vibration_amplitude[0])
    by_amplitude, by_frequency = _friction_derivatives(rig, amplitude)
    by_swing = by_parameter["voltage_scale"] + rig.drive.voltage_offset * by_parameter["voltage_offset"]
    if by_amplitude * by_swing == 0:
        return dict.fromkeys(problem.space.bounds, 0.0)
    change = {"frequency": by_amplitude * by_parameter["frequency"] + by_frequency}
    change |= {name: by_amplitude * by_parameter[name] for name in changes}
    values = {"frequency": point.frequency, **point.candidate.entries}
    return {name: -slope * values[name] / (by_amplitude * by_swing) for name, slope in change.items()}


def local_search(problem: DesignProblem, start: DesignPoint, aim: Aim) -> DesignPoint:
    r"""Best design point near a feasible one, of the same actuator and waveform, by sequential quadratic programming.

    Parameters
    ----------
    problem : DesignProblem
        Of which the tolerance is not used.
    start : DesignPoint
    aim : Aim
        Objective of `OBJECTIVES` to minimise; a second one is constrained by its bound.

    Returns
    -------
    DesignPoint
        The start, where no better feasible point is found.

    See Also
    --------
    swing_sensitivities, optimise

    Notes
    -----
    With the objective :math:`J`, the utilisation :math:`u_j` of the constraints and the logarithms :math:`x` of drive
    frequency and structure,

    .. math::

        \min_x \ln J(x) \quad \text{subject to} \quad 1 - u_j(x) \ge 0, \quad \ln\frac{\varepsilon}{J_2(x)} \ge 0

    where the voltage is that for the target friction ratio at every :math:`x`. Gradients are finite differences along
    that surface, whose direction `swing_sensitivities` gives; the algorithm is SLSQP.
    """
    names = list(problem.space.bounds)
    bounds = np.log(np.array(list(problem.space.bounds.values())))
    search = _ConstrainedProblem(problem=problem, start=start, aim=aim, computed={})
    initial = np.log([{"frequency": start.frequency, **start.candidate.entries}[name] for name in names])
    minimize(
        search.objective,
        np.clip(initial, *bounds.T),
        jac=True,
        method="SLSQP",
        bounds=bounds,
        constraints={"type": "ineq", "fun": search.margins, "jac": search.margin_derivatives},
        options={"maxiter": _MAX_ITERATIONS, "ftol": 1e-8},
    )
    reached = start.objective(aim.minimise)
    better = [point for point in search.feasible_points() if point.objective(aim.minimise) <= reached]
    second = aim.second_objective
    feasible = [
        point for point in [*better, start] if second is None or point.objective(second) <= aim.bound * (1 + 1e-6)
    ]
    return min(feasible or [start], key=lambda point: point.objective(aim.minimise))


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class _ConstrainedProblem:
    """Objective, margins and derivatives as functions of the logarithms of the variables, each point computed once.

    Parameters
    ----------
    problem : DesignProblem
    start : DesignPoint
    minimise : str
    second_objective : str or None
    bound : float
    computed : dict of bytes to tuple
        Design point, row of functions and their derivatives, by the bytes of the variables.
    """

    problem: DesignProblem
    start: DesignPoint
    aim: Aim
    computed: dict[bytes, tuple[DesignPoint | None, Floats, Floats]]

    def objective(self, x: Floats) -> tuple[float, Floats]:
        """Logarithm of the objective and its gradient."""
        point, values, slopes = self._at(x)
        return (_BARRIER, np.zeros(x.size)) if point is None else (float(values[0]), slopes[0])

    def margins(self, x: Floats) -> Floats:
        """Margins of the constraints, negative where they are violated."""
        return self._at(x)[1][1:]

    def margin_derivatives(self, x: Floats) -> Floats:
        """Jacobian of the margins."""
        return self._at(x)[2][1:]

    def feasible_points(self) -> list[DesignPoint]:
        """Computed points that violate no constraint."""
        return [
            point
            for point, _, _ in self.computed.values()
            if point is not None and point.evaluation.maximum_utilisation[0] <= 1
        ]

    def _latest(self) -> DesignPoint:
        """Latest design point, whose voltage is a close estimate for the next one."""
        points = [point for point, _, _ in self.computed.values() if point is not None]
        return points[-1] if points else self.start

    def _at(self, x: Floats) -> tuple[DesignPoint | None, Floats, Floats]:
        """Design point, functions and derivatives, computed where they are new."""
        key = x.tobytes()
        if key not in self.computed:
            self.computed[key] = self._compute(x)
        return self.computed[key]

    def _compute(self, x: Floats) -> tuple[DesignPoint | None, Floats, Floats]:
        """Design point, functions and their derivatives by finite differences at constant friction ratio."""
        f, candidate = self._variables(x)
        point = design_point_at(self.problem, candidate, frequency=f, near=self._latest().voltage_peak_to_peak)
        if point is None or not np.isfinite(point.evaluation.utilisation["admissible_vibration"][0]):
            rows = self._row(self.start.evaluation).size
            return None, np.concatenate([[_BARRIER], np.full(rows - 1, -1.0)]), np.zeros((rows, x.size))
        here = self._row(point.evaluation)
        slopes = np.zeros((here.size, x.size))
        for column, slope in enumerate(swing_sensitivities(self.problem, point).values()):
            step = np.zeros(x.size)
            step[column] = _STEP if x[column] + _STEP < self._upper_bound(column) else -_STEP
            next_f, next_candidate = self._variables(x + step)
            volts = point.voltage_peak_to_peak * np.exp(slope * step[column])
            rig = candidate_rig(self.problem.space, next_candidate)
            evaluation = self.problem.evaluated(rig, frequency=[next_f], voltage_peak_to_peak=[volts])
            slopes[:, column] = (self._row(evaluation) - here) / step[column]
        return point, here, np.nan_to_num(slopes, posinf=0.0, neginf=0.0)

    def _row(self, evaluation: Evaluation) -> Floats:
        """Logarithm of the objective, then the margin of each constraint."""
        margins = [1 - values[0] for name, values in evaluation.utilisation.items() if name != "admissible_vibration"]
        if self.aim.second_objective is not None:
            margins.append(np.log(self.aim.bound / evaluation.objectives[self.aim.second_objective][0]))
        return np.array([np.log(evaluation.objectives[self.aim.minimise][0]), *margins])

    def _variables(self, x: Floats) -> tuple[float, Candidate]:
        """Drive frequency and candidate of the logarithms of the variables."""
        values = dict(zip(self.problem.space.bounds, map(float, np.exp(x)), strict=True))
        f = values.pop("frequency")
        return f, replace(self.start.candidate, entries=values)

    def _upper_bound(self, column: int) -> float:
        """Logarithm of the upper bound of a variable."""
        return float(np.log(list(self.problem.space.bounds.values())[column][1]))


def rig_at_design_point(rig: DrivenRig, point: DesignPoint) -> DrivenRig:
    """Rig with the drive frequency and voltage of a design point, the offset scaled in the rig's own ratio."""
    swing = point.voltage_peak_to_peak
    drive = replace(
        rig.drive, frequency=point.frequency, voltage_peak_to_peak=swing, voltage_offset=rig.drive.offset_ratio * swing
    )
    return replace(rig, drive=drive)


def _friction_derivatives(rig: DrivenRig, amplitude: float) -> tuple[float, float]:
    """Derivatives of the friction ratio under a sine by its amplitude and by its frequency, by central differences."""
    drive = rig.drive

    def ratio(a: float, f: float) -> float:
        sine = prescribed_sine(rig, vibration_amplitude=a, frequency=f)
        return float(friction_ratios(rig, sine, sliding_speed=rig.sliding_speed).raw_friction_ratio)

    h = _FRICTION_STEP
    a, f = amplitude, drive.frequency
    by_amplitude = (ratio(a * (1 + h), f) - ratio(a * (1 - h), f)) / (2 * h * a)
    return by_amplitude, (ratio(a, f * (1 + h)) - ratio(a, f * (1 - h))) / (2 * h * f)


def _structure_derivative(problem: DesignProblem, candidate: Candidate, name: str) -> StructureChange:
    """Derivative of the structure's matrices by one of its entries, in which they are linear."""
    stack = candidate_stack(problem.space, candidate.actuator)
    value = candidate.entries[name]
    (_, here), (_, there) = (
        candidate_structure(problem.space, stack, {**candidate.entries, name: scale * value}) for scale in (1.0, 2.0)
    )
    return StructureChange(
        mass_matrix=(there.mass_matrix - here.mass_matrix) / value,
        damping_matrix=(there.damping_matrix - here.damping_matrix) / value,
        stiffness_matrix=(there.stiffness_matrix - here.stiffness_matrix) / value,
    )
