"""Results of a sweep in a folder: chunks that appear whole, each named by the hash of what it holds."""

import hashlib
import io
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.files import write_atomically
from sonolube.rig import NUMBERS, PointBatch

_MANIFEST = "sweep.json"


@dataclass(frozen=True, kw_only=True, slots=True)
class ChunkStore:
    """A folder that holds the chunks of one sweep.

    Parameters
    ----------
    folder : Path
    digest : str
        Fingerprint of the sweep.
    chunk_points : int
        How many points there are to a chunk.
    """

    folder: Path
    digest: str
    chunk_points: int

    def open(self) -> None:
        """Make the folder ready, or find it so.

        Raises
        ------
        InvalidInput
            If it holds another sweep.
        """
        manifest = self.folder / _MANIFEST
        own = {"sweep": self.digest, "chunk_points": self.chunk_points}
        if manifest.exists():
            try:
                found = json.loads(manifest.read_text(encoding="utf-8"))
            except ValueError:
                found = None
            if found != own:
                raise InvalidInput(
                    f"{self.folder}: holds another sweep, of another rig, other values or another version;"
                    " name another folder, or remove this one"
                )
        else:
            write_atomically(manifest, json.dumps(own))

    def read(self, chunk: int) -> PointBatch | None:
        """Return a chunk, or nothing if it is missing or not what was written; what was damaged is removed."""
        found = None
        for path in self.folder.glob(f"chunk-{chunk:06d}.*.npz"):
            content = path.read_bytes()
            if path.name == _name(chunk, content):
                found = _batch(content)
            else:
                path.unlink()
        return found

    def write(self, chunk: int, batch: PointBatch) -> None:
        """Keep a chunk.

        Raises
        ------
        InvalidInput
            If the folder cannot be written to.
        """
        content = _content(batch)
        write_atomically(self.folder / _name(chunk, content), content)


def _name(chunk: int, content: bytes) -> str:
    return f"chunk-{chunk:06d}.{hashlib.sha256(content).hexdigest()[:32]}.npz"


def _content(batch: PointBatch) -> bytes:
    buffer = io.BytesIO()
    np.savez(
        buffer,
        allow_pickle=False,
        numbers=np.stack([batch.numbers[name] for name in NUMBERS]),
        status=batch.status,
        reason=batch.reason,
        reasons=np.array(batch.reasons, dtype=np.str_),
    )
    return buffer.getvalue()


def _batch(content: bytes) -> PointBatch:
    with np.load(io.BytesIO(content), allow_pickle=False) as held:
        return PointBatch(
            numbers=dict(zip(NUMBERS, held["numbers"], strict=True)),
            status=held["status"],
            reason=held["reason"],
            reasons=tuple(str(text) for text in held["reasons"]),
        )
