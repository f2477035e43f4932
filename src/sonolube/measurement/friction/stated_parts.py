"""Parts of a friction recording as stated: what is measured, where the surfaces rest, steps of a voltage."""

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.checks import Floats, require_finite, require_non_negative
from sonolube.errors import InvalidInput
from sonolube.measurement.friction.sliding import Mask

if TYPE_CHECKING:
    import xarray as xr

_SHORTEST_REST: Final = 0.2  # s, up to which a rest is the reversal of a stroke
_VOLTS: Final = {"units": "V"}
_SPEEDS: Final = ("relative_velocity", "sliding_speed", "rotation_speed", "sliding_speed_set", "motor_on")

STATED_STEP: Final = "stated_step"
"""Channel of the number of the stated step at each sample, 0 for none."""

Span = tuple[float, float]
"""First and last time of a part. [s]"""


@dataclass(frozen=True, kw_only=True, slots=True)
class StatedParts:
    """Parts of a recording as stated.

    Parameters
    ----------
    part : Span or None
        What is measured; None for the whole recording.
    rests : tuple of Span
        Where the surfaces rest.
    steps : tuple of (Span, float)
        Steps with their voltage, peak to peak, in V; in place of the recorded voltage, and what is in none of them is
        left out.

    Raises
    ------
    InvalidInput
        If a part ends before it begins, a rest lasts 0.2 s or less, a voltage is negative, or two steps overlap.
    """

    part: Span | None = None
    rests: tuple[Span, ...] = ()
    steps: tuple[tuple[Span, float], ...] = ()

    def __post_init__(self) -> None:
        spans = sorted(span for span, _ in self.steps)
        for begin, end in (*([self.part] if self.part else []), *self.rests, *spans):
            require_finite(start_time=begin, end_time=end)
            if not end > begin:
                raise InvalidInput(f"a part must end after it begins, got {begin:.6g} s to {end:.6g} s")
        for begin, end in self.rests:
            if end - begin <= _SHORTEST_REST:
                raise InvalidInput(f"a rest must be longer than {_SHORTEST_REST:g} s, got {begin:.6g} s to {end:.6g} s")
        require_non_negative(voltage_peak_to_peak=[voltage for _, voltage in self.steps])
        for (_, end), (begin, _) in pairwise(spans):
            if begin < end:
                raise InvalidInput(f"steps must not overlap: one ends at {end:.6g} s, the next begins at {begin:.6g} s")


def with_stated_parts(recording: "xr.Dataset", stated: StatedParts) -> "xr.Dataset":
    """Recording with its parts as stated: others left out, a speed of 0 at rest, and the voltage of each step.

    Parameters
    ----------
    recording : xarray.Dataset
        Over `time`.
    stated : StatedParts

    Returns
    -------
    xarray.Dataset
        Rest is told by `motor_on` where no speed is recorded, and steps by `STATED_STEP`.

    Raises
    ------
    InvalidInput
        If the recording has no time, or a part holds no sample of it.
    """
    if stated == StatedParts():
        return recording
    if "time" not in recording.variables:
        raise InvalidInput("parts are stated by the time, which this recording does not have")
    time = recording["time"].to_numpy()
    rest = _within(time, stated.rests)
    added: dict[str, Floats] = {}
    if stated.rests:
        channels = [name for name in _SPEEDS if name in recording] or ["motor_on"]
        usual = np.ones(time.size)
        speeds = {name: recording[name].to_numpy() if name in recording else usual for name in channels}
        added = {name: np.where(rest, 0.0, values) for name, values in speeds.items()}
    if stated.steps:
        number, voltage = np.zeros(time.size), np.full(time.size, np.nan)
        for place, (span, each) in enumerate(stated.steps, start=1):
            inside = _within(time, [span])
            number[inside], voltage[inside] = place, each
        added |= {"voltage_peak_to_peak": voltage, STATED_STEP: number}
        if "friction_force" in recording and not any(name in recording for name in _SPEEDS):  # which tell rest
            force = recording["friction_force"].to_numpy()
            added["friction_force"] = np.where(rest | (number > 0), force, np.nan)
    attributes = {name: recording[name].attrs for name in added if name in recording} | {"voltage_peak_to_peak": _VOLTS}
    changed = recording.assign({name: ("time", values, attributes.get(name, {})) for name, values in added.items()})
    if stated.rests:
        changed = changed.assign_attrs(rest="as stated")
    if stated.part is None:
        return changed
    kept = _within(time, [stated.part])
    if stated.steps and not (number[kept] > 0).any():
        raise InvalidInput("the part that is measured holds none of the stated steps")
    return changed.isel(time=kept)


def _within(time: Floats, spans: "tuple[Span, ...] | list[Span]") -> Mask:
    """Whether each sample is in one of some parts, each of which holds samples."""
    found = np.zeros(time.size, bool)
    for begin, end in spans:
        inside = (time >= begin) & (time <= end)
        if not inside.any():
            raise InvalidInput(
                f"{begin:.6g} s to {end:.6g} s holds no sample; the recording is from {time[0]:.6g} s to"
                f" {time[-1]:.6g} s"
            )
        found |= inside
    return found
