"""Decisions about what sets the decay length, on generated runs under each hypothesis in turn and under none."""

from collections import Counter
from collections.abc import Sequence

import numpy as np

from reliability import decay_length_recordings as made
from reliability.study import Measure, Record, Study
from sonolube.identification.decay_length.decision import decide_decay_length
from sonolube.identification.decay_length.recorded_switches import recorded_switches
from sonolube.identification.decay_length.switch_table import SwitchConditions, SwitchTable

_CLEAR = ("long_sliding", "zero_error", "detuning", "none")
_RECORDED = 4  # one run in so many is a recording, the others are tables
_WORDS = {
    "long_sliding": "long sliding",
    "zero_error": "a zero error",
    "detuning": "detuning",
    "none": "none of them",
    "several": "two of them at once",
    "weak": "one weak change",
    "friction_alone": "friction that changes by itself",
}


def switches(rng: np.random.Generator, truth: made.Truth, *, recorded: bool) -> SwitchTable:
    """Table of a generated run, by way of its recording or at once."""
    if not recorded:
        return SwitchTable(title="generated", caveats=(), **made.noisy_table(rng, truth))
    import xarray as xr

    channels = made.recording(rng, truth, rate=5.0)
    time = channels.pop("time")
    recording = xr.Dataset({name: ("time", values) for name, values in channels.items()}, coords={"time": time})
    return recorded_switches(recording, sliding_speed=made.SLIDING_SPEED)


def _trial(seed: int) -> Record:
    kind = made.KINDS[seed % len(made.KINDS)]
    rng = np.random.default_rng([27, seed])
    truth = made.truth(rng, kind)
    table = switches(rng, truth, recorded=seed // len(made.KINDS) % _RECORDED == 0)
    mass = made.MODAL_MASS * float(np.exp(rng.normal(0, 0.1))) if rng.random() < 0.5 else None
    found = decide_decay_length(table, SwitchConditions(natural_frequency=made.FREE_FREQUENCY, modal_mass=mass))
    return {
        "kind": kind,
        "changed": list(truth.changed),
        "verdict": found.leading if found.decided else "not decided",
        "leading": found.leading,
        "probability": found.probabilities[found.leading],
        "effective_draws": found.effective_draws,
        "text": found.verdict,
    }


def _is_right(record: Record) -> bool:
    """Whether the verdict is that of the run; a weak change may be named, or nothing decided."""
    verdict, kind = record["verdict"], record["kind"]
    if kind in _CLEAR:
        return verdict == kind
    return verdict == "not decided" or (kind == "weak" and [verdict] == record["changed"])


def _measures(records: Sequence[Record]) -> list[Measure]:
    found = []
    for kind in made.KINDS:
        own = [str(record["verdict"]) for record in records if record["kind"] == kind]
        if not own:
            continue
        counts = Counter(own)
        listed = ", ".join(f"{_WORDS.get(name, name)} {count}" for name, count in counts.most_common())
        clear = kind in _CLEAR
        right = sum(_is_right(record) for record in records if record["kind"] == kind)
        bar = "right" if clear else "not decided, or right" if kind == "weak" else "not decided"
        found.append(
            Measure(
                label=f"verdicts under {_WORDS[kind]}, of {len(own)}",
                value=listed,
                bar=f"{bar} in nine of ten",
                holds=right >= 0.9 * len(own),
            )
        )
    clear_records = [record for record in records if record["kind"] in _CLEAR]
    wrong = sum(record["verdict"] not in (record["kind"], "not decided") for record in clear_records)
    found.append(
        Measure(
            label="wrong verdicts under one hypothesis or none",
            value=f"{wrong} of {len(clear_records)}",
            bar="at most 2 %",
            holds=wrong <= max(1, 0.02 * len(clear_records)),
        )
    )
    return found


def _sample_measures(records: Sequence[Record]) -> list[Measure]:
    wrong = [record for record in records if not _is_right(record) and record["verdict"] != "not decided"]
    return [Measure(label="wrong verdicts", value=str(len(wrong)), bar="0", holds=not wrong)]


STUDY = Study(
    title="What sets the decay length: decisions on generated runs",
    question="Runs of 300 m with the vibration switched every 5 m, made by another program under each hypothesis in "
    "turn (long sliding, a zero error of the load cell, detuning), under none, under two at once, with a change of 15 "
    "to 30 %, and with friction that changes by itself: the analysis names the right one, and decides nothing where it "
    "must not. One run in four is a recording, the others are tables of their switches.",
    sources=("identification/decay_length/*.py", "identification/decay_length/*.toml"),
    trials=700,
    sample=3,
    trial=_trial,
    measures=_measures,
    sample_measures=_sample_measures,
)
