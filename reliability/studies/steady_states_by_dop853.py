r"""Steady states of random rigs against their equations of motion, integrated by DOP853.

The equations stand here: masses, springs, dampers, stack and contact are put together from the numbers of the rig's
file, and nothing of `sonolube.models.dynamics` is imported. A periodic motion is taken to its coordinates by the linear
response to its own contact force; the state at phase zero is then integrated over one period, and so are small
disturbances.
"""

from collections import Counter
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from reliability.study import Measure, Record, Study
from sonolube.rig import operating_points, point_batch, rig_content, rig_from, steady_states

Array = NDArray[np.float64]
_BASES = ("examples/rigs/tribometer.toml", "examples/rigs/power_map.toml")
_POINTS = 5  # of a trial, solved in one batch
_SAMPLES = 4096
_SAME = ("vibration_amplitude", "mean_displacement", "contact_loss_fraction", "friction_ratio", "dissipated_power")
_CLEAR = 1e-4  # Floquet exponent per period beyond which stability is beyond the error of either side


def _number(text: object) -> float:
    return float(str(text).split()[0])


def _chain(rng: np.random.Generator) -> dict[str, Any]:
    """A structure of two to five masses in a row from the tip on, the stack behind the tip."""
    names = [f"m{i}" for i in range(rng.integers(2, 6))]
    links = list(pairwise(names[1:]))
    held = [(names[-1], "ground")] if rng.random() < 0.5 else []
    return {
        "kind": "chain",
        "masses": {name: f"{rng.uniform(0.05, 2.5)!r} kg" for name in names},
        "springs": [
            {"between": list(pair), "spring_stiffness": f"{10 ** rng.uniform(4.5, 9)!r} N/m"} for pair in links + held
        ],
        "dampers": [
            {"between": list(pair), "viscous_damping": f"{10 ** rng.uniform(0, 3)!r} N s/m"}
            for pair in [*links, *held, (names[0], "ground")]
        ],
        "stack_between": names[:2],
        "contact": names[0],
    }


