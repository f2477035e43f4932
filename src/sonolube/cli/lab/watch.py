"""Command `lab watch`: a run that is being recorded, followed from another terminal by its folder."""

import os
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Final

import typer

from sonolube.cli.console.delivery import deliver
from sonolube.cli.console.options import Json
from sonolube.laboratory.records import Observation, RunObserver, run_to_watch
from sonolube.report.results import ended_run as results
from sonolube.storage.interruption import asked_by_signal
from sonolube.tasks.answer import Answer, Block, answer
from sonolube.text.plain_text import printable

LOOK_INTERVAL = 0.5
"""Between two looks at a run. [s]"""

LINE_INTERVAL = 5.0
"""Between two lines where standard output is no terminal, while the state stays. [s]"""

_POLL: Final = 0.05  # s
_WIDTH: Final = 80  # of a terminal that does not tell its own


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
    end, display = EndOfWatching(), _Display(is_quiet=is_quiet)
    with asked_by_signal(end.ask):
        seen = observer.look()
        while seen.is_running and not end.is_asked:
            display.show(seen)
            end.wait(LOOK_INTERVAL)
            seen = observer.look()
    display.close()
    return seen


class EndOfWatching:
    """End of the watching, asked for by the handler of a signal; an `Event` might wait for the lock it interrupts."""

    def __init__(self) -> None:
        self.is_asked = False

    def ask(self, reason: str) -> None:
        """End the watching."""
        del reason
        self.is_asked = True

    def wait(self, longest: float) -> None:
        """Wait for a time, in s, or until the end is asked for."""
        latest = time.monotonic() + longest
        while not self.is_asked and (left := latest - time.monotonic()) > 0:
            time.sleep(min(left, _POLL))


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
        line = printable(results.observation_line(seen))
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


@answer
class WatchedRun(Answer):
    """A run at the last look."""

    seen: Observation

    def blocks(self) -> Sequence[Block]:
        """Outcome or state, and what was seen last."""
        return results.observation_blocks(self.seen)

    def object(self) -> dict[str, Any]:
        """Same in SI."""
        return results.observation_object(self.seen)

    def caveats(self) -> Sequence[str]:
        """A writer that has died, samples that are missing, and a run that writes nothing."""
        return results.observation_caveats(self.seen)

    @property
    def is_failure(self) -> bool:
        """Whether the run has ended before its protocol."""
        return not (self.seen.is_running or self.seen.outcome == "completed")
