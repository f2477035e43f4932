"""Mutants above the models, drawn from one seed and kept in mutants_above_models.json: each is to fail a test."""

from reliability.mutant_list import MutantList

ROOMS = {
    "laboratory": 16, "measurement": 16, "design": 14, "rig": 12, "tasks": 10, "prediction": 8, "report": 6,
    "validation": 6, "identification": 6, "browser": 6,
}  # fmt: skip

LIST = MutantList(
    name="mutants_above_models",
    title="Mutants above the models",
    question="One comparison, constant, sign, call, argument or condition of a room above the models is changed: does a"
    " test that reaches its line fail, one of its own room or of any, each of a minute together? The list is a random"
    " sample, drawn after the tests were written, and tests for those that survived came later and are not counted;"
    " figures, texts of refusals and the looks of charts are left out.",
    rooms=ROOMS,
    room_bar=0.85,
    bar=0.92,
    max_equivalent=0.05,
)
STUDY = LIST.study()
