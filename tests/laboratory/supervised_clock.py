"""Clock of a supervisor in tests."""


class Clock:
    """Clock of the supervisor, which stands unless a test sets it forward."""

    def __init__(self) -> None:
        self.now = 0.0

    def monotonic(self) -> float:
        return self.now
