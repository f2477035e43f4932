from .planned_run import HeatingAssumptions as HeatingAssumptions, dry_run as dry_run
from .record import (
    DriveLoad as DriveLoad,
    DryRun as DryRun,
    Heating as Heating,
    PlannedPoint as PlannedPoint,
    drive_load as drive_load,
)
from .report import (
    dry_run_cells as dry_run_cells,
    dry_run_chart as dry_run_chart,
    dry_run_lines as dry_run_lines,
    dry_run_sums as dry_run_sums,
)
