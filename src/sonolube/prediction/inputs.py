"""Inputs of a prediction: values of a rig and how well each is known, and its own measured runs."""

from dataclasses import dataclass, replace
from math import log
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, Integers
from sonolube.errors import InvalidInput
from sonolube.measurement.measured_runs import (
    checked_ratios,
    copies_caveat,
    direction_words,
    intrinsic_coefficients,
    resolution,
    run_caveats,
    setting,
)
from sonolube.prediction.evidence import REFERENCE_DECAY_LENGTH, Conditions, TestedRig, UncertainConditions
from sonolube.prediction.posterior import Posterior, learned
from sonolube.prediction.within_plane import NO_LENGTH_ERROR, is_predicted, within_plane
from sonolube.rig import Distribution, FrictionPoint, ResolvedRig, Rig, friction_point
from sonolube.rig.amplitude_source import AMPLITUDE_ERROR
from sonolube.rig.resolved_rig import resolved_rig
from sonolube.rig.vibration_direction import NORMAL, VibrationDirection, require_same_direction
from sonolube.text.units import format_si
from sonolube.validation.run_conditions import amplitude_per_volt, is_by_voltage, known_amplitudes, pooled_scatter
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr

_LENGTH_KEYS: Final = ("contact.decay_length", "contact.normal_stiffness")
_FRICTION_KEY: Final = "friction.friction_coefficient"
_GIVEN_LENGTH: Final = 0.3  # of a decay length without a distribution
_AMPLITUDE_SPREADS: Final = {"measured": AMPLITUDE_ERROR, "computed": 0.15, "waveguide": 0.15, "per-volt": 0.1}
_GIVEN_FRICTION: Final = 0.1
_SAME_VALUE: Final = 1e-3  # relative, within which a distribution is about the value of the rig
_AMPLITUDE_KEYS: Final = {
    "measured": ("vibration.vibration_amplitude",),
    "computed": ("stack.free_stroke_per_volt",),
    "waveguide": ("waveguide.axial_amplitude",),
    "per-volt": ("actuator.amplitude_per_volt",),
}


@dataclass(frozen=True, kw_only=True, slots=True)
class Input:
    """One input of a prediction.

    Parameters
    ----------
    name : str
        Of the vocabulary.
    label : str
        As it is called in a sentence.
    value : float
        Median, in SI.
    spread : float
        Standard deviation of its logarithm.
    reason : str
        Why the spread is what it is.
    remedy : str
        How to know the input better.
    """

    name: str
    label: str
    value: float
    spread: float
    reason: str
    remedy: str

    @property
    def text(self) -> str:
        """Value, spread and reason in a sentence."""
        value = format_si(self.value, quantity(self.name).unit)
        return f"{self.label} {value} within {100 * self.spread:.0f} % ({self.reason})"


