"""Commands on what instruments wrote."""

import typer

from sonolube.cli.measure_calibration import calibration
from sonolube.cli.measure_friction import friction
from sonolube.cli.measure_groove import groove
from sonolube.cli.measure_impedance import impedance
from sonolube.cli.measure_rotation import rotation
from sonolube.cli.measure_surface import surface
from sonolube.cli.measure_vibration import vibration

measure = typer.Typer(no_args_is_help=True, help="Measure what instruments wrote: recordings, surfaces, spectra.")
for command in (friction, rotation, calibration, surface, groove, impedance, vibration):
    measure.command()(command)
