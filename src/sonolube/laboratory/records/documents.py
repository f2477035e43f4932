"""Documents of a run in the event model of the Bluesky project, a line of JSON each: ["name", document]."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final
from uuid import uuid4

from sonolube.laboratory.block import CHANNEL_QUANTITIES
from sonolube.laboratory.records.raw_blocks import RawPart
from sonolube.laboratory.records.run_folder import CLOCK_NAME, DOCUMENTS, RunFacts, raw_path
from sonolube.storage.growing_files import AppendedFile

Document = dict[str, Any]

EXIT_STATUS: Final = {"completed": "success", "stopped": "abort", "interrupted": "abort", "failed": "fail"}
"""Exit status of the event model by outcome of a run."""

_NAMES: Final = ("start", "descriptor", "event", "stream_resource", "stream_datum", "stop")
_NOTES: Final = "notes"
_MIME: Final = "application/x-sonolube-blocks"
_FLOATS: Final = {"dtype": "number", "dtype_numpy": "<f8", "shape": []}  # of a channel
_LARGEST_LINE: Final = 1 << 24
_MAX_SAMPLES: Final = 1 << 53


@dataclass(frozen=True, kw_only=True, slots=True)
class ReadDocuments:
    """Documents of a file.

    Parameters
    ----------
    documents : tuple of (str, dict)
        Whole ones, in order.
    whole_bytes : int
        Length up to the end of the last whole one.
    is_whole : bool
        Whether nothing follows it.
    """

    documents: tuple[tuple[str, Document], ...]
    whole_bytes: int
    is_whole: bool

    def of(self, name: str) -> list[Document]:
        """Documents of a kind, in order."""
        return [document for kind, document in self.documents if kind == name]


def read_documents(folder: Path, *, earlier: ReadDocuments | None = None) -> ReadDocuments:
    """Read the documents of a run up to the first damaged line; none where there is no file."""
    found = [] if earlier is None else list(earlier.documents)
    place = 0 if earlier is None else earlier.whole_bytes
    try:
        with (folder / DOCUMENTS).open("rb") as stream:
            stream.seek(place)
            while line := stream.readline(_LARGEST_LINE):
                document = _document(line)
                if document is None:
                    return ReadDocuments(documents=tuple(found), whole_bytes=place, is_whole=False)
                found.append(document)
                place += len(line)
    except OSError:
        pass
    return ReadDocuments(documents=tuple(found), whole_bytes=place, is_whole=True)


class DocumentLog:
    """Documents of a run that are being written.

    Parameters
    ----------
    folder : Path
    earlier : ReadDocuments, optional
        Of the file that is continued; a new one is made without it.

    Attributes
    ----------
    run : str
        UUID of the run.
    """

    def __init__(self, folder: Path, *, earlier: ReadDocuments | None = None) -> None:
        self._folder = folder
        self._file = AppendedFile(folder / DOCUMENTS, keep=None if earlier is None else earlier.whole_bytes)
        starts = [] if earlier is None else earlier.of("start")
        self.run = str(starts[0]["uid"]) if starts else str(uuid4())
        descriptors = {} if earlier is None else {str(each.get("name")): each for each in earlier.of("descriptor")}
        self._notes = str(descriptors[_NOTES]["uid"]) if _NOTES in descriptors else str(uuid4())
        self._has_notes = _NOTES in descriptors
        self._counts = {} if earlier is None else stream_counts(earlier)

    def start(self, known: RunFacts) -> None:
        """Write the first document: facts, versions and files of the run."""
        self._write(
            "start",
            uid=self.run,
            time=known.begun,
            title=known.title,
            facts={_key(name): value for name, value in known.facts.items()},
            versions=dict(known.versions),
            files=[f"{name} sha256:{digest}" for name, digest in known.files.items()],
        )

    def note(self, kind: str, *, time: float, sample: int | None, facts: Mapping[str, Any]) -> None:
        """Write what happened as an event."""
        if not self._has_notes:
            types = {"kind": "string", "sample": "integer", "facts": "string"}
            keys = {name: {"dtype": kind, "shape": [], "source": "sonolube"} for name, kind in types.items()}
            self._describe(_NOTES, self._notes, time, keys)
            self._has_notes = True
        number = self._counts.get(_NOTES, 0) + 1
        data = {"kind": kind, "sample": sample, "facts": json.dumps(facts, default=_plain)}
        self._write(
            "event",
            uid=str(uuid4()),
            descriptor=self._notes,
            seq_num=number,
            time=time,
            data=data,
            timestamps=dict.fromkeys(data, time),
        )
        self._counts[_NOTES] = number

    def part(self, number: int, part: RawPart) -> None:
        """Write the description of a part of the recording, and where its blocks are; its clock, if not the run's."""
        uid = str(uuid4())
        keys: dict[str, dict[str, Any]] = {
            channel.name: {**_FLOATS, "source": channel.quantity, "units": channel.unit or None, "external": "STREAM:"}
            for channel in part.channels
        }
        self._describe(part_name(number), uid, part.begun, keys)
        for column, channel in enumerate(part.channels):
            self._locate(number, part, f"{uid}-{column}", column, channel.name)

    def end_part(self, earlier: ReadDocuments, number: int, part: RawPart) -> None:
        """Write how many samples of a part there are, and where, unless `earlier` tells it already."""
        name = part_name(number)
        described = [each for each in earlier.of("descriptor") if each.get("name") == name]
        if not described or not part.samples:
            return
        uid = str(described[0]["uid"])
        known = {each["uid"] for kind in ("stream_resource", "stream_datum") for each in earlier.of(kind)}
        for column, channel in enumerate(described[0]["data_keys"]):
            resource = f"{uid}-{column}"
            if resource not in known:
                self._locate(number, part, resource, column, channel)
            if f"{resource}/0" not in known:
                self._count(uid, resource, part.samples)
        self._counts[name] = part.samples

    def stop(self, outcome: str, *, reason: str, time: float) -> None:
        """Write the last document."""
        self._write(
            "stop",
            uid=str(uuid4()),
            run_start=self.run,
            time=time,
            exit_status=EXIT_STATUS[outcome],
            outcome=outcome,
            reason=reason,
            num_events=dict(self._counts),
        )

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def _locate(self, number: int, part: RawPart, uid: str, column: int, channel: str) -> None:
        """Write where the samples of a channel are."""
        path = raw_path(self._folder, number)
        place = {"file": path.relative_to(self._folder).as_posix(), "column": column, "sample_rate": part.sample_rate}
        place |= {} if part.clock is None else {"part": number, "clock": part.clock.name}
        self._write(
            "stream_resource",
            uid=uid,
            run_start=self.run,
            data_key=channel,
            mimetype=_MIME,
            uri=f"file://localhost{path.resolve().as_posix()}",
            parameters=place,
        )

    def _count(self, descriptor: str, resource: str, samples: int) -> None:
        """Write how many samples of a channel there are."""
        self._write(
            "stream_datum",
            uid=f"{resource}/0",
            stream_resource=resource,
            descriptor=descriptor,
            indices={"start": 0, "stop": samples},
            seq_nums={"start": 1, "stop": samples + 1},
        )

    def _describe(self, name: str, uid: str, time: float, keys: Mapping[str, Mapping[str, Any]]) -> None:
        """Write the description of a stream."""
        self._write("descriptor", uid=uid, run_start=self.run, time=time, name=name, data_keys=keys)

    def _write(self, kind: str, /, **entries: Any) -> None:
        """Append a document as one line."""
        self._file.append((json.dumps([kind, entries], default=_plain) + "\n").encode())


