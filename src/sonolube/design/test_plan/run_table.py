"""Table of the runs of a plan, with empty cells for the results."""

import csv
import io

from sonolube.design.test_plan.plan import TestPlan

_COLUMNS = (
    ("normal_load", "N", 1.0),
    ("sliding_speed", "mm/s", 1e3),
    ("voltage_peak_to_peak", "V", 1.0),
    ("vibration_amplitude", "um", 1e6),
)
RESULTS = ("friction_force [N]", "intrinsic_friction_force [N]")
"""Columns that the laboratory fills."""


def run_table(plan: TestPlan) -> str:
    """CSV text of the runs in their order, to be filled and read by `sonolube.measurement.measured_runs.read_runs`."""
    known = [each for each in _COLUMNS if each[0] != "voltage_peak_to_peak" or has_voltage(plan)]
    lines = [",".join(["run", "block", *(f"{name} [{unit}]" for name, unit, _ in known), *RESULTS])]
    for run in plan.runs:
        index = plan.candidate(run)
        cells = [f"{scale * getattr(plan.candidates, name)[index]:.6g}" for name, _, scale in known]
        lines.append(",".join([f"{run.run}", f"{run.block}", *cells, *("" for _ in RESULTS)]))
    return "\n".join(lines) + "\n"


def has_results(text: str) -> bool:
    """Whether a table of runs holds any result, which must not be replaced by an empty one."""
    rows = list(csv.DictReader(io.StringIO(text)))
    return not rows or any((row.get(name) or "").strip() or name not in row for row in rows for name in RESULTS)


def has_voltage(plan: TestPlan) -> bool:
    """Whether the drive voltage of the points is known."""
    return bool(plan.candidates.voltage_peak_to_peak[0] > 0)
