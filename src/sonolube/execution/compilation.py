"""Kernels: loops that numba compiles when they are first called, or that run as plain Python for a few points.

numba is imported with the first compiled call, so that commands of one operating point, whose loops are short, neither
load it nor compile anything. There is one source of each kernel: both ways run the same statements.
"""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cached_property, update_wrapper
from pathlib import Path
from threading import RLock
from types import FunctionType
from typing import Any, Generic, ParamSpec, TypeVar, cast

P = ParamSpec("P")
R = TypeVar("R", covariant=True)

INNER: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
"""Options of a kernel that only kernels call: without wrappers it compiles sooner and needs no cache."""

_PLAIN_CALLS = 8  # calls of the largest size that run as plain Python though a compiled kernel may be there
_POINTS_RUN: ContextVar[dict[int, int] | None] = ContextVar("points_run", default=None)
_BUILDING = RLock()


class Kernel(Generic[P, R]):
    """A function of loops over numbers and arrays.

    Parameters
    ----------
    function : callable
        Of other kernels, numpy, numbers and arrays only.
    options : dict
        Of `numba.njit`.
    plain : dict
        Names of the function's module that have other values where the kernel runs as plain Python.
    """

    def __init__(self, function: Callable[P, R], options: dict[str, Any], plain: dict[str, Any]) -> None:
        self.py_func = function
        self._options, self._plain = options, plain
        update_wrapper(self, function)

    def __call__(self, *arguments: P.args, **named: P.kwargs) -> R:
        """Call the compiled function."""
        return self.compiled(*arguments, **named)

    @cached_property
    def compiled(self) -> Callable[P, R]:
        """Function that numba compiles, or reads from its cache, for each set of types."""
        import numba

        with _BUILDING:
            inner = {name: each.compiled for name, each in self._kernels().items()}
            function = self._with_globals(inner)
            try:
                return cast("Callable[P, R]", numba.njit(**self._options)(function))
            except RuntimeError:  # neither the package's folder nor the user's cache can be written
                config: Any = numba.config
                config.CACHE_DIR = private_folder()
                caching = {"cache": bool(config.CACHE_DIR)}
                return cast("Callable[P, R]", numba.njit(**self._options | caching)(function))

    @property
    def cache_folder(self) -> Path:
        """Folder in which numba keeps the compiled function."""
        dispatcher: Any = self.compiled
        return Path(dispatcher.stats.cache_path)

    @cached_property
    def interpreted(self) -> Callable[P, R]:
        """The same statements as plain Python, some hundred times slower, without any time to compile or load."""
        inner: dict[str, Any] = {name: each.interpreted for name, each in self._kernels().items()}
        return cast("Callable[P, R]", self._with_globals(inner | self._plain))

    def for_points(self, count: int, *, most: int = 4, at_first: int = 0) -> Callable[P, R]:
        """Way to run that suits a number of points; counts them."""
        return self._guarded if self.takes_few(count, most=most, at_first=at_first) else self.compiled

    def takes_few(self, count: int, *, most: int = 4, at_first: int = 0) -> bool:
        """Whether this many points are not to be compiled for; counts them; arguments of `for_points`."""
        run = _POINTS_RUN.get()
        if run is None or not self._runs_plain(count, most, at_first):
            return False
        run[id(self)] = run.get(id(self), 0) + count
        return True

    def lanes(self, count: int, compiled: int, *, most: int = 4, at_first: int = 0) -> int:
        """Points of a block of SIMD lanes: one where `for_points` runs as plain Python."""
        return 1 if self._runs_plain(count, most, at_first) else compiled

    def _runs_plain(self, count: int, most: int, at_first: int) -> bool:
        """Whether this many further points run as plain Python."""
        run = _POINTS_RUN.get()
        if run is None:
            return False
        total = run.get(id(self), 0) + count
        return total <= at_first or (count <= most and total <= _PLAIN_CALLS * most)

    def _guarded(self, *arguments: P.args, **named: P.kwargs) -> R:
        """Run as plain Python; compiled where a number leaves the range, which Python refuses and numba does not."""
        import numpy as np

        try:
            with np.errstate(all="ignore"):
                return self.interpreted(*arguments, **named)
        except (ArithmeticError, ValueError):
            return self.compiled(*arguments, **named)

    def _kernels(self) -> dict[str, "Kernel[..., Any]"]:
        """Kernels that the function calls, by their names in its module."""
        known = self.py_func.__globals__
        found = ((name, known.get(name)) for name in self.py_func.__code__.co_names)
        return {name: each for name, each in found if isinstance(each, Kernel)}

    def _with_globals(self, changed: dict[str, Any]) -> Any:
        """Copy of the function for which names of its module have other values."""
        own = self.py_func
        copy = FunctionType(own.__code__, own.__globals__ | changed, own.__name__, own.__defaults__, own.__closure__)
        copy.__module__, copy.__qualname__ = own.__module__, own.__qualname__
        return copy


def private_folder() -> str:
    """Folder among temporary files that nobody else can write, for compiled kernels and the like.

    Its path; empty without one.
    """
    import stat
    import tempfile

    user = os.getuid() if hasattr(os, "getuid") else 0
    folder = Path(tempfile.gettempdir()) / f"sonolube-kernels-{user}"
    try:
        folder.mkdir(mode=stat.S_IRWXU, exist_ok=True)
        found = folder.lstat()
    except OSError:
        return ""
    shared = hasattr(os, "getuid") and (found.st_uid != user or stat.S_IMODE(found.st_mode) & ~stat.S_IRWXU)
    return "" if shared or not stat.S_ISDIR(found.st_mode) else str(folder)


def kernel(*, plain: dict[str, Any] | None = None, **options: Any) -> Callable[[Callable[P, R]], Kernel[P, R]]:
    """Decorator that makes a function a kernel."""
    return lambda function: Kernel(function, options, plain or {})


@contextmanager
def few_points() -> Iterator[None]:
    """Run kernels as plain Python inside a `with` block where that takes less than loading or compiling them.

    For commands, of which most compute few points. `Kernel.for_points` decides by the numbers of points alone; threads
    run compiled kernels unless they are given `thread_initializer`, lest their order decide.
    """
    before = _POINTS_RUN.set({})
    try:
        yield
    finally:
        _POINTS_RUN.reset(before)


@contextmanager
def many_points() -> Iterator[None]:
    """Run compiled kernels inside a `with` block, for files that are the same to the last byte on every way in."""
    before = _POINTS_RUN.set(None)
    try:
        yield
    finally:
        _POINTS_RUN.reset(before)


def thread_initializer() -> Callable[[], None] | None:
    """Function that a thread calls first, so that it shares the `few_points` of its creator; None outside."""
    run = _POINTS_RUN.get()
    if run is None:
        return None

    def share() -> None:
        _POINTS_RUN.set(run)

    return share


def runs_plain(count: int, *, most: int = 4) -> bool:
    """Whether so few points run without compiled code or special functions, which would have to be loaded."""
    return _POINTS_RUN.get() is not None and count <= most