@dataclass(frozen=True, kw_only=True, slots=True)
class RigInputs:
    """All inputs of a prediction for one rig.

    Parameters
    ----------
    decay, amplitude, friction : Input
        Decay length of the contact force, vibration amplitude and intrinsic coefficient of friction: the uncertain
        ones.
    measured_length : bool
        Whether the decay length is known on this rig, or without effect; else it is that of the population.
    frequency : float
        Of the vibration. [Hz]
    sliding_speed : float
        Mean sliding speed. [m/s]
    normal_load : float
        Force pressing the bodies together. [N]
    voltage_peak_to_peak : float or None
        Of the drive, where it is known. [V]
    point : FrictionPoint
        Friction by the rig's own model.
    direction : VibrationDirection
        Of the vibration; within the plane nothing depends on the decay length.
    amplitude_per_volt : float or None
        By which amplitudes of runs that state a voltage follow, where it is known. [m/V]
    scaling : str
        Caveat on that; empty where the drive of the rig is known.
    """

    decay: Input
    amplitude: Input
    friction: Input
    measured_length: bool
    frequency: float
    sliding_speed: float
    normal_load: float
    voltage_peak_to_peak: float | None
    point: FrictionPoint
    direction: VibrationDirection = NORMAL
    amplitude_per_volt: float | None = None
    scaling: str = ""

    @property
    def uncertain(self) -> tuple[Input, ...]:
        """Decay length where it has an effect, amplitude and dry friction."""
        others = self.amplitude, self.friction
        return (self.decay, *others) if self.direction.is_normal else others

    def with_input(self, known: Input) -> "RigInputs":
        """Inputs with the uncertain one of the same name replaced."""
        every = self.decay, self.amplitude, self.friction
        length, amplitude, friction = (known if known.name == each.name else each for each in every)
        return replace(self, decay=length, amplitude=amplitude, friction=friction)

    def at(
        self,
        *,
        vibration_amplitude: ArrayLike | None = None,
        sliding_speed: ArrayLike | None = None,
        frequency: ArrayLike | None = None,
    ) -> UncertainConditions:
        """Conditions of the rig, at other settings where given; arrays of one length or numbers."""
        amplitude = self.amplitude.value if vibration_amplitude is None else vibration_amplitude
        speed = self.sliding_speed if sliding_speed is None else sliding_speed
        f_set = self.frequency if frequency is None else frequency
        a, v, f = np.broadcast_arrays(
            np.atleast_1d(np.asarray(amplitude, float)), np.asarray(speed, float), np.asarray(f_set, float)
        )
        length = self.decay.value if self.measured_length else REFERENCE_DECAY_LENGTH
        conditions = Conditions(
            vibration_amplitude=a, frequency=f, sliding_speed=v, decay_length=np.full(a.shape, length)
        )
        if not self.direction.is_normal:
            conditions = within_plane(conditions, self.direction)
        return UncertainConditions(
            conditions=conditions,
            decay_length_spread=self.decay.spread if self.measured_length else None,
            amplitude_spread=self.amplitude.spread,
        )


def rig_inputs(rig: Rig | ResolvedRig, *, takes_plane: bool = False) -> RigInputs:
    """Inputs of a prediction from a rig file: its own distributions where it has them, else usual ones.

    A vibration within the plane is refused but for `takes_plane`, and so are friction models of soft bodies.
    """
    resolved = resolved_rig(rig)
    rig = resolved.rig
    if rig.friction_model.for_soft_bodies:
        raise InvalidInput(
            f"{rig.title}: this rests on tests of hard bodies, and friction model {rig.friction_model.name} is of a"
            " soft or floating contact; use friction, which gives the theory"
        )
    if not (rig.direction.is_normal or (takes_plane and is_predicted(rig.direction))):
        raise InvalidInput(within_plane_refusal(rig))
    if rig.drive is None:
        raise InvalidInput(f"{rig.title}: a prediction needs a frequency; give drive.frequency")
    if not rig.sliding_speed > 0:
        raise InvalidInput(f"{rig.title}: a prediction needs a sliding speed above 0; give sliding.sliding_speed")
    point = friction_point(resolved)
    if not point.vibration_amplitude > 0:
        raise InvalidInput(f"{rig.title}: a prediction needs vibration; the vibration amplitude is 0 m")
    length = _measured_decay_length(rig) if rig.direction.is_normal else _NO_LENGTH
    per_volt, scaling = amplitude_per_volt(rig, own=point.vibration_amplitude)
    return RigInputs(
        decay=length or decay_length_of(learned().friction, known_from="published tests"),
        amplitude=_amplitude(rig, point),
        friction=_friction(rig),
        measured_length=length is not None,
        frequency=rig.drive.frequency,
        sliding_speed=rig.sliding_speed,
        normal_load=rig.normal_load,
        voltage_peak_to_peak=rig.drive.voltage_peak_to_peak,
        point=point,
        direction=rig.direction,
        amplitude_per_volt=per_volt,
        scaling=scaling,
    )


