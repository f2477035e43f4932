"""Posterior that a user has learned from shipped and own published tests, as a file that `predict` takes."""

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
from sonolube.prediction.posterior import Posterior, evidence_fingerprint
from sonolube.prediction.published_source import PublishedSource
from sonolube.rig.file.section import Section
from sonolube.rig.file.toml_file import prefixed, validated
from sonolube.storage.files import write_atomically
from sonolube.text.toml_text import require_plain_content, text_of

_FORMAT: Final = "sonolube evidence posterior 1"
_FEWEST_DRAWS: Final = 100
_DECIMALS: Final = 4  # of a logarithm
_LARGEST: Final = 50.0  # size of a logarithm that a draw can have
_AGAIN: Final = "write it again by sonolube evidence learn"


class SourceEntry(Section):
    """Source that a posterior was learned from."""

    title: str
    citation: str
    opened: str
    points: int = Field(ge=1)
    shipped: bool


class PosteriorFile(Section):
    """Content of the file of a posterior."""

    format: Literal["sonolube evidence posterior 1"]
    friction_model: str
    fingerprint: str
    shipped_fingerprint: str
    sources: list[SourceEntry] = Field(min_length=1)
    draws: dict[str, list[float]]

    def require_possible(self) -> None:
        """Refuse another friction model, and draws that are none of the model."""
        if self.friction_model != CLOSURES[0].name:
            raise InvalidInput(f'friction_model "{self.friction_model}" is not that of predictions; {_AGAIN}')
        if set(self.draws) != set(HYPERPARAMETERS):
            raise InvalidInput(f"draws must be of {', '.join(HYPERPARAMETERS)}, got {', '.join(self.draws)}; {_AGAIN}")
        sizes = {len(column) for column in self.draws.values()}
        if len(sizes) > 1 or min(sizes) < _FEWEST_DRAWS:
            raise InvalidInput(
                f"draws must be columns of one length, {_FEWEST_DRAWS} or more, got lengths of"
                f" {', '.join(map(str, sorted(sizes)))}; {_AGAIN}"
            )
        if max(abs(value) for column in self.draws.values() for value in column) > _LARGEST:
            raise InvalidInput(f"draws are logarithms, of which none is larger than {_LARGEST:g}; {_AGAIN}")


@dataclass(frozen=True, kw_only=True, slots=True)
class LearnedSource:
    """Source that a posterior was learned from.

    Parameters
    ----------
    title, citation, opened : str
        Citation with doi.
    points : int
        With vibration along the normal.
    shipped : bool
        Whether it is of the package.
    """

    title: str
    citation: str
    opened: str
    points: int
    shipped: bool


@dataclass(frozen=True, kw_only=True, eq=False)
class EvidencePosterior:
    """Posterior of vibration along the normal by shipped and own tests.

    Parameters
    ----------
    hyperparameters : ndarray, shape (h, 6)
        Draws, equally probable: logarithms.
    fingerprint : str
        Hash of all tests and of the priors.
    shipped_fingerprint : str
        Hash of the shipped tests and the priors alone, of the version that learned.
    sources : tuple of LearnedSource
    name : str
        Of its file; empty before it is written.
    """

    hyperparameters: Floats
    fingerprint: str
    shipped_fingerprint: str
    sources: tuple[LearnedSource, ...]
    name: str = ""

    @cached_property
    def posterior(self) -> Posterior:
        """Posterior of the friction model that predicts."""
        return Posterior(closure=CLOSURES[0], hyperparameters=self.hyperparameters)

    @property
    def own(self) -> tuple[LearnedSource, ...]:
        """Sources that are not of the package."""
        return tuple(source for source in self.sources if not source.shipped)

    @property
    def known_from(self) -> str:
        """Tests that the population is known from, in words."""
        if not self.own:
            return "published tests"
        count = sum(source.points for source in self.own)
        points = "point" if count == 1 else "points"
        return f"published tests and {count} {points} of {', '.join(source.title for source in self.own)}"

    @property
    def caveats(self) -> tuple[str, ...]:
        """What the prediction was learned from, and whether the shipped tests have changed since."""
        place = f" ({self.name})" if self.name else ""
        learned = f"learned from {self.known_from}{place}, in place of the posterior that ships with sonolube"
        if self.shipped_fingerprint == evidence_fingerprint():
            return (learned,)
        changed = "the tests that ship with sonolube are others than those that this posterior was learned from"
        return learned, f"{changed}: {_AGAIN}"

    def text(self) -> str:
        """Content of its file."""
        columns = zip(HYPERPARAMETERS, self.hyperparameters.T, strict=True)
        content = {
            "format": _FORMAT,
            "friction_model": CLOSURES[0].name,
            "fingerprint": self.fingerprint,
            "shipped_fingerprint": self.shipped_fingerprint,
            "sources": self.source_objects(),
            "draws": {name: np.round(column, _DECIMALS).tolist() for name, column in columns},
        }
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


def learned_sources(shipped: Sequence[PublishedSource], own: Sequence[PublishedSource]) -> tuple[LearnedSource, ...]:
    """Sources with their points along the normal, of which some may have none."""
    found = []
    for source in (*shipped, *own):
        points = sum(len(rig.points) for rig in source.rigs if rig.is_normal)
        if points:
            found.append(
                LearnedSource(
                    title=source.title,
                    citation=source.reference,
                    opened=source.opened,
                    points=points,
                    shipped=source in shipped,
                )
            )
    return tuple(found)


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
        return EvidencePosterior(
            hyperparameters=np.column_stack([content.draws[name] for name in HYPERPARAMETERS]),
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
