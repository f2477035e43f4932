"""Store of finished chunks of a sweep in a folder: atomically written files, each named by the hash of its content."""

import hashlib
import io
import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.operating_system import remove_file
from sonolube.rig import NUMBERS, PointBatch
from sonolube.storage.files import clear_unfinished, locked_folder, write_atomically

_MANIFEST = "sweep.json"
_EARLIER = (".sweep.nc.*", ".sweep.json.*", ".chunk-*.npz.*")  # unfinished files of earlier versions


@dataclass(frozen=True, kw_only=True, slots=True)
class ChunkStore:
    """Folder with the finished chunks of one sweep.

    Parameters
    ----------
    folder : Path
    digest : str
        Digest of the sweep's plan.
    chunk_points : int
        Points per chunk.

    Notes
    -----
    The manifest sweep.json holds the digest and the chunk size, so that a folder is never continued with another
    sweep. A chunk is the file chunk-NNNNNN.HASH.npz with 32 hexadecimal digits of the SHA-256 hash of its content; a
    file that does not match its name is damaged and is computed anew.
    """

    folder: Path
    digest: str
    chunk_points: int

    @contextmanager
    def opened(self) -> Iterator[None]:
        """Lock the folder inside a `with` block; create its manifest, or check that it is of the same sweep."""
        with locked_folder(self.folder, purpose="sweep"):
            self._check_manifest()
            clear_unfinished(self.folder, *_EARLIER)
            yield

    def read(self, chunk: int) -> PointBatch | None:
        """Chunk of an index, or None where it is missing or damaged; damaged files are removed."""
        batch = None
        for path in self.folder.glob(f"chunk-{chunk:06d}.*.npz"):
            content = path.read_bytes()
            if path.name == _file_name(chunk, content):
                batch = _decoded(content)
            else:
                remove_file(path)
        return batch

    def write(self, chunk: int, batch: PointBatch) -> None:
        """Write a chunk to its file."""
        content = _encoded(batch)
        write_atomically(self.folder / _file_name(chunk, content), content)

    def _check_manifest(self) -> None:
        """Create the manifest, or check that an existing one is of the same sweep."""
        manifest = self.folder / _MANIFEST
        expected = {"sweep": self.digest, "chunk_points": self.chunk_points}
        if not manifest.exists():
            write_atomically(manifest, json.dumps(expected))
            return
        try:
            found = json.loads(manifest.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            found = None
        if found != expected:
            raise InvalidInput(
                f"{self.folder}: holds another sweep, of another rig, other values or another version;"
                " name another folder, or remove this one"
            )


def _file_name(chunk: int, content: bytes) -> str:
    """Name of a chunk's file from its index and the hash of its content."""
    return f"chunk-{chunk:06d}.{hashlib.sha256(content).hexdigest()[:32]}.npz"


def _encoded(batch: PointBatch) -> bytes:
    """Batch as an uncompressed NPZ archive."""
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


def _decoded(content: bytes) -> PointBatch:
    """Batch from an NPZ archive."""
    with np.load(io.BytesIO(content), allow_pickle=False) as archive:
        return PointBatch(
            numbers=dict(zip(NUMBERS, archive["numbers"], strict=True)),
            status=archive["status"],
            reason=archive["reason"],
            reasons=tuple(str(text) for text in archive["reasons"]),
        )
