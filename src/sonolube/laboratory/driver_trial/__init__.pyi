from .faults import Fault as Fault, faults_of as faults_of
from .trial import (
    DriversToTry as DriversToTry,
    PretendedInstruments as PretendedInstruments,
    Trial as Trial,
    TriedFault as TriedFault,
    drivers_to_try as drivers_to_try,
    try_fault as try_fault,
    without_fault as without_fault,
)
