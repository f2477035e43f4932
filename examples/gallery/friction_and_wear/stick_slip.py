"""Stick-slip of a mass on a spring

The published case of Canudas de Wit et al. (1995): a mass pulled through a spring sticks until the spring
overcomes static friction, jumps, and sticks again.
"""

import matplotlib.pyplot as plt

from sonolube.figure import publication_style
from sonolube.models import friction

law = friction.LuGreFriction(
    coulomb_friction_force=1.0,
    static_friction_force=1.5,
    stribeck_velocity=0.001,
    bristle_stiffness=1e5,
    bristle_damping=1e5**0.5,
    viscous_coefficient=0.4,
)
spring = friction.Holder(holder_stiffness=2.0, holder_mass=1.0)
found = friction.lugre_stick_slip(law, spring, sliding_speed=0.1, duration=30.0)

with publication_style():
    figure, (above, below) = plt.subplots(2, 1, figsize=(4.4, 3.6), sharex=True)
    above.plot(found.time, found.displacement, label="mass")
    above.plot(found.time, 0.1 * found.time, linestyle="--", label="end of the spring")
    above.set(ylabel="Displacement [m]")
    above.legend()
    below.plot(found.time, found.friction_force)
    below.set(xlabel="Time [s]", ylabel="Friction force [N]")

if __name__ == "__main__":
    figure.savefig("stick-slip.png", dpi=150)
