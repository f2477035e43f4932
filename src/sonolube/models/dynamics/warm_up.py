"""Parallel compilation of the kernels at a first call: numba compiles one kernel after another within a process.

While the caller's process compiles the first kernel, a second process compiles those that follow, into the cache that
all processes share. Later calls find every kernel there and start no process.
"""

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numba.core.event import Event

from sonolube.execution.compilation import runs_plain
from sonolube.models.dynamics.friction_average.elliptic_kernel import (
    elliptic_averages,
    friction_workspace,
    sum_precision,
)
from sonolube.models.dynamics.friction_average.elliptic_quadrature import elliptic_nodes
from sonolube.models.dynamics.harmonic_balance.floquet_kernel import monodromy_power_norms, period_workspace
from sonolube.models.dynamics.harmonic_balance.harmonic_kernel import newton_solve
from sonolube.models.dynamics.kernels.contact_kernel import KernelLaw
from sonolube.storage.interruption import undone_at_signal

_KERNELS = (newton_solve, monodromy_power_norms, elliptic_averages)


def compiled_code_folder() -> Path:
    """Folder in which numba keeps the compiled kernels; without a place for it the import fails."""
    return newton_solve.cache_folder


def is_compiled() -> bool:
    """Whether every kernel of a steady state and its friction has been compiled and kept, for any contact law."""
    names = [(each.cache_folder, f"*.{each.py_func.__name__}-*.nbi") for each in _KERNELS]
    return all(any(folder.glob(name)) for folder, name in names)


class CompileProcess:
    """Process that compiles the kernels after `newton_solve`, started when numba begins to compile that one.

    Parameters
    ----------
    law : KernelLaw
    stability : bool
        Whether stability is to be computed.
    tolerance : float
        Relative error of the steady states.
    """

    def __init__(self, law: KernelLaw, stability: bool, tolerance: float) -> None:
        arguments = len(law.kind), len(law.damped), stability, tolerance
        call = f"from {__name__} import compile_remaining_kernels; compile_remaining_kernels{arguments}"
        self._code = f"import gc; gc.disable(); {call}"  # numba makes many objects, of which little is garbage
        self._process: subprocess.Popen[bytes] | None = None

    def on_start(self, event: "Event") -> None:
        """Start the process; where that fails, the caller compiles the remaining kernels itself."""
        if event.data["dispatcher"] is newton_solve.compiled and self._process is None:
            silent, command = subprocess.DEVNULL, [sys.executable, "-P", "-c", self._code]
            with suppress(OSError):
                self._process = subprocess.Popen(command, stdin=silent, stdout=silent, stderr=silent)

    def on_end(self, event: "Event") -> None:
        """Wait for the process after `newton_solve`: it is ahead with the kernels that the caller requires next."""
        if event.data["dispatcher"] is newton_solve.compiled:
            self.wait()

    def wait(self) -> int | None:
        """Wait for the process and return its exit status, or None if none was started."""
        return None if self._process is None else self._process.wait()

    def stop(self) -> None:
        """Kill the process if it is still running."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()


@contextmanager
def compile_in_parallel(law: KernelLaw, *, stability: bool, tolerance: float) -> Iterator[CompileProcess]:
    """Compile the kernels for stability and friction in a second process if `newton_solve` has to be compiled within.

    It has ended when the context has.
    """
    process = CompileProcess(law, stability, tolerance)
    if runs_plain(1) or (os.cpu_count() or 1) == 1 or not sys.executable or getattr(sys, "frozen", False):
        yield process  # not listening, and hence never started
        return
    from numba.core.event import Listener, install_listener

    listener: Any = type("CompileListener", (Listener,), {"on_start": process.on_start, "on_end": process.on_end})()
    try:
        with undone_at_signal(process.stop), install_listener("numba:compile", listener):
            yield process
        process.wait()
    finally:
        process.stop()


def compile_remaining_kernels(kind: int, damped: int, stability: bool, tolerance: float) -> None:
    """Compile, and so cache, the kernels that follow `newton_solve`, by calling them with empty batches."""
    law = KernelLaw((0,) * kind, (0,) * damped, 0.0, 0.0, np.empty((0, 4)))
    empty, points = np.empty((0, 0)), np.empty(0, dtype=np.int64)
    speeds = np.ones(1, dtype=sum_precision(tolerance))
    if stability:
        work, norms = period_workspace(0, 0), np.empty(0)
        monodromy_power_norms(law, empty, empty, empty, empty, points, points, points, work, norms, norms)
    averages, nodes = np.empty((2, 0, 1)), elliptic_nodes(0)
    workspace = friction_workspace(0, speeds)
    elliptic_averages(law, empty, empty, points, points, points, speeds, nodes, workspace, averages)
