from .bounded_error import identify as identify
from .decay_length.conditions import SwitchConditions as SwitchConditions
from .decay_length.decision import (
    DecayLengthDecision as DecayLengthDecision,
    Interval as Interval,
    decide_decay_length as decide_decay_length,
)
from .decay_length.figure import decision_chart as decision_chart, decision_dataset as decision_dataset
from .decay_length.recorded_switches import recorded_switches as recorded_switches
from .decay_length.switch_table import SwitchTable as SwitchTable, switch_table as switch_table
from .fact import (
    Bounds as Bounds,
    Fact as Fact,
    ForwardModel as ForwardModel,
    Relation as Relation,
    normalized_residuals as normalized_residuals,
)
from .observables import (
    NUMBERED_OBSERVABLES as NUMBERED_OBSERVABLES,
    OBSERVABLES as OBSERVABLES,
    Observable as Observable,
    observable_named as observable_named,
)
from .observation import (
    IdentificationProblem as IdentificationProblem,
    Observation as Observation,
    observable_unit as observable_unit,
    structure_model as structure_model,
)
from .result import (
    ConsistentFit as ConsistentFit,
    Identification as Identification,
    ParameterEstimate as ParameterEstimate,
    SingularDirection as SingularDirection,
)
from .sequential_monte_carlo import Posterior as Posterior, posterior as posterior
from .small_vibration import Conditions as Conditions
from .structure_parametrisation import (
    ParametricStructure as ParametricStructure,
    StructureBuilder as StructureBuilder,
    parametric_structure as parametric_structure,
    reference_parameters as reference_parameters,
)
from .subsets import ConsistentSubsets as ConsistentSubsets, consistent_subsets as consistent_subsets
from .toml_tables import rig_tables as rig_tables
