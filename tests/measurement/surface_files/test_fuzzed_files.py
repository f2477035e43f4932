"""Damaged surface files are read or refused with one line that names the file.

Run as a program it does the same at length: ``python tests/measurement/surface_files/test_fuzzed_files.py 100000``.
"""

import random
import struct
import sys
import tempfile
import warnings
from collections import Counter
from pathlib import Path

from hypothesis import given, settings, strategies as st
from pytest import mark

from sonolube.errors import InvalidInput
from sonolube.measurement.surface_files.reader import read_height_map

CORPUS = Path(__file__).parent / "corpus"
SUFFIXES = (".opd", ".xyz", ".npy")
NUMBERS = (0, 1, 2, 4, 24, 255, 32766, 32767, 65535, 2**31 - 1, 2**31, 2**32 - 1)
WORDS = (
    b"nan",
    b"-inf",
    b"1e308",
    b"1e-320",
    b"No Data",
    b"0 0 0\n",
    b"\n",
    b"\0",
    b"Directory",
    b"Mult",
    b"#",
    b"1_0",
)


def seeds(suffix: str) -> list[bytes]:
    return [path.read_bytes() for path in sorted(CORPUS.glob(f"*{suffix}"))]


def mutated(content: bytes, others: list[bytes], rng: random.Random) -> bytes:
    data = bytearray(content)
    for _ in range(rng.choice((1, 1, 2, 3, 8))):
        at = rng.randrange(len(data) + 1)
        span = rng.choice((1, 2, 4, 24))
        match rng.randrange(8):
            case 0:
                data[at : at + 1] = bytes([rng.randrange(256)])
            case 1 if at < len(data):
                data[at] ^= 1 << rng.randrange(8)
            case 2:
                del data[at:]
            case 3:
                del data[at : at + span]
            case 4:
                data[at:at] = data[at : at + span]
            case 5:
                data[at : at + 4] = struct.pack("<I", rng.choice(NUMBERS))
            case 6:
                data[at : at + 2] = struct.pack("<H", rng.choice(NUMBERS) & 0xFFFF)
            case _:
                insert = rng.choice(WORDS) if rng.random() < 0.7 else rng.choice(others)[at:]
                data[at : at + rng.choice((0, len(insert)))] = insert
    return bytes(data)


def outcome(content: bytes, path: Path) -> str:
    """Read the content as a file; anything but a map or a refusal that names the file is a failure."""
    path.write_bytes(content)
    steps = {} if path.suffix == ".xyz" else {"spacing_x": 1e-6, "spacing_y": 1e-6}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for given_steps in (steps, {}):
            try:
                found = read_height_map(path, length_unit="um" if path.suffix == ".xyz" else None, **given_steps)
            except InvalidInput as refused:
                refusal = str(refused)
            else:
                assert found.height.size <= 20 * len(content)
                return "read"
            assert refusal.startswith(f"{path}: ")
            assert "\n" not in refusal
    return "refused"


def fuzz(suffix: str, inputs: int, folder: Path, seed: int = 0) -> Counter[str]:
    rng = random.Random(seed)
    corpus = seeds(suffix)
    counts: Counter[str] = Counter()
    for _ in range(inputs):
        counts[outcome(mutated(rng.choice(corpus), corpus, rng), folder / f"input{suffix}")] += 1
    return counts


@mark.parametrize("suffix", SUFFIXES)
def test_a_damaged_surface_file_is_read_or_refused(suffix: str, tmp_path: Path) -> None:
    counts = fuzz(suffix, 800, tmp_path)
    assert counts["read"] > 0
    assert counts["refused"] > 0


@mark.parametrize("suffix", SUFFIXES)
def test_every_small_file_of_the_corpus_is_read_or_refused(suffix: str, tmp_path: Path) -> None:
    outcomes = {outcome(content, tmp_path / f"input{suffix}") for content in seeds(suffix)}
    assert "read" in outcomes


@settings(max_examples=200, deadline=None)
@given(content=st.binary(max_size=300), suffix=st.sampled_from(SUFFIXES))
def test_any_bytes_are_read_or_refused_as_a_surface(content: bytes, suffix: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        outcome(content, Path(folder) / f"input{suffix}")


@settings(max_examples=200, deadline=None)
@given(text=st.text(alphabet="0123456789.-+e nai,;#\n\t", max_size=200))
def test_any_text_is_read_or_refused(text: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        outcome(text.encode(), Path(folder) / "input.xyz")


if __name__ == "__main__":
    wanted, first = int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0
    with tempfile.TemporaryDirectory() as scratch:
        for each in SUFFIXES:
            sys.stdout.write(f"{each}: {dict(fuzz(each, wanted, Path(scratch), first))}\n")
