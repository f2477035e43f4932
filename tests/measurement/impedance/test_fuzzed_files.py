"""Damaged impedance files are read or refused with one line that names the file."""

import random
import tempfile
import warnings
from collections import Counter
from pathlib import Path

import numpy as np
from hypothesis import given, strategies as st
from pytest import mark
from reliability.damage import mutated
from tests.tiers import examples

from sonolube.errors import SonolubeError
from sonolube.measurement.impedance.spectrum import read_impedance

CORPUS = Path(__file__).parent / "corpus"
SUFFIXES = (".4294a", ".e4990a", ".s1p", ".mfia", ".csv")


def seeds(suffix: str) -> list[bytes]:
    return [path.read_bytes() for path in sorted(CORPUS.glob(f"*{suffix}"))]


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
        counts[outcome(mutated(rng.choice(corpus), rng, others=corpus), folder / f"input{suffix}")] += 1
    return counts


@mark.parametrize("suffix", SUFFIXES)
def test_a_damaged_impedance_file_is_read_or_refused(suffix: str, tmp_path: Path) -> None:
    counts = fuzz(suffix, 2000, tmp_path)
    assert counts["read"] > 0
    assert counts["refused"] > 0


@examples(300)
@given(content=st.binary(max_size=300), suffix=st.sampled_from(SUFFIXES))
def test_any_bytes_are_read_or_refused(content: bytes, suffix: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        outcome(content, Path(folder) / f"input{suffix}")
