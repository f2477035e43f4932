"""Posterior by shipped and own published tests as an argument of the tasks that predict, and its reading."""

from typing import Annotated

from sonolube.prediction.evidence_posterior import EvidencePosterior, read_evidence_posterior
from sonolube.rig import Rig
from sonolube.rig.file.rig_folder import POSTERIOR_FILE, folder_of
from sonolube.tasks.files import InputFile, file_path, is_none
from sonolube.tasks.parameters import File

Evidence = Annotated[
    InputFile | EvidencePosterior | None,
    File(
        "Posterior by shipped and your own published tests, as sonolube evidence learn writes it, in place of the"
        " shipped; by default posterior.json of the folder of the rig, and none for the shipped.",
        "POSTERIOR.json",
    ),
]
"""File of a posterior, or the posterior; None for the shipped one."""


def evidence_of(given: InputFile | EvidencePosterior | None, rig: Rig | None = None) -> EvidencePosterior | None:
    """Posterior of an argument, or of the folder of a rig; None for the shipped one, also by the word none.

    Raises
    ------
    InvalidInput
        If the file is no posterior.
    """
    folder = None if rig is None or given is not None else folder_of(rig)
    if folder is not None and (folder / POSTERIOR_FILE).is_file():
        given = folder / POSTERIOR_FILE
    if isinstance(given, InputFile):
        return None if is_none(given) else read_evidence_posterior(file_path(given))
    return given
