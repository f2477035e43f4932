from .block import CHANNEL_QUANTITIES as CHANNEL_QUANTITIES, Block as Block, Channel as Channel
from .devices import (
    Acquisition as Acquisition,
    DeviceError as DeviceError,
    DeviceLost as DeviceLost,
    Devices as Devices,
    DriveSetting as DriveSetting,
    DriveSource as DriveSource,
    Motor as Motor,
    SamplesLost as SamplesLost,
)
