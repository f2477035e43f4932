"""Clock of a run, which does not jump: the time of day at its begin and a steady clock since."""

import time
from typing import Final

_MIN_JUMP: Final = 0.5  # s; larger than what a time service corrects at once without stepping the clock


class RunClock:
    """Time of day that goes on evenly although the clock of the computer is set meanwhile."""

    def __init__(self) -> None:
        self.begun = time.time()
        self._steady = time.monotonic()
        self._ahead = 0.0  # of the clock of the computer before this one

    def now(self) -> float:
        """Time since 1970 by this clock. [s]"""
        return self.begun + time.monotonic() - self._steady

    def jump(self) -> float:
        """Jump of the computer's clock since the last call, positive where it was set forward; else 0. [s]"""
        ahead = time.time() - self.now()
        jump = ahead - self._ahead
        if abs(jump) < _MIN_JUMP:
            return 0.0
        self._ahead = ahead
        return jump
