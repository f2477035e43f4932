"""Ten claims of the dissertation, and the findings on them that follow from the rows."""

import tomllib
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Final

from dong2015.row import Row, Verdict

Summary = Callable[[Sequence[Row]], tuple[str, str]]
"""Printed and computed value of a claim's rows, each in a few words."""


class ClaimVerdict(StrEnum):
    """Outcome of a claim over all its rows."""

    REPRODUCED = "reproduced"
    FITTED = "fitted"
    MET_TRIVIALLY = "met trivially"
    PARTLY_REPRODUCED = "partly reproduced"
    NOT_REPRODUCED = "not reproduced"
    UNDETERMINED = "undetermined"
    NOT_COMPUTED = "not computed"


def numbers(rows: Sequence[Row]) -> tuple[str, str]:
    """Printed and the computed numbers of rows as text, those of one unit together.

    The second says how many of the rows are fitted or met trivially, if any, and gives a number whose inputs are not
    all printed with its possible values.
    """
    found = [_by_unit(rows, _computed)]
    for verdict, text in ((Verdict.FITTED, "fitted"), (Verdict.TRIVIALLY_MET, "met trivially")):
        if count := sum(row.verdict is verdict for row in rows):
            found.append(f"{count} {text}")
    return _by_unit(rows, _printed), "; ".join(found)


@dataclass(frozen=True, kw_only=True, slots=True)
class Claim:
    """Result that the dissertation states, with the rows that decide about it.

    Parameters
    ----------
    id : str
        Stable name.
    statement : str
        The claim in a few words.
    source : str
        Sections, tables and figures of D that state it.
    judged : str
        Method by which the claim is tested: what is computed, and what was fitted or assumed for it.
    decisive : tuple of str
        Ids of the rows that the verdict follows from.
    supporting : tuple of str
        Ids of further rows on the same subject.
    summary : callable
        How the rows are summed up.
    """

    id: str
    statement: str
    source: str
    judged: str
    decisive: tuple[str, ...]
    summary: Summary = numbers
    supporting: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True, slots=True)
class Finding:
    """Claim with its verdict.

    Parameters
    ----------
    claim : Claim
    verdict : ClaimVerdict
    claimed, found : str
        What is printed, and what was computed.
    """

    claim: Claim
    verdict: ClaimVerdict
    claimed: str
    found: str


def finding(claim: Claim, rows: Mapping[str, Row]) -> Finding:
    """Finding on a claim."""
    decisive = [rows[name] for name in claim.decisive]
    claimed, found = claim.summary(decisive)
    return Finding(claim=claim, verdict=verdict_of(decisive), claimed=claimed, found=found)


def verdict_of(rows: Sequence[Row]) -> ClaimVerdict:
    """Verdict of a claim that rests on rows.

    `NOT_COMPUTED` if a part for one of the rows is missing here, `UNDETERMINED` if an input of all is not printed. Over
    the others: `REPRODUCED` if each agrees and one does so by neither fit nor triviality, `FITTED` or `MET_TRIVIALLY`
    if each agrees by fits, or trivially, alone, `NOT_REPRODUCED` if one disagrees and none is reproduced, else
    `PARTLY_REPRODUCED`.
    """
    count = Counter(row.verdict for row in rows)
    judged = len(rows) - count[Verdict.UNDETERMINED]
    agreed = count[Verdict.REPRODUCED] + count[Verdict.FITTED] + count[Verdict.TRIVIALLY_MET]
    if count[Verdict.NOT_COMPUTED]:
        return ClaimVerdict.NOT_COMPUTED
    if not judged:
        return ClaimVerdict.UNDETERMINED
    if agreed < judged:
        return ClaimVerdict.PARTLY_REPRODUCED if count[Verdict.REPRODUCED] else ClaimVerdict.NOT_REPRODUCED
    if count[Verdict.REPRODUCED]:
        return ClaimVerdict.REPRODUCED
    return ClaimVerdict.FITTED if count[Verdict.FITTED] else ClaimVerdict.MET_TRIVIALLY


def counts(rows: Sequence[Row]) -> tuple[str, str]:
    """Number of statements that rows test, and how many of them are reproduced, as text."""
    reproduced = sum(row.verdict is Verdict.REPRODUCED for row in rows)
    return f"{len(rows)} statements", f"{reproduced} of {len(rows)}"


def _by_unit(rows: Sequence[Row], text: Callable[[Row], str]) -> str:
    """Texts of rows without repetition, each unit once after its numbers."""
    units: dict[str, dict[str, None]] = {}
    for row in rows:
        units.setdefault(row.unit, {})[text(row)] = None
    return "; ".join(f"{', '.join(texts)} {unit}".rstrip() for unit, texts in units.items())


def _printed(row: Row) -> str:
    """Printed number without its scatter, with the sign of an upper limit."""
    mean = row.printed.partition("±")[0]
    return f"< {mean}" if row.is_upper_limit else mean


def _computed(row: Row) -> str:
    """Computed number, with its possible values where it is undetermined."""
    if row.computed is None:
        return "-"
    if row.verdict is Verdict.UNDETERMINED and row.possible_low is not None and row.possible_high is not None:
        return f"{_digits(row.computed)} ({_digits(row.possible_low)} to {_digits(row.possible_high)})"
    return _digits(row.computed)


def _digits(value: float) -> str:
    """Number to three digits, zero below a two-hundredth."""
    return f"{value:.3g}" if abs(value) >= 0.005 else "0"


_SUMMARIES: Final[Mapping[str, Summary]] = {"numbers": numbers, "counts": counts}


def _claim(*, decisive: Iterable[str], supporting: Iterable[str] = (), summary: str = "numbers", **texts: str) -> Claim:
    """Claim of an entry of the file beside this module."""
    return Claim(decisive=tuple(decisive), supporting=tuple(supporting), summary=_SUMMARIES[summary], **texts)


_FILE: Final = Path(__file__).with_suffix(".toml")

CLAIMS: Final = tuple(_claim(**entry) for entry in tomllib.loads(_FILE.read_text(encoding="utf-8"))["claim"])
"""Claims in the order of their chapters."""


def findings(rows: Iterable[Row]) -> tuple[Finding, ...]:
    """Findings on all claims whose rows were computed; in the order of `CLAIMS`."""
    by_id = {row.id: row for row in rows}
    return tuple(finding(claim, by_id) for claim in CLAIMS if by_id.keys() >= set(claim.decisive))
