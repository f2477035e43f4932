"""Work counted, so that bounds on it hold on every machine however busy it is."""

import sys
from collections.abc import Callable
from typing import Any


def calls(act: Callable[[], object]) -> int:
    """Calls of functions of Python and of C while something is done once.

    Code is imported and caches are filled by doing it once before; each item that Python code goes through costs a call
    or more, while one call of C may go through many.
    """
    count = 0

    def take(frame: object, event: str, argument: Any) -> None:
        nonlocal count
        count += event in ("call", "c_call")

    before = sys.getprofile()
    sys.setprofile(take)
    try:
        act()
    finally:
        sys.setprofile(before)
    return count
