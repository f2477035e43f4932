from .measurement.measured_runs import read_runs as read_runs
from .prediction.live_prediction import LivePrediction as LivePrediction
from .rig.file.reader import read_rig as read_rig
from .rig.record import Rig as Rig
from .tasks import (
    evidence as evidence,
    export as export,
    horn as horn,
    identify as identify,
    impedance as impedance,
    lab as lab,
    measure as measure,
)
from .tasks.compare.compare import compare as compare, fit as fit
from .tasks.compare.literature import literature as literature
from .tasks.compare.reproduce import reproduce as reproduce
from .tasks.design.control import control as control
from .tasks.design.efficiency import efficiency as efficiency
from .tasks.design.map import map as map
from .tasks.design.optimise import optimise as optimise
from .tasks.design.plan import plan as plan
from .tasks.design.sweep import sweep as sweep
from .tasks.design.uncertainty import uncertainty as uncertainty
from .tasks.lookup.example import example as example
from .tasks.lookup.facts import actuators as actuators, materials as materials, published as published
from .tasks.lookup.mapping import mapping as mapping
from .tasks.lookup.schema import schema as schema
from .tasks.measure.own_runs import runs as runs
from .tasks.parts.modes import modes as modes
from .tasks.plot import plot as plot
from .tasks.predict.new import new as new
from .tasks.predict.predict import predict as predict
from .tasks.predict.response_and_regime import regime as regime, response as response, transient as transient
from .tasks.predict.rig_record import (
    contact as contact,
    friction as friction,
    simulate as simulate,
    thermal as thermal,
    wear as wear,
)

__version__: str
