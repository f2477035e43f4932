"""Reductions of friction in the literature

Speed and pressure of earlier studies and of D, with the direction of the vibration and the reduction of
friction that each measured.
"""

from sonolube.charts import draw_chart
from sonolube.figure import publication_style
from sonolube.validation.previous_study_map import study_chart

with publication_style():
    figure = draw_chart(study_chart())

if __name__ == "__main__":
    figure.savefig("previous-studies.png", dpi=150)
