"""Damaged records: whatever stands in the files of a run, it is read, recovered or refused in one line."""

import json
import random
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tests.laboratory.records.recorded import begun, block_of, recorded

from sonolube.errors import SonolubeError
from sonolube.laboratory.catalogue import query_runs
from sonolube.laboratory.records import export_run, read_run, recover_run, run_folders, run_summary

WRONG: list[Any] = [
    None,
    True,
    -1,
    1e400,
    10**400,
    "",
    "\x1b",
    "x" * 50,
    "\ud800",
    [],
    {},
    [[]],
    {"a": 1},
    "recording-9",
    -0.5,
]


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    recorder = begun(tmp_path_factory.mktemp("runs"), operator="D")
    recorder.note("drive", sample=0, voltage_peak_to_peak=5.0)
    recorder.append(block_of(0, 10))
    recorder.note("gap", sample=10, missing=3)
    return recorder.finish("completed").folder


def places(content: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Places of all values in a JSON object."""
    found = [path] if path else []
    if isinstance(content, dict | list):
        for key in content if isinstance(content, dict) else range(len(content)):
            found += places(content[key], (*path, key))
    return found


def with_wrong_value(text: str, rng: random.Random) -> str:
    """JSON with one value replaced or removed."""
    content = json.loads(text)
    *path, last = rng.choice(places(content))
    inside = content
    for key in path:
        inside = inside[key]
    if rng.random() < 0.3:
        del inside[last]
    else:
        inside[last] = rng.choice(WRONG)
    return json.dumps(content)


def changed_text(text: str, rng: random.Random) -> str:
    """Text of a record with one value wrong, a line lost or repeated, or a character changed."""
    lines = text.splitlines() if text.startswith('["') else [text]
    place = rng.randrange(len(lines))
    kind = rng.randrange(5)
    if kind == 0 and len(lines) > 1:
        del lines[place]
    elif kind == 1:
        lines.insert(place, lines[place])
    elif kind == 2:
        at = rng.randrange(len(lines[place]))
        lines[place] = lines[place][:at] + chr(rng.randrange(32, 300)) + lines[place][at + 1 :]
    else:
        lines[place] = with_wrong_value(lines[place], rng)
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("name", ["run.json", "documents.jsonl"])
@pytest.mark.parametrize("seed", range(150))
def test_a_damaged_record_is_read_recovered_or_refused(whole: Path, tmp_path: Path, name: str, seed: int) -> None:
    folder = tmp_path / "run"
    shutil.copytree(whole, folder)
    rng = random.Random(seed)
    (folder / name).write_text(changed_text((folder / name).read_text(), rng))
    if rng.random() < 0.5:
        (folder / "recording.nc").unlink()
    uses: list[Callable[[], object]] = [
        lambda: read_run(folder),
        lambda: [run_summary(folder) for folder in run_folders(tmp_path)],
        lambda: query_runs(tmp_path),
        lambda: export_run(folder, file_format="csv", out=tmp_path / "out"),
        lambda: recover_run(folder),
        lambda: read_run(folder).dataset(),
    ]
    for use in uses:
        try:
            use()
        except SonolubeError as failure:
            text = str(failure)
            assert "\n" not in text


def test_a_record_whose_documents_end_in_half_a_line_says_so(tmp_path: Path) -> None:
    folder = recorded(tmp_path)
    assert not any("is damaged" in caveat for caveat in read_run(folder).caveats)
    with (folder / "documents.jsonl").open("ab") as stream:
        stream.write(b'["event", {"seq_num": 9')
    assert "the end of documents.jsonl is damaged" in read_run(folder).caveats
