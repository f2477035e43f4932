"""Mutants of the models, kept in mutants_of_models.json: each is to fail a test."""

from reliability.mutant_list import MutantList

ROOMS = {
    "models/contact": 45, "models/friction": 60, "models/wear": 12, "models/thermal": 35, "models/actuator": 35,
    "facts/metrics": 20, "models/surfaces": 45, "models/dynamics": 30, "models/fem": 18,
}  # fmt: skip

LIST = MutantList(
    name="mutants_of_models",
    title="Mutants of the models",
    question="One operator, number or function of a model is changed: does a test of its line, its room or the rooms"
    " above fail? The list is a random sample of all rooms of models; each mutant is run against the test that failed"
    " before, then against the others.",
    rooms=ROOMS,
    bar=0.95,
)
STUDY = LIST.study()