def part_name(part: int) -> str:
    """Name of the stream of a part of the recording, from 1."""
    return f"recording-{part}"


def stream_counts(read: ReadDocuments) -> dict[str, int]:
    """Number of events or samples of each stream that has any."""
    names = {str(each["uid"]): str(each.get("name")) for each in read.of("descriptor")}
    counts: dict[str, int] = {}
    for event in read.of("event"):
        name = names.get(str(event.get("descriptor")), _NOTES)
        counts[name] = counts.get(name, 0) + 1
    for datum in read.of("stream_datum"):
        name = names.get(str(datum.get("descriptor")), "")
        counts[name] = max(counts.get(name, 0), int(datum["indices"]["stop"]))
    return counts


def numbered_parts(read: ReadDocuments) -> list[int]:
    """Numbers of the parts of the recording that were begun, ascending."""
    names = {str(each.get("name")) for each in read.of("descriptor")}
    numbers = (name.removeprefix("recording-") for name in names if name.startswith("recording-"))
    return sorted(int(number) for number in numbers if number.isascii() and number.isdecimal() and len(number) < 10)


def part_clocks(read: ReadDocuments) -> dict[int, str]:
    """Names of the clocks of those parts of the recording that have another clock than the run."""
    found = (resource["parameters"] for resource in read.of("stream_resource"))
    return {each["part"]: each["clock"] for each in found if "clock" in each}


