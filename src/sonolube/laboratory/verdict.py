"""Verdict on motor and drive at the end of a run: measured off, confirmed off, or cut the power; made here alone."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Final

OUTPUTS: Final = ("drive", "motor")
"""Outputs of a rig that a verdict is about."""


class Outputs(Enum):
    """State of motor and drive after a run, as far as it is known."""

    MEASURED_OFF = "measured off"
    """A channel of each has shown that it is off, after it was switched off for the last time."""
    CONFIRMED_OFF = "confirmed off"
    """Each device has confirmed that it is off, and none was still at work on another call; not all were measured."""
    CUT_THE_POWER = "cut the power"
    """An output may be on."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """Verdict on motor and drive.

    Parameters
    ----------
    outputs : Outputs
    basis : str
        What it rests on, in words; of an output that may be on, why.
    """

    outputs: Outputs
    basis: str = ""

    @property
    def text(self) -> str:
        """Verdict in one line."""
        between = ": " if self.outputs is Outputs.CUT_THE_POWER else ", "
        return between.join(filter(None, (self.outputs.value, self.basis)))

    @property
    def is_off(self) -> bool:
        """Whether motor and drive are off."""
        return self.outputs is not Outputs.CUT_THE_POWER


def verdict_text(verdict: Verdict | None) -> str:
    """Verdict in one line, also of a run that ended before it connected a device."""
    return "as they were before the run, which connected no device" if verdict is None else verdict.text


def verdict_on(failures: Sequence[str], measured: Mapping[str, str]) -> Verdict:
    """Verdict on motor and drive from what was seen when they were switched off.

    Parameters
    ----------
    failures : sequence of str
        Devices that have not confirmed to be off, or that are still at work on a call which may switch on.
    measured : mapping of str to str
        Outputs that a channel has shown since: empty where it is off, else why it counts as on.

    Returns
    -------
    Verdict
    """
    on = [*failures, *filter(None, measured.values())]
    if on:
        return Verdict(Outputs.CUT_THE_POWER, "; ".join(dict.fromkeys(on)))
    unseen = [name for name in OUTPUTS if name not in measured]
    if not unseen:
        return Verdict(Outputs.MEASURED_OFF)
    seen = [f"{name} measured off" for name in OUTPUTS if name in measured]
    word = f"{' and '.join(unseen)} by the device's own word, not measured"
    return Verdict(Outputs.CONFIRMED_OFF, "; ".join([*seen, word]))


def exit_code(verdict: Verdict | None, *, is_failure: bool) -> int:
    """Exit code of a program that has run devices: 3 where motor or drive may be on, else 1 for a failure."""
    return 3 if verdict is not None and not verdict.is_off else int(is_failure)
