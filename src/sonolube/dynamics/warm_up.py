"""Compiling what a first call needs in two processes side by side, since within one numba compiles kernel after kernel.

While the caller's process compiles the kernel that comes first, another one compiles those that follow, into the cache
that all processes share. Later calls find everything there and start nothing.
"""

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress

import numpy as np
from numba.core.event import Event, Listener, install_listener

from sonolube.dynamics.friction_average.elliptic_quadrature import crowded_points
from sonolube.dynamics.friction_average.kernel import precision, scratch, sliding_means
from sonolube.dynamics.harmonic_balance.contact_kernel import Compiled, Law
from sonolube.dynamics.harmonic_balance.floquet_kernel import growth_rates, period_room
from sonolube.dynamics.harmonic_balance.harmonic_kernel import balance


class Helper(Listener):
    """A process that compiles what follows `balance`, from when that has to be compiled."""

    def __init__(self, compiled: Compiled, stability: bool, tolerance: float) -> None:
        choices = len(compiled.kind), len(compiled.damped), stability, tolerance
        self._work = f"from {__name__} import compile_what_follows; compile_what_follows{choices}"
        self._process: subprocess.Popen[bytes] | None = None

    def on_start(self, event: Event) -> None:
        """Start the process; where none can be started, its work is left to the caller."""
        if event.data["dispatcher"] is balance and self._process is None:
            silent = subprocess.DEVNULL
            with suppress(OSError):
                self._process = subprocess.Popen(
                    [sys.executable, "-P", "-c", self._work], stdin=silent, stdout=silent, stderr=silent
                )

    def on_end(self, event: Event) -> None:
        """Let the process go on."""

    def wait(self) -> int | None:
        """Return the process's exit status once it has ended, or None if there was none."""
        return None if self._process is None else self._process.wait()

    def stop(self) -> None:
        """End the process at once if it is still running."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()


@contextmanager
def compiling_alongside(compiled: Compiled, *, stability: bool, tolerance: float) -> Iterator[Helper]:
    """Where `balance` has to be compiled, have another process compile what judges and averages its answers meanwhile.

    Parameters
    ----------
    compiled : Compiled
    stability : bool
        Whether stability is to be judged.
    tolerance : float
        Relative error of the steady states, on which the precision of their means depends.

    Yields
    ------
    Helper
        It has ended when the context has.
    """
    helper = Helper(compiled, stability, tolerance)
    if (os.cpu_count() or 1) == 1 or not sys.executable or getattr(sys, "frozen", False):
        yield helper  # which no event will start
        return
    try:
        with install_listener("numba:compile", helper):
            yield helper
        helper.wait()
    finally:
        helper.stop()


def compile_what_follows(kind: int, damped: int, stability: bool, tolerance: float) -> None:
    """Compile, and so cache, the kernels that follow `balance`, by giving them no points to treat.

    Parameters
    ----------
    kind, damped : int
        Lengths of the tuples of `sonolube.dynamics.harmonic_balance.contact_kernel.Compiled`.
    stability, tolerance
        As in `compiling_alongside`.
    """
    compiled, law = Compiled((0,) * kind, (0,) * damped), Law(0.0, 0.0, np.empty((0, 4)))
    nothing, points = np.empty((0, 0)), np.empty(0, dtype=np.int64)
    speeds = np.ones(1, dtype=precision(tolerance))
    if stability:
        room, rates = period_room(0, 0), np.empty(0)
        growth_rates(*compiled, law, nothing, nothing, nothing, nothing, points, points, points, room, rates, rates)
    means = np.empty((2, 0, 1))
    sliding_means(
        *compiled, law, nothing, nothing, points, points, points, speeds, crowded_points(0), scratch(0, speeds), means
    )
