"""Notebook of a control engineer: friction held at 0.2, and the controller as C."""

# %% [markdown]
# # Friction held at 0.2
#
# For the control engineer: the coefficient of friction of the reference rig is held
# at 0.2 by the voltage of the actuator, although the force is known 2 ms late and the
# real friction is 15 % above the model's. The controller is exported as C.

# %%
import numpy as np

import sonolube as sl
from sonolube.charts import draw_chart
from sonolube.design.control import (
    Amplifier,
    ControlSettings,
    Disturbance,
    controller_source,
    design_control,
    stability_margins,
)
from sonolube.design.control.stick_slip import closed_loop_chart
from sonolube.figure import publication_style, shown_in_notebooks

rig = sl.read_rig("../rigs/tribometer.toml")
wanted = 0.2 * rig.normal_load
print(
    f"{wanted:.2f} N of {rig.friction_coefficient * rig.normal_load:.2f} N without vibration"
)

# %% [markdown]
# ## Design
#
# The steady friction over the voltage, inverted, is the feed-forward; a PI
# controller, tuned by the delay, corrects it.

# %%
settings = ControlSettings(
    friction_force=wanted,
    dead_time=2e-3,
    amplifier=Amplifier(voltage_maximum=28.0),
    disturbance=Disturbance(friction_factor=1.15, friction_force_deviation=0.01),
)
study = design_control(rig, settings)
process, gains = study.controller.process, study.controller.gains
margins = stability_margins(process, gains)
print(
    f"integral time   {1e3 * gains.integral_time:.2f} ms, every {1e3 * process.sample_interval:.1f} ms"
)
print(
    f"gain margin     {margins.gain_margin:.1f}, phase margin {np.degrees(margins.phase_margin):.0f} deg"
)
print(f"delay margin    {1e3 * margins.delay_margin:.1f} ms beyond the 2 ms")

# %% [markdown]
# ## Closed loop
#
# The simulation has the delay, the noise of the sensor, the wrong model and the
# envelope of the vibration.

# %%
with publication_style():
    figure = draw_chart(closed_loop_chart(study))
shown_in_notebooks(figure)

# %%
run = study.run
first = np.flatnonzero(np.isclose(run.setpoint, wanted))
held = run.friction_force[first[first.size // 2 :]] / rig.normal_load
print(
    f"coefficient {held.mean():.3f}, within {np.ptp(held) / 2:.3f}, in the second half of its step"
)

# %% [markdown]
# ## C source
#
# C99 without dependencies; `sonolube_step` is called once every interval.

# %%
source = controller_source(study.controller, study.tracker, title=rig.title)
print(*source.splitlines()[:32], sep="\n")
print(f"... {len(source.splitlines())} lines")
