"""Number of wear tracks in fields with none to three, scratches and pits, and marks along the track."""

import math
from collections.abc import Sequence

import numpy as np

from reliability.groove_maps import random_field
from reliability.study import Measure, Record, Study
from sonolube.errors import InvalidInput, NoGroove, SeveralGrooves
from sonolube.models.surfaces import HeightMap, measure_groove, track_marks

_SHAPE, _PIXEL = (150, 200), 12e-6
_RIGHT, _FALSE, _FOUND = 0.97, 0.01, 0.9


def _trial(seed: int) -> Record:
    rng = np.random.default_rng([seed, 3])
    count, marked = seed % 4, seed % 8 == 1
    y, x = ((n - n.mean()) * _PIXEL for n in np.mgrid[: _SHAPE[0], : _SHAPE[1]].astype(float))
    sq = rng.uniform(0.1e-6, 0.6e-6)
    length = math.exp(rng.uniform(math.log(15e-6), math.log(60e-6)))
    lay = (sq, length, length / rng.choice([1.0, 4.0]), rng.uniform(0, math.pi), rng.uniform(0.3, 1.0), 0.0)
    height = random_field(rng, _SHAPE, _PIXEL, lay) + rng.uniform(-2e-3, 2e-3) * x + rng.uniform(-2e-3, 2e-3) * y
    angle = rng.uniform(0, math.pi)
    s, t = y * math.cos(angle) - x * math.sin(angle), y * math.sin(angle) + x * math.cos(angle)
    places = (np.arange(count) - (count - 1) / 2) * 0.5e-3 + rng.uniform(-0.03e-3, 0.03e-3, count)
    spacing = rng.uniform(80e-6, 400e-6)
    for place in places:
        depth, width = rng.uniform(6e-6, 20e-6), rng.uniform(0.2e-3, 0.35e-3)
        shape = np.maximum(0.0, 1 - (2 * (s - place) / width) ** 2)
        height = height - depth * shape * (1 + (0.12 * np.cos(2 * math.pi * t / spacing) if marked else 0.0))
    scratches = int(rng.integers(0, 3))
    for _ in range(scratches):
        direction, half = rng.uniform(0, math.pi), rng.uniform(0.05e-3, 0.35e-3)
        px, py = rng.uniform(-1e-3, 1e-3), rng.uniform(-0.7e-3, 0.7e-3)
        along = (x - px) * math.cos(direction) + (y - py) * math.sin(direction)
        across = (y - py) * math.cos(direction) - (x - px) * math.sin(direction)
        cut = np.maximum(0.0, 1 - (2 * across / 40e-6) ** 2) * (np.abs(along) < half)
        height = height - rng.uniform(2e-6, 8e-6) * cut
    record = {"tracks": count, "scratches": scratches, "marked": marked}
    scan = HeightMap(height=height, spacing_x=_PIXEL, spacing_y=_PIXEL)
    try:
        groove = measure_groove(scan)
    except NoGroove:
        return {**record, "found": 0}
    except SeveralGrooves as several:
        return {**record, "found": int(str(several).split(maxsplit=1)[0])}
    try:
        marks = track_marks(groove).dot_spacing
    except InvalidInput:
        return {**record, "found": groove.track_count}
    near = marks is not None and abs(marks / spacing - 1) < 0.05
    return {**record, "found": groove.track_count, "spacing_given": marks is not None, "spacing_right": near}


def _measures(records: Sequence[Record]) -> list[Measure]:
    measures = []
    for count in range(4):
        fields = [record for record in records if record["tracks"] == count]
        right = sum(record["found"] == count for record in fields)
        measures.append(
            Measure(
                label=f"fields with {count} tracks whose number is found",
                value=f"{right} of {len(fields)}",
                bar=f"at least {_RIGHT:.0%}",
                holds=right >= _RIGHT * len(fields),
            )
        )
    single = [record for record in records if "spacing_given" in record and record["tracks"] == 1]
    even, marked = ([record for record in single if record["marked"] is state] for state in (False, True))
    false = sum(bool(record["spacing_given"]) for record in even)
    # a rate of 1 % gives more in one study of forty
    allowed = _FALSE * len(even) + 2 * math.sqrt(_FALSE * len(even))
    true = sum(bool(record["spacing_right"]) for record in marked)
    measures += [
        Measure(
            label="spacings given where there are no marks",
            value=f"{false} of {len(even)}",
            bar=f"{_FALSE:.0%}, two standard deviations of the count allowed",
            holds=false <= allowed,
        ),
        Measure(
            label="spacings of marks of 12 % of the depth found",
            value=f"{true} of {len(marked)}",
            bar=f"at least {_FOUND:.0%}",
            holds=true >= _FOUND * len(marked),
        ),
    ]
    return measures


def _sample_measures(records: Sequence[Record]) -> list[Measure]:
    right = sum(record["found"] == record["tracks"] for record in records)
    return [
        Measure(
            label="fields whose number of tracks is found",
            value=f"{right} of {len(records)}",
            bar="all but one",
            holds=right >= len(records) - 1,
        )
    ]


STUDY = Study(
    title="Tracks in a field, and marks along them",
    question="Fields with none to three wear tracks, short scratches, and marks on some: the number of tracks is found,"
    " and a spacing of marks is given only where there are marks.",
    sources=("models/surfaces/grooves/*.py",),
    trials=800,
    sample=5,
    trial=_trial,
    measures=_measures,
    sample_measures=_sample_measures,
)
