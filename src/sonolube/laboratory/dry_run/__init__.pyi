from .amplifier_load import DriveLoad as DriveLoad, drive_load as drive_load
from .figure import dry_run_chart as dry_run_chart
from .heating import Heating as Heating
from .planned_run import HeatingAssumptions as HeatingAssumptions, dry_run as dry_run
from .record import DryRun as DryRun, PlannedPoint as PlannedPoint, PlannedRecording as PlannedRecording
from .text import dry_run_cells as dry_run_cells, dry_run_lines as dry_run_lines, dry_run_sums as dry_run_sums
