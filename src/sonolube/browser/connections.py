"""Connections to the server, bounded in number and in time until their request is whole; others stay answered."""

import asyncio
from typing import Any, Final

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

MAX_WAITING: Final = 200
"""Connections whose request is not whole, fewer than the files that a process may open; the oldest gives way."""

_TIME_OF_A_HEAD: Final = 10.0  # s, until all lines of a request are there
_TIME_OF_A_BODY: Final = 30.0  # s, between two pieces of what is uploaded

_WAITING: Final[dict["BoundedProtocol", None]] = {}  # in the order in which they came


class BoundedProtocol(H11Protocol):
    """HTTP by h11 that closes a connection whose request does not become whole."""

    _end: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Wait for a request."""
        super().connection_made(transport)  # type: ignore[arg-type]
        _WAITING[self] = None
        if len(_WAITING) > MAX_WAITING:
            next(iter(_WAITING))._abort()
        self._wait(_TIME_OF_A_HEAD)

    def connection_lost(self, exc: Exception | None) -> None:
        """Wait no more."""
        self._settle()
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Take what arrived, and wait for the rest of the request."""
        super().data_received(data)
        state: Any = self.conn.their_state
        if state is h11.SEND_BODY:
            self._wait(_TIME_OF_A_BODY)
        elif state is not h11.IDLE:
            self._settle()
        elif self._end is None:  # of a further request on the same connection
            self._wait(_TIME_OF_A_HEAD)

    def _wait(self, seconds: float) -> None:
        """Close the connection unless its request is whole in time."""
        if self._end is not None:
            self._end.cancel()
        self._end = self.loop.call_later(seconds, self._abort)

    def _settle(self) -> None:
        """Count the connection no more among those that wait."""
        _WAITING.pop(self, None)
        if self._end is not None:
            self._end.cancel()
            self._end = None

    def _abort(self) -> None:
        """Close the connection without an answer."""
        self._settle()
        self.transport.abort()
