from .block import (
    BLOCK_DURATION as BLOCK_DURATION,
    CHANNEL_QUANTITIES as CHANNEL_QUANTITIES,
    Block as Block,
    Channel as Channel,
    Sensor as Sensor,
)
from .devices import (
    Acquisition as Acquisition,
    DeviceError as DeviceError,
    DeviceLost as DeviceLost,
    Devices as Devices,
    DriveSetting as DriveSetting,
    DriveSource as DriveSource,
    Motor as Motor,
    Recorder as Recorder,
    SamplesLost as SamplesLost,
    connect_devices as connect_devices,
    switch_outputs_off as switch_outputs_off,
)
from .interlocks import Interlock as Interlock, first_trip as first_trip, interlocks_for as interlocks_for
from .own_clocks import OwnClocks as OwnClocks
from .run_plan import RunPlan as RunPlan, impossibilities as impossibilities, planned_run as planned_run
from .runner import run_protocol as run_protocol
from .states import (
    OUTCOMES as OUTCOMES,
    TRANSITIONS as TRANSITIONS,
    Event as Event,
    RunControl as RunControl,
    RunState as RunState,
    State as State,
    after as after,
)
from .supervised_run import Sampling as Sampling
from .verdict import Outputs as Outputs, Verdict as Verdict, exit_code as exit_code, verdict_text as verdict_text
from .watching import RunWatcher as RunWatcher
