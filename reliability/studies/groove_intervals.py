"""Width, depth and volume of generated wear grooves against their 95 % intervals."""

from collections.abc import Sequence

import numpy as np

from reliability.groove_maps import CLASSES, FAMILIES, drawn_groove, heights
from reliability.study import Measure, Record, Study
from sonolube.errors import SonolubeError
from sonolube.models.surfaces import HeightMap, measure_groove

_QUANTITIES = {"groove_width": "width", "groove_depth": "depth", "wear_volume": "volume"}
_REPEATED = 4  # of so many trials one repeats its groove with another roughness
_ALL, _OF_CLASS, _RATIO, _FOUND = (0.93, 0.97), 0.91, 1.3, 0.95


def _measured(seed: int, roughness: int) -> dict[str, object]:
    """Errors and half-widths over the true values, or why nothing was measured."""
    drawn = drawn_groove(seed)
    scan = HeightMap(height=heights(drawn, roughness), spacing_x=drawn.pixel, spacing_y=drawn.pixel)
    try:
        groove = measure_groove(scan)
    except SonolubeError as refusal:
        return {"refused": str(refusal)[:120]}
    record: dict[str, object] = {}
    for name, short in _QUANTITIES.items():
        true = float(getattr(drawn, name))
        low, high = getattr(groove, f"{name}_interval")
        record |= {
            f"{short}_covered": bool(low <= true <= high),
            f"{short}_error": float(getattr(groove, name)) / true - 1,
            f"{short}_half_width": (high - low) / 2 / true,
        }
    return record


def _trial(seed: int) -> Record:
    drawn = drawn_groove(seed)
    record = {"class": drawn.kind, "family": drawn.family, **_measured(seed, seed)}
    if seed // len(CLASSES) % _REPEATED == 0:
        record["repeat"] = _measured(seed, seed + 1_000_000)
    return record


def _scatter_ratio(records: Sequence[Record], short: str) -> float:
    """Median over grooves measured twice of half-width over 1.96 times the scatter, this from both scans."""
    pairs = [
        (float(str(record[f"{short}_error"])), float(str(again[f"{short}_error"])), record[f"{short}_half_width"])
        for record in records
        if isinstance(again := record.get("repeat"), dict) and f"{short}_error" in again and f"{short}_error" in record
    ]
    if len(pairs) < 3:
        return float("nan")
    first, second, half = np.array(pairs, dtype=float).T
    # a difference of two normal errors is within 0.954 standard deviations of one in half of the cases
    scatter = float(np.median(np.abs(first - second) / half)) / 0.9539
    return 1 / (1.96 * scatter)


def _measures(records: Sequence[Record]) -> list[Measure]:
    found = [record for record in records if "refused" not in record]
    measures = [
        Measure(
            label="grooves measured",
            value=f"{len(found)} of {len(records)}",
            bar=f"at least {_FOUND:.0%}",
            holds=len(found) >= _FOUND * len(records),
        )
    ]
    for short in _QUANTITIES.values():
        share = float(np.mean([bool(record[f"{short}_covered"]) for record in found]))
        measures.append(
            Measure(
                label=f"95 % intervals of {short} that cover",
                value=f"{share:.1%}",
                bar=f"{_ALL[0]:.0%} to {_ALL[1]:.0%}",
                holds=_ALL[0] <= share <= _ALL[1],
            )
        )
        ratio = _scatter_ratio(records, short)
        measures.append(
            Measure(
                label=f"median half-width of {short} over 1.96 times the scatter of repeats",
                value=f"{ratio:.2f}",
                bar=f"at most {_RATIO}",
                holds=bool(ratio <= _RATIO),
            )
        )
    groups = [*(("class", kind) for kind in CLASSES), *(("family", family) for family in FAMILIES)]
    for key, kind in groups:
        of_class = [record for record in found if record[key] == kind]
        shares = {
            short: float(np.mean([bool(record[f"{short}_covered"]) for record in of_class])) if of_class else 0.0
            for short in _QUANTITIES.values()
        }
        halves = ", ".join(
            f"{np.median([float(str(r[f'{short}_half_width'])) for r in of_class]):.1%}" if of_class else "-"
            for short in _QUANTITIES.values()
        )
        measures.append(
            Measure(
                label=f"coverage of width, depth, volume: {kind}",
                value=", ".join(f"{share:.1%}" for share in shares.values())
                + f" of {len(of_class)}; median half-widths {halves}",
                bar=f"at least {_OF_CLASS:.0%}",
                holds=min(shares.values()) >= _OF_CLASS,
            )
        )
    return measures


def _sample_measures(records: Sequence[Record]) -> list[Measure]:
    wide = [
        record
        for record in records
        for short in _QUANTITIES.values()
        if "refused" not in record
        and abs(float(str(record[f"{short}_error"]))) > 4 * float(str(record[f"{short}_half_width"]))
    ]
    return [Measure(label="errors beyond four half-widths", value=str(len(wide)), bar="0", holds=not wide)]


STUDY = Study(
    title="Intervals of wear grooves",
    question="Width, depth and volume of generated grooves on rough surfaces of many spectra; an interval fails where"
    " it misses the groove as generated more often than once in twenty, or is wider than the scatter of repeats.",
    sources=("models/surfaces/grooves/*.py",),
    trials=2000,
    sample=3,
    trial=_trial,
    measures=_measures,
    sample_measures=_sample_measures,
)
