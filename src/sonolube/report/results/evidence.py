"""Published tests and what was learned from them: rows, lines, and objects for JSON."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from sonolube.prediction.evidence_learning import EvidenceScore, LearnedEvidence
from sonolube.prediction.hierarchy import PROBABILITIES
from sonolube.prediction.published_source import PublishedRig, PublishedSource
from sonolube.prediction.source_file import PublishedPoint
from sonolube.prediction.within_plane import slip_length
from sonolube.report.blocks import Block, Rows, Table
from sonolube.text.units import format_si
from sonolube.vocabulary import quantities, si

if TYPE_CHECKING:
    import xarray as xr

SCORE_HEADS: Final = (
    "tests",
    "of",
    *(f"in {100 * probability:.0f} %" for probability in PROBABILITIES),
    "CRPS",
    "mean ratio's",
)
"""Heads of the table of blind scores."""

_QUANTITIES: Final = ("sliding_speed", "vibration_amplitude", "frequency", "vibration_velocity", "friction_ratio")
_RIG_HEADS: Final = ("set", "points", "direction", "amplitude", "speed", "frequency", "ratio")


def source_blocks(source: PublishedSource) -> list[Block]:
    """Source with a row a rig, and what is not printed and doubtful of each."""
    lines: list[Block] = []
    for rig in source.rigs:
        section = rig.section
        name = f"  {section.set}: {section.title}"
        lines.append(f"{name}; {section.materials}" if section.materials else name)
        lines.append(f"    amplitude: {section.amplitude_known}")
        if section.not_printed:
            lines.append(f"    not printed: {', '.join(section.not_printed)}")
        lines += [f"    caveat: {caveat}" for caveat in section.caveats]
    return [
        source_line(source),
        Rows([("citation", source.reference), ("opened", source.opened)]),
        Table(_RIG_HEADS, [_rig_row(rig) for rig in source.rigs]),
        *lines,
    ]


def source_line(source: PublishedSource) -> str:
    """Name and number of points of a source, with their directions."""
    return f"{source.title}: {_points(source.points)} on {_counted(len(source.rigs), 'rig')}, {_directions(source)}"


def _directions(source: PublishedSource) -> str:
    """Number of points along the normal and within the plane."""
    normal = sum(len(rig.points) for rig in source.rigs if rig.is_normal)
    parts = ((normal, "along the normal"), (source.points - normal, "within the plane"))
    return " and ".join(f"{count} {where}" for count, where in parts if count)


def _points(count: int) -> str:
    return _counted(count, "point")


def _counted(count: int, thing: str) -> str:
    return f"{count} {thing}{'' if count == 1 else 's'}"


def _rig_row(rig: PublishedRig) -> list[str]:
    """Row of a rig: ranges of its conditions."""
    points = rig.points
    return [
        rig.section.set,
        str(len(points)),
        _direction(rig),
        _range([point.vibration_amplitude for point in points], "m"),
        _range([point.sliding_speed for point in points], "m/s"),
        _range([point.frequency for point in points], "Hz"),
        _range([point.friction_ratio for point in points], ""),
    ]


def _direction(rig: PublishedRig) -> str:
    """Direction of the vibration in a word, or its angle."""
    angle = rig.section.vibration_direction
    return rig.section.path.direction if angle is None else format_si(angle, "rad")


def _range(values: Sequence[float | None], unit: str) -> str:
    """Lowest and highest of some values as text."""
    known = [value for value in values if value is not None]
    if not known:
        return "not printed"
    ends = dict.fromkeys(format_si(value, unit) for value in (min(known), max(known)))
    return " to ".join(ends)


def source_object(source: PublishedSource) -> dict[str, Any]:
    """Source with its rigs and points in SI."""
    return {
        "file": source.file,
        "title": source.title,
        "citation": source.citation,
        "doi": source.doi,
        "opened": source.opened,
        "rigs": [
            {
                "set": rig.section.set,
                "title": rig.section.title,
                "direction": rig.section.path.text,
                "materials": rig.section.materials,
                "roughness": rig.section.roughness,
                "amplitude_known": rig.section.amplitude_known,
                "not_printed": rig.section.not_printed,
                "caveats": rig.section.caveats,
                "points": list(map(_point_object, rig.points)),
            }
            for rig in source.rigs
        ],
    }


def _point_object(point: PublishedPoint) -> dict[str, Any]:
    """Point in SI."""
    load = None if point.normal_load is None else point.normal_load.value
    return {
        "label": point.label,
        "note": point.note,
        **si({"normal_load": load, **{name: getattr(point, name) for name in _QUANTITIES}}),
        **si({"uncertainty": point.uncertainty}, unit=""),
    }


def score_row(score: EvidenceScore) -> list[str]:
    """Coverage and scores of blind predictions."""
    found = score.found
    covered = [str(found.covered(probability)) for probability in PROBABILITIES]
    return [score.name, str(len(found.predictions)), *covered, f"{found.crps:.3f}", f"{score.rival.crps:.3f}"]


def score_object(score: EvidenceScore) -> dict[str, Any]:
    """Coverage and scores of blind predictions."""
    found = score.found
    return {
        "tests": len(found.predictions),
        "covered": {f"interval_{100 * each:.0f}": found.covered(each) for each in PROBABILITIES},
        "crps": found.crps,
        "crps_of_mean_ratio": score.rival.crps,
    }


def learned_object(learned: LearnedEvidence) -> dict[str, Any]:
    """What was learned, without the draws."""
    posterior = learned.posterior
    length, spread = posterior.posterior.decay_length()
    slip, slip_spread = slip_length(posterior.posterior_within_plane)
    return {
        "fingerprint": posterior.fingerprint,
        "sources": posterior.source_objects(),
        "blind_scores": {score.name: score_object(score) for score in learned.scores},
        "effective_draws": learned.effective_draws,
        "effective_draws_within_plane": learned.effective_draws_within_plane,
        **si({"decay_length": length, "slip_length": slip}),
        "decay_length_spread": spread,
        "slip_length_spread": slip_spread,
    }


def learned_blocks(learned: LearnedEvidence) -> list[Block]:
    """What was learned from, blind scores, and the populations of decay lengths and of slip lengths."""
    posterior = learned.posterior
    decay = _length_text(*posterior.posterior.decay_length())
    slip = _length_text(*slip_length(posterior.posterior_within_plane))
    return [
        f"Learned from {posterior.learned_from}",
        Table(SCORE_HEADS, [score_row(score) for score in learned.scores]),
        f"  decay length of worn contacts on a further rig, along the normal: {decay}",
        f"  slip length of contacts on a further rig, within the plane: {slip}",
        f"  effective draws: {learned.effective_draws:.0f} along the normal,"
        f" {learned.effective_draws_within_plane:.0f} within the plane",
        *(f"  source: {source.citation}" for source in posterior.sources),
    ]


def _length_text(middle: float, spread: float) -> str:
    """Median of a length and the factor within which it lies."""
    return f"{format_si(middle, 'm', digits=2)} within a factor of {np.exp(spread):.2g}"


def points_dataset(sources: Sequence[PublishedSource]) -> "xr.Dataset":
    """Points of sources over `point`, by source, set and label."""
    import xarray as xr

    rows = [(source, rig, point) for source in sources for rig in source.rigs for point in rig.points]
    known = quantities()
    variables = {
        name: (
            "point",
            np.array([getattr(point, name) for _, _, point in rows], dtype=np.float64),
            {"units": known[name].unit, "long_name": known[name].meaning},
        )
        for name in _QUANTITIES
    }
    uncertainty = np.array([point.uncertainty for _, _, point in rows], dtype=np.float64)
    return xr.Dataset(
        variables
        | {
            "uncertainty": (
                "point",
                uncertainty,
                {"units": "", "long_name": "Standard uncertainty of the friction ratio"},
            ),
            "direction": ("point", [rig.section.path.text for _, rig, _ in rows], {"long_name": "Direction"}),
            "source": ("point", [source.title for source, _, _ in rows], {"long_name": "Source"}),
            "set": ("point", [rig.section.set for _, rig, _ in rows], {"long_name": "Rig of the source"}),
        },
        coords={"point": ("point", [point.label for _, _, point in rows], {"long_name": "Published point"})},
        attrs={"result": "evidence", "citations": "\n".join(source.reference for source in sources)},
    )
