"""Faults in every call to a function generator and a motor by their drivers: is each run's end told truly?"""

from reliability.studies.output_faults import SOURCES, measures_of, record_of
from reliability.study import Record, Study
from sonolube.laboratory.driver_trial import drivers_to_try, faults_of

_BENCH = "tests.laboratory.drivers.pretended_bench"
FAULTS = faults_of(("drive", "motor"))


def _trial(seed: int) -> Record:
    return record_of(drivers_to_try(_BENCH), FAULTS[seed])


STUDY = Study(
    title="Faults of a generator and a motor",
    question="The same faults in the calls to a function generator by SCPI and to a motor by lines of text, whose"
    " instruments are pretended on this computer in a process that no fault reaches. Does every run end with a verdict"
    " that the state of the instruments bears out?",
    sources=(*SOURCES, "laboratory/drivers/*.py"),
    trials=len(FAULTS),
    sample=1,
    trial=_trial,
    measures=measures_of,
)
