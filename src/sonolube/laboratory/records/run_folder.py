"""Folder of a run: the names of its files, its facts, and the SHA-256 of what it was given."""

import hashlib
import json
import re
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Final

from sonolube.errors import InvalidInput
from sonolube.storage.files import write_atomically
from sonolube.storage.growing_files import new_folder
from sonolube.text.plain_text import printable

PROTOCOL: Final = "protocol.toml"
RUN: Final = "run.json"
DOCUMENTS: Final = "documents.jsonl"
TRUTH: Final = "truth/truth.nc"
PURPOSE: Final = "run"
"""Purpose of the lock of the folder."""
RESERVE: Final = ".reserve"
"""File that is removed when a run ends, so that its last documents fit on a full disk."""

UNRESOLVED: Final = "unresolved"
"""Fact that says which channels were sampled too seldom to show the drive."""

Fact = str | float | int | bool
Facts = Mapping[str, Fact]

LATEST: Final = 1e11
"""Time in s since 1970 beyond which no run began."""

CLOCK_NAME: Final = re.compile(r"[a-z][a-z0-9_]{0,29}")
"""Names of clocks, which are part of the names of files."""

_FORMAT: Final = 1
_LARGEST_NUMBER: Final = 1e300
_RESERVED_BYTES: Final = 1 << 16
_LONGEST_NAME: Final = 60
_STAMPED: Final = re.compile(r"(\d{8}T\d{6}Z)-")
_PLAIN_NAME: Final = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,99}")
_LARGEST_TEXT: Final = 1 << 24  # bytes of run.json


@dataclass(frozen=True, kw_only=True, slots=True)
class RunFacts:
    """Facts known when a run began.

    Parameters
    ----------
    title : str
    begun : float
        Of the clock of the computer, in s since 1970.
    facts : mapping of str to str, float, int or bool
    versions : mapping of str to str
        Of sonolube, python and numpy.
    files : mapping of str to str
        SHA-256 of each file that the run was given, by name.
    referenced : tuple of str
        Recordings that lie elsewhere, of a run that was taken in.
    recordings : mapping of str to str
        SHA-256 of each part of the recording as it was written, by name.
    """

    title: str
    begun: float
    facts: Facts
    versions: Mapping[str, str]
    files: Mapping[str, str]
    referenced: tuple[str, ...] = ()
    recordings: Mapping[str, str] = field(default_factory=dict)


def utc_text(moment: float) -> str:
    """Time since 1970 in s as date and time of day in UTC, to the microsecond, such as 2026-11-23T01:42:10.250000Z."""
    return datetime.fromtimestamp(moment, UTC).strftime("%Y-%m-%dT%H:%M:%S.%fZ")


def utc_time(text: str) -> float:
    """Time since 1970 of a date and time of day, which without a zone is one of UTC. [s]"""
    found = datetime.fromisoformat(text)
    return (found if found.tzinfo is not None else found.replace(tzinfo=UTC)).timestamp()


def raw_path(folder: Path, part: int) -> Path:
    """File of the raw blocks of a part of the recording, from 1."""
    return folder / "raw" / f"blocks-{part}.bin"


def recording_path(folder: Path, part: int, clock: str = "") -> Path:
    """File of a part of the recording, from 1, as netCDF; of another clock than that of the run by its name."""
    if clock:
        return folder / f"clock-{clock}-{part}.nc"
    return folder / ("recording.nc" if part == 1 else f"recording-{part}.nc")


def raw_parts(folder: Path) -> list[int]:
    """Numbers of the parts that have raw blocks, ascending."""
    found = (re.fullmatch(r"blocks-(\d{1,9})\.bin", path.name) for path in (folder / "raw").glob("blocks-*.bin"))
    return sorted(int(match[1]) for match in found if match)


def make_run_folder(
    parent: Path, *, title: str, begun: float, texts: Mapping[str, str], facts: Facts, referenced: Mapping[str, str]
) -> tuple[Path, RunFacts]:
    """Make the folder of a new run with the texts it is given, its facts, and room for its last documents.

    `folder`: Named by the time in UTC and the title; none is ever made twice.
    """
    for name in texts:
        if not _PLAIN_NAME.fullmatch(name) or name in (RUN, DOCUMENTS) or name.startswith("recording"):
            raise InvalidInput(f"file {name!r} of a run must have a plain name other than those of the record")
    plain = {name: _plain(name, value) for name, value in facts.items()}
    stamp = datetime.fromtimestamp(begun, UTC).strftime("%Y%m%dT%H%M%SZ")
    words = re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-")[:_LONGEST_NAME].strip("-") or "run"
    folder = new_folder(parent, f"{stamp}-{words}")
    known = RunFacts(
        title=title,
        begun=begun,
        facts=plain,
        versions=_versions(),
        files={name: sha256(text.encode()) for name, text in texts.items()} | dict(referenced),
        referenced=tuple(referenced),
    )
    new_folder(folder, "raw")
    for name, text in texts.items():
        write_atomically(folder / name, text)
    write_run_facts(folder, known)
    write_atomically(folder / RESERVE, bytes(_RESERVED_BYTES))
    return folder, known


def write_run_facts(folder: Path, known: RunFacts) -> None:
    """Write run.json."""
    content = {"format": _FORMAT} | {name: getattr(known, name) for name in RunFacts.__slots__}
    write_atomically(folder / RUN, json.dumps(content, indent=1, allow_nan=False, default=dict) + "\n")


