"""Stick-slip of a mass pulled by a spring: period and peaks, and the speed above which it slides steadily.

Run: python examples/stick_slip.py
"""

from sonolube.models.friction import Holder, LuGreFriction, lugre_stick_slip

# the published case of Canudas de Wit et al. (1995)
law = LuGreFriction(
    coulomb_friction_force=1.0,
    static_friction_force=1.5,
    stribeck_velocity=0.001,
    bristle_stiffness=1e5,
    bristle_damping=1e5**0.5,
    viscous_coefficient=0.4,
)
spring = Holder(holder_stiffness=2.0, holder_mass=1.0)

found = lugre_stick_slip(law, spring, sliding_speed=0.1, duration=30.0)
print(f"first slip after {found.first_slip_time:.2f} s, then every {found.period:.2f} s")
print(f"peaks: spring {found.peak_spring_force:.2f} N, friction {found.peak_friction_force:.2f} N,", end=" ")
print(f"velocity {found.peak_velocity:.2f} m/s")
for speed in (0.1, 0.3, 1.0, 3.0):
    kind = lugre_stick_slip(law, spring, sliding_speed=speed, duration=60.0).kind
    print(f"pulled at {speed} m/s: {kind}")
