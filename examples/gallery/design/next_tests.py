"""The tests to make next

Three tests of a rig, chosen of all that it can make because the models disagree most about them; the shade is
the information that each test alone would give.
"""

from pathlib import Path

import numpy as np

import sonolube as sl
from sonolube.charts import draw_chart
from sonolube.design.test_plan.candidates import Factors
from sonolube.design.test_plan.plan import Procedure, Question, plan_tests, published_distances
from sonolube.design.test_plan.run_protocols import plan_chart
from sonolube.figure import publication_style

rig = sl.read_rig(Path(__file__).parents[2] / "rigs" / "power_map.toml")
factors = Factors(
    normal_load=np.array([3.0]),
    sliding_speed=np.geomspace(0.02, 0.2, 5),
    vibration_amplitude=np.geomspace(0.5e-6, 2.5e-6, 5),
)
without, vibrated = published_distances()
procedure = Procedure(intrinsic_distance=without, vibrated_distance=vibrated)
plan = plan_tests(rig, factors, question=Question(), procedure=procedure, points=3)
with publication_style():
    figure = draw_chart(plan_chart(plan))

if __name__ == "__main__":
    figure.savefig("next-tests.png", dpi=150)
