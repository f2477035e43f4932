from .electromechanical_model import (
    ElectromechanicalMode as ElectromechanicalMode,
    ElectromechanicalModel as ElectromechanicalModel,
    converged_electromechanical_model as converged_electromechanical_model,
)
from .mesh.element_order import (
    change_order as change_order,
    generate_mesh as generate_mesh,
    transfer_field as transfer_field,
)
from .mesh.geometry import (
    MILLIMETRE as MILLIMETRE,
    Geometry as Geometry,
    bond as bond,
    cad_kernel as cad_kernel,
    read_step as read_step,
    single_body as single_body,
    step_text as step_text,
    translate as translate,
)
from .mesh.grading import grade_reentrant_edges as grade_reentrant_edges
from .mesh.mesh import (
    Mesh as Mesh,
    add_face_patch as add_face_patch,
    box_mesh as box_mesh,
    edge_nodes as edge_nodes,
    face_triangulation as face_triangulation,
    transform_nodes as transform_nodes,
)
from .mode_analysis import (
    ModeFamily as ModeFamily,
    TrajectoryEllipse as TrajectoryEllipse,
    face_residual_compliance as face_residual_compliance,
    kinetic_energy_fractions as kinetic_energy_fractions,
    mass_loaded_frequencies as mass_loaded_frequencies,
    mode_names as mode_names,
    trajectory_ellipse as trajectory_ellipse,
)
from .parts.bodies import (
    PARTS as PARTS,
    Slot as Slot,
    acorn_nut as acorn_nut,
    block as block,
    booster as booster,
    conical_horn as conical_horn,
    cylinder as cylinder,
    exponential_horn as exponential_horn,
    extruded_polygon as extruded_polygon,
    hexagon as hexagon,
    hub_disc as hub_disc,
    ring as ring,
    stepped_horn as stepped_horn,
)
from .parts.length_adjustment import adjust_length as adjust_length
from .parts.stack_material import homogenised_stack as homogenised_stack, stack_ceramic as stack_ceramic
from .parts.transducers import (
    TRANSDUCERS as TRANSDUCERS,
    SourcedDimension as SourcedDimension,
    Transducer as Transducer,
    poled_part as poled_part,
    stack_bodies as stack_bodies,
    stack_from_bodies as stack_from_bodies,
    stack_transducer as stack_transducer,
)
from .results.nodal_fields import (
    gauss_point_stress as gauss_point_stress,
    interpolate_at_points as interpolate_at_points,
    nodal_stress as nodal_stress,
    von_mises_stress as von_mises_stress,
    vtu_text as vtu_text,
)
from .solver.assembly import scalar_mass_matrix as scalar_mass_matrix, tributary_areas as tributary_areas
from .solver.model import (
    Electrodes as Electrodes,
    FaceSpring as FaceSpring,
    FixedSupport as FixedSupport,
    Medium as Medium,
    Model as Model,
    isotropic_medium as isotropic_medium,
    medium_from_material as medium_from_material,
    poled_medium as poled_medium,
)
from .solver.modes import (
    ConvergedModes as ConvergedModes,
    NaturalModes as NaturalModes,
    NotConverged as NotConverged,
    converged_modes as converged_modes,
    extrapolate_frequencies as extrapolate_frequencies,
    natural_modes as natural_modes,
    rigid_body_mode_count as rigid_body_mode_count,
)
from .solver.reduction import (
    Output as Output,
    ReducedModel as ReducedModel,
    krylov_reduction as krylov_reduction,
    reduce_model as reduce_model,
)
from .solver.response import (
    HarmonicResponse as HarmonicResponse,
    contact_structure as contact_structure,
    coupled_resonances as coupled_resonances,
    forced_response as forced_response,
    harmonic_response as harmonic_response,
    with_free_body as with_free_body,
)
from .tuning import NamedMode as NamedMode, TunedMode as TunedMode, named_mode as named_mode, tuned_mode as tuned_mode
