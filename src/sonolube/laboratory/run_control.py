"""Requests to a running protocol, from other threads and from signals."""

from dataclasses import dataclass, field
from threading import Event as Signal


@dataclass(slots=True)
class RunControl:
    """Requests to a running protocol.

    Parameters
    ----------
    stop_reason : str
        Why the run is to end; empty while it is not.
    """

    stop_reason: str = ""
    _pause: Signal = field(default_factory=Signal)

    def stop(self, reason: str) -> None:
        """End the run after the present block."""
        self.stop_reason = self.stop_reason or reason

    def pause(self) -> None:
        """Switch motor and drive off after the present block, and let the clock stand."""
        self._pause.set()

    def resume(self) -> None:
        """Resume after a pause."""
        self._pause.clear()

    @property
    def is_paused(self) -> bool:
        """Whether a pause is wanted."""
        return self._pause.is_set()
