"""Random text in place of a unit."""

import random
import time
from collections.abc import Sequence

from reliability.study import Measure, Record, Study
from sonolube.errors import InvalidInput
from sonolube.text.units import to_si

_WORDS = ("N", "m", "um", "kg", "s", "degC", "ohm", "rpm", "per", "squared", "square", "sqrt", "dB", "lambda", "None")
_SIGNS = (
    "*",
    "**",
    "/",
    "^",
    "(",
    ")",
    "·",
    "²",
    "⁻¹",
    " ",
    "-",
    "+",
    ".",
    ",",
    "#",
    "?",
    "'",
    "%",
    "°",
    "Δ",
    "µ",
    "Ω",
)
_DIGITS = ("0", "1", "2", "9", "9**9**9", "1e999", "1/2", "0.5", "9" * 400)
_TEXTS = 100  # of a trial
_LONGEST = 1.0  # s of a text; the first one loads the table of units


def _text(rng: random.Random) -> str:
    pools = (_WORDS, _WORDS, _SIGNS, _SIGNS, _DIGITS, tuple(map(chr, range(1, 0x400))))
    parts = [rng.choice(rng.choice(pools)) for _ in range(rng.randrange(1, 14))]
    return f"{rng.choice(('3', '1e3', '-2.5', ''))}{rng.choice(('', ' '))}{''.join(parts)}" * rng.choice((1, 1, 1, 500))


def _trial(seed: int) -> Record:
    rng = random.Random(seed)
    to_si("1 N", unit="N", name="x")
    counts = {"read": 0, "refused": 0}
    slow = 0
    for _ in range(_TEXTS):
        begun = time.process_time()
        try:
            value = to_si(_text(rng), unit=rng.choice(("N", "m", "", "1/s", "K")), name="x")
            counts["read"] += isinstance(value, float)
        except InvalidInput as refusal:
            counts["refused"] += len(str(refusal)) < 600
        slow += time.process_time() - begun > _LONGEST
    return {**counts, "slow": slow}


def _measures(records: Sequence[Record]) -> list[Measure]:
    read, refused, slow = (sum(int(str(record[key])) for record in records) for key in ("read", "refused", "slow"))
    texts = _TEXTS * len(records)
    return [
        Measure(
            label="texts that are a number or are refused in a short line",
            value=f"{read + refused} of {texts}",
            bar="all",
            holds=read + refused == texts,
        ),
        Measure(label="texts that are a number", value=f"{read}"),
        Measure(label="texts that took more than 1 s", value=f"{slow}", bar="0", holds=not slow),
    ]


STUDY = Study(
    title="Random text as a quantity",
    question="A quantity with random symbols, operators, digits and other characters for its unit is a number or is "
    "refused, and never takes long.",
    sources=("text/units.py", "text/unit_grammar.py"),
    trials=2000,
    sample=10,
    trial=_trial,
    measures=_measures,
)
