"""Prediction with intervals

A brass pin on a stainless disc, 5 N, 0.2 m/s, 20 kHz, 3 µm: what `sonolube predict` answers before any test.
The bands hold 50, 80 and 95 % of what the published tests make credible.
"""

import sonolube as sl

rig = sl.new(
    pin="brass", disc="304", load="5 N", speed="0.2 m/s", frequency="20 kHz", amplitude="3 um", finish="ground N6"
).rig
answer = sl.predict(rig)
figure = sl.plot(answer)

if __name__ == "__main__":
    figure.savefig("prediction.png", dpi=150)
