"""Command `lab check`: a device map against what is installed, a protocol, and the devices themselves."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from sonolube.cli.console.answer import Answer, aligned, deliver, si
from sonolube.cli.console.options import Json
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.facts.protocol import protocol_by_name_or_file
from sonolube.laboratory.drivers import DeviceMap, first_block, missing_parts, read_device_map, unfulfilled
from sonolube.units import format_si

_SAMPLE_RATE = 1000.0  # Hz, of the first look


def check(
    device_map: Annotated[Path, typer.Argument(metavar="MAP.toml", help="Devices of a rig.")],
    protocol: Annotated[
        str | None, typer.Option(metavar="PROTOCOL", help="Such as map_test, or a TOML file: can these devices run it?")
    ] = None,
    connect: Annotated[
        bool, typer.Option("--connect", help="Connect, and read one block with motor and drive off.")
    ] = False,
    json: Json = False,
) -> None:
    """Check a device map: what is missing to run it, whether it can run a protocol, and what its inputs read.

    Ends with exit code 0 if nothing is missing and nothing asked for is beyond the devices, else with 1.

    Example: sonolube lab check examples/lab/devices.toml --protocol map_test
    """
    read = read_device_map(device_map)
    beyond = () if protocol is None else unfulfilled(read, protocol_by_name_or_file(protocol))
    answer = CheckAnswer(
        device_map=read,
        missing=missing_parts(read),
        protocol=protocol,
        beyond=beyond,
        readings=_readings(read) if connect else None,
    )
    deliver(answer, as_json=json)
    if answer.missing or answer.beyond:
        raise typer.Exit(1)


@dataclass(frozen=True, kw_only=True)
class CheckAnswer(Answer):
    """What a device map has, lacks and reads."""

    device_map: DeviceMap
    missing: Sequence[str]
    protocol: str | None
    beyond: Sequence[str]
    readings: Mapping[str, tuple[float, str]] | None

    def lines(self) -> list[str]:
        """Devices, what is missing, what is beyond them, and readings."""
        described = dict(self.device_map.devices().description)
        told = [described.pop("rig"), *aligned(list(described.items()))]
        told += [f"missing: {each}" for each in self.missing] or ["all packages and drivers are installed"]
        if self.protocol is not None:
            told += [f"impossible: {each}" for each in self.beyond] or [f"{self.protocol} can be run"]
        if self.readings is not None:
            told.append("readings with motor and drive off")
            shown = [(name, format_si(value, unit)) for name, (value, unit) in self.readings.items()]
            told += aligned(shown)
        return told

    def object(self) -> dict[str, Any]:
        """Same as an object."""
        readings = self.readings
        return {
            "devices": dict(self.device_map.devices().description),
            "missing": list(self.missing),
            "protocol": self.protocol,
            "impossible": list(self.beyond),
            "readings": None
            if readings is None
            else {name: si({name: value}, unit=unit)[name] for name, (value, unit) in readings.items()},
        }

    def caveats(self) -> Sequence[str]:
        """That no driver has met hardware."""
        return ("the drivers were tested on stand-ins, never on hardware: keep a hand on the switch in the first run",)


def _readings(device_map: DeviceMap) -> dict[str, tuple[float, str]]:
    """Mean of each channel over a tenth of a second, with its unit."""
    devices = device_map.devices()
    channels = devices.acquisition.channels
    highest = device_map.entries.acquisition.sample_rate_maximum / len(channels)
    try:
        block = first_block(devices, sample_rate=min(_SAMPLE_RATE, highest))
    except SonolubeError as failure:
        raise InvalidInput(f"--connect: {failure}") from None
    means = block.values.mean(axis=0)
    return {name: (float(mean), channels[name].unit) for name, mean in zip(channels, means, strict=True)}
