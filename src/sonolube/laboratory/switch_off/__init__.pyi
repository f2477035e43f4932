from .client import (
    SwitchOffProcess as SwitchOffProcess,
    ready_devices as ready_devices,
    with_outputs_apart as with_outputs_apart,
)
