"""SHA-256 that the record of a run keeps of its recordings, beside the file that is read."""

import json
from pathlib import Path

_RECORD = "run.json"
_LARGEST = 1 << 24  # bytes


def change_since_recorded(path: Path, digest: str) -> tuple[str, ...]:
    """Caveat where a recording is not as the run of its folder wrote it.

    Empty where it is as it was written, or no record beside it tells.
    """
    record = path.parent / _RECORD
    try:
        if record.stat().st_size > _LARGEST:
            return ()
        kept = json.loads(record.read_text(encoding="utf-8"))["recordings"].get(path.name, digest)
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return ()
    return () if kept == digest else (f"{path.name} was changed after its run wrote it: its SHA-256 is another",)
