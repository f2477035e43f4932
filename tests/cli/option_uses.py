"""Uses of every command with a value for each of its options, and the files that they read."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from tests.mode_files import write_universal_file

from reliability import virtual_contact
from sonolube.laboratory import Block, Channel
from sonolube.laboratory.records import new_run
from sonolube.prediction import learned
from sonolube.prediction.evidence_posterior import EvidencePosterior, LearnedSource

ROOT = Path(__file__).parents[2]
RIGS = ROOT / "examples" / "rigs"
RIG = str(RIGS / "tribometer.toml")
COLLAR = str(RIGS / "collar.toml")
FLAT = str(RIGS / "welder_flat.toml")  # without a voltage
AMPLITUDE = {"--amplitude": "per-volt"}
LOADED = {"--load": "2N", "--set": "contact.normal_load=2N"}
VIBRATED = LOADED | AMPLITUDE
SIZES = ("--set", "length=20mm", "--set", "width=10mm", "--set", "thickness=5mm")
BAR = ("--set", "length=10mm", "--set", "width=4mm", "--set", "thickness=20mm")
RUNS = str(ROOT / "examples" / "efficiency-runs.csv")
OWN_TESTS = str(ROOT / "examples" / "evidence" / "own_tests.toml")
OWN_RUNS = str(ROOT / "examples" / "tribometer-runs.csv")
SWITCHES = str(ROOT / "examples" / "decay-length-run.csv")
OVER = ("--over", "sliding.sliding_speed=20mm/s,50mm/s")
STUDY = {"--over": OVER[1], "--of": "waveform", "--from": "", "--to": "", "--points": "4", "--voltage": "10V"}
DRAWN = {"--sample": "lhs", "--seed": "1", "--workers": "1", "--scheduler": "local", "--chunk": "7"}
POSTERIOR = {"--evidence": "FOLDER/posterior.json"}
MEASURED = {"--runs": OWN_RUNS, "--mapping": "FOLDER/halved.toml"}  # own runs behind a prediction
SWEEP = STUDY | DRAWN | LOADED | MEASURED | {"--amplitude": "computed"}
SHEETS = {"--test-sheet": "FOLDER/sheet.toml", "--report": "OUT/page.html"}
KNOWN = (
    *("--pin", "aluminium_2024", "--disc", "stainless_steel_316", "--load", "5N", "--speed", "0.2m/s"),
    *("--frequency", "20kHz", "--friction", "0.4"),
)
BOLTED = (
    *("--set", "outer_radius=15mm", "--set", "inner_radius=6mm", "--set", "length=20mm", "--set", "rod_radius=4mm"),
    *("--set", "back_length=30mm", "--set", "front_length=30mm"),
)
FOREIGN = (
    *("--tip", "3", "--direction", "+x", "--port", "1", "--port", "2", "--force-per-volt", "12N/V"),
    *("--clamped-capacitance", "4nF", "--quality-factor", "500", "--modal-mass", "1kg"),
)
_SHORT_PROTOCOL = """title = "short"
source = "none"

[limits]
voltage_maximum = "30 V"
duration_maximum = "2 s"

[[steps]]
kind = "acquire"
channels = ["friction_force"]
sample_rate = "400 Hz"
duration = "{duration}"

