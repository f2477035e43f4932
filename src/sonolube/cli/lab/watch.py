"""Command `lab watch`: a run that is being recorded, followed from another terminal by its folder."""

import os
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from shlex import quote
from threading import Event
from typing import Annotated, Any, Final

import typer

from sonolube.cli.console.delivery import deliver
from sonolube.cli.console.options import Json
from sonolube.interruption import asked_by_signal
from sonolube.laboratory.records import Observation, RunObserver, run_to_watch
from sonolube.printable_text import printable
from sonolube.tasks.answer import Answer, answer, si
from sonolube.tasks.blocks import Block, Rows
from sonolube.tasks.lab.run_answer import SIMULATED
from sonolube.units import format_si
from sonolube.vocabulary import unit_of

LOOK_INTERVAL = 0.5
"""Between two looks at a run. [s]"""

LINE_INTERVAL = 5.0
"""Between two lines where standard output is no terminal, while the state stays. [s]"""

_WIDTH: Final = 80  # of a terminal that does not tell its own
_QUIET: Final = 5.0  # s without a block or event that are told
_SHOWN: Final = ("friction_force", "normal_load", "temperature", "voltage_peak_to_peak")


def watch(
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="A run, or a folder of runs.")] = Path("runs"),
    once: Annotated[bool, typer.Option("--once", help="Look once, whether the run goes on or not.")] = False,
    json: Json = False,
) -> None:
    """Follow a run that is being recorded: state, step, time, friction, load, temperature, set points, trips, outcome.

    Of a folder of runs the newest that is at work, else the newest. Only reads; Ctrl-C ends watching, not the run. Exit
    code 0 while the run goes on or if it was completed, else 1.

    Example: sonolube lab watch runs
    """
    observer = RunObserver(run_to_watch(folder))
    seen = observer.look() if once else _follow(observer, is_quiet=json)
    deliver(WatchedRun(seen=seen), as_json=json)


def _follow(observer: RunObserver, *, is_quiet: bool) -> Observation:
    """Look until the run or the watching ends, with lines unless it is to be quiet, and return the last look."""
    ended, display = Event(), _Display(is_quiet=is_quiet)
    with asked_by_signal(lambda reason: ended.set()):
        seen = observer.look()
        while seen.is_running and not ended.is_set():
            display.show(seen)
            ended.wait(LOOK_INTERVAL)
            seen = observer.look()
    display.close()
    return seen


class _Display:
    """Line of a run on standard output: written over on a terminal, else a further one every few seconds.

    Parameters
    ----------
    is_quiet : bool
        Whether nothing is shown.
    """

    def __init__(self, *, is_quiet: bool) -> None:
        self._is_quiet, self._is_terminal = is_quiet, sys.stdout.isatty()
        self._state, self._next = ("", 0), 0.0

    def show(self, seen: Observation) -> None:
        """Show a look at a run."""
        if self._is_quiet:
            return
        line = printable(observation_line(seen))
        if self._is_terminal:
            width = (os.get_terminal_size(sys.stdout.fileno()).columns or _WIDTH) - 1
            sys.stdout.write(f"\r{line[:width]}\x1b[K")
            sys.stdout.flush()
            return
        state, now = (seen.state, len(seen.trips)), time.monotonic()
        if state != self._state or now >= self._next:
            self._state, self._next = state, now + LINE_INTERVAL
            sys.stdout.write(f"{line}\n")
            sys.stdout.flush()

    def close(self) -> None:
        """Remove the line that is written over."""
        if self._is_terminal and not self._is_quiet:
            sys.stdout.write("\r\x1b[K")
            sys.stdout.flush()


def observation_line(seen: Observation) -> str:
    """Line of a look at a run: state, step, time, means of the last second, set points, and what is wrong.

    Parameters
    ----------
    seen : Observation

    Returns
    -------
    str
    """
    parts = [seen.state, _step(seen), _time(seen), _means(seen), _set_points(seen), *_warnings(seen)]
    return "; ".join(filter(None, parts))


