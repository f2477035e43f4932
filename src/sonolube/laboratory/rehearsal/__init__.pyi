from .faults import FAULTS as FAULTS, Fault as Fault, faults_named as faults_named
from .rig import Rehearsal as Rehearsal, rehearsal as rehearsal
from .sources import SimulatedChannel as SimulatedChannel
