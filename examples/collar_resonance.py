"""The collar with variable friction by finite elements: its resonance closed, open and clamped, and what a bolt does.

Run: python examples/collar_resonance.py (needs netgen-mesher)
"""

from dataclasses import replace

from dong2015.hardware.collar import COLLAR_DIMENSION_SOURCES, FINAL_COLLAR
from dong2015.hardware.collar_analysis import reduced_collar_model
from dong2015.hardware.collar_tuning import main_resonance
from sonolube.models.fem import harmonic_response

for case, changes in (("top closed", {}), ("top open", {"open_top": True}), ("base clamped", {"clamped": True})):
    model = reduced_collar_model(FINAL_COLLAR, **changes)
    found = main_resonance(model)
    peak = harmonic_response(model, frequency=found.series_frequency)
    crown = abs(peak.displacement_per_volt[model.outputs.index("crown"), 0])
    print(
        f"{case:13s} {found.series_frequency * 1e-3:6.2f} kHz   k_eff {found.coupling_factor:.2f}   "
        f"inner ring {crown * 1e9:4.0f} nm/V"
    )

thin = main_resonance(reduced_collar_model(replace(FINAL_COLLAR, bolt_diameter=3e-3)))
print(f"bolt of 3 mm  {thin.series_frequency * 1e-3:6.2f} kHz   ({COLLAR_DIMENSION_SOURCES['bolt_diameter']})")
