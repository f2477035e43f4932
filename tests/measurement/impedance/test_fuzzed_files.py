"""Damaged impedance files are read or refused with one line that names the file.

Run as a program it does the same at length: ``python tests/measurement/impedance/test_fuzzed_files.py 100000 [seed]``.
"""

import random
import sys
import tempfile
import warnings
from collections import Counter
from pathlib import Path

import numpy as np
from hypothesis import given, settings, strategies as st
from pytest import mark

from sonolube.errors import SonolubeError
from sonolube.measurement.impedance.reader import read_impedance

CORPUS = Path(__file__).parent / "corpus"
SUFFIXES = (".4294a", ".e4990a", ".s1p", ".mfia", ".csv")
WORDS = (
    b"nan", b"-inf", b"1e308", b"1e-320", b"0", b"-1", b";", b",", b"\t", b"\n", b"\r", b"\0", b'"', b"#", b"!",
    b"END", b"BEGIN", b"[End]", b"[Version] 2.0\n", b"# GHZ Z DB R 1e-300\n", b"9" * 400, b"1_0", b"\xff", b"chunk",
    b'"Frequency"', "µΩ".encode(), "\u0661\u0662".encode(), b"(", b")", b"()", b"[]",
)  # fmt: skip


def seeds(suffix: str) -> list[bytes]:
    return [path.read_bytes() for path in sorted(CORPUS.glob(f"*{suffix}"))]


def mutated(content: bytes, others: list[bytes], rng: random.Random) -> bytes:
    data = bytearray(content)
    for _ in range(rng.choice((1, 1, 2, 3, 8))):
        at = rng.randrange(len(data) + 1)
        span = rng.choice((1, 2, 4, 24, 200))
        match rng.randrange(6):
            case 0:
                data[at : at + 1] = bytes([rng.randrange(256)])
            case 1 if at < len(data):
                data[at] ^= 1 << rng.randrange(8)
            case 2 if rng.random() < 0.3:
                del data[at:]
            case 3:
                del data[at : at + span]
            case 4:
                data[at:at] = data[at : at + span]
            case _:
                insert = rng.choice(WORDS) if rng.random() < 0.8 else rng.choice(others)[at:]
                data[at : at + rng.choice((0, len(insert)))] = insert
    return bytes(data)


def outcome(content: bytes, path: Path) -> str:
    """Read the content as a file; anything but a spectrum or a refusal that names the file is a failure."""
    path.write_bytes(content)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            found = read_impedance(path)
        except SonolubeError as refused:
            refusal = str(refused)
        else:
            refusal = ""
    if refusal:
        assert refusal.startswith(f"{path}: ")
        assert "\n" not in refusal
        return "refused"
    assert found.frequency.size <= len(content)
    assert np.isfinite(found.admittance).all()
    return "read"


def fuzz(suffix: str, inputs: int, folder: Path, seed: int = 0) -> Counter[str]:
    rng = random.Random(seed)
    corpus = seeds(suffix)
    counts: Counter[str] = Counter()
    for _ in range(inputs):
        counts[outcome(mutated(rng.choice(corpus), corpus, rng), folder / f"input{suffix}")] += 1
    return counts


@mark.parametrize("suffix", SUFFIXES)
def test_a_damaged_impedance_file_is_read_or_refused(suffix: str, tmp_path: Path) -> None:
    counts = fuzz(suffix, 2000, tmp_path)
    assert counts["read"] > 0
    assert counts["refused"] > 0


@settings(max_examples=300, deadline=None)
@given(content=st.binary(max_size=300), suffix=st.sampled_from(SUFFIXES))
def test_any_bytes_are_read_or_refused(content: bytes, suffix: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        outcome(content, Path(folder) / f"input{suffix}")


if __name__ == "__main__":
    wanted, first = int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0
    with tempfile.TemporaryDirectory() as scratch:
        for each in SUFFIXES:
            sys.stdout.write(f"{each}: {dict(fuzz(each, wanted, Path(scratch), first))}\n")
            sys.stdout.flush()
