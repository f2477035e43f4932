"""Rigs: an experiment or a device as one record, read from a file, and what it does at its operating point."""

from sonolube.rig.dataset import dataset, write_netcdf
from sonolube.rig.edit import with_tables
from sonolube.rig.operating_point import (
    ContactPoint,
    FrictionPoint,
    WearPoint,
    contact_point,
    friction_point,
    wear_point,
)
from sonolube.rig.read import read_rig, rig_from
from sonolube.rig.record import Rig
from sonolube.rig.response import Response, frequency_grid, linear_response, touching_structure
from sonolube.rig.schema import rig_schema
from sonolube.rig.simulation import Simulation, simulate
from sonolube.rig.start_up import StartUp, start_up

__all__ = [
    "ContactPoint",
    "FrictionPoint",
    "Response",
    "Rig",
    "Simulation",
    "StartUp",
    "WearPoint",
    "contact_point",
    "dataset",
    "frequency_grid",
    "friction_point",
    "linear_response",
    "read_rig",
    "rig_from",
    "rig_schema",
    "simulate",
    "start_up",
    "touching_structure",
    "wear_point",
    "with_tables",
    "write_netcdf",
]
