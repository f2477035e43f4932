"""Posterior that a user has learned from shipped and own published tests, as a file that `predict` takes.

A file has draws along the normal and, where anything of its own was learned from, within the plane. Files of the first
format have none within the plane, where the shipped posterior holds.
"""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np
from pydantic import Field

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.prediction.evidence import CLOSURES
from sonolube.prediction.hierarchy import HYPERPARAMETERS
from sonolube.prediction.posterior import Posterior, evidence_fingerprint, learned
from sonolube.prediction.published_source import PublishedSource
from sonolube.prediction.within_plane import SPRINGS, plane_posterior, plane_rigs
from sonolube.rig.file.section import Section
from sonolube.rig.file.toml_file import prefixed, validated
from sonolube.rig.vibration_direction import VibrationDirection
from sonolube.storage.files import write_atomically
from sonolube.text.toml_text import require_plain_content, text_of

_FORMAT: Final = "sonolube evidence posterior 2"
_FEWEST_DRAWS: Final = 100
_DECIMALS: Final = 4  # of a logarithm
_LARGEST: Final = 50.0  # size of a logarithm that a draw can have
_AGAIN: Final = "write it again by sonolube evidence learn"


class SourceEntry(Section):
    """Source that a posterior was learned from."""

    title: str
    citation: str
    opened: str
    points: int = Field(ge=0)
    points_within_plane: int = Field(default=0, ge=0)
    shipped: bool


class PosteriorFile(Section):
    """Content of the file of a posterior."""

    format: Literal["sonolube evidence posterior 1", "sonolube evidence posterior 2"]
    friction_model: str
    fingerprint: str
    shipped_fingerprint: str
    sources: list[SourceEntry] = Field(min_length=1)
    draws: dict[str, list[float]]
    draws_within_plane: dict[str, list[float]] | None = None

    def require_possible(self) -> None:
        """Refuse another friction model, and draws that are none of the model."""
        if self.friction_model != CLOSURES[0].name:
            raise InvalidInput(f'friction_model "{self.friction_model}" is not that of predictions; {_AGAIN}')
        _require_draws(self.draws, name="draws")
        if self.draws_within_plane is not None:
            _require_draws(self.draws_within_plane, name="draws_within_plane")


def _require_draws(draws: Mapping[str, Sequence[float]], *, name: str) -> None:
    """Refuse draws that are none of the model."""
    if set(draws) != set(HYPERPARAMETERS):
        raise InvalidInput(f"{name} must be of {', '.join(HYPERPARAMETERS)}, got {', '.join(draws)}; {_AGAIN}")
    sizes = {len(column) for column in draws.values()}
    if len(sizes) > 1 or min(sizes) < _FEWEST_DRAWS:
        raise InvalidInput(
            f"{name} must be columns of one length, {_FEWEST_DRAWS} or more, got lengths of"
            f" {', '.join(map(str, sorted(sizes)))}; {_AGAIN}"
        )
    if max(abs(value) for column in draws.values() for value in column) > _LARGEST:
        raise InvalidInput(f"{name} are logarithms, of which none is larger than {_LARGEST:g}; {_AGAIN}")


@dataclass(frozen=True, kw_only=True, slots=True)
class LearnedSource:
    """Source that a posterior was learned from.

    Parameters
    ----------
    title, citation, opened : str
        Citation with doi.
    points, points_within_plane : int
        With vibration along the normal and within the plane.
    shipped : bool
        Whether it is of the package.
    """

    title: str
    citation: str
    opened: str
    points: int
    shipped: bool
    points_within_plane: int = 0


