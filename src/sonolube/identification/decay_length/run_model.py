"""Readings at the switches from the courses of decay length and amplitude, with their priors and noise."""

from dataclasses import dataclass
from functools import cache
from typing import Final, NamedTuple

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from sonolube.checks import Floats
from sonolube.identification.decay_length.switch_table import (
    LONG_DECAY_LENGTH,
    SHORT_DECAY_LENGTH,
    SwitchConditions,
    SwitchTable,
)
from sonolube.models.friction.models.asperity_stick_slip_sine import EMPIRICAL_MEMORY_LENGTH, sine_stick_slip_ratio

_COURSES = (0.05, 0.1, 0.2, 0.4, 1.0)  # distances of relaxation over that of the run
_SHARES = (0.0, 0.2, 0.5, 0.8)  # of the variance, that wander slowly
_LENGTHS = (0.03, 0.1, 0.3)  # of this wander over the distance of the run
_SCALES = (1e-3, 1e2)  # limits of relaxation distances over that of the run; beyond, courses no longer change
_EXPONENTS = (0.1, 8.0)
_CAUTION = 1e-9


def relaxation(distance: Floats, *, reach: Floats, exponent: Floats | float = 1.0) -> Floats:
    """Course from 0 on the fresh track to 1 at the end of the run, a row for each relaxation distance S and exponent n.

    (1 - exp(-(s/S)^n))/(1 - exp(-(s_end/S)^n)).
    """
    scale = np.clip(np.asarray(reach)[..., None] / distance[-1], *_SCALES)
    power = np.clip(np.asarray(exponent)[..., None], *_EXPONENTS)
    slid = distance / distance[-1]
    return np.asarray(np.expm1(-((slid / scale) ** power)) / np.expm1(-((1 / scale) ** power)))


def noise_covariance(distance: Floats, values: Floats, uncertainty: Floats | None) -> Floats:
    """Covariance of white and slowly wandering noise by restricted maximum likelihood, shape (readings, readings).

    The course of the reading beside it is a constant, a relaxation and its square, so that the noise is the same under
    every hypothesis. Stated standard uncertainties are a lower limit of the white part.
    """
    weights = np.ones(values.size) if uncertainty is None else uncertainty**2 / np.mean(uncertainty**2)
    gaps = np.abs(np.subtract.outer(distance, distance)) / distance[-1]
    white = np.diag(weights)
    wandering = [(share, length) for share in _SHARES[1:] for length in _LENGTHS]
    shapes = [white, *((1 - share) * white + share * np.exp(-gaps / length) for share, length in wandering)]
    shares = [0.0, *(share for share, _ in wandering)]
    courses = relaxation(distance, reach=distance[-1] * np.array(_COURSES))
    designs = [np.column_stack([np.ones(values.size), c, c**2]) for c in courses]
    found = [(*_restricted(values, design, shape), index) for index, shape in enumerate(shapes) for design in designs]
    _, variance, index = max(found)
    floor = 0.0 if uncertainty is None else float(np.mean(uncertainty**2))
    variance = max(variance, floor / (1 - shares[index]), (_CAUTION * float(np.abs(values).max())) ** 2, 1e-300)
    return np.asarray(variance * shapes[index])


def _restricted(values: Floats, design: Floats, shape: Floats) -> tuple[float, float]:
    """Logarithm of the restricted likelihood at its best variance, and that variance."""
    factor = cho_factor(shape, lower=True)
    solved = cho_solve(factor, design)
    normal = design.T @ solved + 1e-12 * np.eye(design.shape[1])
    rest = values - design @ np.linalg.solve(normal, solved.T @ values)
    freedom = values.size - design.shape[1]
    variance = max(float(rest @ cho_solve(factor, rest)) / freedom, 1e-300)
    log_determinants = 2 * np.log(np.diag(factor[0])).sum() + np.linalg.slogdet(normal)[1]
    return -0.5 * float(freedom * np.log(variance) + log_determinants), variance


