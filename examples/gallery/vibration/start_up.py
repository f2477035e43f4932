"""Start-up

The first milliseconds after the drive is switched on: the amplitude builds up within tens of periods, and the
mean position settles much later, with the arm.
"""

from pathlib import Path

import sonolube as sl
from sonolube.charts import draw_chart
from sonolube.figure import publication_style
from sonolube.rig import start_up
from sonolube.rig.figures import start_up_chart

rig = sl.read_rig(Path(__file__).parents[2] / "rigs" / "tribometer.toml")
with publication_style():
    figure = draw_chart(start_up_chart(rig, start_up(rig, duration=0.02)))

if __name__ == "__main__":
    figure.savefig("start-up.png", dpi=150)
