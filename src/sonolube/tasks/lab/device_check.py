"""Task `lab check`: a device map against what is installed, a protocol, and the devices themselves."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

from sonolube.errors import InvalidInput, SonolubeError
from sonolube.facts.protocol import protocol_by_name_or_file
from sonolube.laboratory.drivers import DeviceMap, first_readings, missing_parts, read_device_map, unfulfilled
from sonolube.laboratory.dry_run.report import SAFETY
from sonolube.tasks.answer import Answer, Block, Dataset, Rows, answer
from sonolube.tasks.files import InputFile, file_path
from sonolube.tasks.parameters import DeviceFile, Parameter
from sonolube.tasks.task import shown, task
from sonolube.text.units import format_si

_SAMPLE_RATE = 1000.0  # Hz, of the first look


@answer
class CheckedDevices(Answer):
    """Devices of a map, missing parts, and first readings.

    Parameters
    ----------
    device_map : DeviceMap
    missing : sequence of str
        Packages and drivers that are not installed, each with its remedy.
    protocol : str or None
        Name of the protocol that the devices were held against.
    beyond : sequence of str
        What it wants of the devices that they cannot do.
    readings : mapping of str to tuple of float and str, or None
        Mean of each channel with its unit; None where the devices were not connected.
    """

    device_map: DeviceMap
    missing: Sequence[str]
    protocol: str | None
    beyond: Sequence[str]
    readings: Mapping[str, tuple[float, str]] | None

    def blocks(self) -> Sequence[Block]:
        """Devices, what is missing, what is beyond them, and readings."""
        described = dict(self.device_map.devices().description)
        blocks: list[Block] = [described.pop("rig"), Rows(list(described.items()))]
        blocks += [f"missing: {each}" for each in self.missing] or ["all packages and drivers are installed"]
        if self.protocol is not None:
            blocks += [f"impossible: {each}" for each in self.beyond] or [f"{self.protocol} can be run"]
        if self.readings is not None:
            rows = [(name, format_si(value, unit)) for name, (value, unit) in self.readings.items()]
            blocks += ["readings with motor and drive off", Rows(rows)]
        return blocks

    def object(self) -> dict[str, Any]:
        """Same as an object."""
        return {
            "devices": dict(self.device_map.devices().description),
            "missing": list(self.missing),
            "protocol": self.protocol,
            "impossible": list(self.beyond),
            "readings": None
            if self.readings is None
            else {name: {"value": value, "unit": unit} for name, (value, unit) in self.readings.items()},
        }

    def caveats(self) -> Sequence[str]:
        """Caveats: no driver has met hardware, and software is no safety function."""
        return (
            "the drivers were tested on stand-ins, never on hardware: keep a hand on the switch in the first run",
            SAFETY,
        )

    def dataset(self) -> Dataset:
        """Readings, a variable each."""
        import xarray as xr

        readings = (self.readings or {}).items()
        return xr.Dataset(
            {
                name: ((), value, {"units": unit, "long_name": name.replace("_", " ")})
                for name, (value, unit) in readings
            },
            attrs=self.notes(),
        )

    @property
    def is_failure(self) -> bool:
        """Whether something is missing, or the protocol is beyond the devices."""
        return bool(self.missing or self.beyond)


@task
def check(
    device_map: Annotated[str | Path, DeviceFile("Devices of a rig.", "MAP.toml")],
    *,
    protocol: Annotated[
        InputFile | None, Parameter("Such as map_test, or a TOML file: can these devices run it?", "PROTOCOL")
    ] = None,
    connect: Annotated[bool, Parameter("Connect, and read one block with motor and drive off.")] = False,
) -> CheckedDevices:
    """Check a device map: what is missing to run it, whether it can run a protocol, and what its inputs read.

    Ends with exit code 0 if nothing is missing and nothing asked for is beyond the devices, else with 1.

    Example: sonolube lab check examples/lab/devices.toml --protocol map_test
    """
    read, name = read_device_map(Path(device_map)), None if protocol is None else str(file_path(protocol))
    return CheckedDevices(
        device_map=read,
        missing=missing_parts(read),
        protocol=name,
        beyond=() if name is None else unfulfilled(read, protocol_by_name_or_file(name)),
        readings=_readings(read) if connect else None,
    )


def _readings(device_map: DeviceMap) -> dict[str, tuple[float, str]]:
    """Mean of each channel over a tenth of a second, with its unit."""
    devices = device_map.devices()
    channels = devices.channels
    highest = device_map.entries.acquisition.total_rate_maximum / len(devices.acquisition.channels)
    try:
        means = first_readings(devices, sample_rate=min(_SAMPLE_RATE, highest))
    except SonolubeError as failure:
        raise InvalidInput(f"{shown('connect')}: {failure}") from None
    return {name: (mean, channels[name].unit) for name, mean in means.items()}
