"""Identification of parameters: feasible sets and posteriors from facts, circuits and stacks from impedance."""

from sonolube.identification.bounded_error import identify
from sonolube.identification.fact import Bounds, Fact, ForwardModel, Relation, normalized_residuals
from sonolube.identification.observables import NUMBERED_OBSERVABLES, OBSERVABLES, Observable, observable_named
from sonolube.identification.observation import (
    IdentificationProblem,
    Observation,
    observable_unit,
    structure_model,
)
from sonolube.identification.parametric_structure import (
    ParametricStructure,
    StructureBuilder,
    parametric_structure,
    reference_parameters,
)
from sonolube.identification.pin_on_disc import PinOnDiscTest, pin_on_disc_model
from sonolube.identification.result import ConsistentFit, Identification, ParameterEstimate, SingularDirection
from sonolube.identification.sequential_monte_carlo import Posterior, posterior
from sonolube.identification.small_vibration import Conditions
from sonolube.identification.subsets import ConsistentSubsets, consistent_subsets
from sonolube.identification.toml_tables import rig_tables

__all__ = [
    "NUMBERED_OBSERVABLES",
    "OBSERVABLES",
    "Bounds",
    "Conditions",
    "ConsistentFit",
    "ConsistentSubsets",
    "Fact",
    "ForwardModel",
    "Identification",
    "IdentificationProblem",
    "Observable",
    "Observation",
    "ParameterEstimate",
    "ParametricStructure",
    "PinOnDiscTest",
    "Posterior",
    "Relation",
    "SingularDirection",
    "StructureBuilder",
    "consistent_subsets",
    "identify",
    "normalized_residuals",
    "observable_named",
    "observable_unit",
    "parametric_structure",
    "pin_on_disc_model",
    "posterior",
    "reference_parameters",
    "rig_tables",
    "structure_model",
]
