from .measurement.measured_runs import read_runs as read_runs
from .prediction.live_prediction import LivePrediction as LivePrediction
from .rig.file.reader import read_rig as read_rig
from .rig.record import Rig as Rig
from .tasks import horn as horn, identify as identify, impedance as impedance, lab as lab, measure as measure
from .tasks.compare.compare import compare as compare
from .tasks.compare.fit import fit as fit
from .tasks.compare.literature import literature as literature
from .tasks.compare.reproduce import reproduce as reproduce
from .tasks.design.control import control as control
from .tasks.design.efficiency import efficiency as efficiency
from .tasks.design.map import map as map
from .tasks.design.optimise import optimise as optimise
from .tasks.design.plan import plan as plan
from .tasks.design.sweep import sweep as sweep
from .tasks.design.uncertainty import uncertainty as uncertainty
from .tasks.lookup.actuators import actuators as actuators
from .tasks.lookup.example import example as example
from .tasks.lookup.mapping import mapping as mapping
from .tasks.lookup.materials import materials as materials
from .tasks.lookup.published import published as published
from .tasks.lookup.schema import schema as schema
from .tasks.parts.modes import modes as modes
from .tasks.plot import plot as plot
from .tasks.predict.contact import contact as contact
from .tasks.predict.friction import friction as friction
from .tasks.predict.new import new as new
from .tasks.predict.predict import predict as predict
from .tasks.predict.regime import regime as regime
from .tasks.predict.response import response as response
from .tasks.predict.simulate import simulate as simulate
from .tasks.predict.thermal import thermal as thermal
from .tasks.predict.transient import transient as transient
from .tasks.predict.wear import wear as wear

__version__: str