def keep_digests(folder: Path, known: RunFacts, paths: Iterable[Path]) -> RunFacts:
    """Keep the SHA-256 of parts of the recording that have none yet in run.json."""
    found = {path.name: _digest_of(path) for path in paths if path.name not in known.recordings and path.is_file()}
    if not found:
        return known
    kept = replace(known, recordings={**known.recordings, **found})
    write_run_facts(folder, kept)
    return kept


def is_run_folder(path: Path) -> bool:
    """Whether a folder is that of a run, also of one that was killed before run.json was written."""
    if (path / RUN).is_file() or (path / DOCUMENTS).is_file():
        return True
    return _STAMPED.match(path.name) is not None and (path / "raw").is_dir()


def read_run_facts(folder: Path) -> RunFacts:
    """Read what was known when a run began."""
    path = folder / RUN
    try:
        if path.stat().st_size > _LARGEST_TEXT:
            raise ValueError
        content: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        begun = float(content["begun"])
        if not 0 <= begun < LATEST:
            raise ValueError
        return RunFacts(
            title=printable(str(content["title"])),
            begun=begun,
            facts={printable(str(name)): _fact(value) for name, value in content["facts"].items()},
            versions={str(name): str(value) for name, value in content["versions"].items()},
            files={str(name): str(value) for name, value in content["files"].items()},
            referenced=tuple(printable(str(name)) for name in content.get("referenced", ())),
            recordings={str(name): str(value) for name, value in content.get("recordings", {}).items()},
        )
    except OSError:
        raise InvalidInput(f"{folder}: holds no run: it has no file {RUN}") from None
    except (ValueError, TypeError, KeyError, AttributeError, OverflowError, RecursionError):
        raise InvalidInput(f"{path}: is damaged; `sonolube lab recover` writes it from the other files") from None


def rebuilt_run_facts(folder: Path, start: Mapping[str, Any] | None) -> RunFacts:
    """Facts of a run whose run.json is missing or damaged, by its first document, else by its folder.

    With the SHA-256 of the files as they are now where no document tells them.
    """
    stamp = _STAMPED.match(folder.resolve().name)
    told = start or {}
    if (stamp is None and "time" not in told) or not is_run_folder(folder.resolve()):
        state = "is damaged, and neither a document nor the folder's name tells when it began"
        raise InvalidInput(f"{folder}: holds no run: its {RUN} is missing or {state}")
    try:
        begun = 0.0 if stamp is None else datetime.strptime(f"{stamp[1]}+0000", "%Y%m%dT%H%M%SZ%z").timestamp()
        texts = (line.rsplit(" sha256:", 1) for line in told.get("files", ()))
        files = {str(name): str(digest) for name, digest in texts}
        facts = {printable(str(name)): _fact(value) for name, value in dict(told.get("facts", {})).items()}
        versions = {str(name): str(value) for name, value in dict(told.get("versions", {})).items()}
        begun = float(told.get("time", begun))
    except (ValueError, TypeError, AttributeError):
        raise InvalidInput(f"{folder / DOCUMENTS}: its first document is damaged; restore {RUN}") from None
    present = {path.name: _digest_of(path) for path in sorted(folder.glob("*.toml"))}
    title = str(told.get("title") or _title(folder) or folder.name)
    return RunFacts(title=printable(title), begun=begun, facts=facts, versions=versions, files=files or present)


def _title(folder: Path) -> str:
    """Title of the protocol of a run; empty where it cannot be read."""
    try:
        return str(tomllib.loads((folder / PROTOCOL).read_text(encoding="utf-8")).get("title", ""))
    except (OSError, ValueError):
        return ""


def _fact(value: object) -> Fact:
    """Fact as it was read; raises ValueError where it is none."""
    if isinstance(value, str):
        return printable(value)
    if isinstance(value, bool):
        return value
    if isinstance(value, int | float) and abs(value) < _LARGEST_NUMBER:
        return value
    raise ValueError


def changed_files(folder: Path, known: RunFacts) -> list[str]:
    """Names of the files that a run was given and that are missing or not as they were."""
    return [name for name, digest in known.files.items() if _digest_of(folder / name) != digest]


def changed_recordings(folder: Path, known: RunFacts) -> list[str]:
    """Names of the parts of the recording that exist and are not as they were written."""
    paths = {name: folder / Path(name).name for name in known.recordings}
    return [name for name, path in paths.items() if path.is_file() and _digest_of(path) != known.recordings[name]]


def sha256(content: bytes) -> str:
    """SHA-256 of bytes in hexadecimal digits."""
    return hashlib.sha256(content).hexdigest()


def _digest_of(path: Path) -> str:
    """SHA-256 of a file; empty where it cannot be read."""
    if not path.is_file():
        return ""  # a pipe would wait for ever
    try:
        with path.open("rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except (OSError, ValueError):
        return ""


def number_of(facts: Mapping[str, Any], name: str) -> float | None:
    """Number among facts; None where there is none."""
    value = facts.get(name)
    return float(value) if isinstance(value, int | float) and not isinstance(value, bool) else None


def _plain(name: str, value: object) -> Fact:
    """Fact as JSON holds it; refuse what it cannot."""
    item = getattr(value, "item", None)
    plain = item() if callable(item) else value
    if isinstance(plain, float) and plain - plain != 0:
        plain = str(plain)  # infinite or not a number
    if not isinstance(plain, Fact):
        raise InvalidInput(f"fact {name!r} must be a text, a number or a truth value, got {type(value).__name__}")
    return plain


def _versions() -> dict[str, str]:
    """Versions of Python, sonolube and the libraries that compute."""
    import platform

    import numpy as np

    from sonolube import __version__

    return {"sonolube": __version__, "python": platform.python_version(), "numpy": np.__version__}
