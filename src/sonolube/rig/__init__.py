"""Rigs: records of experiments and devices, their files, operating points, simulation and parametric studies."""

from sonolube.rig.contact_temperature import TemperaturePoint, temperature_point, thermal_solid
from sonolube.rig.datasets import dataset, gridded, write_netcdf
from sonolube.rig.distribution import Distribution, LogNormal, Normal, Uniform
from sonolube.rig.file.edit import with_tables
from sonolube.rig.file.json_schema import rig_schema
from sonolube.rig.file.reader import read_rig, rig_content, rig_from, structure_by_stack, structure_entries
from sonolube.rig.friction_and_wear import friction_ratios
from sonolube.rig.least_power import least_power_study
from sonolube.rig.linear_response import FrequencyResponse, frequency_grid, frequency_response, structure_in_contact
from sonolube.rig.lubrication import (
    LubricationMap,
    LubricationPoint,
    lubrication_map,
    lubrication_point,
    wear_of_materials,
)
from sonolube.rig.operating_point import (
    ContactPoint,
    FrictionPoint,
    WearPoint,
    contact_point,
    friction_point,
    wear_point,
)
from sonolube.rig.operating_point_batch import NUMBERS, STATUSES, PointBatch, point_batch
from sonolube.rig.operating_point_grid import OperatingPoints, operating_points, steady_states
from sonolube.rig.parametric_study import frequency_study, load_study, speed_study, voltage_study, waveform_study
from sonolube.rig.record import Rig
from sonolube.rig.simulation import Simulation, simulate
from sonolube.rig.start_up_transient import StartUp, start_up
from sonolube.rig.study_figures import STUDY_FIGURES
from sonolube.rig.vibration import gap_motion

__all__ = [
    "NUMBERS",
    "STATUSES",
    "STUDY_FIGURES",
    "ContactPoint",
    "Distribution",
    "FrequencyResponse",
    "FrictionPoint",
    "LogNormal",
    "LubricationMap",
    "LubricationPoint",
    "Normal",
    "OperatingPoints",
    "PointBatch",
    "Rig",
    "Simulation",
    "StartUp",
    "TemperaturePoint",
    "Uniform",
    "WearPoint",
    "contact_point",
    "dataset",
    "frequency_grid",
    "frequency_response",
    "frequency_study",
    "friction_point",
    "friction_ratios",
    "gap_motion",
    "gridded",
    "least_power_study",
    "load_study",
    "lubrication_map",
    "lubrication_point",
    "operating_points",
    "point_batch",
    "read_rig",
    "rig_content",
    "rig_from",
    "rig_schema",
    "simulate",
    "speed_study",
    "start_up",
    "steady_states",
    "structure_by_stack",
    "structure_entries",
    "structure_in_contact",
    "temperature_point",
    "thermal_solid",
    "voltage_study",
    "waveform_study",
    "wear_of_materials",
    "wear_point",
    "with_tables",
    "write_netcdf",
]
