"""A motor controller on a pseudo-terminal, which VISA takes as a serial port."""

import os
import re
import threading
import tty
from dataclasses import dataclass, field


@dataclass
class Controller:
    """Speed of a motor, in counts; 1 count is 0.1 rpm of the disc."""

    counts: int = 0
    is_enabled: bool = False
    most: int = 3000
    heard: list[str] = field(default_factory=list)
    is_mute: bool = False
    reads_back: int | None = None

    def answer(self, line: str) -> str | None:
        """Answer to a line, None where it keeps silent."""
        self.heard.append(line)
        if self.is_mute:
            return None
        if line == "EN":
            self.is_enabled = True
            return "OK"
        if line == "GV":
            return str(self.counts if self.reads_back is None else self.reads_back)
        found = re.fullmatch(r"V(\d+)", line)
        if found is None or int(found[1]) > self.most or (int(found[1]) and not self.is_enabled):
            return "ERR"
        self.counts = int(found[1])
        return "OK"


class SerialPort:
    """Pseudo-terminal with a controller at its other end."""

    def __init__(self, controller: Controller) -> None:
        self._controller = controller
        self._here, self._there = os.openpty()
        tty.setraw(self._there)
        self.path = os.ttyname(self._there)
        os.set_blocking(self._here, False)
        self._is_closing = threading.Event()
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    @property
    def resource(self) -> str:
        """Name by VISA."""
        return f"ASRL{self.path}::INSTR"

    def close(self) -> None:
        """End the thread and remove the port."""
        self._is_closing.set()
        self._thread.join()
        os.close(self._here)
        os.close(self._there)

    def _serve(self) -> None:
        waiting = b""
        while not self._is_closing.wait(0.002):
            try:
                waiting += os.read(self._here, 4096)
            except BlockingIOError:
                continue
            while b"\r" in waiting:
                line, waiting = waiting.split(b"\r", 1)
                answer = self._controller.answer(line.decode("ascii"))
                if answer is not None:
                    os.write(self._here, answer.encode("ascii") + b"\r")
