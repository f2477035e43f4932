"""Friction over the drive voltage

The reference rig from 2 V to 28 V peak to peak, as `sonolube sweep` draws it: friction falls once the amplitude
approaches the length over which the contact force decays.
"""

from pathlib import Path

import sonolube as sl

rig = sl.read_rig(Path(__file__).parents[2] / "rigs" / "tribometer.toml")
figure = sl.plot(sl.sweep(rig, over={"drive.voltage_peak_to_peak": "2V:28V:27"}))

if __name__ == "__main__":
    figure.savefig("voltage-sweep.png", dpi=150)
