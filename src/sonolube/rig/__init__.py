"""Rigs: an experiment or a device as one record, read from a file, and what it does at its operating point."""

from sonolube.rig.contact_temperature import HeatPoint, heat_point, thermal_solid
from sonolube.rig.dataset import dataset, gridded, write_netcdf
from sonolube.rig.distribution import Distribution, LogNormal, Normal, Uniform
from sonolube.rig.file.edit import with_tables
from sonolube.rig.file.json_schema import rig_schema
from sonolube.rig.file.reader import read_rig, rig_content, rig_from, structure_by_stack, structure_entries
from sonolube.rig.friction_and_wear import friction_ratios
from sonolube.rig.least_power import least_power_study
from sonolube.rig.linear_response import Response, frequency_grid, linear_response, touching_structure
from sonolube.rig.lubrication import RegimeMap, RegimePoint, regime_map, regime_point, wear_of_materials
from sonolube.rig.operating_point import (
    ContactPoint,
    FrictionPoint,
    WearPoint,
    contact_point,
    friction_point,
    wear_point,
)
from sonolube.rig.operating_point_batch import NUMBERS, STATUSES, PointBatch, point_batch
from sonolube.rig.operating_points import OperatingPoints, operating_points, steady_states
from sonolube.rig.parametric_study import frequency_study, load_study, speed_study, voltage_study, waveform_study
from sonolube.rig.record import Rig
from sonolube.rig.simulation import Simulation, simulate
from sonolube.rig.start_up import StartUp, start_up
from sonolube.rig.steady_vibration import gap_motion
from sonolube.rig.study_figures import STUDY_FIGURES

__all__ = [
    "NUMBERS",
    "STATUSES",
    "STUDY_FIGURES",
    "ContactPoint",
    "Distribution",
    "FrictionPoint",
    "HeatPoint",
    "LogNormal",
    "Normal",
    "OperatingPoints",
    "PointBatch",
    "RegimeMap",
    "RegimePoint",
    "Response",
    "Rig",
    "Simulation",
    "StartUp",
    "Uniform",
    "WearPoint",
    "contact_point",
    "dataset",
    "frequency_grid",
    "frequency_study",
    "friction_point",
    "friction_ratios",
    "gap_motion",
    "gridded",
    "heat_point",
    "least_power_study",
    "linear_response",
    "load_study",
    "operating_points",
    "point_batch",
    "read_rig",
    "regime_map",
    "regime_point",
    "rig_content",
    "rig_from",
    "rig_schema",
    "simulate",
    "speed_study",
    "start_up",
    "steady_states",
    "structure_by_stack",
    "structure_entries",
    "thermal_solid",
    "touching_structure",
    "voltage_study",
    "waveform_study",
    "wear_of_materials",
    "wear_point",
    "with_tables",
    "write_netcdf",
]
