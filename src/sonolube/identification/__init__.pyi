from .bounded_error import (
    ConsistentSubsets as ConsistentSubsets,
    consistent_subsets as consistent_subsets,
    identify as identify,
)
from .bounded_search import Posterior as Posterior, posterior as posterior
from .decay_length.decision import (
    DecayLengthDecision as DecayLengthDecision,
    Interval as Interval,
    decide_decay_length as decide_decay_length,
)
from .decay_length.figure import decision_chart as decision_chart, decision_dataset as decision_dataset
from .decay_length.recorded_switches import recorded_switches as recorded_switches
from .decay_length.switch_table import (
    SwitchConditions as SwitchConditions,
    SwitchTable as SwitchTable,
    switch_table as switch_table,
)
from .fact import (
    Bounds as Bounds,
    ConsistentFit as ConsistentFit,
    Fact as Fact,
    ForwardModel as ForwardModel,
    Identification as Identification,
    ParameterEstimate as ParameterEstimate,
    Relation as Relation,
    SingularDirection as SingularDirection,
    normalized_residuals as normalized_residuals,
    rig_tables as rig_tables,
)
from .observables import (
    NUMBERED_OBSERVABLES as NUMBERED_OBSERVABLES,
    OBSERVABLES as OBSERVABLES,
    IdentificationProblem as IdentificationProblem,
    Observable as Observable,
    Observation as Observation,
    observable_named as observable_named,
    observable_unit as observable_unit,
    structure_model as structure_model,
)
from .small_vibration import Conditions as Conditions
from .structure_parametrisation import (
    ParametricStructure as ParametricStructure,
    StructureBuilder as StructureBuilder,
    parametric_structure as parametric_structure,
    reference_parameters as reference_parameters,
)
