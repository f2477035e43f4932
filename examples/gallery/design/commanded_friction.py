"""Friction on command

Closed loop on the reference rig with a delay of 1 ms: the set-point steps, the controller finds the voltage,
and the force follows although the real friction is 15 % above the model's.
"""

from pathlib import Path

import sonolube as sl
from sonolube.charts import draw_chart
from sonolube.design.control import Amplifier, ControlSettings, Disturbance, design_control
from sonolube.design.control.stick_slip import closed_loop_chart
from sonolube.figure import publication_style

rig = sl.read_rig(Path(__file__).parents[2] / "rigs" / "tribometer.toml")
settings = ControlSettings(
    friction_force=0.5, amplifier=Amplifier(voltage_maximum=28.0), disturbance=Disturbance(friction_factor=1.15)
)
with publication_style():
    figure = draw_chart(closed_loop_chart(design_control(rig, settings)))

if __name__ == "__main__":
    figure.savefig("commanded-friction.png", dpi=150)