def within_plane_refusal(rig: Rig) -> str:
    """Why a vibration with a part within the plane is not taken, and what to do instead."""
    if is_predicted(rig.direction):
        return (
            f"{rig.title}: this rests on tests of vibration along the normal, but this one is {rig.direction.text}; use"
            " predict or friction, which say how far it was tested, or fit own runs"
        )
    return (
        f"{rig.title}: no prediction of a vibration along the normal and within the plane at once, whose phase decides"
        f" and of which no one law has the tested limits, but this one is {rig.direction.text}; use friction, which"
        " gives the theory, or fit own runs"
    )


_NO_LENGTH: Final = Input(
    name="decay_length",
    label="decay length of the contact",
    value=REFERENCE_DECAY_LENGTH,
    spread=NO_LENGTH_ERROR,
    reason="without effect within the plane",
    remedy="none",
)


def _measured_decay_length(rig: Rig) -> Input | None:
    """Decay length of the contact force as known on the rig, where the rig file has one of its own."""
    length, origin = rig.contact.decay_length, rig.decay_length_origin or "stated"
    if length is None or origin == "published_tests":
        return None
    spread, reason = _GIVEN_LENGTH, "given without a distribution"
    for key in _LENGTH_KEYS:
        if own := rig.uncertainty.get(key):
            spread, reason = _lognormal(own)[1], f"{own.text} in the rig file"
    return Input(
        name="decay_length",
        label="decay length of the contact",
        value=length,
        spread=spread,
        reason=f"{origin.replace('_', ' ')}; {reason}",
        remedy="a run with vibration on this rig",
    )


def decay_length_of(posterior: Posterior, *, known_from: str) -> Input:
    """Decay length of the force of worn contacts by a posterior, and the tests that it is known from."""
    value, spread = posterior.decay_length()
    return Input(
        name="decay_length",
        label="decay length of the contact",
        value=value,
        spread=spread,
        reason=f"of worn contacts by {known_from}; no roughness tells it",
        remedy="a run with vibration on this rig, or its contact stiffness (`sonolube measure stiffness`)",
    )


def _amplitude(rig: Rig, point: FrictionPoint) -> Input:
    """Vibration amplitude, by the source that all commands take it from."""
    spread, reason = _AMPLITUDE_SPREADS[point.amplitude_source], point.amplitude_origin
    for key in _AMPLITUDE_KEYS[point.amplitude_source]:
        if own := rig.uncertainty.get(key):
            spread, reason = _lognormal(own)[1], f"{reason}; {key} {own.text}"
    return Input(
        name="vibration_amplitude",
        label="amplitude",
        value=point.vibration_amplitude,
        spread=spread,
        reason=reason,
        remedy="a vibrometer on the running rig",
    )


def _friction(rig: Rig) -> Input:
    """Intrinsic coefficient of friction: that of the rig, with its distribution where that is about this value."""
    value, spread, reason = rig.friction_coefficient, _GIVEN_FRICTION, "given without a distribution"
    if own := rig.uncertainty.get(_FRICTION_KEY):
        middle, deviation = _lognormal(own)
        if abs(middle / value - 1) < _SAME_VALUE:
            spread, reason = deviation, f"{own.text} in the rig file"
        else:
            reason = f"given in place of {own.text}"
    return Input(
        name="friction_coefficient",
        label="dry friction",
        value=value,
        spread=spread,
        reason=reason,
        remedy="a run without vibration on the same pair",
    )


def intrinsic_draws(friction: Input, *, count: int, seed: int = 0) -> Floats:
    """Draws of the coefficient of friction without vibration, shape (count,)."""
    normals = np.random.default_rng(seed + 1).standard_normal(count)
    return np.asarray(friction.value * np.exp(friction.spread * normals))


def _lognormal(distribution: Distribution) -> tuple[float, float]:
    """Median of a distribution of a positive quantity, and the standard deviation of the like lognormal one."""
    low, middle, high = (float(each) for each in distribution.quantile((0.1587, 0.5, 0.8413)))
    return middle, log(high / max(low, 1e-3 * middle)) / 2