_BETA = (0.02, 60.0)  # amplitude over decay length
_SPEED = (1e-3, 1.0)  # sliding speed over that from which the ratio is 1
_NODES = (80, 64)  # of the ratios that are computed
_FINE = (800, 640)  # of those that are interpolated between them


@cache
def _table() -> Floats:
    """Ratio at even steps of the logarithms of amplitude over decay length and of the reduced speed."""
    from scipy.interpolate import RectBivariateSpline

    beta, speed = (np.geomspace(*ends, count) for ends, count in zip((_BETA, _SPEED), _NODES, strict=True))
    length, frequency = 1e-6, 1e4
    a = beta[:, None] * length
    ratio = sine_stick_slip_ratio(
        decay_length=length,
        vibration_amplitude=a,
        frequency=frequency,
        sliding_speed=speed * 2 * np.pi * frequency * a,
        memory_length=length,
    )
    spline = RectBivariateSpline(np.log(beta), np.log(speed), ratio)
    fine = [np.log(np.geomspace(*ends, count)) for ends, count in zip((_BETA, _SPEED), _FINE, strict=True)]
    return np.asarray(np.clip(spline(*fine), 0.0, 1.0))


def interpolated_ratio(*, relative_amplitude: Floats, reduced_speed: Floats) -> Floats:
    """Friction ratio from amplitude over decay length a/l and reduced speed v l/(omega a D_c), any shape.

    Values outside the table, 0.02 to 60 and 0.001 to 1, are taken at its edge; from a reduced speed of 1 on it is 1.
    """
    from scipy.ndimage import map_coordinates

    places = [
        (np.log(np.clip(values, *ends)) - np.log(ends[0])) * ((count - 1) / np.log(ends[1] / ends[0]))
        for values, ends, count in zip((relative_amplitude, reduced_speed), (_BETA, _SPEED), _FINE, strict=True)
    ]
    ratio = map_coordinates(_table(), places, order=1, mode="nearest")
    return np.asarray(np.where(reduced_speed >= 1, 1.0, ratio))


DIFFERENCE: Final = float(np.log(LONG_DECAY_LENGTH / SHORT_DECAY_LENGTH))
"""Logarithm of the ratio of the two decay lengths that the published sets ask for."""

PARAMETERS: Final = (
    "decay_length", "amplitude", "memory_length", "discrepancy_slope", "large_drive", "shift_scale",
    "capacitive_share", "turned_share", "growth", "growth_distance", "growth_exponent", "fall", "fall_distance",
    "fall_exponent", "drift", "drift_distance",
)  # fmt: skip
"""Parameters in their order; logarithms of lengths and factors, the logit of the share."""

_LEVEL_ERROR: Final = 0.1  # of the friction model: the rms error of a friction ratio on published tests
_SLOPE_ERROR: Final = 0.08  # of the ratio for a factor of e in amplitude over decay length
_MASS_ERROR: Final = 0.15  # relative, of a stated modal mass
_STEADY_LENGTH: Final = 0.05  # standard deviation of the logarithm of a change that a steady decay length may have
_STEADY_AMPLITUDE: Final = 0.03  # likewise of an amplitude at constant voltage
_CHANGE_SPREAD: Final = 0.4  # of the logarithm of a change that a hypothesis has
_DRIFT: Final = 0.03  # of the friction ratio over the run, by what the model leaves out
_UNEXPLAINED: Final = 0.3  # the same where the friction ratio changes by itself
_LARGEST_SHARE: Final = 0.8  # of a capacitive current over the motional one
_ANY: Final = 10.0  # standard deviation of a level that is not known


