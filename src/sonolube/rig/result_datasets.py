"""Labelled datasets of results of a rig over time or frequency: steady vibration, linear response and start-up."""

from dataclasses import replace

import numpy as np

from sonolube.models.contact import separation
from sonolube.rig.datasets import LabelledArray, LabelledArrays, labelled, labels, result_quantities, result_texts
from sonolube.rig.linear_response import FrequencyResponse
from sonolube.rig.record import Rig
from sonolube.rig.simulation import Simulation
from sonolube.rig.start_up_transient import StartUp
from sonolube.rig.vibration import SteadyVibration


def simulation_arrays(rig: Rig, result: Simulation) -> LabelledArrays:
    """One repetition of the steady vibration, and the friction and wear under it.

    Displacement and contact force over `time`; every quantity of the result as a scalar, NaN outside the range of a
    model. Attributes hold the texts of the result, its caveats and the assumptions of the rig.
    """
    vibration = result.vibration
    motion = vibration.motions[0]
    time = np.arange(motion.displacement.size) / (motion.displacement.size * motion.frequency)
    values = {"time": time, "displacement": motion.displacement, "normal_force": motion.normal_force}
    moving = labelled(values, along="time", title=f"Steady motion of {rig.title}")
    scalars = {
        name: LabelledArray(dims=(), values=np.asarray(np.nan if value is None else value), attrs=labels(name))
        for name, value in result_quantities(result).items()
        if name not in moving
    }
    about = result_texts(result) | {
        "result": "simulation",
        "rig": rig.title,
        "caveats": "\n".join(result.caveats),
        "assumptions": "\n".join(f"{key}: {reason}" for key, reason in rig.assumptions.items()),
        "interval": _interval_of(vibration),
        "attractor": vibration.attractor,
        "repetition_periods": vibration.repetition_periods,
        "normal_load_N": motion.normal_load,
        "separation_at_rest_m": float(separation(rig.contact, normal_load=rig.normal_load)),
        "mean_displacement_m": vibration.mean_displacement,
        "contact_loss_fraction": vibration.contact_loss_fraction,
    }
    return replace(moving, variables={**moving.variables, **scalars}).assign_attrs(**about)


def response_arrays(rig: Rig, result: FrequencyResponse) -> LabelledArrays:
    """Linear response over frequency: amplitude per volt, magnitude and phase of the impedance; over `frequency`."""
    names = ("frequency", "amplitude_per_volt", "impedance", "phase")
    values = {name: getattr(result, name) for name in names}
    return labelled(values, along="frequency", title=f"Linear response of {rig.title}")


def start_up_arrays(rig: Rig, result: StartUp) -> LabelledArrays:
    """Start-up from rest: displacement and contact force at every step of the time integration; over `time`."""
    values = {
        "time": result.trajectory.time,
        "displacement": result.trajectory.contact.displacement,
        "normal_force": result.trajectory.contact.normal_force,
    }
    return labelled(values, along="time", title=f"Start-up of {rig.title}")


def _interval_of(result: SteadyVibration) -> str:
    """Interval of a steady motion: a period, several periods, or part of an aperiodic motion."""
    if result.repetition_periods == 1:
        return "one period of the drive"
    if result.repetition_periods:
        return f"{result.repetition_periods} periods of the drive, after which the motion repeats"
    return f"a stretch of a motion that does not repeat: {result.attractor}"