_MAX_RUNS: Final = 200
_USUAL_UNCERTAINTY: Final = 0.05  # of a friction ratio, where neither column nor repeats state it
_WITHIN_ONE_TEST: Final = 0.02  # below which a stated one is a standard error within a test; printed scatter is 0.047
_MIN_REPEATS: Final = 4  # from which the scatter of repeats is taken
_NO_SCATTER: Final = 1e-9  # of repeats, that of the arithmetic
_FINEST: Final = 1e-5  # uncertainty of a ratio below which covariances of repeats lose their rank; no rig is that fine
_SAME_ANGLE: Final = 0.02  # rad


@dataclass(frozen=True, kw_only=True, slots=True)
class OwnRuns:
    """Measured runs of a rig.

    Parameters
    ----------
    tested : TestedRig
        Friction ratios with their conditions.
    friction : Input or None
        Intrinsic coefficient of friction by the runs, where they have forces.
    wear_rate_ratio : ndarray, shape (w,)
        Of runs that state wear; may be empty. []
    wear_runs : ndarray of int, shape (w,)
        Places of these runs.
    caveats : tuple of str
    """

    tested: TestedRig
    friction: Input | None
    wear_rate_ratio: Floats
    wear_runs: Integers
    caveats: tuple[str, ...]


def own_runs(runs: "xr.Dataset", inputs: RigInputs, *, title: str) -> OwnRuns:
    """Measured runs of a rig with what they do not state taken from the rig."""
    count = runs.sizes["run"]
    if count > _MAX_RUNS:
        raise InvalidInput(f"{title}: {count} runs; at most {_MAX_RUNS} update a prediction: average repeats")
    ratio, copies = checked_ratios(runs, title=title), copies_caveat(runs)
    _require_direction(setting(runs, "vibration_direction", np.nan), inputs.direction, title=title)
    require_same_direction(direction_words(runs), inputs.direction, title=title)
    amplitude, speed = _amplitudes(runs, inputs), setting(runs, "sliding_speed", inputs.sliding_speed)
    for name, values in (("vibration_amplitude", amplitude), ("sliding_speed", speed)):
        if not np.all(values > 0):
            raise InvalidInput(f"{title}: {name} of run {int(np.argmin(values > 0)) + 1} must be positive")
    at = inputs.at(vibration_amplitude=amplitude, sliding_speed=speed)
    uncertainty, caveats = _uncertainty(runs, ratio, amplitude, speed)
    uncertainty = np.maximum(uncertainty, _FINEST)
    caveats = (*run_caveats(runs), *copies, *caveats)
    if inputs.scaling and is_by_voltage(runs).any():
        caveats += (inputs.scaling,)
    loads = setting(runs, "normal_load", inputs.normal_load)
    if np.any(np.abs(loads / inputs.normal_load - 1) > 0.5):
        caveats += ("some runs have a load far from the rig's; the friction model does not depend on the load",)
    wear = _wear(runs)
    stated = np.flatnonzero(np.isfinite(wear))
    return OwnRuns(
        tested=TestedRig(name=title, at=at, friction_ratio=ratio, uncertainty=uncertainty),
        friction=_intrinsic(runs, loads),
        wear_rate_ratio=wear[stated],
        wear_runs=stated,
        caveats=caveats,
    )


def _require_direction(angles: Floats, direction: VibrationDirection, *, title: str) -> None:
    """Refuse runs that state another direction than that of the rig."""
    stated = angles[np.isfinite(angles)]
    if direction.is_normal and stated.size:
        raise InvalidInput(
            f"{title}: this prediction is of vibration along the normal; leave out runs with a direction"
        )
    if stated.size and (direction.angle is None or np.any(np.abs(np.sin(stated - direction.angle)) > _SAME_ANGLE)):
        raise InvalidInput(f"{title}: the rig vibrates {direction.text}; leave out runs in other directions")


def _amplitudes(runs: "xr.Dataset", inputs: RigInputs) -> Floats:
    """Amplitude of each run; by its voltage in proportion to the rig's, where only that is stated."""
    amplitude, voltage = (setting(runs, name, np.nan) for name in ("vibration_amplitude", "voltage_peak_to_peak"))
    own, volts = inputs.amplitude.value, inputs.voltage_peak_to_peak
    per_volt = own / volts if volts else inputs.amplitude_per_volt
    return known_amplitudes(amplitude, voltage, np.isnan(amplitude), own=own, per_volt=per_volt)


