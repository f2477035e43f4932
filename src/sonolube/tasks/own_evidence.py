"""Posterior by shipped and own published tests as an argument of the tasks that predict, and its reading."""

from typing import Annotated

from sonolube.prediction.evidence_posterior import EvidencePosterior, read_evidence_posterior
from sonolube.tasks.files import InputFile, file_path
from sonolube.tasks.parameters import File

Evidence = Annotated[
    InputFile | EvidencePosterior | None,
    File(
        "Posterior by shipped and your own published tests, as sonolube evidence learn writes it, in place of the"
        " shipped.",
        "POSTERIOR.json",
    ),
]
"""File of a posterior, or the posterior; None for the shipped one."""


def evidence_of(given: InputFile | EvidencePosterior | None) -> EvidencePosterior | None:
    """Posterior of an argument; None for the shipped one.

    Raises
    ------
    InvalidInput
        If the file is no posterior.
    """
    return read_evidence_posterior(file_path(given)) if isinstance(given, InputFile) else given
