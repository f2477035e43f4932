from .device_check import check as check
from .friction_hold import hold as hold
from .protocol_run import run as run, virtual as virtual
from .recording_export import export as export
from .recovery import recover as recover
from .run_list import runs as runs
from .shown_run import show as show
