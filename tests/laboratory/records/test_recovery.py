"""Recovery: a killed run is completed as interrupted, nothing lost but the block in flight, once and for all."""

import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from tests.laboratory.records.recorded import begun, block_of, contents, recorded, values_of
from tests.laboratory.records.test_recorder import judge

from sonolube.errors import InvalidInput
from sonolube.laboratory.records import last_verdict, read_run, recover_run
from sonolube.laboratory.verdict import Outputs, Verdict

WRITER = """
import sys
sys.path.insert(0, {root!r})
from pathlib import Path
from tests.laboratory.records.recorded import begun, block_of
recorder = begun(Path({parent!r}), rig="tribometer")
first = 0
while True:
    recorder.append(block_of(first, 10))
    first += 10
    print(first, flush=True)
"""


def unfinished(parent: Path, *, blocks: int = 3) -> Path:
    """Folder of a run as a killed program leaves it."""
    folder = recorded(parent, sizes=(10,) * blocks)
    lines = (folder / "documents.jsonl").read_bytes().splitlines(keepends=True)
    kept = [line for line in lines if not line.startswith((b'["stop"', b'["stream_datum"'))]
    (folder / "documents.jsonl").write_bytes(b"".join(kept))
    (folder / "recording.nc").unlink(missing_ok=True)
    return folder


def test_a_killed_writer_loses_nothing_that_append_has_taken(tmp_path: Path) -> None:
    code = WRITER.format(root=str(Path(__file__).parents[3]), parent=str(tmp_path))
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as writer:
        assert writer.stdout is not None
        for _ in range(200):
            told = int(writer.stdout.readline())
        (folder,) = (path for path in tmp_path.iterdir() if path.name != ".rigs")
        with pytest.raises(InvalidInput, match="another run is at work"):
            recover_run(folder)
        writer.send_signal(signal.SIGKILL)
        told = max([told, *(int(line) for line in writer.stdout.read().split("\n")[:-1])])
    assert read_run(folder).summary.outcome == "unfinished"
    recovery = recover_run(folder)
    assert recovery.summary.outcome == "interrupted"
    assert recovery.summary.samples >= told
    dataset = read_run(folder).dataset()
    assert np.array_equal(dataset["friction_force"], values_of(0, recovery.summary.samples)[:, 0])
    judge(folder)
    recorded(tmp_path, rig="tribometer")


@pytest.mark.parametrize("cut", [1, 100, 170, 192, 193, 300])
def test_the_rest_of_a_block_is_kept_aside(tmp_path: Path, cut: int) -> None:
    folder = unfinished(tmp_path)
    path = folder / "raw" / "blocks-1.bin"
    content = path.read_bytes()
    path.write_bytes(content[:-cut])
    recovery = recover_run(folder)
    whole = 3 - -(-cut // 192)
    assert recovery.summary.samples == 10 * whole
    aside = list(path.parent.glob("*.damaged"))
    assert path.read_bytes() + b"".join(each.read_bytes() for each in aside) == content[:-cut]
    assert np.array_equal(read_run(folder).dataset()["temperature"], values_of(0, 10 * whole)[:, 1])


@pytest.mark.parametrize("share", [0.0, 0.2, 0.5, 0.8, 0.99])
def test_documents_cut_anywhere_are_completed(tmp_path: Path, share: float) -> None:
    folder = unfinished(tmp_path)
    path = folder / "documents.jsonl"
    content = path.read_bytes()
    path.write_bytes(content[: int(share * len(content))])
    assert recover_run(folder).summary.outcome == "interrupted"
    judge(folder)
    assert read_run(folder).dataset().sizes["time"] == 30


def test_a_second_recovery_changes_nothing(tmp_path: Path) -> None:
    folder = unfinished(tmp_path)
    assert recover_run(folder).done == ("marked as interrupted", "recording.nc written")
    before = contents(folder)
    assert recover_run(folder).done == ()
    assert contents(folder) == before


def test_a_completed_run_is_left_as_it_is(tmp_path: Path) -> None:
    folder = recorded(tmp_path)
    before = contents(folder)
    assert recover_run(folder).done == ()
    assert contents(folder) == before


def test_a_run_killed_before_its_first_block_is_completed_without_a_recording(tmp_path: Path) -> None:
    folder = unfinished(tmp_path, blocks=0)
    (folder / "raw" / "blocks-1.bin").write_bytes(b"SNL")
    recovery = recover_run(folder)
    assert (recovery.summary.outcome, recovery.summary.samples) == ("interrupted", 0)
    with pytest.raises(InvalidInput, match="has no recording"):
        read_run(folder).dataset()


def test_a_folder_without_a_run_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InvalidInput, match="holds no run"):
        recover_run(tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_a_run_at_work_is_not_recovered(tmp_path: Path) -> None:
    recorder = begun(tmp_path)
    recorder.append(block_of(0, 10))
    with pytest.raises(InvalidInput, match="another run is at work"):
        recover_run(recorder.folder)
    recorder.finish("completed")


@pytest.mark.parametrize("content", ["", "{", "[1]", '{"format": 1, "title": 3}', "\x00\xff"])
@pytest.mark.parametrize("has_documents", [True, False])
def test_damaged_facts_are_written_from_the_documents_or_the_protocol(
    content: str, has_documents: bool, tmp_path: Path
) -> None:
    folder = recorded(tmp_path, rig="tribometer")
    whole = read_run(folder)
    (folder / "run.json").write_text(content, encoding="latin-1")
    if not has_documents:
        (folder / "documents.jsonl").write_text("damaged\n")
    with pytest.raises(InvalidInput, match=r"run\.json: is damaged; `sonolube lab recover` writes it"):
        read_run(folder)
    assert recover_run(folder).done[0].startswith("run.json written from")
    again = read_run(folder)
    assert again.summary.title == (whole.summary.title if has_documents else "test")  # of the protocol
    assert again.summary.samples == whole.summary.samples
    assert again.facts == (whole.facts if has_documents else {})
    assert recover_run(folder).done == ()


def test_a_verdict_of_the_switch_off_process_closes_the_record_of_a_killed_run(tmp_path: Path) -> None:
    folder = unfinished(tmp_path)
    assert last_verdict(folder) == ""
    recover_run(folder, outputs=Verdict(Outputs.CUT_THE_POWER, "motor: does not answer"))
    assert last_verdict(folder) == "cut the power: motor: does not answer"
    assert read_run(folder).notes[-1].kind == "not off"
    recover_run(folder, outputs=Verdict(Outputs.MEASURED_OFF))
    assert last_verdict(folder) == "cut the power: motor: does not answer"  # the first one stays
