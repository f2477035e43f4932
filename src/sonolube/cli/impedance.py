"""The command that computes impedance spectra."""

from pathlib import Path
from typing import Annotated

import typer

from sonolube.cli.operate import Json

impedance = typer.Typer(no_args_is_help=True, help="Impedance of piezoelectric parts, by finite elements.")


@impedance.callback()
def _impedance() -> None:
    """Impedance of piezoelectric parts, by finite elements."""


@impedance.command()
def compute(
    part: Annotated[
        str,
        typer.Argument(metavar="PART", help="stack, tribometer_actuator, cutter_head, or a part or STEP file."),
    ],
    sizes: Annotated[
        list[str] | None, typer.Option("--set", metavar="SIZE=VALUE", help="A size of the part, such as length=12mm.")
    ] = None,
    lowest: Annotated[str, typer.Option("--from", metavar="FREQUENCY", help="Lowest frequency.")] = "1kHz",
    highest: Annotated[str, typer.Option("--to", metavar="FREQUENCY", help="Highest frequency.")] = "60kHz",
    count: Annotated[int, typer.Option("--points", metavar="NUMBER", help="How many frequencies.", min=2)] = 1001,
    clamp: Annotated[
        list[str] | None, typer.Option(metavar="FACE", help="A face held still for a second spectrum, as back.-z.")
    ] = None,
    ceramic: Annotated[str, typer.Option(metavar="NAME", help="Ceramic of a part that is no transducer.")] = "pic255",
    poled: Annotated[str, typer.Option(metavar="x|y|z", help="Along which such a part is poled.")] = "z",
    drive: Annotated[str, typer.Option(metavar="FACE", help="Its driven electrode.")] = "+z",
    ground: Annotated[str, typer.Option(metavar="FACE", help="Its grounded electrode.")] = "-z",
    measured: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Spectrum to draw over it, as `measure impedance` reads it.")
    ] = None,
    tolerance: Annotated[
        float, typer.Option(metavar="RATIO", help="Largest change of a coupled resonance from mesh to mesh.")
    ] = 0.02,
    vtu: Annotated[bool, typer.Option("--vtu", help="Write the coupled modes for ParaView too.")] = False,
    out: Annotated[Path, typer.Option(help="Folder for the figure, the table and the dataset.")] = Path("out"),
    json: Json = False,
) -> None:
    """Electrical impedance of a transducer, free and clamped: resonances, coupling and motion per volt.

    Example: sonolube impedance compute tribometer_actuator --clamp back.-z --to 40kHz
    """
    import json as json_module
    from functools import lru_cache

    import numpy as np

    from sonolube.checks import require_positive
    from sonolube.cli.impedance_output import (
        Spectrum,
        impedance_lines,
        impedance_object,
        write_impedance,
    )
    from sonolube.cli.modal_part import longest_axis, starting_size, transducer_of
    from sonolube.cli.progress import progress
    from sonolube.errors import InvalidInput
    from sonolube.fem import FixedSupport, Mesh, Model, generate_mesh, harmonic_response
    from sonolube.fem.electromechanical_model import converged_electromechanical_model
    from sonolube.measurement.impedance.reader import read_impedance
    from sonolube.units import to_si

    low, high = to_si(lowest, unit="Hz", name="--from"), to_si(highest, unit="Hz", name="--to")
    if not low < high:
        raise InvalidInput(f"--from must lie below --to, got {lowest} and {highest}")
    frequency = np.linspace(float(require_positive(frequency=low)), high, count)
    seen = None if measured is None else read_impedance(measured)
    transducer = transducer_of(part, sizes or [], ceramic=ceramic, along=poled, driven=drive, grounded=ground)
    supports = {"free": (), **({"clamped": tuple(FixedSupport(face=face) for face in clamp)} if clamp else {})}
    size, spectra = starting_size(transducer.geometry), {}

    @lru_cache
    def mesh_at(element_size: float) -> Mesh:
        return generate_mesh(transducer.geometry, element_size=element_size)

    with progress("meshing and solving") as advance:
        for name, fixed in supports.items():

            def model_at(element_size: float, fixed: tuple[FixedSupport, ...] = fixed) -> Model:
                return transducer.model(mesh_at(element_size), fixed=fixed)

            watched = {key: output for key, output in transducer.outputs.items() if output.face not in (clamp or ())}
            port = converged_electromechanical_model(
                model_at,
                outputs=watched if fixed else transducer.outputs,
                axis=longest_axis(mesh_at(size)),
                highest_frequency=high,
                element_size=size,
                relative_tolerance=tolerance,
                advance=advance,
            )
            spectra[name] = Spectrum(port=port, response=harmonic_response(port.reduction, frequency=frequency))
        written = write_impedance(spectra, seen, folder=out, part=Path(part).stem, with_modes=vtu)
    told = (part, transducer, spectra, seen, written)
    if json:
        typer.echo(json_module.dumps(impedance_object(*told), indent=2, allow_nan=False))
    else:
        typer.echo("\n".join(impedance_lines(*told)))
