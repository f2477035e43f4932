"""Prediction of tests not seen

Two published tables, each predicted from all other rigs: bands of 50, 80 and 95 % and the measured ratio. A prediction
is worth something where the points fall inside as often as the bands say.
"""

from sonolube.charts import draw_chart
from sonolube.figure import publication_style
from sonolube.prediction.figures import unseen_chart

with publication_style():
    figure = draw_chart(unseen_chart())

if __name__ == "__main__":
    figure.savefig("unseen-tests.png", dpi=150)
