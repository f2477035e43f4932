"""What the uncertainty comes from

Friction of the reference rig with the distributions of its file: the share of the variance that each entry
causes alone, and with others. Measure first what stands on top.
"""

from pathlib import Path

from sonolube.charts import draw_chart
from sonolube.design import propagate, sobol_chart
from sonolube.design.uncertainty_summary import outcome_indices
from sonolube.figure import publication_style

rig = Path(__file__).parents[2] / "rigs" / "tribometer_uncertain.toml"
found = propagate(rig, samples=128, indices=True)
with publication_style():
    figure = draw_chart(sobol_chart(found, outcome_indices(found)))

if __name__ == "__main__":
    figure.savefig("uncertainty.png", dpi=150)
