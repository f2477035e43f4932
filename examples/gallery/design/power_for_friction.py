"""Power from a calibrated line

Runs at several speeds give a line of the efficiency coefficient over the speed (D 4.2), with the band in which
the next run is expected.
"""

from pathlib import Path

import sonolube as sl
from sonolube.charts import draw_chart
from sonolube.design.efficiency import calibrate_efficiency, efficiency_chart
from sonolube.figure import publication_style

examples = Path(__file__).parents[2]
rig = sl.read_rig(examples / "rigs" / "power_map.toml")
runs = sl.read_runs(examples / "efficiency-runs.csv")
found = calibrate_efficiency(rig, runs, friction_force=0.5, sliding_speed=0.1, confidence_level=0.95)
with publication_style():
    figure = draw_chart(efficiency_chart(found))

if __name__ == "__main__":
    figure.savefig("power-for-friction.png", dpi=150)
