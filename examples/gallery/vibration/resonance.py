"""Resonance and impedance

Amplitude per volt and impedance of the stack in the reference rig about its resonance, for a drive too weak to
open the contact.
"""

from pathlib import Path

import numpy as np

import sonolube as sl
from sonolube.charts import draw_chart
from sonolube.figure import publication_style
from sonolube.rig import frequency_response
from sonolube.rig.figures import response_chart

rig = sl.read_rig(Path(__file__).parents[2] / "rigs" / "tribometer.toml")
with publication_style():
    figure = draw_chart(response_chart(rig, frequency_response(rig, frequency=np.linspace(15e3, 35e3, 800))))

if __name__ == "__main__":
    figure.savefig("resonance.png", dpi=150)
