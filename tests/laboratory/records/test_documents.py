"""Documents written by hand: which are whole, and what parts, clocks, counts and channels they tell."""

import json
from pathlib import Path
from typing import Any

import pytest

from sonolube.laboratory.records.documents import (
    Document,
    ReadDocuments,
    RecordedChannel,
    main_parts,
    numbered_parts,
    part_clocks,
    part_name,
    read_documents,
    recorded_channels,
    stream_counts,
)


def line(name: object, **entries: object) -> bytes:
    return (json.dumps([name, {"uid": "u", **entries}]) + "\n").encode()


def read(folder: Path, *lines: bytes) -> ReadDocuments:
    (folder / "documents.jsonl").write_bytes(b"".join(lines))
    return read_documents(folder)


START = line("start")
EVENT = {"kind": "drive", "facts": "{}"}


@pytest.mark.parametrize(
    "whole",
    [
        line("event", data=EVENT),
        line("stream_datum", indices={"stop": 0}),
        line("stream_datum", indices={"stop": 2**53 - 1}),
        line("stream_resource", parameters={}),
        line("stream_resource", parameters={"clock": "oil", "part": 2}),
        line("descriptor", data_keys={}),
        line("stop", exit_status="success"),
    ],
)
def test_a_document_with_what_is_read_of_it_is_whole(tmp_path: Path, whole: bytes) -> None:
    found = read(tmp_path, START, whole)
    assert (len(found.documents), found.is_whole, found.whole_bytes) == (2, True, len(START + whole))


@pytest.mark.parametrize(
    "damaged",
    [
        START[:-1],
        b"{\n",
        b"[" * 100_000 + b"\n",
        b'{"start": 1}\n',
        b'["start"]\n',
        b'["start", {"uid": "u"}, 1]\n',
        line("other"),
        b'["start", ["uid"]]\n',
        b'["start", {"uid": 3}]\n',
        line("event"),
        line("event", data=[]),
        line("event", data={"kind": 1, "facts": "{}"}),
        line("event", data={"kind": "drive", "facts": {}}),
        line("stream_datum", indices={}),
        line("stream_datum", indices={"stop": -1}),
        line("stream_datum", indices={"stop": 2**53}),
        line("stream_datum", indices={"stop": 1.5}),
        line("stream_resource"),
        line("stream_resource", parameters=[]),
        line("stream_resource", parameters={"clock": "oil"}),
        line("stream_resource", parameters={"clock": "oil", "part": "2"}),
        line("stream_resource", parameters={"clock": "../oil", "part": 2}),
        line("descriptor", data_keys=[]),
        line("stop"),
        line("stop", exit_status=0),
    ],
)
def test_reading_ends_before_the_first_document_that_is_damaged(tmp_path: Path, damaged: bytes) -> None:
    found = read(tmp_path, START, damaged, START)
    assert (len(found.documents), found.is_whole, found.whole_bytes) == (1, False, len(START))


def test_what_was_added_is_read_after_what_is_known_and_no_file_has_none(tmp_path: Path) -> None:
    assert read_documents(tmp_path) == ReadDocuments(documents=(), whole_bytes=0, is_whole=True)
    before = read(tmp_path, START)
    path = tmp_path / "documents.jsonl"
    path.write_bytes(line("stop", exit_status="fail")[: len(START)].ljust(len(START)) + line("event", data=EVENT))
    found = read_documents(tmp_path, earlier=before)  # what is known is not read again
    assert [name for name, _ in found.documents] == ["start", "event"]
    assert found.whole_bytes == path.stat().st_size
    assert [len(found.of(name)) for name in ("start", "event", "stop")] == [1, 1, 0]


def described(name: str, uid: str, **keys: object) -> tuple[str, Document]:
    return "descriptor", {"uid": uid, "name": name, "data_keys": keys}


def located(**parameters: object) -> tuple[str, Document]:
    return "stream_resource", {"uid": "r", "parameters": parameters}


def datum(descriptor: str, stop: int) -> tuple[str, Document]:
    return "stream_datum", {"uid": "d", "descriptor": descriptor, "indices": {"stop": stop}}


def event(descriptor: str) -> tuple[str, Document]:
    return "event", {"uid": "e", "descriptor": descriptor}


def of(*documents: tuple[str, Document]) -> ReadDocuments:
    return ReadDocuments(documents=documents, whole_bytes=0, is_whole=True)


def key(source: str, units: str | None) -> dict[str, Any]:
    return {"source": source, "units": units}


PARTS = of(
    described("notes", "n"),
    described("recording-1", "a", friction_force=key("friction_force", "N"), voltage=key("stack_voltage", "V")),
    described("recording-10", "c", friction_force=key("friction_force", "N")),
    described("recording-2", "b", oil=key("temperature", "K"), noise=key("acoustic_emission", None), odd="?"),
    located(column=0),
    located(part=2, clock="slow"),
    event("n"),
    event("n"),
    event("unknown"),
    datum("a", 40),
    datum("a", 30),
    datum("b", 7),
)


def test_parts_are_told_ascending_and_those_of_other_clocks_apart() -> None:
    assert part_name(3) == "recording-3"
    assert numbered_parts(PARTS) == [1, 2, 10]
    assert part_clocks(PARTS) == {2: "slow"}
    assert main_parts(PARTS) == [1, 10]
    strange = of(*(described(f"recording-{each}", "s") for each in ("x", "²", "1234567890", "123456789")))
    assert numbered_parts(strange) == [123456789]


def test_events_are_counted_and_samples_are_those_of_the_last_count() -> None:
    assert stream_counts(PARTS) == {"notes": 3, "recording-1": 40, "recording-2": 7}


def test_a_channel_is_described_with_what_its_name_does_not_tell() -> None:
    found = recorded_channels(PARTS)
    assert found["friction_force"] == RecordedChannel(
        name="friction_force", quantity="friction_force", unit="N", clock=""
    )
    told = {name: channel.described for name, channel in found.items()}
    assert told == {
        "friction_force": "friction_force",
        "voltage": "voltage",
        "oil": "oil (temperature, K, clock slow)",
        "noise": "noise (acoustic_emission, 1, clock slow)",
        "odd": "odd (odd, 1, clock slow)",
    }
    beside = RecordedChannel(name="temperature", quantity="temperature", unit="K", clock="slow")
    assert beside.described == "temperature (clock slow)"
