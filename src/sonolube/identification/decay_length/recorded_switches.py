"""Reduction of a recording with switched vibration and lifted pin to the table of its switches."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.identification.decay_length.switch_table import SwitchTable
from sonolube.measurement.friction.step_means import sampled_parts, without_wobble, wobble_columns
from sonolube.measurement.friction_analysis import channel_values
from sonolube.measurement.statistics.autocorrelation import correlated_mean
from sonolube.measurement.time_series import constant_stretches
from sonolube.text.units import format_si

if TYPE_CHECKING:
    import xarray as xr

_LIFTED: Final = 0.1  # of the median load, below which the pin is lifted
_DRIVEN: Final = 0.1  # of the largest voltage, above which the vibration is on
_SETTLING: Final = 0.1  # of a part at either end, left out of means
_FEWEST: Final = 8  # samples of a mean
_HARMONICS: Final = 2
_PAUSE: Final = 1.5  # sample intervals, beyond which nothing was recorded between two samples
_SAMPLES_PER_PERIOD: Final = 5  # of the drive, below which samples do not show its amplitude
_RECTIFIED: Final = 0.5  # of the standard deviation, above which the mean of a current is its reading


@dataclass(frozen=True, slots=True)
class _Part:
    """Samples in which nothing is switched."""

    begin: int
    end: int
    lifted: bool
    driven: bool

    def half(self, *, last: bool) -> slice:
        """Half of the part beside a switch, without the settling at either end."""
        size = self.end - self.begin
        settling, middle = int(_SETTLING * size), self.begin + size // 2
        return slice(middle, self.end - settling) if last else slice(self.begin + settling, middle)

    @property
    def inner(self) -> slice:
        """The part without the settling at either end."""
        settling = int(_SETTLING * (self.end - self.begin))
        return slice(self.begin + settling, self.end - settling)


def recorded_switches(
    recording: "xr.Dataset", *, sliding_speed: float, rotation_speed: float | None = None
) -> SwitchTable:
    """Readings at the switches of the vibration from a recording of one run.

    Parameters
    ----------
    recording : xarray.Dataset
        With the channels `friction_force`, `voltage_peak_to_peak` and `normal_load`, in which the pin counts as lifted
        below a tenth of the median load, and `stack_current`, `small_drive_shift` and `large_drive_shift` where they
        were recorded: shifts in the samples about a switch, NaN elsewhere. A current that alternates counts by its
        amplitude; where `frequency_set` says that a period has fewer than five samples, it does not enter. The set
        point `sliding_speed_set`, where there is one, tells the distance.
    sliding_speed : float
        While the pin is on the track. [m/s]
    rotation_speed : float, optional
        Of the disc, to remove its wobble; found in the friction without it. [1/s]

    Returns
    -------
    SwitchTable
        A row for each change between sliding with and without vibration. Forces are means over the halves of the two
        parts beside the switch, without wobble; the zero is the mean with the pin lifted between them. Standard
        uncertainties account for autocorrelation.

    Raises
    ------
    InvalidInput
        If a channel is missing, the vibration is never switched, or as `SwitchTable`.

    See Also
    --------
    switch_table : The same from a table.
    """
    require_positive(sliding_speed=sliding_speed)
    time, force = channel_values(recording, "time"), channel_values(recording, "friction_force")
    parts = _parts(channel_values(recording, "normal_load"), channel_values(recording, "voltage_peak_to_peak"))
    switches = _switches(parts)
    title = str(recording.attrs.get("file_name", "recording"))
    if not switches:
        raise InvalidInput(f"{title}: the vibration is never switched on or off; record several switches in one run")
    steady = _without_wobble(time, force, [part for part in parts if not part.lifted], rotation_speed)
    slid = _slid(recording, time, sliding_speed * ~_lifted(parts, time.size))
    unseen = _unseen_current(recording, time)
    columns: dict[str, list[float]] = {}
    for before, between, after in switches:
        on, off = (after.half(last=False), before.half(last=True))
        if before.driven:
            on, off = off, on
        row: dict[str, float] = {"sliding_distance": float(slid[before.end - 1])}
        row |= _mean("friction_force", steady[on]) | _mean("intrinsic_friction_force", steady[off])
        row |= _mean("force_zero", force[between.inner] if between else np.empty(0))
        if "stack_current" in recording and not unseen:
            row |= _current(channel_values(recording, "stack_current")[on])
        for name in ("small_drive_shift", "large_drive_shift"):
            if name in recording:
                near = slice(before.half(last=True).start, after.half(last=False).stop)
                row |= _mean(name, channel_values(recording, name)[near], constant=True)
        for name, value in row.items():
            columns.setdefault(name, []).append(value)
    arrays = {name: np.array(values) for name, values in columns.items()}
    needed = ("sliding_distance", "friction_force", "intrinsic_friction_force", "force_zero")
    stated = {name: values for name, values in arrays.items() if name in needed or np.isfinite(values).any()}
    caveats = tuple(line for line in str(recording.attrs.get("caveats", "")).split("\n") if line)
    return SwitchTable(**stated, title=title, caveats=(*caveats, *unseen))


def _unseen_current(recording: "xr.Dataset", time: Floats) -> tuple[str, ...]:
    """Caveat of a current whose samples do not show its amplitude, as the frequency of the drive was recorded."""
    if "stack_current" not in recording or "frequency_set" not in recording:
        return ()
    current, rate = channel_values(recording, "stack_current"), 1 / float(np.median(np.diff(time)))
    known = current[np.isfinite(current)]
    is_rectified = bool(known.size) and abs(known.mean()) > _RECTIFIED * known.std()
    if is_rectified or rate >= _SAMPLES_PER_PERIOD * float(np.nanmax(channel_values(recording, "frequency_set"))):
        return ()
    return (f"stack_current at {format_si(rate, 'Hz')} does not resolve the drive, and does not enter",)


def _parts(load: Floats, voltage: Floats) -> list[_Part]:
    """Parts between the samples at which the pin is lifted or lowered, or the vibration is switched."""
    median = float(np.nanmedian(load[load > _LIFTED * np.nanmax(load)])) if np.nanmax(load) > 0 else 0.0
    if median <= 0:
        raise InvalidInput("normal_load must be positive while the pin slides; lifted it falls below a tenth")
    lifted, driven = load < _LIFTED * median, voltage > _DRIVEN * np.nanmax(voltage)
    driven &= ~lifted
    stretches = constant_stretches(lifted, driven)
    return [_Part(begin, end, bool(lifted[begin]), bool(driven[begin])) for begin, end in stretches]


def _switches(parts: list[_Part]) -> list[tuple[_Part, _Part | None, _Part]]:
    """Parts before and after each switch of the vibration, with that between in which the pin is lifted."""
    found: list[tuple[_Part, _Part | None, _Part]] = []
    before: _Part | None = None
    between: _Part | None = None
    for part in parts:
        if part.lifted:
            between = part
            continue
        if before is not None and before.driven != part.driven:
            found.append((before, between, part))
        before, between = part, None
    return found


def _lifted(parts: list[_Part], samples: int) -> np.ndarray:
    """Whether the pin is lifted at each sample."""
    lifted = np.zeros(samples, bool)
    for part in parts:
        lifted[part.begin : part.end] = part.lifted
    return lifted


def _slid(recording: "xr.Dataset", time: Floats, speed: Floats) -> Floats:
    """Distance until each sample, by the speed that was set where it was recorded; none while nothing was recorded."""
    if "sliding_speed_set" in recording:
        speed = channel_values(recording, "sliding_speed_set")
    steps = np.diff(time)
    recorded = steps < _PAUSE * np.median(steps)
    return np.concatenate([[0.0], np.cumsum(steps * speed[1:] * recorded)])


def _current(values: Floats) -> dict[str, float]:
    """Amplitude of an alternating current, or mean of one that was rectified, with its standard uncertainty."""
    known = values[np.isfinite(values)]
    if known.size < _FEWEST or abs(known.mean()) > _RECTIFIED * known.std():
        return _mean("stack_current", known)
    squares = correlated_mean(2 * (known - known.mean()) ** 2)
    amplitude = float(np.sqrt(squares.mean))
    uncertainty = squares.uncertainty / (2 * amplitude) if amplitude else 0.0
    return {"stack_current": amplitude, "stack_current_uncertainty": max(uncertainty, 1e-9 * amplitude + 1e-15)}


def _without_wobble(time: Floats, force: Floats, slides: list[_Part], rotation_speed: float | None) -> Floats:
    """Force without the harmonics of the rotation; unknown samples and those with the pin lifted stay as they are."""
    pieces = [part.half(last=last) for part in slides for last in (False, True)]
    known = [piece for piece in pieces if np.count_nonzero(np.isfinite(force[piece])) >= _FEWEST]
    if not known:
        return force
    sampled = sampled_parts(known, time=time, friction_force=force)
    turns = None if rotation_speed is None else [rotation_speed * t for t in sampled.times]
    waves, _ = wobble_columns(sampled, revolutions=turns, harmonics=_HARMONICS)
    steady = force.copy()
    for piece, values in zip(known, without_wobble(sampled, waves), strict=True):
        steady[piece] = np.where(np.isfinite(force[piece]), np.nan, force[piece])
        steady[np.flatnonzero(np.isfinite(force[piece])) + piece.start] = values
    return steady


def _mean(name: str, values: Floats, *, constant: bool = False) -> dict[str, float]:
    """Mean of a reading with its standard uncertainty; of one reading held over samples without one."""
    known = values[np.isfinite(values)]
    if constant:
        return {name: float(known.mean()) if known.size else float("nan")}
    if known.size < _FEWEST:
        return {name: float("nan"), f"{name}_uncertainty": float("nan")}
    found = correlated_mean(known)
    return {name: found.mean, f"{name}_uncertainty": max(found.uncertainty, 1e-9 * abs(found.mean) + 1e-15)}
