"""Own measured runs as conditions of model variants: repeats averaged, what they do not state taken from a rig."""

from dataclasses import dataclass, replace
from math import cos, isfinite, pi
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
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
from sonolube.models.contact import RoughContact
from sonolube.rig import Rig, steady_vibration
from sonolube.rig.amplitude_source import stated_per_volt
from sonolube.rig.vibration_direction import NORMAL, require_same_direction
from sonolube.text.units import format_si

if TYPE_CHECKING:
    import xarray as xr

_MAX_RUNS: Final = 1000
_SAME: Final = 0.01  # relative difference of settings that count as one
_FIRST_LETTER: Final = 0x4E00  # of the groups of conditions; no published set has one so high
_MAX_GROUPS: Final = 12
_IN_PLANE: Final = 1e-6  # cosine of an angle that counts as across the sliding
_SETTINGS: Final = ("vibration_amplitude", "vibration_velocity", "vibration_direction", "frequency", "sliding_speed")


@dataclass(frozen=True, kw_only=True, slots=True)
class RunConditions:
    """Own measured friction ratio under one condition; inputs that are not known are None.

    Parameters
    ----------
    label : str
        Settings in words.
    set_name : str
        One character for the conditions that cross-validation leaves out together.
    friction_ratio : float
        Mean of the repeats. []
    uncertainty : float or None
        Standard uncertainty of that mean.
    repeats : int
    contact : RoughContact or None
    normal_load : float or None
        Force pressing the bodies together. [N]
    friction_coefficient : float or None
        Coefficient of friction without vibration. []
    sliding_speed : float or None
        Sliding speed. [m/s]
    vibration_amplitude : float or None
        Amplitude along the surface normal. [m]
    frequency : float or None
        Frequency of the vibration. [Hz]
    in_plane_amplitude : float or None
        Amplitude along the sliding direction. [m]
    vibration_velocity : float or None
        Peak velocity of a vibration in the contact plane. [m/s]
    vibration_direction : float or None
        Angle between that vibration and the sliding. [rad]
    holder_stiffness : float or None
        Stiffness of the holder along the sliding direction. [N/m]
    """

    label: str
    set_name: str
    friction_ratio: float
    uncertainty: float | None
    repeats: int
    contact: RoughContact | None = None
    normal_load: float | None = None
    friction_coefficient: float | None = None
    sliding_speed: float | None = None
    vibration_amplitude: float | None = None
    frequency: float | None = None
    in_plane_amplitude: float | None = None
    vibration_velocity: float | None = None
    vibration_direction: float | None = None
    holder_stiffness: float | None = None

    @property
    def strength(self) -> float | None:
        """Amplitude along the normal, in m, else the peak velocity in the plane, in m/s; None if neither is known."""
        return self.vibration_velocity if self.vibration_amplitude is None else self.vibration_amplitude

    def at(self, *, strength: float | None = None, sliding_speed: float | None = None) -> "RunConditions":
        """These conditions at another strength of the vibration or sliding speed."""
        other = self if sliding_speed is None else replace(self, sliding_speed=sliding_speed)
        if strength is None or self.strength is None:
            return other
        scaled = ("vibration_amplitude", "vibration_velocity", "in_plane_amplitude")
        factor = strength / self.strength
        known = {name: getattr(other, name) for name in scaled}
        return replace(other, **{name: factor * value for name, value in known.items() if value is not None})

    @property
    def settings(self) -> str:
        """Strength and sliding speed in words."""
        unit = "m/s" if self.vibration_amplitude is None else "m"
        parts = [(self.strength, unit), (self.sliding_speed, "m/s")]
        return ", ".join(format_si(value, each) for value, each in parts if value is not None)


@dataclass(frozen=True, kw_only=True, slots=True)
class RunsTable:
    """Own runs by their conditions.

    Parameters
    ----------
    title : str
    conditions : tuple of RunConditions
    runs : int
        Number of runs that entered.
    scatter : float or None
        Standard deviation of repeats under equal conditions; None where there are none.
    caveats : tuple of str
    """

    title: str
    conditions: tuple[RunConditions, ...]
    runs: int
    scatter: float | None
    caveats: tuple[str, ...]