def main_parts(read: ReadDocuments) -> list[int]:
    """Numbers of the parts that the clock of the run timed, ascending."""
    others = part_clocks(read)
    return [part for part in numbered_parts(read) if part not in others]


def _document(line: bytes) -> tuple[str, Document] | None:
    """Name and document of a line; None where it is damaged."""
    if not line.endswith(b"\n"):
        return None
    try:
        content = json.loads(line)
    except (ValueError, RecursionError):
        return None
    if not (isinstance(content, list) and len(content) == 2):
        return None
    name, document = content
    is_document = name in _NAMES and isinstance(document, dict) and isinstance(document.get("uid"), str)
    return (name, document) if is_document and _has_what_is_read(name, document) else None


def _has_what_is_read(name: str, document: Document) -> bool:
    """Whether a document has the entries that this module and `run` read."""
    try:
        if name == "event":
            return isinstance(document["data"]["kind"], str) and isinstance(document["data"]["facts"], str)
        if name == "stream_datum":
            return isinstance(stop := document["indices"]["stop"], int) and 0 <= stop < _MAX_SAMPLES
        if name == "stream_resource":
            place = document["parameters"]
            return isinstance(place, dict) and ("clock" not in place or _names_clock(place))
        if name == "descriptor":
            return isinstance(document["data_keys"], dict)
        return name != "stop" or isinstance(document["exit_status"], str)
    except (KeyError, TypeError):
        return False


def _names_clock(place: Mapping[str, Any]) -> bool:
    """Whether a place of samples names part and clock."""
    return isinstance(place["part"], int) and CLOCK_NAME.fullmatch(place["clock"]) is not None


def _key(name: str) -> str:
    """Name of a fact as the event model allows it."""
    return name.replace(".", "_").replace("/", "_")


def _plain(value: object) -> Any:
    """Number of numpy as a number of Python; anything else as text."""
    item = getattr(value, "item", None)
    return item() if callable(item) else str(value)


@dataclass(frozen=True, kw_only=True, slots=True)
class RecordedChannel:
    """Channel of a run.

    Parameters
    ----------
    name : str
        As protocols call it.
    quantity : str
        Of the vocabulary, or a free one.
    unit : str
        Of SI; empty for pure numbers.
    clock : str
        Name of its clock; empty for that of the run.
    """

    name: str
    quantity: str
    unit: str
    clock: str

    @property
    def described(self) -> str:
        """Name, with quantity, unit and clock where the name does not tell them."""
        told = [] if CHANNEL_QUANTITIES.get(self.name) == self.quantity else [self.quantity, self.unit or "1"]
        told += [f"clock {self.clock}"] if self.clock else []
        return f"{self.name} ({', '.join(told)})" if told else self.name


def recorded_channels(documents: ReadDocuments) -> dict[str, RecordedChannel]:
    """Channels of all parts of a recording by name, as they were begun.

    Parameters
    ----------
    documents : ReadDocuments
        Of the run.

    Returns
    -------
    dict of str to RecordedChannel
    """
    clocks = {part_name(part): clock for part, clock in part_clocks(documents).items()}
    found: dict[str, RecordedChannel] = {}
    for each in documents.of("descriptor"):
        stream = str(each.get("name"))
        for name, key in each["data_keys"].items() if stream.startswith(part_name(0)[:-1]) else ():
            told = key if isinstance(key, dict) else {}
            found[str(name)] = RecordedChannel(
                name=str(name),
                quantity=str(told.get("source", name)),
                unit=str(told.get("units") or ""),
                clock=clocks.get(stream, ""),
            )
    return found