[[steps]]
kind = "motor_speed"
sliding_speed = "50 mm/s"
"""
MAP = ("--over", "sliding.sliding_speed=10mm/s,20mm/s", "--over", "drive.voltage_peak_to_peak=5V,10V")

# Options that say how an answer is computed or kept: the answer stays the same.
EXECUTION = {"--once", "--force", "--real-time", "--yes", "--workers", "--scheduler", "--chunk", "--keep"}
# Options of the place of files, which every run here gives, and of the form of text.
PLACES = {"--out", "--json", "--help", "--full"}
# A run takes a minute, or needs a test of its own; tests of these commands try them.
TESTED_ELSEWHERE = {
    *(
        ("app", option)
        for option in ("--port", "--no-browser", "--host", "--token-file", "--allow-host", "--lab", "--runs")
    ),
    ("reproduce", "--chapter"),
    ("uncertainty", "--identified"),
    ("identify rig", "--facts"),
    ("identify rig", "--seed"),
    ("lab run", "--anyway"),
    ("lab run", "--fact"),
    ("lab run", "--no-self-test"),
    ("lab hold", "--no-self-test"),
    ("lab recover", "--drop-blocks"),
    ("lab try-driver", "--quick"),
    ("lab try-driver", "--set"),
}


@dataclass(frozen=True)
class Mode:
    """One use of a command, and a value for each of its options; of a pair, the first is replaced by the second."""

    command: str
    base: Sequence[str]
    values: Mapping[str, str | tuple[str, str]] = field(default_factory=dict)
    flags: Sequence[str] = ()


MODES = {
    "contact": Mode("contact", (RIG,), LOADED | {"--tangential-stiffness": "dong_2015"}),
    "predict": Mode(
        "predict",
        (RIG, "--runs", OWN_RUNS, "--pin", "m50", "--disc", "m50"),
        {
            **{"--runs": RUNS, "--laboratory": f"{RIG}={OWN_RUNS}", "--pin": "aluminium_2024"},
            **{
                "--disc": "aluminium_2024",
                "--seed": "1",
                "--evidence": "FOLDER/posterior.json",
                "--draws": "500",
                "--mapping": "FOLDER/halved.toml",
                **VIBRATED,
            },
        },
        ("--lubricant",),
    ),
    "plan": Mode(
        "plan",
        (
            RIG,
            *("--speed", "20:80:3mm/s", "--vibration", "1:2.5:3um", "--points", "2", "--pin", "m50", "--disc", "m50"),
        ),
        {
            "--runs": OWN_RUNS,
            "--mapping": "FOLDER/halved.toml",
            "--evidence": "FOLDER/posterior.json",
            "--speed": "30,60mm/s",
            "--load": "2,3N",
            "--vibration": "1.2:2.5:3um",
            "--voltage": "10:20:2V",
            "--points": "3",
            "--difference": "12%",
            "--power": "0.99",
            "--significance": "0.001",
            "--comparison": "separate",
            "--scatter": "12%",
            "--block": "pair",
            "--running-in": "1m",
            "--measuring-time": "30s",
            "--amplifier-voltage": "25V",
            "--amplifier-power": "40W",
            "--temperature-rise": "0.1K",
            "--pin": "aluminium_2024",
            "--disc": "aluminium_2024",
            "--seed": "1",
            "--amplitude": "per-volt",
            "--set": "friction.friction_coefficient=0.5",
        },
    ),
    "new": Mode(
        "new",
        ("OUT/rig.toml", *KNOWN, "--amplitude", "3um"),
        {
            "--pin": "m50",
            "--disc": "m50",
            "--shape": "ball 5mm",
            "--load": "6N",
            "--speed": "0.1m/s",
            "--frequency": "21kHz",
            "--amplitude": "2um",
            "--direction": "along",
            "--finish": "N8",
            "--pin-finish": "N8",
            "--disc-finish": "N8",
            "--scan": "FOLDER/plate.asc",
            "--pin-scan": "FOLDER/plate.asc",
            "--friction": "0.3",
            "--decay-length": "2um",
            "--stiffness": "1.5MN/m",
        },
        ("--force", "--folder"),
    ),
    "new on a track of a radius": Mode(
        "new",
        ("OUT/rig.toml", *KNOWN, "--amplitude", "3um", "--speed", "100 rpm", "--track-radius", "20mm"),
        {"--track-radius": "15mm"},
    ),
    "new on a track of a diameter": Mode(
        "new",
        ("OUT/rig.toml", *KNOWN, "--amplitude", "3um", "--speed", "100 rpm", "--track-diameter", "50mm"),
        {"--track-diameter": "30mm"},
    ),
    "new of a ring": Mode(
        "new",
        ("OUT/rig.toml", *KNOWN, "--amplitude", "3um", "--direction", "torsional", "--torsion-radius", "20mm"),
        {"--torsion-radius": "15mm"},
    ),
    "new of a soft layer": Mode(
        "new",
        ("OUT/rig.toml", *KNOWN, "--pin", "felt", "--amplitude", "3um", "--layer-thickness", "3mm"),
        {"--layer-thickness": "5mm"},
    ),
    "new of a calibration": Mode(
        "new", ("OUT/rig.toml", *KNOWN, "--calibration", "25V=2um"), {"--calibration": "25V=3um", "--amplitude": "3um"}
    ),
    "new with an actuator": Mode(
        "new",
        ("OUT/rig.toml", *KNOWN, "--actuator", "sa050510", "--voltage", "40V"),
        {"--actuator": "sa030318", "--voltage": "50V"},
    ),
    "identify decay-length": Mode(
        "identify decay-length",
        (SWITCHES, "--free-frequency", "40Hz", "--modal-mass", "8kg"),
        {
            "--free-frequency": ("40Hz", "60Hz"),
            "--modal-mass": ("8kg", "6kg"),
            "--vibration": "2um",
            "--frequency": "21kHz",
            "--sliding-speed": "50mm/s",
            "--load": "4N",
            "--large-amplitude": "3um",
            "--rotation-speed": "0.5 1/s",
            "--mapping": "FOLDER/halved.toml",
            "--seed": "1",
        },
    ),
    "friction": Mode(
        "friction",
        (RIG,),
        VIBRATED | {"--model": "kinematic", "--evidence": "FOLDER/posterior.json"},
        ("--no-interval",),
    ),
    "wear": Mode("wear", (RIG,), VIBRATED),
    "simulate": Mode("simulate", (RIG,), VIBRATED),
    "response": Mode("response", (RIG,), {"--from": "30kHz", "--to": "20kHz", **LOADED}),
    "response along the voltage": Mode(
        "response",
        (RIG, "--curve", "voltage"),
        {"--curve": "frequency", "--from-voltage": "2V", "--to-voltage": "20V", **LOADED},
    ),
    "transient": Mode(
        "transient", (RIG, "--duration", "0.02s"), {"--duration": "0.03s", "--amplitude": "computed", **LOADED}
    ),
    "thermal": Mode(
        "thermal",
        (RIG, "--pin", "stainless_steel_316", "--disc", "aluminium_2024"),
        {
            "--pin": "m50",
            "--disc": "m50",
            "--duration": "70s",
            "--heat-capacity": "2J/K",
            "--conductance": "0.1W/K",
            "--dry": "10s",
            "--vibration-heat": "1W,2W",
            "--friction-ratio": "0.9",
            "--flash-model": "tian_kennedy_1994",
            "--amplitude": "per-volt",
            "--set": "contact.normal_load=2N",
            "--load": "2N",
        },
    ),
    "regime": Mode(
        "regime",
        (RIG, "--film-coefficient", "0.1", "--asperity-pressure", "10MPa"),
        {
            "--film-coefficient": "0.2",
            "--asperity-pressure": "2MPa",
            "--smallest-gain": "0.9",
            "--pin": "m50",
            "--disc": "m50",
            "--amplitude": "per-volt",
            "--set": "contact.normal_load=2N",
            "--load": "2N",
        },
    ),
    "regime with wear": Mode(
        "regime",
        (RIG, "--film-coefficient", "0.1", "--asperity-pressure", "10MPa", "--pin", "m50", "--disc", "m50"),
        {"--pin": "aluminium_2024", "--disc": "aluminium_2024"},
    ),
    "regime by viscosity": Mode(
        "regime", (RIG, "--viscosity", "1 Pa s"), {"--viscosity": "10 Pa s", "--inlet-ratio": "4"}
    ),
    "regime of a ball": Mode(
        "regime",
        (RIG, "--viscosity", "1 Pa s", "--tip-radius", "5mm"),
        {"--tip-radius": "50mm", "--pressure-viscosity": "4e-8 /Pa"},
    ),
    "modes of a part": Mode(
        "modes",
        ("block", *SIZES, "--count", "1", "--tolerance", "0.5"),
        {
            "--set": ("thickness=5mm", "thickness=6mm"),
            "--material": "aluminium_2024",
            "--young-modulus": "70GPa",
            "--poisson-ratio": "0.4",
            "--density": "2700kg/m3",
            "--count": "2",
            "--clamp": "-x",
            "--axis": "y",
            "--tolerance": "0.0005",
            "--points": "FOLDER/points.csv",
            "--toward": "y",
        },
        ("--vtu", "--animate"),
    ),
    "modes at points": Mode(
        "modes",
        ("block", *SIZES, "--count", "1", "--tolerance", "0.5", "--points", "FOLDER/points.csv"),
        {"--toward": "y"},
    ),
    "modes of a transducer": Mode(
        "modes", ("stack", "--count", "1", "--tolerance", "0.5"), {"--material": "aluminium_2024"}
    ),
    "modes for a rig": Mode(
        "modes",
        (
            "stack",
            "--count",
            "1",
            "--tolerance",
            "0.5",
            "--contact",
            "tip",
            "--body-mass",
            "1kg",
            "--body-stiffness",
            "100N/m",
        ),
        {"--contact": "back", "--body-mass": "2kg", "--body-stiffness": "200N/m", "--body-damping": "2N*s/m"},
    ),
    "modes of another program": Mode(
        "modes",
        ("--from", "FOLDER/bar.unv", *FOREIGN, "--length-unit", "mm", "--force-unit", "N"),
        {
            "--from": ("FOLDER/bar.unv", "FOLDER/lighter.unv"),
            "--tip": "20,0,0mm",
            "--direction": ("+x", "-x"),
            "--port": "2",
            "--force-per-volt": ("12N/V", "13N/V"),
            "--clamped-capacitance": ("4nF", "5nF"),
            "--quality-factor": ("500", "600"),
            "--modal-mass": ("1kg", "2kg"),
            "--length-unit": ("mm", "cm"),
            "--force-unit": ("N", "kN"),
            "--body-mass": "2kg",
        },
    ),
    "modes of another program with a static analysis": Mode(
        "modes",
        (
            *("--from", "FOLDER/bar.unv", *FOREIGN, "--length-unit", "mm", "--force-unit", "N"),
            *("--static-compliance", "1e-6m/N", "--displacement-per-volt", "-10nm/V"),
        ),
        {"--static-compliance": "2e-6m/N", "--displacement-per-volt": "-20nm/V"},
    ),
    "impedance of a part": Mode(
        "impedance compute",
        ("block", *BAR, "--points", "5", "--tolerance", "0.9", "--to", "120kHz"),
        {
            "--set": ("thickness=20mm", "thickness=18mm"),
            "--from": "2kHz",
            "--to": "200kHz",
            "--points": "6",
            "--clamp": "-z",
            "--ceramic": "pzt4",
            "--poled": "x",
            "--drive": "+x",
            "--ground": "-x",
            "--measured": "FOLDER/spectrum.csv",
            "--tolerance": "0.0001",
        },
        ("--vtu",),
    ),
    "impedance of a transducer": Mode(
        "impedance compute",
        ("stack", "--points", "5", "--tolerance", "0.9", "--to", "200kHz"),
        {"--ceramic": "pzt4", "--poled": "x", "--drive": "+x", "--ground": "-x"},
    ),
    "stress of a transducer": Mode(
        "impedance compute",
        ("stack", *BOLTED, "--points", "5", "--tolerance", "0.9", "--amplitude", "5um", "--torque", "20N*m"),
        {"--amplitude": ("5um", "6um"), "--torque": ("20N*m", "25N*m"), "--nut-factor": "0.18", "--preload": "20kN"},
    ),
    "sweep on a grid": Mode(
        "sweep",
        (RIG, *OVER),
        SWEEP | POSTERIOR | {"--over": (OVER[1], "sliding.sliding_speed=20mm/s,60mm/s"), "--from": "1V"},
    ),
    "sweep of a list": Mode(
        "sweep", (RIG, *OVER, "--sample", "list"), SWEEP | {"--over": "contact.normal_load=2N,3N", "--to": "1V"}
    ),
    "sweep of points drawn": Mode(
        "sweep",
        (RIG, "--over", "sliding.sliding_speed=20mm/s:50mm/s", "--sample", "lhs", "--points", "4"),
        SWEEP
        | {"--over": "contact.normal_load=2N:3N", "--points": "5", "--sample": "grid", "--from": "1V", "--to": "1V"},
    ),
    "sweep at an address": Mode("sweep", (RIG, *OVER, "--scheduler", "tcp://nowhere:1"), {"--workers": "1"}),
    "sweep of another rig": Mode("sweep", (RIG, "--over", "contact.roughness.rms_height=1um,2um"), POSTERIOR),
    "sweep of a swept key": Mode("sweep", (RIG, *OVER), {"--set": "sliding.sliding_speed=30mm/s"}),
    "sweep of voltage": Mode(
        "sweep", (RIG, "--of", "voltage", "--points", "3"), SWEEP | {"--from": "5V", "--to": "20V"}
    ),
    "sweep of speed": Mode(
        "sweep", (RIG, "--of", "speed", "--points", "3"), SWEEP | POSTERIOR | {"--from": "5mm/s", "--to": "50mm/s"}
    ),
    "sweep of frequency": Mode(
        "sweep", (RIG, "--of", "frequency", "--points", "3"), SWEEP | {"--from": "5kHz", "--to": "21kHz"}
    ),
    "sweep of power": Mode(
        "sweep", (RIG, "--of", "power", "--points", "3"), SWEEP | {"--from": "22kHz", "--to": "30kHz"}
    ),
    "sweep of waveforms": Mode(
        "sweep", (RIG, "--of", "waveform"), SWEEP | {"--of": "load", "--from": "5V", "--to": "20V"}
    ),
    "sweep of amplitude": Mode(
        "sweep",
        (FLAT, "--of", "amplitude", "--points", "3"),
        {"--of": "load", "--from": "2um", "--to": "8um", "--points": "4", "--vibration": "3um", "--voltage": "3V"},
    ),
    "sweep beside own runs": Mode("sweep", (RIG, *OVER, "--runs", OWN_RUNS), {"--mapping": "FOLDER/halved.toml"}),
    "study beside own runs": Mode(
        "sweep", (RIG, "--of", "speed", "--points", "3", "--runs", OWN_RUNS), {"--mapping": "FOLDER/halved.toml"}
    ),
    "sweep of speed at amplitudes": Mode(
        "sweep", (FLAT, "--of", "speed", "--points", "3"), {"--vibration": "30um", "--to": "0.5m/s"}
    ),
    "sweep of load": Mode("sweep", (RIG, "--of", "load", "--points", "3"), STUDY | {"--from": "2N", "--to": "5N"}),
    "fit": Mode(
        "fit",
        (OWN_RUNS, "--rig", RIG, "--model", "asperity-stick-slip-fitted"),
        {
            "--rig": str(RIGS / "tribometer_uncertain.toml"),
            "--mapping": "FOLDER/halved.toml",
            "--model": "kinematic",
            "--amplitude": "computed",
            "--set": "contact.roughness.rms_height=3um",
            "--load": "2N",
        },
    ),
    "map": Mode(
        "map",
        (str(RIGS / "power_map.toml"), *MAP),
        {
            "--over": "contact.normal_load=3N",
            "--runs": RUNS,
            "--mapping": "FOLDER/reduced.toml",
            "--target-reduction": "60%",
            **POSTERIOR,
            "--form": "svg",
            "--load": "2N",
            "--amplitude": "per-volt",
            "--set": "contact.roughness.rms_height=1um",
        },
    ),
    "map of chances": Mode(
        "map",
        (str(RIGS / "power_map.toml"), *MAP, "--target-reduction", "60%"),
        {"--confidence": "40%", "--runs": RUNS, "--evidence": "FOLDER/posterior.json"},
    ),
    "map of a kind": Mode(
        "map",
        (str(RIGS / "power_map.toml"), "--over", "drive.voltage_peak_to_peak=5V,10V"),
        {"--kind": "frequency-voltage"},
    ),
    "map over amplitude": Mode(
        "map",
        (FLAT, "--over", "vibration.vibration_amplitude=20um,40um", "--over", "sliding.sliding_speed=10mm/s,20mm/s"),
        {"--kind": "velocity-stress", "--over": "contact.normal_load=10N"},
    ),
    "uncertainty": Mode(
        "uncertainty",
        (str(RIGS / "tribometer_uncertain.toml"), "--samples", "32"),
        {
            "--of": "vibration_amplitude",
            "--samples": "64",
            "--over": "sliding.sliding_speed=20mm/s,50mm/s",
            "--seed": "1",
            "--workers": "1",
            "--keep": "OUT/keep",
            "--evidence": "FOLDER/posterior.json",
            **VIBRATED,
        },
        ("--sobol", "--no-interval"),
    ),
    "optimise": Mode(
        "optimise",
        (RIG, "--target-friction", "0.15"),
        {
            "--target-friction": "0.2",
            "--target-reduction": "50%",
            "--confidence": "50%",
            "--runs": RUNS,
            "--mapping": "FOLDER/reduced.toml",
            "--evidence": "FOLDER/posterior.json",
            "--over": "structure.tip_mass=80g:120g",
            "--actuator": "catalogue",
            "--catalogue": "FOLDER/catalogue.toml",
            "--minimise": "voltage",
            "--pareto": "voltage",
            "--robust": "0.02",
            "--quantile": "0.9",
            "--samples": "8",
            "--voltage-limit": "100V",
            "--current-limit": "10A",
            "--slew-limit": "10V/us",
            "--stress-limit": "100MPa",
            "--temperature-limit": "1K",
            "--conductance": "1W/K",
            "--horn": "titanium_6al4v",
            "--horn-limit": "1MPa",
            "--bolt": "M6x40mm",
            "--preload": "1kN",
            "--bolt-strength": "800MPa",
            "--quality": "200",
            "--source-resistance": "50ohm",
            "--set": "sliding.sliding_speed=30mm/s",
            "--load": "2N",
        },
    ),
    "optimise masses": Mode(
        "optimise",
        (RIG, "--target-friction", "0.15", "--samples", "2", "--over", "structure.tip_mass=80g:120g"),
        {"--samples": "4"},
    ),
    "optimise for power twice": Mode("optimise", (RIG, "--target-friction", "0.15"), {"--pareto": "power"}),
    "control": Mode(
        "control",
        (RIG, "--duration", "0.05s"),
        {
            "--friction": "0.6N",
            "--feed-forward": "none",
            "--efficiency": "1e-9m2/N",
            "--delay": "2ms",
            "--rate": "4kHz",
            "--noise": "0.01N",
            "--factor": "1.1",
            "--disturbance": "20%",
            "--closed-loop": "5ms",
            "--voltage-limit": "20V",
            "--current-limit": "4A",
            "--slew-limit": "1V/us",
            "--warming": "40K",
            "--warming-time": "0.01s",
            "--quality": "100",
            "--coupling": "0.3",
            "--duration": "0.06s",
            "--tuned-for": "worst",
            **POSTERIOR,
            **MEASURED,
            **VIBRATED,
        },
        ("--no-track", "--stick-slip"),
    ),
    "control beside own runs": Mode(
        "control", (RIG, "--duration", "0.05s", "--runs", OWN_RUNS), {"--mapping": "FOLDER/halved.toml"}
    ),
    "control in the warm": Mode(
        "control", (RIG, "--duration", "0.05s", "--warming", "40K"), {"--warming-time": "0.01s"}, ("--no-track",)
    ),
    "control by the amplitude": Mode(
        "control", (FLAT, "--duration", "0.05s"), {"--amplitude-limit": "20um", "--quality": "100", "--warming": "40K"}
    ),
    "control by the efficiency": Mode(
        "control", (RIG, "--duration", "0.05s", "--feed-forward", "efficiency"), {"--efficiency": "1e-9m2/N"}
    ),
    "control of a device without structure": Mode(
        "control", (COLLAR, "--duration", "0.05s"), {"--quality": "100", "--coupling": "0.3"}
    ),
    "export of units": Mode(
        "export fmu",
        (COLLAR,),
        {
            "--fmi": "2",
            "--over": "sliding.sliding_speed=40mm/s:60mm/s",
            "--delay": "2ms",
            "--rate": "2kHz",
            "--closed-loop": "5ms",
            "--pin": "steel_1045",
            "--quality": "100",
            "--heat-capacity": "3J/K",
        }
        | LOADED
        | {"--amplitude": "waveguide"},
    ),
    "export of units of a driven rig": Mode(
        "export fmu",
        (RIG, *("--over", "contact.normal_load=2.99N:3.01N", "--over", "drive.voltage_peak_to_peak=0V:9V")),
        flags=("--no-track",),
    ),
    "export of units with heat": Mode(
        "export fmu",
        (COLLAR, "--pin", "aluminium_2024", "--disc", "stainless_steel_316"),
        {
            "--pin": "stainless_steel_316",
            "--disc": "aluminium_2024",
            "--heat-capacity": "3J/K",
            "--conductance": "0.1W/K",
        },
    ),
    "export of units without structure": Mode(
        "export fmu", (str(RIGS / "flextensional.toml"),), {"--quality": "100", "--coupling": "0.3"}
    ),
    "efficiency": Mode(
        "efficiency",
        (RUNS, "--rig", str(RIGS / "power_map.toml")),
        {
            "--rig": RIG,
            "--mapping": "FOLDER/reduced.toml",
            "--target-friction": "0.5N",
            "--speed": "40mm/s",
            "--level": "0.9",
            "--set": "contact.nominal_area=1mm2",
        },
    ),
    "efficiency for a target": Mode(
        "efficiency", (RUNS, "--rig", str(RIGS / "power_map.toml"), "--target-friction", "0.8N"), {"--speed": "50mm/s"}
    ),
    "horn face": Mode(
        "horn face", ("aluminium",), {"--frequency": "20.5kHz", "--amplitude": "5um", "--sliding-speed": "20mm/s"}
    ),
    "horn": Mode(
        "horn design",
        ("conical_horn", "--frequency", "20kHz", "--material", "titanium_6al4v", "--tolerance", "0.3"),
        {
            "--frequency": "20.5kHz",
            "--material": "aluminium_2024",
            "--gain": "2",
            "--amplitude": "20um",
            "--set": "radius=19mm",
            "--mode": "axial 2",
            "--axis": "x",
            "--tool-mass": "50g",
            "--tolerance": "-1",
        },
    ),
    "horn of even thickness": Mode(
        "horn design",
        (
            "cylinder",
            "--set",
            "radius=10mm",
            "--frequency",
            "40kHz",
            "--material",
            "titanium_6al4v",
            "--tolerance",
            "0.3",
        ),
        {"--tune": "radius"},
    ),
    "friction of recordings": Mode(
        "measure friction",
        ("FOLDER/friction.csv",),
        {
            "--mapping": "FOLDER/friction.toml",
            "--without-vibration": "FOLDER/other.csv",
            "--sliding-speed": "20mm/s",
            "--load": "5N",
            "--load-uncertainty": "0.1N",
            "--zero-uncertainty": "5mN",
            "--window": "1s",
            "--rotation-speed": "1/s",
            "--torque-constant": "0.5 N m/A",
            "--idle-current": "0.1A",
            "--groove-diameter": "50mm",
            "--group": "run",
            "--channel": "friction",
            "--section": "2",
            "--part": "1s:9s",
        }
        | SHEETS,
    ),
    "friction of stated parts": Mode(
        "measure friction", ("FOLDER/friction.csv",), {"--rest": "0s:1s", "--step": "1s:5s=10V"}
    ),
    "table of own runs": Mode(
        "runs",
        (OWN_RUNS, "--add", "FOLDER/friction.csv", "--leave-out", "2"),
        {
            **{"--add": RUNS, "--leave-out": "3", "--use": "2", "--remove": "1", "--load": "2N", "--speed": "30mm/s"},
            **{"--voltage": "20V", "--vibration": "2um", "--frequency": "21kHz"},
        },
    ),
    "table of own runs by a mapping": Mode("runs", (OWN_RUNS,), {"--mapping": "FOLDER/halved.toml"}),
    "friction of a test in several files": Mode(
        "measure friction", ("FOLDER/friction.csv", "FOLDER/other.csv"), flags=("--join",)
    ),
    "rotation": Mode(
        "measure rotation",
        ("FOLDER/hall.csv", "--groove-diameter", "50mm"),
        {"--groove-diameter": "40mm", "--magnets": "2", "--prominence": "0.9", "--mapping": "FOLDER/hall.toml"}
        | SHEETS,
    ),
    "temperature": Mode(
        "measure temperature",
        ("FOLDER/warm.csv",),
        {
            "--start-time": "3s",
            "--end-time": "15s",
            "--exponentials": "2",
            "--without-vibration": "FOLDER/cool.csv",
            "--mapping": "FOLDER/warm.toml",
        }
        | SHEETS,
    ),
    "calibration": Mode(
        "measure calibration",
        ("FOLDER/gauge.csv",),
        {
            "--apply": "FOLDER/applied.csv",
            "--mapping": "FOLDER/gauge.toml",
            "--degree": "1",
            "--levels": "8",
            "--displacement-uncertainty": "1um",
        }
        | SHEETS,
    ),
    "calibration applied": Mode(
        "measure calibration",
        ("FOLDER/gauge.csv", "--apply", "FOLDER/applied.csv"),
        {"--displacement-uncertainty": "1um"},
    ),
    "surface": Mode(
        "measure surface",
        ("FOLDER/plate.npy", "--spacing", "1um"),
        {"--spacing": "2um", "--length-unit": "um", "--form": "2", "--short-cutoff": "5um", "--long-cutoff": "20um"}
        | SHEETS,
        ("--robust",),
    ),
    "groove": Mode(
        "measure groove",
        ("FOLDER/groove.npy", "--spacing", "1um"),
        {
            "--groove-diameter": "50mm",
            "--sliding-distance": "10m",
            "--without-vibration": "FOLDER/groove.npy",
            "--tip-radius": "3mm",
            "--pin": "FOLDER/plate.npy",
            "--track": "2",
            "--spacing": "2um",
            "--length-unit": "mm",
        }
        | SHEETS,
    ),
    "ring": Mode(
        "measure groove",
        ("FOLDER/ring", "--spacing", "1um", "--groove-diameter", "50mm", "--sliding-distance", "10m"),
        {"--without-vibration": "FOLDER/deeper", "--tip-radius": "3mm", "--sliding-distance": "20m"},
    ),
    "impedance of a file": Mode(
        "measure impedance",
        ("FOLDER/spectrum.csv",),
        {
            "--branches": "2",
            "--residual": "linear-magnitude",
            "--series-resistance": "3ohm",
            "--circuit": "leads",
            "--sweep": "memory",
            "--stack-of": RIG,
        }
        | SHEETS,
    ),
    "impedance of a stack": Mode(
        "measure impedance",
        ("FOLDER/spectrum.csv", "--stack-of", RIG),
        {"--branches": "2", "--series-resistance": "3ohm", "--circuit": "loss"},
    ),
    "vibration": Mode(
        "measure vibration",
        ("FOLDER/tip.csv", "--frequency", "1kHz"),
        {"--frequency": "1.1kHz", "--modes": "FOLDER/shapes.csv", "--mapping": "FOLDER/tip.toml"} | SHEETS,
    ),
    "stiffness of a contact": Mode(
        "measure stiffness",
        ("FOLDER/free.csv", "FOLDER/pressed.csv", "--rig", RIG, "--mode-near", "154Hz"),
        {
            "--rig": COLLAR,
            "--load": "2N",
            "--set": "contact.normal_load=2N",
            "--mode-near": "0Hz",
            "--pressed-near": "128Hz",
            "--modal-mass": "5kg",
            "--mass-uncertainty": "20%",
            "--large": "FOLDER/large.csv",
            "--amplitude": "2.5um",
            "--amplitude-uncertainty": "10%",
        },
    ),
    "stiffness by the ratio of shifts": Mode(
        "measure stiffness",
        (
            *("FOLDER/free.csv", "FOLDER/pressed.csv", "--rig", RIG, "--mode-near", "154Hz"),
            *("--large", "FOLDER/large.csv", "--amplitude", "2.5um"),
        ),
        {"--large": "FOLDER/pressed.csv", "--amplitude": "3um", "--amplitude-uncertainty": "10%"},
    ),
    "compare": Mode(
        "compare",
        (RIG, "--model", "kinematic"),
        {
            "--model": "asperity-stick-slip",
            "--runs": OWN_RUNS,
            "--mapping": "FOLDER/halved.toml",
            "--set": "sliding.sliding_speed=50mm/s",
            "--load": "2N",
        }
        | AMPLITUDE,
    ),
    "compare without a rig": Mode("compare", ("--model", "kinematic"), VIBRATED),
    "lab run": Mode(
        "lab run",
        ("FOLDER/short.toml", "--rig", str(RIGS / "power_map.toml")),
        {"--rig": RIG, "--device": "FOLDER/devices.toml", "--seed": "1", "--tag": "mine", **POSTERIOR},
        ("--real-time", "--dry-run", "--yes"),
    ),
    "lab virtual": Mode(
        "lab virtual",
        (str(RIGS / "power_map.toml"), "--protocol", "FOLDER/short.toml"),
        {
            "--protocol": "FOLDER/shorter.toml",
            "--evidence": "FOLDER/posterior.json",
            "--seed": "1",
            "--format": "csv",
            **LOADED,
        },
        ("--dry-run",),
    ),
    "lab virtual with a map": Mode(
        "lab virtual",
        (
            *(str(RIGS / "power_map.toml"), "--protocol", "FOLDER/short.toml"),
            *("--device", str(ROOT / "examples" / "lab" / "siglent_sdg.toml")),
        ),
        {"--device": str(ROOT / "examples" / "lab" / "several_clocks.toml"), "--fault": "friction_reversed"},
    ),
    "lab virtual with a drive": Mode("lab virtual", (str(RIGS / "power_map.toml"),), AMPLITUDE),
    "lab hold": Mode(
        "lab hold",
        (str(RIGS / "power_map.toml"), "--duration", "1s", "--run-in", "0.1s"),
        {
            "--friction": "0.9N",
            "--step-to": "40mm/s",
            "--step-at": "0.3s",
            "--delay": "60ms",
            "--rate": "25Hz",
            "--closed-loop": "0.2s",
            "--voltage-limit": "20V",
            "--temperature-limit": "294K",
            "--friction-limit": "0.5N",
            "--quality": "20",
            "--coupling": "0.3",
            "--run-in": "0.2s",
            "--duration": "1.2s",
            "--device": "FOLDER/devices.toml",
            "--seed": "1",
            "--tag": "mine",
            **POSTERIOR,
            **VIBRATED,
        },
        ("--real-time",),
    ),
    "lab watch": Mode("lab watch", ("FOLDER/runs/first",), {}, ("--once",)),
    "lab runs": Mode(
        "lab runs",
        ("FOLDER/runs",),
        {
            "--material": "m50",
            "--load": "6N..",
            "--speed": "1m/s",
            "--since": "2100-01-01",
            "--until": "2000-01-01",
            "--tag": "map",
            "--text": "first",
            "--outcome": "stopped",
            "--fact": "normal_load=3",
        },
    ),
    "lab runs taken in": Mode(
        "lab runs",
        ("OUT/runs", "--add", "FOLDER/friction.csv"),
        {"--add": "FOLDER/other.csv", "--fact": "normal_load=3"},
    ),
    "lab export": Mode("lab export", ("FOLDER/runs/first",), {"--format": "csv"}),
    "lab check": Mode(
        "lab check", (str(ROOT / "examples" / "lab" / "devices.toml"),), {"--protocol": "map_test"}, ("--connect",)
    ),
    "mapping": Mode("mapping", (OWN_RUNS,), {"--column": "friction_force [N]=-", "--decimal-sign": ","}),
    "mapping of an export": Mode("mapping", ("FOLDER/bridge.csv",), {"--instrument": "bridge"}),
    "evidence list": Mode("evidence list", ()),
    "evidence check": Mode("evidence check", (OWN_TESTS,)),
    "evidence plot": Mode("evidence plot", (OWN_TESTS,)),
    "literature": Mode("literature", (RIG,), VIBRATED | {"--table": "FOLDER/studies.csv"}),
    "literature with a table": Mode(
        "literature", ("--table", "FOLDER/studies.csv"), {"--mapping": "FOLDER/reduced.toml"}
    ),
    "literature without a rig": Mode("literature", (), VIBRATED),
}


def _write_posterior(path: Path) -> None:
    """Write a posterior whose decay lengths are twice those of the shipped one."""
    found = learned().friction.hyperparameters.copy()
    found[:, 1] += np.log(2)
    source = LearnedSource(title="Own", citation="Own 2026", opened="full text", points=3, shipped=False)
    EvidencePosterior(hyperparameters=found, fingerprint="1", shipped_fingerprint="2", sources=(source,)).write(path)


def write_inputs(place: Path) -> None:
    """Write files of every kind that commands measure or read."""
    rng = np.random.default_rng(0)
    time = np.arange(0, 20, 0.01)
    force = 0.4 + 0.02 * np.sin(2 * np.pi * time) + 0.01 * rng.standard_normal(time.size)
    _write_posterior(place / "posterior.json")
    (place / "studies.csv").write_text("study,sliding_speed [mm/s],friction_reduction [%],source\nOwn,50,40,page 3\n")
    _table(place / "friction.csv", "time (s),friction_force (N)", time, force)
    _table(place / "bridge.csv", "time (s),friction_force (uN)", time, 1e6 * force)
    _table(place / "other.csv", "time (s),friction_force (N)", time, 2 * force)
    pulse = np.exp(-(((0.8 * time % 1 - 0.5) / 0.03) ** 2)) + 0.4 * np.exp(-(((0.8 * time % 1 - 0.1) / 0.03) ** 2))
    _table(place / "hall.csv", "time (s),magnetic_flux_density (mT)", time, pulse)
    warm = 300 - 20 * np.exp(-time / 5) + 0.1 * rng.standard_normal(time.size)
    _table(place / "warm.csv", "time (s),temperature (K)", time, warm)
    _table(place / "cool.csv", "time (s),temperature (K)", time, 280 + 0.01 * time)
    loop = 1e-5 * (1 - np.cos(2 * np.pi * time / 20))
    load = 1e5 * loop + 0.05 * np.sin(2 * np.pi * time / 20) + 0.001 * rng.standard_normal(time.size)
    _table(place / "gauge.csv", "time (s),displacement (m),applied_force (N)", time, loop, load)
    _table(place / "applied.csv", "time (s),displacement (m)", time, 0.5 * loop)
    fast = np.arange(0, 0.2, 5e-5)
    tips = [np.sin(2 * np.pi * 1000 * fast + phase) for phase in (0.0, 0.3)]
    _table(place / "tip.csv", "time (s),left (um),right (um)", fast, *tips)
    for name, quantity, gain in (
        ("friction", "friction_force", 2.0),
        ("hall", "magnetic_flux_density", 1.0),
        ("gauge", "applied_force", 2.0),
        ("warm", "temperature", 2.0),
        ("tip", "displacement", 2.0),
    ):
        column = {
            "friction": "friction_force (N)",
            "hall": "magnetic_flux_density (mT)",
            "gauge": "applied_force (N)",
            "warm": "temperature (K)",
        }
        unit = {"friction": "N", "hall": "mT", "gauge": "N", "warm": "K", "tip": "um"}[name]
        more = '[channels.displacement]\ncolumn = "displacement (m)"\nunit = "m"\n' if name == "gauge" else ""
        (place / f"{name}.toml").write_text(
            f'[axis]\ncolumn = "time (s)"\nunit = "s"\ngain = 2.0\n{more}[channels.{quantity}]\n'
            f'column = "{column.get(name, "left (um)")}"\nunit = "{unit}"\ngain = {gain}\n'
        )
    for name, heading, gain in (("halved", "friction_force [N]", 0.5), ("reduced", "friction_reduction [%]", 0.9)):
        quantity, unit = heading.strip("]").split(" [")
        lines = f"[channels.{quantity}]", f'column = "{heading}"', f'unit = "{unit}"', f"gain = {gain}"
        (place / f"{name}.toml").write_text("\n".join(lines))
    for name, outcome in (("first", "completed"), ("second", "stopped")):
        facts: dict[str, str | float] = {
            "pin_material": "brass",
            "normal_load": 5.0,
            "sliding_speed": 0.02,
            "tags": name,
        }
        recorder = new_run(place / "runs", title=name, protocol="", facts=facts)
        recorder.begin([Channel(name="friction_force", quantity="friction_force")], sample_rate=100.0)
        recorder.append(Block(first_sample=0, sample_rate=100.0, values=force[:, np.newaxis]))
        recorder.finish(outcome).folder.rename(place / "runs" / name)
    for name, duration in (("short", "1 s"), ("shorter", "0.7 s")):
        (place / f"{name}.toml").write_text(_SHORT_PROTOCOL.format(duration=duration))
    (place / "points.csv").write_text("0,0,0\n5,1,0\n")
    (place / "shapes.csv").write_text("1,0\n0.5,1\n")
    (place / "sheet.toml").write_bytes((ROOT / "examples" / "test-sheet.toml").read_bytes())
    f = np.linspace(15e3, 30e3, 400)
    w = 2 * np.pi * f
    z = 1 / (1j * w * 1e-8 + 1 / (20 + 1j * w * 0.1 + 1 / (1j * w * 6e-10))) + 0.01 * rng.standard_normal(f.size)
    _table(place / "spectrum.csv", "frequency (Hz),|Z| (ohm),phase (deg)", f, np.abs(z), np.degrees(np.angle(z)))
    hertz = np.linspace(70, 400, 166)
    for name, spring in (("free", 0.0), ("pressed", 4.286e6), ("large", 2.03e6)):
        v = virtual_contact.velocity(virtual_contact.TRIBOMETER, hertz, spring=spring)
        v = virtual_contact.noisy(rng, v, 1e-3)
        heads = "frequency (Hz),velocity (m/s),phase (deg)"
        _table(place / f"{name}.csv", heads, hertz, np.abs(v), np.degrees(np.angle(v)))
    x = np.arange(96.0)
    plate = 1e-6 * (np.sin(x / 3)[:, np.newaxis] + np.cos(x / 7) + 0.3 * rng.standard_normal((96, 96)))
    np.save(place / "plate.npy", plate - 1e-9 * (x - 48) ** 2)
    header = "Channel: Height\nWidth: 96 um\nHeight: 96 um\nValue units: m"
    np.savetxt(place / "plate.asc", plate, header=header)
    valley = -4e-5 * np.clip(1 - ((x - 48) / 12) ** 2, 0, None) + 1e-7 * rng.standard_normal((96, 96))
    np.save(place / "groove.npy", valley)
    for name, depth in (("ring", 1.0), ("deeper", 2.0)):
        (place / name).mkdir()
        for scan in range(3):
            np.save(place / name / f"{scan}.npy", depth * (1 + 0.1 * scan) * valley)
    bar = np.array([[0.0, 0, 0], [10, 0, 0], [20, 0, 0]])
    shape = np.array([[[1.0, 0, 0], [0, 0, 0], [-1, 0.1, 0]], [[1.0, 0, 0], [-1, 0, 0], [1, 0, 0.2]]])
    for name, mass in (("bar", 2e-3), ("lighter", 1e-3)):
        write_universal_file(
            place / f"{name}.unv", frequency=[2e4, 4e4], position=bar, shape=shape, mass=[mass, 0], damping=[1e-3, 0]
        )
    (place / "catalogue.toml").write_text(
        '[mine]\ntitle = "T"\nkind = "stack"\nsource = "own"\nstroke = 2e-5\n'
        "stroke_voltage = 100.0\nblocked_force = 800.0\n"
        "free_capacitance = 1e-6\nresonance_frequency = 4e4\nlowest_voltage = -20.0\nhighest_voltage = 130.0\n"
    )


def _table(path: Path, heads: str, *columns: "np.ndarray[Any, np.dtype[np.float64]]") -> None:
    np.savetxt(path, np.stack(columns, 1), delimiter=",", header=heads, comments="", fmt="%.9g")
