"""Own runs against the models

Runs of a tribometer, as a table, against every model that applies, ranked by what each predicts of runs that it
has not seen (`sonolube fit`).
"""

from pathlib import Path

import sonolube as sl

examples = Path(__file__).parents[2]
rig = sl.read_rig(examples / "rigs" / "tribometer.toml")
figure = sl.plot(sl.fit(examples / "tribometer-runs.csv", rig=rig))

if __name__ == "__main__":
    figure.savefig("own-runs.png", dpi=150)