@answer
class WatchedRun(Answer):
    """A run at the last look."""

    seen: Observation

    def blocks(self) -> Sequence[Block]:
        """Outcome or state, and what was seen last."""
        seen = self.seen
        outcome = seen.outcome + (f": {seen.reason}" if seen.reason and not seen.is_running else "")
        rows = [
            ("outcome", outcome),
            ("state", seen.state + (f": {seen.reason}" if seen.reason and seen.is_running else "")),
            ("step", _step(seen).removeprefix("step ")),
            ("time", _time(seen)),
            ("last second", _means(seen)),
            ("set", _set_points(seen).removeprefix("set ")),
            *(("limit", trip) for trip in seen.trips),
        ]
        return [f"{seen.folder.name}: {seen.known.title}", Rows([row for row in rows if row[1]])]

    def object(self) -> dict[str, Any]:
        """Same in SI."""
        seen = self.seen
        times = {"protocol_time": seen.protocol_time, "duration": seen.duration, "time_left": seen.time_left}
        return {
            "folder": str(seen.folder),
            "title": seen.known.title,
            "simulated": bool(seen.known.facts.get("simulated", False)),
            "outcome": seen.outcome,
            "reason": seen.reason,
            "state": seen.state,
            "step": seen.step,
            "step_kind": seen.step_kind,
            **si(times, unit="s"),
            "means": {name: {"value": value, "unit": unit} for name, (value, unit) in seen.means.items()},
            "set_points": si(seen.set_points),
            "trips": list(seen.trips),
            "gaps": seen.gaps,
            **si({"silence": seen.silence if seen.is_running else None}, unit="s"),
        }

    def caveats(self) -> Sequence[str]:
        """A writer that has died, samples that are missing, and a run that writes nothing."""
        seen = self.seen
        told = [line for line in _warnings(seen) if line not in seen.trips]
        if seen.outcome == "unfinished":
            remedy = f"sonolube lab recover {quote(str(seen.folder))}"
            told.append(f"the program died during the run, and motor or drive may be on; {remedy} completes its record")
        if seen.known.facts.get("simulated"):
            told.append(SIMULATED)
        return told

    @property
    def is_failure(self) -> bool:
        """Whether the run has ended before its protocol."""
        return not (self.seen.is_running or self.seen.outcome == "completed")


def _step(seen: Observation) -> str:
    """Step with its kind."""
    return f"step {seen.step} {seen.step_kind.replace('_', ' ')}".rstrip() if seen.step else ""


def _time(seen: Observation) -> str:
    """Time into the protocol and left."""
    if seen.duration is None or seen.time_left is None:
        return f"{seen.protocol_time:.1f} s"
    return f"{seen.protocol_time:.1f} s of {seen.duration:.1f} s, {seen.time_left:.1f} s left"


def _means(seen: Observation) -> str:
    """Friction, load and temperature with units, and the voltage where it is not among the set points."""
    shown = [name for name in _SHOWN if name in seen.means and name not in seen.set_points]
    found = [(name, *seen.means[name]) for name in shown]
    return ", ".join(
        f"{name.replace('_', ' ')} {'no number' if value is None else format_si(value, unit)}"
        for name, value, unit in found
    )


def _set_points(seen: Observation) -> str:
    """Set points of motor and drive while they are on."""
    known = seen.set_points
    shown = [name for name in known if name != "rotation_speed" or "sliding_speed" not in known]
    texts = [f"{name.replace('_', ' ')} {format_si(known[name], unit_of(name))}" for name in shown]
    return f"set {', '.join(texts)}" if texts else ""


def _warnings(seen: Observation) -> list[str]:
    """Limits that were exceeded, gaps, and silence while the run should write."""
    told = list(seen.trips)
    if seen.gaps:
        told.append(f"samples are missing in {seen.gaps} places")
    if seen.is_running and seen.means and seen.silence > _QUIET:
        told.append(f"nothing was written for {seen.silence:.0f} s")
    return told
