from .device_check import check as check
from .driver_trial import try_driver as try_driver
from .friction_hold import hold as hold
from .protocol_run import run as run, virtual as virtual
from .run_folders import export as export, recover as recover, runs as runs, show as show
