from .daqmx_acquisition import DaqmxAcquisition as DaqmxAcquisition
from .daqmx_guard import DaqmxGuard as DaqmxGuard
from .daqmx_output import DaqmxDrive as DaqmxDrive, DaqmxMotor as DaqmxMotor
from .device_map import (
    DeviceMap as DeviceMap,
    device_map_schema as device_map_schema,
    read_device_map as read_device_map,
)
from .driver_table import DriverTable as DriverTable, known_drivers as known_drivers
from .entry import (
    AcquisitionEntry as AcquisitionEntry,
    ChannelEntry as ChannelEntry,
    DriveEntry as DriveEntry,
    DriverEntry as DriverEntry,
    GuardEntry as GuardEntry,
    MotorEntry as MotorEntry,
)
from .function_generator import FunctionGenerator as FunctionGenerator
from .line_motor import LineMotor as LineMotor
from .output_limits import DriveLimits as DriveLimits
from .readiness import first_readings as first_readings, missing_parts as missing_parts, unfulfilled as unfulfilled
from .scpi_query import ScpiQueries as ScpiQueries
from .scpi_source import ScpiSource as ScpiSource
from .sensor_scale import LinearScale as LinearScale, SensorScale as SensorScale, TabulatedScale as TabulatedScale
from .visa_connection import VisaConnection as VisaConnection