class Changes(NamedTuple):
    """Quantities of the readings beside the zero that change in a run.

    Parameters
    ----------
    grows, falls : bool
        Whether the decay length grows, and the amplitude falls, over the run; if not they are steady.
    drifts : bool
        Whether the friction ratio changes by itself too.
    follows : bool
        Whether the amplitude at large drive falls with that of the vibration.
    """

    grows: bool
    falls: bool
    drifts: bool
    follows: bool


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Channel:
    """Readings of one kind with their noise.

    Parameters
    ----------
    name : str
        Of the quantity.
    rows : ndarray of int
        Switches that have the reading.
    values : ndarray
        In the unit of the model: friction ratios, logarithms of currents, linear frequency shifts.
    covariance : ndarray
        Of their noise, with that of a free level.
    level : float
        Standard deviation of that level.
    """

    name: str
    rows: np.ndarray
    values: Floats
    covariance: Floats
    level: float


class RunModel:
    r"""Residuals of all readings of a run for many parameter values at once.

    Over the run the decay length grows by :math:`e^{g}` and the amplitude falls by :math:`e^{d}`,

    .. math:: l(s) = l_0 e^{g\,c(s; S_l, n_l)}, \qquad a(s) = a_0 e^{-d\,c(s; S_a, n_a)}, \qquad
        c(s; S, n) = \frac{1 - e^{-(s/S)^n}}{1 - e^{-(s_1/S)^n}} ,

    where :math:`s_1` is the distance of the run. The readings are

    .. math::

        \frac{F_1 - z}{F_0 - z} &= R(a/l,\ v l/(\omega a D_c)) + \delta_0 + \delta_1 \ln\frac{a\,l_0}{a_0\,l}
            + \delta_2\,c(s; S_\delta) \\
        I &\propto \abs{\mathrm{j} p + r e^{-\mathrm{j}\varphi}}, \qquad r = a/a_0, \quad
            \sin\varphi = t \sqrt{1 - r^2} \\
        \Delta_s (1 + \Delta_s/2f_0) &= \frac{F_N/l}{8 \pi^2 m f_0}, \qquad
        \frac{\Delta_l (1 + \Delta_l/2f_0)}{\Delta_s (1 + \Delta_s/2f_0)} = \frac{2 I_1(\beta)}{\beta I_0(\beta)}

    with asperity stick-slip R, a capacitive current p over the motional one, whose phase turns where the resonance
    leaves the drive (t = 1 or -1) and does not where the drive weakens (t = 0), and :math:`\beta = A/l` for the
    amplitude A at large drive, which follows that of the vibration or does not.

    Parameters
    ----------
    table : SwitchTable
    conditions : SwitchConditions
    changes : Changes
    channels : tuple of Channel
        From `run_channels`.
    """

    def __init__(
        self, table: SwitchTable, conditions: SwitchConditions, changes: Changes, *, channels: tuple[Channel, ...]
    ) -> None:
        self.table, self.conditions, self.channels, self.follows = table, conditions, channels, changes.follows
        self._whiteners = [np.linalg.inv(np.linalg.cholesky(each.covariance)) for each in channels]
        self.means, self.deviations = self._priors(changes)

    def _priors(self, changes: Changes) -> tuple[Floats, Floats]:
        """Means and standard deviations of the normal priors of the parameters."""
        end = self.table.sliding_distance[-1]
        change = (DIFFERENCE, _CHANGE_SPREAD)
        priors = {
            "decay_length": (np.log(1.5e-6), 0.7),
            "amplitude": (np.log(self.conditions.vibration_amplitude), 0.15),
            "memory_length": (np.log(EMPIRICAL_MEMORY_LENGTH), 0.4),
            "discrepancy_slope": (0.0, _SLOPE_ERROR),
            "large_drive": (np.log(self.conditions.large_drive_amplitude or self.conditions.vibration_amplitude), 0.3),
            "shift_scale": self._shift_scale(),
            "capacitive_share": (-0.5, 1.0),
            "turned_share": (0.0, 1.0),
            "growth": change if changes.grows else (0.0, _STEADY_LENGTH),
            "growth_distance": (np.log(end / 5), 1.0),
            "growth_exponent": (0.3, 0.4),
            "fall": change if changes.falls else (0.0, _STEADY_AMPLITUDE),
            "fall_distance": (np.log(end / 2), 1.0),
            "fall_exponent": (0.3, 0.4),
            "drift": (0.0, _UNEXPLAINED if changes.drifts else _DRIFT),
            "drift_distance": (np.log(end / 3), 1.0),
        }
        table = np.array([priors[name] for name in PARAMETERS])
        return table[:, 0], table[:, 1]

    @property
    def has_stiffness(self) -> bool:
        """Whether a shift is a contact stiffness: mass and natural frequency of the mode are stated."""
        return self.conditions.modal_mass is not None and self.conditions.natural_frequency is not None

    def _shift_scale(self) -> tuple[float, float]:
        """Prior of the logarithm of the shift at the beginning, or of the error of the stated modal mass."""
        if self.has_stiffness:
            return 0.0, _MASS_ERROR
        shifts = [each.values for each in self.channels if each.name.endswith("drive_shift")]
        level = float(np.median(np.concatenate(shifts))) if shifts else 1.0
        spread = float(np.sqrt(np.mean(np.concatenate(shifts) ** 2))) if shifts else 1.0
        return float(np.log(max(level, 0.1 * spread, 1e-12))), 2.0

    def parameters(self, deviates: Floats) -> dict[str, Floats]:
        """Parameters by name, shape (n, 1), from standard normal deviates of shape (n, parameters)."""
        values = self.means + self.deviations * deviates
        return {name: values[:, [column]] for column, name in enumerate(PARAMETERS)}

    def courses(self, deviates: Floats) -> tuple[Floats, Floats]:
        """Decay length and amplitude at each switch, shape (n, switches) each, in m."""
        p = self.parameters(deviates)
        grown, fallen = (
            relaxation(
                self.table.sliding_distance,
                reach=np.exp(p[f"{name}_distance"][:, 0]),
                exponent=np.exp(p[f"{name}_exponent"][:, 0]),
            )
            for name in ("growth", "fall")
        )
        length = np.exp(p["decay_length"] + p["growth"] * grown)
        return length, np.exp(p["amplitude"] - p["fall"] * fallen)

    def predicted(self, deviates: Floats) -> dict[str, Floats]:
        """Readings of each channel without noise at all switches, shape (n, switches)."""
        from scipy.special import expit, i0e, i1e

        p = self.parameters(deviates)
        length, a = self.courses(deviates)
        known = self.conditions
        v = known.sliding_speed * length / (2 * np.pi * known.frequency * a * np.exp(p["memory_length"]))
        start = np.exp(p["amplitude"] - p["decay_length"])
        ratio = interpolated_ratio(relative_amplitude=a / length, reduced_speed=v)
        ratio = ratio + p["discrepancy_slope"] * np.log(a / length / start)
        drifted = relaxation(self.table.sliding_distance, reach=np.exp(p["drift_distance"][:, 0]))
        ratio = ratio + p["drift"] * drifted
        fall = a / np.exp(p["amplitude"])
        small = np.exp(p["shift_scale"]) * self._stiffness_shift(length, np.exp(p["decay_length"]))
        beta = np.exp(p["large_drive"]) * (fall if self.follows else 1.0) / length
        return {
            "friction_ratio": ratio,
            "stack_current": _log_current(fall, _LARGEST_SHARE * expit(p["capacitive_share"]), p["turned_share"]),
            "small_drive_shift": small,
            "large_drive_shift": small * 2 * i1e(beta) / (beta * i0e(beta)),
        }

    def _stiffness_shift(self, length: Floats, first: Floats) -> Floats:
        """Shift at small drive over its scale, in Hz where the mode is known, else over that at the beginning."""
        mass, f0 = self.conditions.modal_mass, self.conditions.natural_frequency
        if mass is None or f0 is None:
            return np.asarray(first / length)
        return np.asarray(self.conditions.normal_load / length / (8 * np.pi**2 * mass * f0))

    def residuals(self, deviates: Floats) -> Floats:
        """White residuals of all channels one after the other, shape (n, readings)."""
        predicted = self.predicted(deviates)
        return np.concatenate(
            [
                (each.values - predicted[each.name][:, each.rows]) @ whitener.T
                for each, whitener in zip(self.channels, self._whiteners, strict=True)
            ],
            axis=1,
        )

    def fitted(self, deviates: Floats) -> dict[str, Floats]:
        """Readings at all switches for one set of deviates, with the levels that fit best, in SI."""
        found = {}
        predicted = self.predicted(deviates[None])
        for each in self.channels:
            course = predicted[each.name][0]
            rest = each.values - course[each.rows]
            course = course + each.level**2 * np.linalg.solve(each.covariance, rest).sum()
            if each.name == "stack_current":
                course = np.exp(course)
            elif each.name != "friction_ratio" and self.conditions.natural_frequency is not None:
                f0 = self.conditions.natural_frequency
                course = f0 * (np.sqrt(1 + 2 * course / f0) - 1)
            found[each.name] = course
        return found


