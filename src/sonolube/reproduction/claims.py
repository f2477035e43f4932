"""Ten claims of the dissertation, and the findings on them that follow from the rows."""

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Final

from sonolube.reproduction.row import Row, Verdict

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


_DEFAULT: Final = "friction-model-asperity-stick-slip-fitted"

CLAIMS: Final = (
    Claim(
        id="cube-friction",
        statement="The cube model errs by less than 20 % of friction on average",
        source="D 3.1.4, 3.1.5, 5.1.2",
        judged="Mean error over the loads of each test, at the amplitude of the waveguide in D 2.1.2; at that of D "
        "4.3.5 as the alternative beside each row. Of the tests only the range of the reduction is printed, so that it "
        "is taken to fall in proportion to the load.",
        decisive=("3.1.5-error-1-2", "3.1.5-error-3"),
        supporting=("3.1.4-reduction-1-2", "3.1.4-reduction-3", "3.1.4-error"),
    ),
    Claim(
        id="cube-wear",
        statement="The cube model errs by less than 15 % of wear",
        source="D 3.2.2, 3.2.3, 5.1.2",
        judged="Largest error over Tables 3.3 and 3.4, with the inputs of Table 3.2, nothing fitted.",
        decisive=("3.2.2-error", "3.2.3-error"),
        supporting=(*(f"table-3.3-error-{n}" for n in range(1, 7)), *(f"table-3.4-error-{n}" for n in range(1, 7))),
    ),
    Claim(
        id="multi-scale-friction",
        statement="The multi-scale model errs by less than 10 % of friction",
        source="D 3.3.4, 3.3.6, 5.1.2",
        judged="Largest error over Table 2.3 of D 3.46 to 3.48 as printed, on the computed motion of the tribometer; "
        "about no mean gap is it less than 14 %.",
        decisive=("3.3.4-error", "3.3.6-error"),
        supporting=tuple(f"{_DEFAULT}-A-{n}" for n in (1, 2, 3)),
    ),
    Claim(
        id="friction-over-speed",
        statement="Vibration reduces friction by 62, 36 and 29 % at 20.3, 40.6 and 87 mm/s",
        source="D 2.3.5, Tables 2.3 and 2.5",
        judged="Asperity stick-slip against the test, within the printed scatter of the forces; its memory length is "
        "fitted to the sets of tests that the note of each row names, this one among them.",
        decisive=tuple(f"{_DEFAULT}-A-{n}" for n in (1, 2, 3)),
        supporting=(
            *(f"table-2.5-friction-reduction-{n}" for n in (1, 2, 3)),
            *(f"table-2.3-friction-force-{n}" for n in (2, 4, 6)),
        ),
    ),
    Claim(
        id="wear-reduction",
        statement="Vibration reduces wear by 46 to 49 % at every speed",
        source="D 2.3.5, Table 2.5",
        judged="Arithmetic of the printed wear rates, and the cube model with the inputs of Table 3.2.",
        decisive=("2.3.5-wear-reduction-from", "2.3.5-wear-reduction-to", "2.3.5-wear-reduction-by-the-cube"),
        supporting=tuple(f"table-2.5-wear-reduction-{n}" for n in (1, 2, 3)),
    ),
    Claim(
        id="trends",
        statement="Friction over voltage, speed, frequency and waveform follows Figs. 3.15 to 3.18",
        source="D 3.3.5, 3.3.6",
        judged="Statements of the text on the figures, tested on the multi-scale model with asperity stick-slip and "
        "the structure identified from published facts.",
        decisive=(
            *("3.3.5-voltage-knee", "3.3.5-voltage-order", "3.3.5-voltage-saturation", "3.3.5-hopping-displacement"),
            *("3.3.5-speed-order", "3.3.5-speed-voltage-order"),
            *("3.3.5-resonance-friction", "3.3.5-resonance-voltage-order", "3.3.5-resonance-power"),
            *("3.3.5-waveform-square", "3.3.5-waveform-sine", "3.3.5-waveform-triangle", "3.3.6-waveform-ratio"),
        ),
        summary=counts,
    ),
    Claim(
        id="power-map",
        statement="The example test loses 3 to 100 % of its friction from 5 to 26 V",
        source="D 4.1.2, Table 4.2",
        judged="Asperity stick-slip against the test, within the printed scatter of the forces; its memory length is "
        "fitted to the sets of tests that the note of each row names.",
        decisive=tuple(f"{_DEFAULT}-B-{n}" for n in range(1, 6)),
        supporting=(
            *(f"table-4.2-friction-reduction-{n}" for n in range(2, 7)),
            *(f"table-4.2-friction-force-{n}-by-the-cube" for n in range(2, 7)),
            *(f"table-4.2-friction-force-{n}-by-the-line" for n in range(2, 7)),
        ),
    ),
    Claim(
        id="load",
        statement="The load matters by less than 10 %, most at 6 to 7 N",
        source="D 4.1.2, Fig. 4.7",
        judged="Range of the reduction from 3 to 9 N and the load of its maximum, by the multi-scale model with "
        "asperity stick-slip. Nothing in D 3.31 excites the arm whose resonance the text holds responsible, and at "
        "100 Hz no amplitude below 69 decay lengths reduces friction at this speed.",
        decisive=("4.1.2-arm-extra-reduction", "4.1.2-peak-load-1", "4.1.2-peak-load-2"),
        supporting=("4.1.2-arm-frequency",),
    ),
    Claim(
        id="temperature",
        statement="Contact, waveguide and foil reach 53, 80 and 41 degC",
        source="D 4.3.5, Fig. 4.36",
        judged="Frictional and vibrational heat of the tribometer, from a conducting to an insulating bond of the "
        "thermocouple; the rows on waveguide and foil state bounds, for what warmed the thermocouple there is not "
        "printed.",
        decisive=("4.3.5-tribometer-temperature-peak", "4.3.5-temperature-peak", "4.3.5-foil-temperature-peak"),
    ),
    Claim(
        id="collar",
        statement="The collar saves 48.9 % of the work of friction on a pulled rod",
        source="D 4.5.4, 4.5.6",
        judged="Finite elements of the collar with the contact of Table 3.2 and asperity stick-slip; length, load and "
        "speed of the rod are assumed, the speed over a range.",
        decisive=("4.5.4-work-reduction",),
        supporting=("4.5.4-reduction-from", "4.5.4-reduction-to", "4.5.3-mode-closed-top", "4.5.3-mode-open-top"),
    ),
)
"""Claims in the order of their chapters."""


def findings(rows: Iterable[Row]) -> tuple[Finding, ...]:
    """Findings on all claims whose rows were computed; in the order of `CLAIMS`."""
    by_id = {row.id: row for row in rows}
    return tuple(finding(claim, by_id) for claim in CLAIMS if by_id.keys() >= set(claim.decisive))
