"""Text that programs mistake for something else, and a run of the program on it."""

import contextlib
import io
import os
import re
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from reliability.study import Measure, Record
from sonolube.cli import main

ROOT = Path(__file__).parents[1]
TRIBOMETER = str(ROOT / "examples" / "rigs" / "tribometer.toml")
COLLAR = str(ROOT / "examples" / "rigs" / "collar.toml")

HOSTILE = (
    "",
    " ",
    "$x_{$",
    r"$\frac{1}{$",
    "{{ 7 * 7 }}",
    "{% raw %}",
    "%s%n{0}",
    "<script>alert(1)</script>",
    "&amp;\"'><",
    "[bold]x[/]",
    "\x1b[2J\x1b]0;title\x07",
    "a\x00b",
    "a\nb\r\nc",
    "\u202eevil\u202c",
    "\udcff\udc80",
    "\U0001f600 漢字 é",
    "../../etc/passwd",
    "-",
    "--help",
    "9" * 5000,
    "1e999",
    "-1e999 N",
    "nan",
    "inf m",
    "1e-320 N",
    "3 N**9**9**9",
    "9**9**9 N",
    "3 " + "x" * 100_000,
    "3 N?",
    "3 N #x",
    "1 m,m",
    "0x10 N",
    "1_000 N",
    "٣ N",
    "3 N" + " " * 50_000 + "x",
    "uniform 1" + " " * 50_000 + "x",
    ".".join("a" * 20_000),
    "[" * 5_000,
    "=",
    "a=b=c",
    ":::",
    "1kHz:2kHz:" + "9" * 5000,
    ",,,",
    "None",
    "true",
)
"""Formulas, markup, control characters, bytes that are no UTF-8, and numbers and units without end."""

_LONGEST = 5.0  # s of the processor, which other programs do not lengthen
_LONGEST_FAULT, _MAX_FAULTS = 320, 21  # characters of a line, lines
_CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069\ud800-\udfff]")


def program_record(arguments: Sequence[str]) -> Record:
    """Record of one run of the program in this process: its outcome, and whether it took more than five seconds.

    The outcome is "answered", "refused" in one line, or what went wrong.
    """
    answer, errors = io.StringIO(), io.StringIO()
    begun, folder = time.process_time(), Path.cwd()
    with tempfile.TemporaryDirectory() as place:
        os.chdir(place)
        try:
            with contextlib.redirect_stdout(answer), contextlib.redirect_stderr(errors):
                main(list(arguments))
        except SystemExit as end:
            outcome = _outcome(int(end.code or 0), answer.getvalue(), errors.getvalue())
        except BaseException as failure:  # any other is the finding
            outcome = f"{type(failure).__name__}: {failure}"[:300]
        else:
            outcome = "did not exit"
        finally:
            os.chdir(folder)
    return {"outcome": outcome, "slow": time.process_time() - begun > _LONGEST, "command": arguments[0]}


def outcome_measures(records: Sequence[Record]) -> list[Measure]:
    """Share of runs that answered or refused in one line, and number of slow ones."""
    wrong = [record for record in records if record["outcome"] not in ("answered", "refused")]
    slow = sum(bool(record["slow"]) for record in records)
    first = f"; seed {wrong[0]['seed']}: {wrong[0]['outcome']}" if wrong else ""
    right = len(records) - len(wrong)
    refused = sum(record["outcome"] == "refused" for record in records)
    return [
        Measure(
            label="runs that answer or refuse in one line without control characters",
            value=f"{right} of {len(records)}{first}",
            bar="all",
            holds=not wrong,
        ),
        Measure(label="runs that refuse", value=f"{refused} of {len(records)}"),
        Measure(label="runs of more than 5 s of the processor", value=f"{slow}", bar="0", holds=not slow),
    ]


def _outcome(code: int, answer: str, errors: str) -> str:
    """Outcome of a run by its exit code and what it printed."""
    if found := _CONTROL.search(answer + errors):
        return f"printed U+{ord(found[0]):04X}"
    try:
        (answer + errors).encode(sys.stdout.encoding or "utf-8")
    except UnicodeEncodeError as failure:
        return f"printed what cannot be encoded: {failure}"
    if code == 0:
        return "answered"
    head, *faults = errors.splitlines() or [""]
    if code == 2 and len(head) < 1500 and _are_faults(head, faults):
        return "refused"
    return f"exit code {code}: {errors[-200:]}"


def _are_faults(head: str, faults: list[str]) -> bool:
    """Whether what follows the line of a refusal is nothing, or its faults: at most 21 indented lines."""
    listed = all(line.startswith("  ") and len(line) < _LONGEST_FAULT for line in faults)
    return not faults or (head.endswith(" faults") and len(faults) <= _MAX_FAULTS and listed)
