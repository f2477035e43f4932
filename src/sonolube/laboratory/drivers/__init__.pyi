from .daqmx_acquisition import DaqmxAcquisition as DaqmxAcquisition, SensorScale as SensorScale
from .daqmx_library import DaqmxGuard as DaqmxGuard
from .daqmx_output import DaqmxDrive as DaqmxDrive, DaqmxMotor as DaqmxMotor
from .device_map import (
    DeviceMap as DeviceMap,
    device_map_schema as device_map_schema,
    first_readings as first_readings,
    missing_parts as missing_parts,
    read_device_map as read_device_map,
    unfulfilled as unfulfilled,
)
from .driver_table import DriverTable as DriverTable, known_drivers as known_drivers
from .entry import (
    AcquisitionEntry as AcquisitionEntry,
    ChannelEntry as ChannelEntry,
    DriveEntry as DriveEntry,
    DriveLimits as DriveLimits,
    DriverEntry as DriverEntry,
    GuardEntry as GuardEntry,
    MotorEntry as MotorEntry,
)
from .function_generator import FunctionGenerator as FunctionGenerator
from .line_motor import LineMotor as LineMotor
from .scpi_instruments import ScpiQueries as ScpiQueries
from .scpi_source import ScpiSource as ScpiSource
from .visa_connection import VisaConnection as VisaConnection
