"""Task `evidence learn`: posterior of predictions by the shipped published tests and a user's own."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Unpack

from sonolube.prediction.evidence_learning import LearnedEvidence, expected_time, learn_evidence
from sonolube.prediction.evidence_posterior import EvidencePosterior
from sonolube.report.results import evidence as results
from sonolube.tasks.answer import Answer, Block, answer
from sonolube.tasks.evidence.published_tests import own_sources
from sonolube.tasks.files import InputFile
from sonolube.tasks.parameters import File, Watched
from sonolube.tasks.progress import stage
from sonolube.tasks.task import task

_FILES = File("Folders of your own files of published tests, or files.", "FOLDER...")


@task
def learn(
    folder: Annotated[Sequence[InputFile] | InputFile, _FILES], **watch: Unpack[Watched]
) -> "LearnedEvidenceAnswer":
    """Learn from the shipped published tests and your own; the posterior is for predict --evidence.

    Example: sonolube evidence learn examples/evidence/own_tests.toml --out posterior.json

    Examples
    --------
    >>> import sonolube as sl
    >>> answer = sl.evidence.learn("examples/evidence/own_tests.toml")
    >>> predicted = sl.predict("examples/rigs/tribometer.toml", evidence=answer.posterior)
    """
    sources = own_sources(folder)
    with stage(f"learning from {expected_time(sources)}") as advance:
        found = learn_evidence(sources, advance=advance)
    return LearnedEvidenceAnswer(found=found)


@answer
class LearnedEvidenceAnswer(Answer):
    """Posterior by shipped and own tests, with blind scores beside those of the shipped ones.

    Parameters
    ----------
    found : LearnedEvidence
    target : Path or None
        File of the posterior; None where none is written.
    """

    found: LearnedEvidence
    target: Path | None = None

    @property
    def posterior(self) -> EvidencePosterior:
        """Posterior for `predict`, which `write` puts into a file."""
        return self.found.posterior

    def blocks(self) -> Sequence[Block]:
        """What was learned from, blind scores, and the population of decay lengths."""
        return results.learned_blocks(self.found)

    def object(self) -> dict[str, Any]:
        """Sources, fingerprint and blind scores."""
        return results.learned_object(self.found)

    def caveats(self) -> Sequence[str]:
        """What nothing was learned of, and whether the tests contradict each other."""
        return self.found.caveats

    def files(self) -> Mapping[str, str]:
        """Posterior."""
        return {} if self.target is None else {self.target.name: self.posterior.text()}