def _uncertainty(runs: "xr.Dataset", ratio: Floats, amplitude: Floats, speed: Floats) -> tuple[Floats, tuple[str, ...]]:
    """Standard uncertainty of each ratio: as stated, by the scatter of repeats, or the usual one.

    None is below that of the digits as they are written.
    """
    stated, digits = setting(runs, "friction_reduction_uncertainty", np.nan), resolution(runs)
    if np.any(stated <= 0):
        raise InvalidInput("friction_reduction_uncertainty must be positive in every run")
    if np.all(np.isfinite(stated)):
        found = np.maximum(stated, digits)
        return found, () if np.median(found) >= _WITHIN_ONE_TEST else (_too_narrow("state", found),)
    keys = np.round(np.log(np.stack([amplitude, speed])), 2)
    _, group, counts = np.unique(keys, axis=1, return_inverse=True, return_counts=True)
    scatter = pooled_scatter(ratio, group.ravel())
    has_repeats = scatter is not None and ratio.size - counts.size + 1 >= _MIN_REPEATS
    if scatter is not None and has_repeats and np.all(np.maximum(scatter, digits) > _NO_SCATTER):
        found = np.where(np.isnan(stated), np.maximum(scatter, digits), np.maximum(stated, digits))
        told = [_too_narrow("scatter by", found)] if np.median(found) < _WITHIN_ONE_TEST else []
        if np.any(digits > scatter):
            told.append(
                f"the repeats scatter by less than the last digit that is written; {np.max(digits):.2g} by the digits"
                " is taken for their ratios"
            )
        return found, tuple(told)
    reason = "hold repeats that are equal in every digit" if has_repeats else "hold too few repeats"
    return np.where(np.isnan(stated), np.maximum(_USUAL_UNCERTAINTY, digits), np.maximum(stated, digits)), (
        f"the runs state no uncertainty and {reason}; {_USUAL_UNCERTAINTY:g} is taken for each ratio",
    )


def _too_narrow(verb: str, uncertainty: Floats) -> str:
    """Caveat on an uncertainty that is one within a test."""
    of = "an uncertainty of " if verb == "state" else ""
    return (
        f"the runs {verb} {of}{np.median(uncertainty):.2g} of their ratios, as of one test: others on the same rig"
        f" differ by about {_USUAL_UNCERTAINTY:g}, and the interval is too narrow for them"
    )


def _intrinsic(runs: "xr.Dataset", loads: Floats) -> Input | None:
    """Intrinsic coefficient of friction by the runs' own forces over loads, or coefficients, without vibration."""
    coefficients = intrinsic_coefficients(runs, loads)
    if np.all(np.isnan(coefficients)):
        return None
    logs = np.log(coefficients[np.isfinite(coefficients)])
    spread = float(np.std(logs, ddof=1) / np.sqrt(logs.size)) if logs.size > 1 else _USUAL_UNCERTAINTY
    of_load = setting(runs, "normal_load_uncertainty", 0.0) / loads
    by_force = np.isfinite(setting(runs, "intrinsic_friction_force", np.nan))
    shared = float(np.mean(of_load[by_force])) if by_force.any() else 0.0
    named = "forces" if by_force.any() else "coefficients"
    return Input(
        name="friction_coefficient",
        label="dry friction",
        value=float(np.exp(np.mean(logs))),
        spread=float(np.hypot(max(spread, 0.02), shared)),
        reason=f"{named} of the runs without vibration",
        remedy="more runs without vibration",
    )


def _wear(runs: "xr.Dataset") -> Floats:
    """Wear rate ratio of each run, NaN where it states none."""
    ratios = setting(runs, "wear_rate_ratio", 1 - setting(runs, "wear_reduction", np.nan))
    if np.any(ratios <= 0):
        raise InvalidInput("wear with vibration over wear without must be positive in every run")
    return ratios
