"""How often the intervals hold

Share of published tests inside an interval over the probability that it claims. An honest prediction lies on
the diagonal; above it, it is too cautious.
"""

from sonolube.figure import publication_style
from sonolube.prediction import calibration_figure, calibrations

with publication_style():
    figure = calibration_figure(calibrations())

if __name__ == "__main__":
    figure.savefig("calibration.png", dpi=150)
