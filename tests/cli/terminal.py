"""What a program shows on a terminal, read until it shows something or has ended."""

import os
import re
import select
import time

_LONGEST = 300.0  # s, which ends a hung test only

_PROGRESS = re.compile(r"\w+(: .*)? \(.*\b\d+ (s|min)\b.*\)\n")


def without_progress(err: str) -> str:
    """Lines on standard error but those of progress, which a slow machine tells."""
    return "".join(line for line in err.splitlines(keepends=True) if not _PROGRESS.fullmatch(line))


def read_until(terminal: int, *words: bytes) -> bytes:
    """What a terminal shows until all of these words."""
    text, latest = b"", time.monotonic() + _LONGEST
    while not all(word in text for word in words):
        assert time.monotonic() < latest, text
        if select.select([terminal], [], [], 1.0)[0]:
            text += os.read(terminal, 4096)
    return text


def rest(terminal: int) -> bytes:
    """What a terminal shows until the program has ended."""
    text = b""
    try:
        while piece := os.read(terminal, 4096):
            text += piece
    except OSError:  # the program has closed the terminal
        pass
    return text
