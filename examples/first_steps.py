"""A rig in Python: read, looked at, changed, predicted, simulated and drawn.

Run: python examples/first_steps.py [FOLDER]
"""

import sys
from pathlib import Path

import sonolube as sl

rig = sl.read_rig(Path(__file__).parent / "rigs" / "tribometer.toml")
print(rig)

weaker = rig.replace("drive.voltage_peak_to_peak", "14 V")
for each in (rig, weaker):
    result = sl.simulate(each)
    print(f"{each.drive.voltage_peak_to_peak:.0f} V: friction ratio {float(result['friction_ratio']):.2f}")

prediction = sl.predict(rig)
print(prediction)

swept = sl.sweep(rig, over={"drive.voltage_peak_to_peak": "2 V:28 V:14"})
folder = Path(sys.argv[1] if len(sys.argv) > 1 else "out")
folder.mkdir(parents=True, exist_ok=True)
sl.plot(swept).savefig(folder / "friction-over-voltage.png")
