"""One period of the reference rig

Displacement of the pin's tip and normal force in steady vibration at 22 kHz: the force varies between a fifth
of the load and more than twice the load, and its mean is the load.
"""

from pathlib import Path

import sonolube as sl

rig = sl.read_rig(Path(__file__).parents[2] / "rigs" / "tribometer.toml")
figure = sl.plot(sl.simulate(rig))

if __name__ == "__main__":
    figure.savefig("steady-motion.png", dpi=150)
