"""Command `app`: the workbench in the browser."""

from pathlib import Path
from typing import Annotated

import typer

from sonolube.errors import InvalidInput
from sonolube.extras import missing_package

_LOOPBACK = ("127.0.0.1", "localhost", "::1")

Rig = Annotated[
    Path | None,
    typer.Argument(metavar="[RIG.toml]", help="The rig that the first page shows, as a TOML file or its folder."),
]
Port = Annotated[int, typer.Option(min=0, max=65535, help="Port on which it listens; 0 for any free one.")]
Browser = Annotated[bool, typer.Option(help="Open the browser.")]
Host = Annotated[str, typer.Option(help="Address on which it listens; others than this computer need --token-file.")]
TokenFile = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="File with the token of the link, 32 characters or more, readable by you alone."),
]
Allowed = Annotated[
    list[str] | None,
    typer.Option("--allow-host", metavar="NAME", help="Name of a proxy by which pages may ask; may come again."),
]
DeviceMap = Annotated[
    Path | None,
    typer.Option(metavar="MAP.toml", help="Devices of the rig that page Lab runs; without it a virtual tribometer."),
]
Runs = Annotated[
    Path | None,
    typer.Option(
        metavar="DIR", help="Folder of the runs of page Lab; by default runs, or records of the rig's folder."
    ),
]


def app(
    rig: Rig = None,
    port: Port = 8765,
    browser: Browser = True,
    host: Host = "127.0.0.1",
    token_file: TokenFile = None,
    allow_host: Allowed = None,
    lab: DeviceMap = None,
    runs: Runs = None,
) -> None:
    """Open the workbench in the browser.

    Example: sonolube app examples/rigs/tribometer.toml
    """
    try:
        from sonolube.browser.server import run, token_of_file
    except ImportError:
        raise missing_package("app", remedy="use the terminal or Python") from None
    if host not in _LOOPBACK and token_file is None:
        raise InvalidInput(
            f"--host {host}: opens the workbench, which reads and computes as you do, to other computers; give a"
            " --token-file, and let a proxy encrypt the connection"
        )
    if rig is not None:
        from sonolube.rig import read_rig

        read_rig(rig)  # its faults are said here, not on a page
    if lab is not None:
        _require_devices(lab)
    token = "" if token_file is None else token_of_file(token_file)
    if host not in _LOOPBACK:
        typer.echo(f"Other computers can reach it at {host}; without a proxy, what is sent can be read on the way.")
    run(
        rig=rig,
        port=port,
        host=host,
        token=token,
        hosts=tuple(allow_host or ()),
        opens_browser=browser,
        device_map=lab,
        runs=runs,
    )


def _require_devices(device_map: Path) -> None:
    """Raise if a map of devices has faults, or parts that it needs are not installed."""
    from sonolube.laboratory.drivers import missing_parts, read_device_map

    found = missing_parts(read_device_map(device_map))
    if found:
        raise InvalidInput(f"--lab {device_map}: {found[0]}")
