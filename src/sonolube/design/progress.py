"""Type of the callbacks that report the progress of long computations."""

from collections.abc import Callable

ProgressCallback = Callable[[int, int], None]
"""Called with the number of finished items and their total."""
