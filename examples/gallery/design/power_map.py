"""Friction reduction over speed and power

The map of D 4.1 for its rig, computed: which power a speed asks for. As the sliding speeds up, more power is
needed for the same reduction.
"""

from pathlib import Path

import sonolube as sl

rig = sl.read_rig(Path(__file__).parents[2] / "rigs" / "power_map.toml")
figure = sl.plot(sl.map(rig, over={"contact.normal_load": "3 N"}))

if __name__ == "__main__":
    figure.savefig("power-map.png", dpi=150)
