"""Set points of a part of a recording, as a table of steps that is read from the notes of a run."""

import json
from collections.abc import Mapping
from math import ceil
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from sonolube.laboratory.records.documents import ReadDocuments, part_name
from sonolube.laboratory.records.run_folder import LATEST, Facts, number_of

SET_POINT_CHANNELS: Final = (
    *("sliding_speed_set", "motor_on", "voltage_peak_to_peak_set", "frequency_set"),
    *("normal_load_set", "lubricant_set", "recording_part"),
)
"""Channels of a recording that hold set points, by their names in the vocabulary."""

_MOTOR: Final = ("sliding_speed_set", "motor_on")
_DRIVE: Final = ("voltage_peak_to_peak_set", "frequency_set")


def set_point_steps(
    documents: ReadDocuments,
    part: int,
    *,
    first_sample: int,
    facts: Facts,
    own_clock: tuple[float, float] | None = None,
) -> "SetPointSteps":
    """Set points of a part of a recording, those before it at its first sample."""
    found = SetPointSteps(first_sample, facts)
    uid = ""
    for name, document in documents.documents:
        if name == "descriptor" and document.get("name") == part_name(part):
            uid = str(document["uid"])
            found.begin()
        elif name == "stream_datum" and uid and document.get("descriptor") == uid:
            break  # the part has ended
        elif name == "event":
            found.take(document["data"] if own_clock is None else _timed(document, first_sample, *own_clock))
    found.end(part)
    return found


def _timed(document: Mapping[str, Any], first_sample: int, begun: float, sample_rate: float) -> Mapping[str, Any]:
    """Data of a note with the sample of another clock at its time."""
    time = document.get("time")
    if not isinstance(time, int | float) or abs(time) > LATEST:
        return {**document["data"], "sample": None}
    return {**document["data"], "sample": first_sample + max(ceil((time - begun) * sample_rate), 0)}


class SetPointSteps:
    """Set points of a part of a recording, as the notes of its run are followed.

    Attributes
    ----------
    lubricants : list of str
        Names of the lubricants 1, 2, ...
    drives : bool
        Whether the drive was used in the run before the end of the part.
    read_back : list of (int or None, str)
        Sample from which settings held, and what the source answered of them; None for those before the part.
    """

    def __init__(self, first_sample: int, facts: Facts) -> None:
        load = number_of(facts, "normal_load")
        self._state = dict.fromkeys(SET_POINT_CHANNELS, 0.0)
        self._state |= dict.fromkeys((*_MOTOR, *_DRIVE), float("nan"))
        self._state["normal_load_set"] = float("nan") if load is None else load
        self._first, self.lubricants, self.drives = first_sample, list[str](), False
        self.read_back = list[tuple[int | None, str]]()
        self._samples, self._rows = list[int](), list[dict[str, float]]()  # set points hold from each sample on

    @property
    def names(self) -> tuple[str, ...]:
        """Channels of which any value is known."""
        return tuple(name for name in SET_POINT_CHANNELS if any(row[name] == row[name] for row in self._rows))

    @property
    def frequencies(self) -> tuple[float, ...]:
        """Frequencies of the drive while it was on, ascending. [Hz]"""
        found = {row["frequency_set"] for row in self._rows if row["voltage_peak_to_peak_set"] > 0}
        return tuple(sorted(each for each in found if each > 0))

    def at(self, name: str, numbers: NDArray[np.int64]) -> NDArray[np.float64]:
        """Values of a channel, in SI, at samples by their numbers; NaN where they are not known."""
        values = np.array([row[name] for row in self._rows])
        return values[np.maximum(np.searchsorted(self._samples, numbers, side="right") - 1, 0)]

    def begin(self) -> None:
        """Begin the part, in which the latest settings that were read back hold."""
        self.read_back = [(None, answers) for _, answers in self.read_back[-1:]]
        self._samples, self._rows = [self._first], [dict(self._state)]

    def take(self, data: Mapping[str, Any]) -> None:
        """Update the set points by a note of the run."""
        if str(data["kind"]) == "read back" and (answers := _facts(data).get("answers")):
            sample = data.get("sample")
            self.read_back.append((sample if isinstance(sample, int) else None, str(answers)))
        changes = self._changes(str(data["kind"]), data)
        self._state |= changes
        sample = data.get("sample")
        if not changes or not self._samples or not isinstance(sample, int):
            return
        if self._samples[-1] >= max(sample, self._first):  # of several at one sample the last holds
            self._rows[-1] = dict(self._state)
        else:
            self._samples.append(sample)
            self._rows.append(dict(self._state))

    def end(self, part: int) -> None:
        """End the part, whose number is known now."""
        if not self._samples:
            self.begin()
        for row in self._rows:
            row["recording_part"] = float(part)
            if self.drives:  # before its first note the drive was off
                row.update({name: 0.0 for name in _DRIVE if row[name] != row[name]})

    def _changes(self, kind: str, data: Mapping[str, Any]) -> dict[str, float]:
        """Set points that a note changes."""
        if kind == "prepared":  # devices were connected, motor and drive off
            return dict.fromkeys((*_MOTOR, *_DRIVE), 0.0)
        if kind == "pause":
            return {name: 0.0 for name in (*_MOTOR, *_DRIVE) if self._state[name] == self._state[name]}
        if kind not in ("drive", "motor", "conditions"):
            return {}
        return self._told(kind, _facts(data))

    def _told(self, kind: str, facts: Mapping[str, Any]) -> dict[str, float]:
        """Set points by the facts of a note."""
        if kind == "drive":
            volts = number_of(facts, "voltage_peak_to_peak")
            if volts is None:
                return {}
            self.drives = True
            frequency = number_of(facts, "frequency") or 0.0
            return {"voltage_peak_to_peak_set": volts, "frequency_set": frequency if volts else 0.0}
        if kind == "motor":
            turns, speed = number_of(facts, "rotation_speed"), number_of(facts, "sliding_speed")
            on = turns if turns is not None else speed
            known = {} if on is None else {"motor_on": float(on > 0)}
            slides = speed if speed is not None else 0.0 if on == 0 else float("nan")
            return known | {"sliding_speed_set": slides}
        load = number_of(facts, "normal_load")
        changes = {} if load is None else {"normal_load_set": load}
        if isinstance(name := facts.get("lubricant"), str):
            changes["lubricant_set"] = self._number_of(name)
        return changes

    def _number_of(self, lubricant: str) -> float:
        """Number of a lubricant."""
        if not lubricant:
            return 0.0
        if lubricant not in self.lubricants:
            self.lubricants.append(lubricant)
        return 1.0 + self.lubricants.index(lubricant)


def _facts(data: Mapping[str, Any]) -> Mapping[str, Any]:
    """Facts of a note; none where they are damaged."""
    try:
        facts = json.loads(data["facts"])
    except (ValueError, RecursionError):
        return {}
    return facts if isinstance(facts, dict) else {}
