"""Answers of the first page as they are shipped, which stand in until a worker process has imported sonolube.

After a change of a prediction or of the view of a rig, `python -m sonolube.browser.first_page` computes them anew.
"""

import json
from collections.abc import Mapping
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Any, Final

from sonolube.browser.requests import OPENED, Places
from sonolube.storage.files import write_atomically

_RIG: Final = {"rig": {"name": OPENED, "changes": {}}}
REQUESTS: Final[Mapping[str, Mapping[str, Any]]] = {"rig": _RIG, "task": {"task": "predict", "arguments": _RIG}}
"""Requests of the first page, by their kind."""

_FILE: Final = "static/first-page.json"


@cache
def shipped_answers() -> dict[str, Any]:
    """Answers to `REQUESTS` by their kind, as objects for JSON."""
    found: dict[str, Any] = json.loads(files("sonolube.browser").joinpath(_FILE).read_bytes())
    return found


def shipped_answer(kind: str, payload: Mapping[str, Any]) -> bytes | None:
    """JSON of a shipped answer; None for any other request."""
    return json.dumps(shipped_answers()[kind]).encode() if REQUESTS.get(kind) == payload else None


def computed_answers() -> dict[str, Any]:
    """Answers to `REQUESTS` as they are computed."""
    from sonolube.browser.worker import reply

    return {kind: json.loads(reply(kind, payload, Places(rigs={}))[1]) for kind, payload in REQUESTS.items()}


if __name__ == "__main__":
    text = json.dumps(computed_answers(), ensure_ascii=False, separators=(",", ":"))
    write_atomically(Path(str(files("sonolube.browser")), _FILE), text)
