"""Finite elements of linear piezoelectricity: bodies, meshes, natural modes, electromechanical and forced response."""

from sonolube.fem.classification import ModeFamily, kinetic_energy_fractions, mode_names
from sonolube.fem.electromechanical_model import (
    ElectromechanicalMode,
    ElectromechanicalModel,
    converged_electromechanical_model,
)
from sonolube.fem.mass_loading import face_residual_compliance, mass_loaded_frequencies
from sonolube.fem.parts.bodies import (
    PARTS,
    Slot,
    block,
    booster,
    conical_horn,
    cylinder,
    exponential_horn,
    hexagon,
    ring,
    stepped_horn,
)
from sonolube.fem.parts.length_adjustment import adjust_length
from sonolube.fem.parts.stack_material import homogenised_stack, stack_ceramic
from sonolube.fem.parts.tips import acorn_nut, hub_disc
from sonolube.fem.parts.transducers import (
    TRANSDUCERS,
    SourcedDimension,
    Transducer,
    poled_part,
    stack_bodies,
    stack_from_bodies,
    stack_transducer,
)
from sonolube.fem.ritz import CrossSection, annular_section, rectangular_section, ritz_frequencies
from sonolube.fem.solver.cad import MissingPackage
from sonolube.fem.solver.convergence import ConvergedModes, converged_modes, extrapolate_frequencies
from sonolube.fem.solver.element_order import change_order, transfer_field
from sonolube.fem.solver.forced_vibration import forced_response
from sonolube.fem.solver.geometry import Geometry, bond, read_step, translate
from sonolube.fem.solver.grading import grade_reentrant_edges
from sonolube.fem.solver.harmonic_analysis import HarmonicResponse, direct_response, harmonic_response
from sonolube.fem.solver.krylov import krylov_reduction
from sonolube.fem.solver.medium import Medium, isotropic_medium, medium_from_material, poled_medium
from sonolube.fem.solver.mesh import Mesh, box_mesh, face_triangulation
from sonolube.fem.solver.mesh_editing import add_face_patch, edge_nodes, transform_nodes
from sonolube.fem.solver.meshing import generate_mesh
from sonolube.fem.solver.model import Electrodes, FaceSpring, FixedSupport, Model
from sonolube.fem.solver.modes import NaturalModes, NotConverged, natural_modes, rigid_body_mode_count
from sonolube.fem.solver.postprocessing import (
    gauss_point_stress,
    interpolate_at_points,
    nodal_average,
    von_mises_stress,
)
from sonolube.fem.solver.reduction import Output, ReducedModel, reduce_model
from sonolube.fem.solver.resonances import coupled_resonances, series_parallel_resonances
from sonolube.fem.solver.structure_conversion import contact_structure, with_free_body
from sonolube.fem.surface_trajectories import TrajectoryEllipse, trajectory_ellipse
from sonolube.fem.tuning import NamedMode, TunedMode, named_mode, tuned_mode
from sonolube.fem.vtk_export import vtu_text

__all__ = [
    "PARTS",
    "TRANSDUCERS",
    "ConvergedModes",
    "CrossSection",
    "Electrodes",
    "ElectromechanicalMode",
    "ElectromechanicalModel",
    "FaceSpring",
    "FixedSupport",
    "Geometry",
    "HarmonicResponse",
    "Medium",
    "Mesh",
    "MissingPackage",
    "ModeFamily",
    "Model",
    "NamedMode",
    "NaturalModes",
    "NotConverged",
    "Output",
    "ReducedModel",
    "Slot",
    "SourcedDimension",
    "TrajectoryEllipse",
    "Transducer",
    "TunedMode",
    "acorn_nut",
    "add_face_patch",
    "adjust_length",
    "annular_section",
    "block",
    "bond",
    "booster",
    "box_mesh",
    "change_order",
    "conical_horn",
    "contact_structure",
    "converged_electromechanical_model",
    "converged_modes",
    "coupled_resonances",
    "cylinder",
    "direct_response",
    "edge_nodes",
    "exponential_horn",
    "extrapolate_frequencies",
    "face_residual_compliance",
    "face_triangulation",
    "forced_response",
    "gauss_point_stress",
    "generate_mesh",
    "grade_reentrant_edges",
    "harmonic_response",
    "hexagon",
    "homogenised_stack",
    "hub_disc",
    "interpolate_at_points",
    "isotropic_medium",
    "kinetic_energy_fractions",
    "krylov_reduction",
    "mass_loaded_frequencies",
    "medium_from_material",
    "mode_names",
    "named_mode",
    "natural_modes",
    "nodal_average",
    "poled_medium",
    "poled_part",
    "read_step",
    "rectangular_section",
    "reduce_model",
    "rigid_body_mode_count",
    "ring",
    "ritz_frequencies",
    "series_parallel_resonances",
    "stack_bodies",
    "stack_ceramic",
    "stack_from_bodies",
    "stack_transducer",
    "stepped_horn",
    "trajectory_ellipse",
    "transfer_field",
    "transform_nodes",
    "translate",
    "tuned_mode",
    "von_mises_stress",
    "vtu_text",
    "with_free_body",
]
