"""The collar with variable friction: how far its resonance may drift before the friction commanded is lost.

Run: python examples/collar_on_command.py
"""

from pathlib import Path

from sonolube.design.control import (
    Amplifier,
    ControlSettings,
    ThermalDrift,
    assumed_mode,
    capture_limit,
    design_control,
)
from sonolube.rig import read_rig

collar = read_rig(Path(__file__).parent / "rigs" / "collar.toml")
mode = assumed_mode(collar, quality_factor=50.0, coupling_factor=0.2)  # not measured

print("warming   friction wanted   tracked          at a fixed frequency")
for kelvin in (0.0, 50.0, 100.0, 150.0):
    study = design_control(
        collar,
        ControlSettings(
            friction_force=0.9,
            amplifier=Amplifier(voltage_maximum=100.0, current_maximum=3.0),
            drift=ThermalDrift(final_temperature_rise=kelvin, warming_time=0.02),
        ),
        mode=mode,
    )
    before_second_step = int(0.5 * study.run.time.size)
    tracked, fixed = (
        f"{run.friction_force[before_second_step]:.3f} N, {run.level[before_second_step]:5.1f} V"
        for run in (study.run, study.fixed_frequency_run or study.run)
    )
    print(f"{kelvin:4.0f} K    {study.friction_force:.1f} N             {tracked}  {fixed}")
print(f"The tracker finds the resonance from up to {capture_limit(mode) - mode.frequency:.0f} Hz above it.")
print("At 150 K it has fallen further before the drive is strong enough to tell.")
