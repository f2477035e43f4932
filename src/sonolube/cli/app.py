"""The command line: which commands there are, and what a user reads when one is refused."""

import os
import sys
from collections.abc import Sequence

import typer

from sonolube import __version__
from sonolube.cli import (
    actuators,
    catalogue,
    comparison,
    control,
    efficiency,
    horn,
    identification,
    impedance,
    literature,
    mapping,
    measure,
    modal,
    motion,
    operate,
    optimise,
    regime,
    reproduction,
    study,
    sweep,
    thermal,
    uncertainty,
)
from sonolube.errors import SonolubeError
from sonolube.threads import threads_running

_INTERRUPTED = 130
_LONGEST = 1200  # characters of a complaint, which may quote what was given

app = typer.Typer(
    name="sonolube",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="Ultrasonic lubrication: friction and wear of two surfaces of which one vibrates.\n\n"
    "Example: sonolube friction examples/rigs/tribometer.toml",
)
app.command()(reproduction.reproduce)
app.command()(operate.contact)
app.command()(operate.friction)
app.command()(operate.wear)
app.command()(operate.simulate)
app.command()(motion.response)
app.command()(motion.transient)
app.command()(modal.modes)
app.add_typer(horn.horn, name="horn")
app.add_typer(impedance.impedance, name="impedance")
app.command()(study.study)
app.command()(comparison.compare)
app.command()(thermal.thermal)
app.command()(regime.regime)
app.command()(control.control)
app.command()(sweep.sweep)
app.command()(mapping.map)
app.command()(uncertainty.uncertainty)
app.command()(optimise.optimise)
app.command()(efficiency.efficiency)
app.add_typer(identification.identify, name="identify")
app.add_typer(measure.measure, name="measure")
app.command()(catalogue.materials)
app.command()(actuators.actuators)
app.command()(catalogue.published)
app.command()(literature.literature)
app.command()(catalogue.schema)


@app.callback(invoke_without_command=True)
def _version(
    version: bool = typer.Option(False, "--version", help="Print the version and stop.", is_eager=True),
) -> None:
    if version:
        typer.echo(f"sonolube {__version__}")
        raise typer.Exit


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and exit: 0 after success, 2 after bad input, 130 after an interruption.

    Parameters
    ----------
    arguments : sequence of str, optional
        What follows the command's name; what the shell gave where absent.
    """
    arguments = list(sys.argv[1:] if arguments is None else arguments)
    command = " ".join(["sonolube", *[word for word in arguments[:1] if not word.startswith("-")]])
    try:
        code = app(args=arguments, prog_name="sonolube", standalone_mode=False)
    except (SonolubeError, OSError) as refusal:
        code = _refuse(command, str(refusal))
    except typer.TyperException as refusal:
        code = _refuse(command, getattr(refusal, "format_message", refusal.__str__)())
    except MemoryError as refusal:
        code = _refuse(command, f"does not fit into memory; ask for fewer points: {refusal}")
    except (KeyboardInterrupt, typer.Abort):
        code = _INTERRUPTED
    if code == _INTERRUPTED and threads_running():
        sys.stdout.flush()
        os._exit(_INTERRUPTED)
    sys.exit(code if isinstance(code, int) else 0)


def _refuse(command: str, reason: str) -> int:
    told = " ".join(reason.replace("Value error, ", "").split())
    if len(told) > _LONGEST:
        told = f"{told[: _LONGEST // 2]} ... {told[-_LONGEST // 2 :]}"
    if told:
        typer.echo(f"{command}: {told}", err=True)
    return 2