@dataclass(frozen=True, kw_only=True, eq=False)
class EvidencePosterior:
    """Posterior by shipped and own tests, along the normal and within the plane.

    Parameters
    ----------
    hyperparameters : ndarray, shape (h, 6)
        Draws along the normal, equally probable: logarithms.
    fingerprint : str
        Hash of all tests and of the priors.
    shipped_fingerprint : str
        Hash of the shipped tests and the priors alone, of the version that learned.
    sources : tuple of LearnedSource
    plane_hyperparameters : ndarray, shape (h, 6), or None
        Draws within the plane; None where the shipped posterior holds there.
    name : str
        Of its file; empty before it is written.
    """

    hyperparameters: Floats
    fingerprint: str
    shipped_fingerprint: str
    sources: tuple[LearnedSource, ...]
    plane_hyperparameters: Floats | None = None
    name: str = ""

    @cached_property
    def posterior(self) -> Posterior:
        """Posterior of the friction model that predicts along the normal."""
        return Posterior(closure=CLOSURES[0], hyperparameters=self.hyperparameters)

    @cached_property
    def posterior_within_plane(self) -> Posterior:
        """Posterior of springs on exponential heights, which predict within the plane."""
        if self.plane_hyperparameters is None:
            return plane_posterior()
        return Posterior(closure=SPRINGS, hyperparameters=self.plane_hyperparameters)

    @property
    def own(self) -> tuple[LearnedSource, ...]:
        """Sources that are not of the package."""
        return tuple(source for source in self.sources if not source.shipped)

    @property
    def known_from(self) -> str:
        """Tests along the normal that the population is known from, in words."""
        return _tests_of(self._own_along_normal)

    @property
    def _own_along_normal(self) -> str:
        """Own points along the normal, in words; empty without any."""
        return _points_of([(source.title, source.points) for source in self.own])

    @property
    def own_within_plane(self) -> str:
        """Own points within the plane that draws were learned from, in words; empty without any."""
        if self.plane_hyperparameters is None:
            return ""
        return _points_of([(source.title, source.points_within_plane) for source in self.own], "within the plane")

    @property
    def learned_from(self) -> str:
        """All tests that it was learned from, in words."""
        return _tests_of(self._own_along_normal, self.own_within_plane)

    def caveats(self, direction: VibrationDirection) -> tuple[str, ...]:
        """What a prediction in a direction was learned from, and whether the shipped tests have changed since."""
        place = f" ({self.name})" if self.name else ""
        if not direction.is_normal and self.plane_hyperparameters is None:
            return (
                f"the evidence{place} tells nothing of vibration within the plane, of which the posterior that ships"
                " with sonolube holds",
            )
        tests = self.known_from
        if not direction.is_normal:
            tests = _tests_of(self.own_within_plane, self._own_along_normal)
        said = f"learned from {tests}{place}, in place of the posterior that ships with sonolube"
        if self.shipped_fingerprint in (evidence_fingerprint(), shipped_fingerprint()):
            return (said,)
        changed = "the tests that ship with sonolube are others than those that this posterior was learned from"
        return said, f"{changed}: {_AGAIN}"

    def text(self) -> str:
        """Content of its file."""
        content = {
            "format": _FORMAT,
            "friction_model": CLOSURES[0].name,
            "fingerprint": self.fingerprint,
            "shipped_fingerprint": self.shipped_fingerprint,
            "sources": self.source_objects(),
            "draws": _columns(self.hyperparameters),
        }
        if self.plane_hyperparameters is not None:
            content["draws_within_plane"] = _columns(self.plane_hyperparameters)
        return json.dumps(content).replace("], ", "],\n") + "\n"  # one column a line

    def source_objects(self) -> list[dict[str, Any]]:
        """Sources for JSON."""
        return [{name: getattr(source, name) for name in SourceEntry.model_fields} for source in self.sources]

    def write(self, path: str | Path) -> Path:
        """Write its file, whole or not at all.

        Parameters
        ----------
        path : str or Path

        Returns
        -------
        Path
        """
        return write_atomically(Path(path), self.text())


def population_of(direction: VibrationDirection, evidence: EvidencePosterior | None = None) -> Posterior:
    """Posterior that predicts vibration in a direction: the shipped one, or that by own published tests too."""
    if evidence is None:
        return learned().friction if direction.is_normal else plane_posterior()
    return evidence.posterior if direction.is_normal else evidence.posterior_within_plane


def shipped_fingerprint() -> str:
    """Hash of all shipped tests and of the priors, along the normal and within the plane."""
    return evidence_fingerprint(plane_rigs(), laws=(SPRINGS,))


def learned_sources(shipped: Sequence[PublishedSource], own: Sequence[PublishedSource]) -> tuple[LearnedSource, ...]:
    """Sources with their points along the normal and within the plane."""
    return tuple(
        LearnedSource(
            title=source.title,
            citation=source.reference,
            opened=source.opened,
            points=normal,
            points_within_plane=source.points - normal,
            shipped=source in shipped,
        )
        for source in (*shipped, *own)
        for normal in [sum(len(rig.points) for rig in source.rigs if rig.is_normal)]
    )


def _tests_of(*own: str) -> str:
    """Published and own tests in words; empty words are left out."""
    *others, last = "published tests", *(words for words in own if words)
    return f"{', '.join(others)} and {last}" if others else last


def _points_of(counts: Sequence[tuple[str, int]], where: str = "") -> str:
    """Number of points and the titles of their sources, of which some may have none, in words; empty without any."""
    total = sum(count for _, count in counts)
    if not total:
        return ""
    points = " ".join(word for word in ("point" if total == 1 else "points", where) if word)
    return f"{total} {points} of {', '.join(title for title, count in counts if count)}"


def _columns(draws: Floats) -> dict[str, list[float]]:
    """Columns of draws by name, to four decimals of the logarithm."""
    return {name: np.round(column, _DECIMALS).tolist() for name, column in zip(HYPERPARAMETERS, draws.T, strict=True)}


def read_evidence_posterior(path: str | Path) -> EvidencePosterior:
    """Read the file of a posterior.

    Parameters
    ----------
    path : str or Path
        As `sonolube evidence learn` writes it.

    Returns
    -------
    EvidencePosterior

    Raises
    ------
    InvalidInput
        In one line that names the file, the key and the value.
    """
    with prefixed(str(path)):
        content = validated(PosteriorFile, _json_content(Path(path)))
        plane = content.draws_within_plane
        return EvidencePosterior(
            hyperparameters=np.column_stack([content.draws[name] for name in HYPERPARAMETERS]),
            plane_hyperparameters=None if plane is None else np.column_stack([plane[name] for name in HYPERPARAMETERS]),
            fingerprint=content.fingerprint,
            shipped_fingerprint=content.shipped_fingerprint,
            sources=tuple(LearnedSource(**source.model_dump()) for source in content.sources),
            name=Path(path).name,
        )


def _json_content(path: Path) -> Mapping[str, Any]:
    """Content of a JSON file."""
    try:
        content = json.loads(text_of(path, kind="a posterior"))
    except json.JSONDecodeError as failure:
        raise InvalidInput(
            f"not valid JSON: {failure}; expected a posterior that sonolube evidence learn wrote"
        ) from None
    except RecursionError:
        raise InvalidInput("not valid JSON: nested too deeply") from None
    if not isinstance(content, dict):
        raise InvalidInput("is no posterior that sonolube evidence learn wrote")
    require_plain_content(content)
    return content
