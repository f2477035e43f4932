"""The nine shipped protocols on the virtual rig, each shortened to recordings of 30 s in all, with the truth beside."""

import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import pi
from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.facts.protocol import Protocol, protocol_from, protocol_path
from sonolube.laboratory import Block, Channel, run_protocol
from sonolube.laboratory.virtual_tribometer import Disturbances, virtual_tribometer
from sonolube.rig import Rig

if TYPE_CHECKING:
    import xarray as xr

Steps = list[dict[str, Any]]
_BY_SIGNAL = ("interrupted", "terminated", "ended ", "suspended")  # begin the reasons of runs that a signal ended


def _until_second_cleaning(steps: Steps, *, whole: str, lasts: str) -> Steps:
    """The first two specimens of a study, each recorded for a short time."""
    cleanings = [number for number, step in enumerate(steps) if step.get("task") == "cleaning"]
    return _timed(steps[: cleanings[2]], {whole: lasts})


def _timed(steps: Steps, durations: Mapping[str, str]) -> Steps:
    """Steps, and those within repeats, with other durations in place of those named."""
    return [
        {
            key: _timed(value, durations) if key == "steps" else durations.get(value, value)
            if key == "duration" else value
            for key, value in step.items()
        }
        for step in steps
    ]  # fmt: skip


def _lubrication(steps: Steps) -> Steps:
    """One load and two speeds."""
    found = []
    for step in steps:
        if step["kind"] == "repeat":
            step["over"]["load"] = ["3 N"]
            for inner in step["steps"]:
                if inner["kind"] == "repeat":
                    inner["over"]["speed"] = inner["over"]["speed"][:2]
        found.append(step)
    return _timed(found, {"46 s": "11 s"})


def _decay_length(steps: Steps) -> Steps:
    """One cycle, of which each part slides for 12 s."""
    for step in steps:
        if step["kind"] == "repeat":
            step["count"] = 1
    return _timed(steps, {"76.925 s": "12 s"})


def _appendix(steps: Steps) -> Steps:
    """The first test, with a turn of the disc before."""
    first = next(
        number for number, step in enumerate(steps) if step.get("duration") == "4 h" and step["kind"] == "wait"
    )
    for step in steps:
        if step["kind"] == "repeat":
            step["count"] = 1
    return _timed(steps[: first + 3], {"4 h": "10 s", "90 s": "10 s"})


SHORTENED: Mapping[str, Callable[[Steps], Steps]] = {
    "appendix_a": _appendix,
    "decay_length_run": _decay_length,
    "lubrication_comparison": _lubrication,
    "map_test": lambda steps: _timed(steps, {"32.5 s": "29.5 s", "12 s": "9 s"}),
    "resonance_sweep": lambda steps: _timed(steps, {"40.5 s": "4.05 s"}),
    "study_1": lambda steps: _until_second_cleaning(steps, whole="4 h", lasts="15 s"),
    "study_2": lambda steps: _until_second_cleaning(steps, whole="1 h", lasts="15 s"),
    "temperature_test": lambda steps: _timed(steps, {"50 s": "30 s", "2 s": "1 s", "10 s": "8 s", "18 s": "1 s"}),
    "waveguide_calibration": lambda steps: _timed(steps, {"150 s": "10 s"}),
}
"""Shortening of each shipped protocol."""


def shortened(name: str) -> Protocol:
    """A shipped protocol with recordings of 30 s in all, at most."""
    content = tomllib.loads(protocol_path(name).read_text(encoding="utf-8"))
    content["steps"] = SHORTENED[name](content["steps"])
    return protocol_from(content)


@dataclass
class Part:
    """One recording: its blocks, set points by sample, and the true temperatures of its last second."""

    channels: tuple[str, ...]
    rate: float
    blocks: list[Block] = field(default_factory=list)
    settings: list[tuple[int, float, float]] = field(default_factory=list)  # sample, voltage, sliding speed
    temperature: float | None = None  # K, mean over the last second; None where a setting began in it

    def dataset(self) -> "xr.Dataset":
        """Channels by their quantities with set voltage and speed, over time."""
        import xarray as xr

        values = np.concatenate([block.values for block in self.blocks])
        number = np.arange(len(values))
        sample, voltage, speed = np.array(self.settings).T
        since = np.searchsorted(sample, number, side="right") - 1
        data = {name: ("time", values[:, place]) for place, name in enumerate(self.channels)}
        data |= {"voltage_peak_to_peak": ("time", voltage[since]), "sliding_speed_set": ("time", speed[since])}
        return xr.Dataset(data, {"time": number / self.rate})


class PartsInMemory:
    """Record of a run, in memory."""

    def __init__(self, virtual: Any, diameter: float) -> None:
        self.parts: list[Part] = []
        self._virtual, self._diameter = virtual, diameter
        self._voltage, self._speed, self._is_open = 0.0, 0.0, False

    def begin(self, channels: Sequence[Channel], *, sample_rate: float) -> None:
        """Begin a part."""
        self.parts.append(Part(tuple(each.quantity for each in channels), sample_rate))
        self.parts[-1].settings.append((0, self._voltage, self._speed))
        self._is_open = True

    def append(self, block: Block, *, clock: str = "") -> None:
        """Keep a block; after the last one the true temperature is that of then."""
        self.parts[-1].blocks.append(block)

    def end(self, *, clock: str = "") -> None:
        """End a part, and keep the temperature without noise that its last second had."""
        self._is_open = False
        rig = self._virtual._virtual
        now, settings = rig.clock(), rig.truth()["start_time"].to_numpy()
        if not settings.size or settings[-1] <= now - 1.0:
            times = now - 1.0 + np.arange(400) / 400
            self.parts[-1].temperature = float(np.mean(rig._temperatures.reading(times)))

    def begin_beside(self, *args: Any, **more: Any) -> None:
        """Leave out other clocks."""

    def note(self, kind: str, *, sample: int | None = None, **facts: str | float) -> None:
        """Keep the set points."""
        if kind == "drive":
            self._voltage = float(facts["voltage_peak_to_peak"])
        elif kind == "motor":
            self._speed = float(facts["rotation_speed"]) * pi * self._diameter
        if self._is_open and kind in ("drive", "motor"):
            first = self.parts[-1].blocks[0].first_sample if self.parts[-1].blocks else sample or 0
            self.parts[-1].settings.append(((sample or 0) - first, self._voltage, self._speed))

    def finish(self, outcome: str, *, reason: str = "") -> None:
        """Nothing is open."""


def require_completed(name: str, *, outcome: str, reason: str) -> None:
    """Raise KeyboardInterrupt where a signal ended a run, so that its trial is tried again, and else RuntimeError."""
    if outcome != "completed":
        raise (KeyboardInterrupt if reason.startswith(_BY_SIGNAL) else RuntimeError)(f"{name}: {reason}")


def run_shortened(
    rig: Rig, name: str, *, seed: int, disturbances: Disturbances | None = None
) -> "tuple[list[Part], xr.Dataset, float]":
    """Parts of a shortened protocol on the virtual rig, its truth, and the diameter of the groove in m.

    A signal that ends the run, with the devices off, raises KeyboardInterrupt: it is no failure of what is tried.
    """
    protocol = shortened(name)
    diameter = protocol.metadata.groove_diameter or 0.028
    virtual = virtual_tribometer(rig, seed=seed, groove_diameter=diameter, disturbances=disturbances)
    record = PartsInMemory(virtual, diameter)
    result = run_protocol(protocol, virtual.devices, record, operator=lambda prompt: True)
    require_completed(name, outcome=result.outcome, reason=result.reason)
    return record.parts, virtual.truth(), diameter