def _log_current(fall: Floats, capacitive: Floats, turned: Floats) -> Floats:
    """Logarithm of the current of a resonator beside its capacitance, over the motional current at the beginning.

    `fall` is the amplitude over that at the beginning, `capacitive` the capacitive current in the same unit, and
    `turned` the deviate of how far the fall comes from the phase of a resonance that leaves the drive.
    """
    sine = np.sin(np.pi / 2 * np.tanh(2 * turned)) * np.sqrt(np.clip(1 - fall**2, 0.0, None))
    in_phase = fall**2 * (1 - sine**2)
    return np.asarray(0.5 * np.log(in_phase + (capacitive - fall * sine) ** 2))


def run_channels(table: SwitchTable, conditions: SwitchConditions) -> tuple[Channel, ...]:
    """Readings of a run in the units of the model, each with the covariance of its noise.

    Friction ratio, then current and shifts where the run has them.
    """
    ratio, uncertainty = zero_free_ratio(table)
    channels = [_channel("friction_ratio", table, ratio, uncertainty, level=_LEVEL_ERROR)]
    if "stack_current" not in table.missing and table.stack_current is not None:
        known = table.stack_current_uncertainty
        relative = None if known is None else known / table.stack_current
        channels.append(_channel("stack_current", table, np.log(table.stack_current), relative, level=_ANY))
    for name in ("small_drive_shift", "large_drive_shift"):
        shift, stated = getattr(table, name), getattr(table, f"{name}_uncertainty")
        if name in table.missing:
            continue
        f0 = conditions.natural_frequency
        factor = np.zeros_like(shift) if f0 is None else shift / f0
        spread = None if stated is None else stated * np.abs(1 + factor)
        channels.append(_channel(name, table, shift * (1 + factor / 2), spread, level=0.0))
    return tuple(channels)


def zero_free_ratio(table: SwitchTable) -> tuple[Floats, Floats | None]:
    """Friction ratio of each switch with its zero subtracted, and its standard uncertainty where all are stated. []"""
    without = table.intrinsic_friction_force - table.force_zero
    ratio = (table.friction_force - table.force_zero) / without
    parts = (table.friction_force_uncertainty, table.intrinsic_friction_force_uncertainty, table.force_zero_uncertainty)
    on, off, zero = parts
    if on is None or off is None or zero is None:
        return ratio, None
    return ratio, np.sqrt(on**2 + (ratio * off) ** 2 + ((1 - ratio) * zero) ** 2) / without


def _channel(name: str, table: SwitchTable, values: Floats, uncertainty: Floats | None, *, level: float) -> Channel:
    """Readings that are known, with their noise and a free level of a standard deviation."""
    known = np.isfinite(values) if uncertainty is None else np.isfinite(values) & np.isfinite(uncertainty)
    rows = np.flatnonzero(known)
    kept = None if uncertainty is None else uncertainty[rows]
    noise = noise_covariance(table.sliding_distance[rows], values[rows], kept)
    return Channel(name=name, rows=rows, values=values[rows], covariance=noise + level**2, level=level)
