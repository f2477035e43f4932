"""First screens on a terminal of 80 columns: length, caveats, bars and what is left out, for the longest answers."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tests.same import approx

from sonolube.report.first_screen import MAX_LINES

Program = Callable[..., Any]

LONG = {"predict": ["--out", "{out}"], "friction": [], "simulate": ["--out", "{out}"]}


def words(lines: list[str]) -> str:
    return " ".join(" ".join(lines).split())


@pytest.mark.parametrize("name", LONG)
def test_a_long_answer_has_24_lines_of_80_columns_with_every_caveat_whole(
    name: str, sonolube: Program, rigs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    command = [name, rigs / "tribometer.toml", *(each.format(out=tmp_path) for each in LONG[name])]
    lines = sonolube(*command).out.splitlines()
    every = sonolube(*command, "--full").out.splitlines()
    assert len(lines) <= MAX_LINES < len(every)
    assert max(len(line) for line in lines if "/" not in line) <= 80
    caveats = sonolube(*command, "--json").answer["caveats"]
    assert caveats
    for caveat in caveats:
        assert words([f"caveat: {caveat}"]) in words(lines)
        assert words([f"caveat: {caveat}"]) in words(every)
    assert lines[-1].endswith("in full by --full") or lines[-1].endswith("in full, by --full")


def test_a_prediction_begins_with_its_change_in_words_and_as_bars(
    sonolube: Program, rigs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    rig = rigs / "tribometer.toml"
    lines = sonolube("predict", rig, "--out", tmp_path).out.splitlines()
    answer = sonolube("predict", rig, "--out", tmp_path, "--json").answer
    reduction = answer["friction_reduction"]
    assert f" Friction falls by about {100 * reduction['median']:.0f} %. Likely between " in words(lines)
    (bar,) = (line for line in lines if line.startswith("  friction "))
    inside = bar[bar.index("[") + 1 : bar.index("]")]
    last = len(inside) - 1
    for mark, end in (
        ("|", reduction["median"]),
        ("-", reduction["interval_80"][0]),
        ("=", reduction["interval_50"][0]),
    ):
        assert inside.index(mark) / last == approx(end, abs=0.51 / last)
    assert inside.rindex("-") / last == approx(reduction["interval_80"][1], abs=0.51 / last)
    (run,) = re.findall(r"One run of yours here: (\d+) to (\d+) % becomes about (\d+) to (\d+) %", words(lines))
    said = [100 * end for each in (reduction, answer["one_run"]["friction_reduction"]) for end in each["interval_80"]]
    assert list(map(float, run)) == approx(said, abs=0.51)
    # what one run leaves of the width, about the median
    share = answer["measurements"][0]["share_left"]
    assert answer["measurements"][0]["key"] == "run_here"
    low, high = answer["one_run"]["friction_reduction"]["interval_80"]
    assert high - low == approx(share * (reduction["interval_80"][1] - reduction["interval_80"][0]))


def test_a_short_answer_is_whole(sonolube: Program, rigs: Path) -> None:
    short = sonolube("thermal", rigs / "tribometer.toml")
    assert short.out == sonolube("thermal", rigs / "tribometer.toml", "--full").out
    assert "--full" not in short.out