class _Equations:
    """M x'' + C x' + K x = b V(t) + c (F_N exp(-x_1/l) - F_N), positive away from the other surface."""

    def __init__(self, content: dict[str, Any], load: float, frequency: float, swing: float) -> None:
        structure, stack = content["structure"], content["stack"]
        if structure.get("kind", "pin_on_disc") == "chain":
            masses = {name: _number(mass) for name, mass in structure["masses"].items()}
            near, behind = structure["stack_between"]
            springs = [(*s["between"], _number(s["spring_stiffness"])) for s in structure["springs"]]
            dampers = [(*d["between"], _number(d["viscous_damping"])) for d in structure["dampers"]]
        else:
            masses = {name: _number(structure[f"{name}_mass"]) for name in ("tip", "reaction", "arm")}
            near, behind = "tip", "reaction"
            springs = [("reaction", "arm", _number(structure["arm_stiffness"]))]
            dampers = [
                ("reaction", "arm", _number(structure["arm_damping"])),
                ("tip", "ground", _number(structure["tip_damping"])),
            ]
        masses[behind] += _number(stack["stack_mass"])
        names, stiffness = list(masses), _number(stack["stack_stiffness"])
        springs.append((near, behind, stiffness))
        dampers.append((near, behind, _number(stack["stack_damping"])))
        self.mass = np.array(list(masses.values()))
        self.stiffness, self.damping = self._matrix(names, springs), self._matrix(names, dampers)
        stroke = _number(stack["free_stroke_per_volt"]) * 1e-9
        self.drive = stroke * stiffness * np.array([(name == behind) - (name == near) for name in names], dtype=float)
        self.tip = np.eye(len(names))[0]
        self.decay_length = _number(content["contact"]["roughness"]["rms_height"]) * 1e-6 / 3  # exp(-3 d/Rq), D 3.2
        self.load, self.omega, self.swing = load, 2 * np.pi * frequency, swing

    @staticmethod
    def _matrix(names: list[str], links: list[tuple[str, str, float]]) -> Array:
        matrix = np.zeros((len(names), len(names)))
        for one, other, value in links:
            along = np.array([(name == one) - (name == other) for name in names], dtype=float)
            matrix += value * np.outer(along, along)
        return matrix

    def dynamic_stiffness(self, order: int) -> NDArray[np.complex128]:
        w = order * self.omega
        return np.asarray(self.stiffness + 1j * w * self.damping - w * w * np.diag(self.mass))

    def free_amplitude(self) -> float:
        """Amplitude of the tip per volt without contact."""
        return float(abs(np.linalg.solve(self.dynamic_stiffness(1), self.drive)[0]))

    def highest_resonance(self) -> float:
        root = 1 / np.sqrt(self.mass)
        return float(np.sqrt(np.linalg.eigvalsh(root[:, np.newaxis] * self.stiffness * root)[-1]) / (2 * np.pi))

    def contact_force(self, x: Any) -> Any:
        return self.load * np.exp(-x / self.decay_length)

    def motion(self, mean: float, harmonics: NDArray[np.complex128]) -> tuple[Array, Array, Array, float]:
        """State at phase zero, contact displacement, velocities of all masses, mean electrical power."""
        n, count = self.mass.size, harmonics.size
        orders = np.arange(1, count + 1)
        wave = np.exp(2j * np.pi * np.multiply.outer(np.arange(_SAMPLES) / _SAMPLES, orders))
        contact = mean + (wave @ harmonics).real
        force = 2 * np.fft.fft(self.contact_force(contact))[1 : count + 1] / _SAMPLES
        volts = np.where(orders == 1, -1j * self.swing, 0.0)  # of a sine
        amplitudes = np.array(
            [
                np.linalg.solve(self.dynamic_stiffness(int(k)), self.drive * v + self.tip * f)
                for k, v, f in zip(orders, volts, force, strict=True)
            ]
        )
        static = np.vstack([self.stiffness, 1e12 * self.tip])
        mean_force = self.contact_force(contact).mean()
        applied = np.r_[self.tip * (mean_force - self.load), 1e12 * mean]
        rest = np.linalg.lstsq(static, applied, rcond=None)[0]
        rates = 1j * self.omega * orders[:, np.newaxis] * amplitudes
        power = 0.5 * (volts[0] * np.conj(rates[0] @ self.drive)).real  # V times the current b x'
        state = np.r_[rest + amplitudes.sum(axis=0).real, rates.sum(axis=0).real / self.omega]
        velocities = (wave @ rates).real
        return state, np.asarray((wave @ amplitudes[:, :1]).real[:, 0] + mean), velocities.reshape(-1, n), float(power)

    def rate(self, phase: float, flat: Array) -> Array:
        """Derivatives by phase of the state, and of unit disturbances of it, columns of one matrix."""
        n = self.mass.size
        z = flat.reshape(2 * n, -1)
        x, v, w = z[:n], z[n:], self.omega
        force = self.contact_force(x[0, 0])
        spring = np.zeros_like(x)
        spring[:, 0] = self.drive * self.swing * np.sin(phase) + self.tip * (force - self.load)
        spring[0, 1:] = -force / self.decay_length * x[0, 1:]
        acceleration = (spring - self.stiffness @ x - w * (self.damping @ v)) / self.mass[:, np.newaxis]
        return np.asarray(np.concatenate([v, acceleration / (w * w)]).reshape(-1))

    def integrated(self, state: Array) -> tuple[Array, Array, Array]:
        """State after a period, contact displacement at the samples, and Floquet multipliers."""
        start = np.concatenate([state[:, np.newaxis], np.eye(state.size)], axis=1)
        scale = np.abs(state).max()
        tolerance = np.concatenate([np.full((state.size, 1), 1e-12 * scale), np.full((state.size,) * 2, 1e-11)], axis=1)
        phases = 2 * np.pi * np.arange(0, _SAMPLES + 1, 16) / _SAMPLES
        found = solve_ivp(
            self.rate, (0, 2 * np.pi), start.reshape(-1), "DOP853", phases, rtol=1e-11, atol=tolerance.reshape(-1)
        )
        end = found.y[:, -1].reshape(start.shape)
        return end[:, 0], found.y[0], np.asarray(np.linalg.eigvals(end[:, 1:]))


def _drawn(content: dict[str, Any], rng: np.random.Generator) -> dict[str, Array]:
    """Drives and loads; half of them are hard ones, at which vibrations lose contact, coexist or are unstable."""
    hard = rng.random(_POINTS) < 0.5
    load = np.where(hard, rng.uniform(20, 100, _POINTS), rng.uniform(0.5, 20, _POINTS))
    resonance = _Equations(content, load=1.0, frequency=1.0, swing=1.0).highest_resonance()
    near = np.where(rng.random(_POINTS) < 0.7, rng.uniform(0.95, 1.2, _POINTS), 10 ** rng.uniform(-1, 0.3, _POINTS))
    frequency = np.where(hard, resonance * near, rng.uniform(1e4, 4e4, _POINTS))
    amplitude = np.where(hard, rng.uniform(2e-6, 1.5e-5, _POINTS), rng.uniform(0.2e-6, 6e-6, _POINTS))
    free = [_Equations(content, load=1.0, frequency=f, swing=1.0).free_amplitude() for f in frequency]
    return {"normal_load": load, "frequency": frequency, "voltage_peak_to_peak": 2 * amplitude / free}


def _trial(seed: int) -> Record:
    rng = np.random.default_rng(seed)
    content = rig_content(_BASES[seed % 2])
    if seed % 4 >= 2:
        content["structure"] = _chain(rng)
    else:
        content["structure"]["tip_damping"] = f"{10 ** rng.uniform(0, 3)!r} N s/m"
    content["drive"]["voltage_offset"] = "0 V"
    content["vibration"]["amplitude_source"] = "computed"
    points = _drawn(content, rng)
    load, frequency, voltage = points["normal_load"], points["frequency"], points["voltage_peak_to_peak"]
    rig = rig_from(content)
    batch = operating_points(rig, normal_load=load, frequency=frequency, voltage_peak_to_peak=voltage)
    rows = point_batch(rig, normal_load=load, frequency=frequency, voltage_peak_to_peak=voltage).numbers
    return {"points": [_checked(content, points, batch, rows, i) for i in range(_POINTS)]}