def run_conditions(runs: "xr.Dataset", rig: Rig | None = None) -> RunsTable:
    """Own runs as conditions of model variants, repeats averaged.

    Conditions within 1 % of each other are one.
    """
    title = str(runs.attrs.get("title", "runs")).removesuffix(", in %")
    if runs.sizes["run"] > _MAX_RUNS:
        raise InvalidInput(f"{title}: {runs.sizes['run']} runs; at most {_MAX_RUNS} are fitted: average repeats")
    ratio, copies = checked_ratios(runs, title=title), copies_caveat(runs)
    inputs = _inputs(runs, rig)
    for name in ("vibration_amplitude", "vibration_velocity", "frequency", "sliding_speed", "normal_load"):
        if np.any(inputs[name] <= 0):
            raise InvalidInput(f"{title}: {name} of run {int(np.argmax(inputs[name] <= 0)) + 1} must be positive")
    group, first = _groups(inputs)
    stated = setting(runs, "friction_reduction_uncertainty", np.nan)
    scatter, digits = pooled_scatter(ratio, group), resolution(runs)
    conditions = []
    for index, run in enumerate(first):
        members = group == index
        conditions.append(
            _condition(
                {name: float(values[run]) for name, values in inputs.items()}
                | {"friction_coefficient": float(np.mean(inputs["friction_coefficient"][members]))},
                rig,
                friction_ratio=float(np.mean(ratio[members])),
                uncertainty=_uncertainty(stated[members], scatter, float(np.max(digits[members]))),
                repeats=int(members.sum()),
            )
        )
    lettered = tuple(
        replace(one, set_name=chr(_FIRST_LETTER + place % _MAX_GROUPS), label=one.settings or f"condition {place + 1}")
        for place, one in enumerate(conditions)
    )
    return RunsTable(
        title=title,
        conditions=lettered,
        runs=ratio.size,
        scatter=scatter,
        caveats=(*run_caveats(runs), *copies, *_scaling(runs, rig)),
    )


def _scaling(runs: "xr.Dataset", rig: Rig | None) -> tuple[str, ...]:
    """Caveat on amplitudes that follow from voltages by a calibration."""
    if rig is None or not is_by_voltage(runs).any():
        return ()
    _, caveat = amplitude_per_volt(rig, own=1.0)
    return (caveat,) if caveat else ()


def is_by_voltage(runs: "xr.Dataset") -> NDArray[np.bool_]:
    """Which runs state a voltage and neither amplitude nor velocity; shape (n,)."""
    names = ("voltage_peak_to_peak", "vibration_amplitude", "vibration_velocity")
    voltage, amplitude, velocity = (np.isfinite(setting(runs, name, np.nan)) for name in names)
    return np.asarray(voltage & ~amplitude & ~velocity)


def _inputs(runs: "xr.Dataset", rig: Rig | None) -> dict[str, Floats]:
    """Settings of each run, those of the rig where it states none, NaN where nothing does."""
    speed = np.nan if rig is None or not rig.sliding_speed > 0 else rig.sliding_speed
    frequency = np.nan if rig is None or rig.drive is None else rig.drive.frequency
    load = setting(runs, "normal_load", np.nan if rig is None else rig.normal_load)
    dry = intrinsic_coefficients(runs, load)
    angle = None if rig is None else rig.direction.angle
    words = direction_words(runs)
    require_same_direction(words, NORMAL if rig is None else rig.direction, title="runs" if rig is None else rig.title)
    coefficient = float(np.nanmean(dry)) if np.any(np.isfinite(dry)) else np.nan
    if rig is not None and not isfinite(coefficient):
        coefficient = rig.friction_coefficient
    return {
        "vibration_amplitude": _amplitudes(runs, rig),
        "vibration_velocity": setting(runs, "vibration_velocity", np.nan),
        "vibration_direction": setting(runs, "vibration_direction", np.nan if angle is None else angle),
        "frequency": setting(runs, "frequency", frequency),
        "sliding_speed": setting(runs, "sliding_speed", speed),
        "normal_load": load,
        "friction_coefficient": np.where(np.isfinite(dry), dry, coefficient),
    }


def _amplitudes(runs: "xr.Dataset", rig: Rig | None) -> Floats:
    """Amplitude of each run; by its voltage in proportion to the rig's where only that is stated, else the rig's."""
    amplitude = setting(runs, "vibration_amplitude", np.nan)
    voltage = setting(runs, "voltage_peak_to_peak", np.nan)
    unknown = np.isnan(amplitude) & np.isnan(setting(runs, "vibration_velocity", np.nan))
    if rig is None:
        if np.any(unknown & np.isfinite(voltage)):
            raise InvalidInput(
                "the runs state voltages: add a column vibration_amplitude [um], or a rig file that scales them (--rig)"
            )
        return amplitude
    if not np.any(unknown):
        return amplitude
    own = steady_vibration(rig).vibration_amplitude
    return known_amplitudes(amplitude, voltage, unknown, own=own, per_volt=amplitude_per_volt(rig, own=own)[0])


