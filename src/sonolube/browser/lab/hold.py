"""Hold of the laboratory: one tab at a time starts and steers runs, kept by its requests, and lost after a silence."""

import json
import re
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, Final

from sonolube.errors import InvalidInput
from sonolube.storage.files import locked_folder, write_atomically

SILENCE: Final = 15.0
"""Time without a request after which the hold is free. [s]"""

_REFRESH: Final = 1.0  # s, between two records of the hold
_NAME: Final = re.compile(r"[A-Za-z0-9-]{8,64}")
_FILE: Final = "hold.json"


class Hold:
    """Hold of one user's laboratory, in a file that all workbenches of the user read.

    Parameters
    ----------
    folder : Path
    clock : callable
        Time in s since 1970.
    """

    def __init__(self, folder: Path, clock: Callable[[], float] = time.time) -> None:
        self._folder, self._clock = folder, clock

    def state(self, holder: str) -> dict[str, bool]:
        """Whether a tab has the hold, and whether it is free; a request of its holder keeps it."""
        present = self._present()
        if holder and present == holder:
            self._keep(holder)
        return {"is_me": bool(holder) and present == holder, "is_free": not present}

    def take(self, holder: str) -> None:
        """Give the hold to a tab.

        Raises
        ------
        InvalidInput
            If another has it.
        """
        if not _NAME.fullmatch(holder):
            raise InvalidInput("holder: give 8 to 64 letters, digits or hyphens that the tab has drawn", key="holder")
        with locked_folder(self._folder / "hold", purpose="workbench"):
            if self._present() not in ("", holder):
                raise InvalidInput(
                    "another tab has the laboratory; it is free when that releases it, or is silent for 15 s; everybody"
                    " may stop a run",
                    key="holder",
                )
            self._write(holder)

    def release(self, holder: str) -> None:
        """Free the hold where a tab has it."""
        if holder and self._present() == holder:
            self._write("")

    def require(self, holder: str) -> None:
        """Raise if a tab has not the hold; its request keeps it."""
        if not holder or self._present() != holder:
            raise InvalidInput("take the laboratory first: this tab watches only", key="holder")
        self._keep(holder)

    def _present(self) -> str:
        """Tab that has the hold; empty where it is free."""
        known = self._read()
        holder, seen = known.get("holder"), known.get("seen")
        if not isinstance(holder, str) or not isinstance(seen, int | float):
            return ""
        return holder if abs(self._clock() - seen) < SILENCE else ""

    def _keep(self, holder: str) -> None:
        """Record that the holder has asked."""
        if abs(self._clock() - float(self._read().get("seen", 0.0))) > _REFRESH:
            self._write(holder)

    def _read(self) -> dict[str, Any]:
        """Record of the hold; empty where there is none."""
        with suppress(OSError, ValueError, RecursionError):
            found = json.loads((self._folder / _FILE).read_text(encoding="utf-8"))
            if isinstance(found, dict):
                return found
        return {}

    def _write(self, holder: str) -> None:
        """Record a holder, now."""
        content = {"holder": holder, "seen": self._clock()}
        write_atomically(self._folder / _FILE, json.dumps(content), is_private=True)