def _checked(
    content: dict[str, Any], points: dict[str, Array], batch: Any, rows: dict[str, Array], i: int
) -> dict[str, object]:
    """Status of one point, largest errors of its motion, and whether its numbers alone are those of the batch."""
    load, frequency, volts = (float(points[name][i]) for name in points)
    alone = operating_points(rig_from(content), normal_load=load, frequency=frequency, voltage_peak_to_peak=volts)
    other = [n for n in _SAME if not np.array_equal(getattr(batch, n)[i], getattr(alone, n), equal_nan=True)]
    row = point_batch(rig_from(content), normal_load=load, frequency=frequency, voltage_peak_to_peak=volts).numbers
    other += [n for n, values in rows.items() if not np.array_equal(values[i], row[n][0], equal_nan=True)]
    record: dict[str, object] = {"status": str(batch.status[i]), "differ": other}
    if batch.status[i] in ("refused", "not_converged"):
        return record
    own = {**content, "contact": {**content["contact"], "normal_load": f"{load!r} N"}}
    own["drive"] = {**content["drive"], "frequency": f"{frequency!r} Hz", "voltage_peak_to_peak": f"{volts!r} V"}
    states = steady_states(rig_from(own), relative_tolerance=1e-8)
    record["tolerance"] = 1e-8 if np.isfinite(states.mean_displacement[0]) else 1e-6
    if record["tolerance"] == 1e-6:  # 64 harmonics are too few for the closer one
        states = steady_states(rig_from(own))
    equations = _Equations(own, load, frequency, volts / 2)
    record["stable"] = not states.reason(0).startswith("unstable")
    start, contact, velocities, power = equations.motion(float(states.mean_displacement[0]), states.harmonics[0])
    end, marched, multipliers = equations.integrated(start)
    size = float(states.vibration_amplitude[0])
    in_dampers = np.einsum("ti,ij,tj->", velocities, equations.damping, velocities) / _SAMPLES
    exponent = float(np.log(np.abs(multipliers).max()))
    lost = float(np.mean(equations.contact_force(contact) < 0.01 * load))
    return record | {
        "return": float(np.abs(end - start).max() / np.abs(start).max()),
        "orbit": float(np.abs(marched - contact[np.arange(0, _SAMPLES + 1, 16) % _SAMPLES]).max() / size),
        "power": float(abs(states.dissipated_power[0] / power - 1)),
        "balance": float(abs(in_dampers / power - 1)),
        "loss": abs(lost - float(states.contact_loss_fraction[0])),
        "exponent": exponent,
        "loses_contact": lost > 0,
    }


def _measures(records: Sequence[Record]) -> list[Measure]:
    points: list[Any] = [point for record in records for point in record["points"]]  # type: ignore[attr-defined]
    solved = [p for p in points if "return" in p]
    kinds = Counter(p["status"] for p in points)
    hard = sum(not p["stable"] or p["status"] == "multistable" or p["loses_contact"] for p in solved)
    growth = [p for p in solved if abs(p["exponent"]) > _CLEAR]
    wrong = sum((p["exponent"] > 0) == p["stable"] for p in growth)
    least_hard = len(points) // 10

    close = [p for p in solved if p["tolerance"] == 1e-8]

    def most(name: str, bar: float, label: str) -> Measure:
        worst = max(p[name] for p in (close if name == "balance" else solved))
        return Measure(label=label, value=f"{worst:.1e}", bar=f"at most {bar:g}", holds=worst <= bar)

    return [
        Measure(label="points (status: number)", value=", ".join(f"{k}: {v}" for k, v in sorted(kinds.items()))),
        Measure(
            label="points that are unstable, multistable or lose contact",
            value=str(hard),
            bar=f"at least {least_hard}",
            holds=hard >= least_hard,
        ),
        most("orbit", 1e-5, "difference of the marched period from the periodic one, of the amplitude"),
        most("balance", 1e-6, f"electrical power less that in the dampers, at tolerance 1e-8 ({len(close)} points)"),
        most("power", 1e-6, "reported electrical power less that of the equations, of the latter"),
        most("loss", 2e-3, "difference of the fraction of the period without contact"),
        Measure(
            label=f"statuses that contradict the Floquet exponent, of {len(growth)} clear ones",
            value=str(wrong),
            bar="0",
            holds=wrong == 0,
        ),
        Measure(
            label="points whose numbers in a batch differ in any bit from those alone",
            value=str(sum(bool(p["differ"]) for p in points)),
            bar="0",
            holds=not any(p["differ"] for p in points),
        ),
    ]


STUDY = Study(
    title="Steady states against their equations of motion",
    question="Random rigs, drives and loads, half of them hard: does the periodic motion obey the equations of motion,"
    " written apart from the program and integrated by DOP853, and are stability, lost contact and power right?",
    sources=("models/dynamics/**/*.py", "rig/**/*.py", "models/contact/**/*.py", "models/friction/**/*.py"),
    trials=400,
    sample=4,
    trial=_trial,
    measures=_measures,
)