def amplitude_per_volt(rig: Rig, *, own: float) -> tuple[float | None, str]:
    """Amplitude over voltage by which runs that state a voltage are scaled, and a caveat; None where nothing tells it.

    `own` is the amplitude of the rig, in m, at its own drive voltage where it states one.
    """
    volts = None if rig.drive is None else rig.drive.voltage_peak_to_peak
    if volts:
        return own / volts, ""
    stated = stated_per_volt(rig)
    if stated is None:
        return None, ""
    return stated[0], f"amplitudes of runs that state a voltage are taken as proportional to it, by {stated[1]}"


def known_amplitudes(
    amplitude: Floats, voltage: Floats, unknown: NDArray[np.bool_], *, own: float, per_volt: float | None
) -> Floats:
    """Amplitudes, unknown ones by their voltage and the amplitude per volt, else the rig's own. [m]"""
    by_voltage = unknown & np.isfinite(voltage)
    if np.any(by_voltage):
        if per_volt is None:
            raise InvalidInput(
                "the runs state voltages, but the rig says of none which amplitude it gives: add one pair of them,"
                ' such as --set vibration.calibration="25 V = 2 um"'
            )
        amplitude = np.where(by_voltage, per_volt * voltage, amplitude)
    return np.where(unknown & ~by_voltage, own, amplitude)


def _groups(inputs: dict[str, Floats]) -> tuple[np.ndarray, np.ndarray]:
    """Number of the condition of each run, and the first run of each; settings within 1 % are one."""
    settings = np.stack([np.nan_to_num(inputs[name], nan=-1.0) for name in (*_SETTINGS, "normal_load")], axis=1)
    group = np.full(len(settings), -1)
    first: list[int] = []
    for run, each in enumerate(settings):
        same = np.flatnonzero(np.isclose(settings[first], each, rtol=_SAME, atol=0).all(axis=1))
        if not same.size:
            first.append(run)
        group[run] = same[0] if same.size else len(first) - 1
    return group, np.array(first)


def pooled_scatter(ratio: Floats, group: np.ndarray) -> float | None:
    """Pooled standard deviation of repeats."""
    counts = np.bincount(group)
    free = ratio.size - counts.size
    if not free:
        return None
    means = np.bincount(group, weights=ratio) / counts
    return float(np.sqrt(np.sum((ratio - means[group]) ** 2) / free))


def _uncertainty(stated: Floats, scatter: float | None, digits: float) -> float | None:
    """Standard uncertainty of the mean of repeats: by their scatter, else as stated; at least that of the digits.

    Equal digits are rounded alike, so that a mean of repeats is no better known by them. None where nothing tells it.
    """
    if scatter is not None:
        found = scatter / float(np.sqrt(stated.size))
    elif np.all(np.isfinite(stated)):
        found = float(np.sqrt(np.sum(stated**2))) / stated.size
    else:
        return None
    return max(found, digits) or None


def _condition(
    inputs: dict[str, float], rig: Rig | None, *, friction_ratio: float, uncertainty: float | None, repeats: int
) -> RunConditions:
    """Conditions of one group of repeats; a stated direction means a vibration in the contact plane."""
    known: dict[str, Any] = {name: value if isfinite(value) else None for name, value in inputs.items()}
    amplitude, velocity, frequency = (
        known.pop("vibration_amplitude"),
        known.pop("vibration_velocity"),
        known["frequency"],
    )
    if amplitude is None and velocity is not None and frequency is not None:
        amplitude = velocity / (2 * pi * frequency)
    if velocity is None and amplitude is not None and frequency is not None:
        velocity = 2 * pi * frequency * amplitude
    direction = known["vibration_direction"]
    if direction is None:
        motion = {"vibration_amplitude": amplitude}
    else:
        along = amplitude if abs(abs(cos(direction)) - 1) < _IN_PLANE else None
        motion = {"vibration_velocity": velocity, "in_plane_amplitude": along}
    stiffness = getattr(rig.friction_model, "holder_stiffness", None) if rig else None
    return RunConditions(
        label="",
        set_name="",
        friction_ratio=friction_ratio,
        uncertainty=uncertainty,
        repeats=repeats,
        contact=None if rig is None else rig.contact,
        holder_stiffness=stiffness if stiffness is not None and isfinite(stiffness) else None,
        **known,
        **motion,
    )
