"""A new friction model, asperity law or command takes one file and one line of its table, and works everywhere."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from pytest import approx

RIG = Path(__file__).parents[1] / "examples" / "rigs" / "tribometer.toml"

FRICTION_MODEL = '''
"""Friction ratio that does not depend on the motion."""

from dataclasses import dataclass
from typing import ClassVar, final

import numpy as np

from sonolube.models.friction.models.model import FrictionModel, parameter


@final
@dataclass(frozen=True, kw_only=True, slots=True)
class ConstantRatio(FrictionModel):
    """Friction ratio equal to a parameter over a reference of 1 kg/s."""

    name: ClassVar[str] = "constant_ratio"
    citation: ClassVar[str] = "Toy and Model 2026, eq. (7)"

    damping_reference: float = parameter(0.5, positive=True, unit="kg/s", meaning="Reference of the damping")

    def _ratios(self, contact, motion, v_r, mu):
        return np.full(v_r.shape, self.damping_reference)

    def batched_ratio(self, contact, motions, *, sliding_speed, motion, friction_coefficient, tolerance=1e-7):
        return np.full(sliding_speed.shape, self.damping_reference)
'''

ASPERITY_LAW = '''
"""Elastic asperity of twice the load of Hertz."""

from typing import ClassVar

from sonolube.models.contact.asperity import ElasticAsperity


class DoubledAsperity(ElasticAsperity):
    """Twice the load of an elastic sphere at every interference."""

    name: ClassVar[str] = "doubled"
    citation: ClassVar[str] = "Toy and Law 2026, eq. (8)"

    def force_ratio(self, pair, interference_ratio):
        return 2 * super().force_ratio(pair, interference_ratio)
'''

TASK = '''
"""Task `hello`: the circular frequency of a frequency."""

import math
from collections.abc import Sequence
from typing import Annotated

from sonolube.tasks.answer import Answer, answer
from sonolube.report.blocks import Block
from sonolube.tasks.parameters import Number, Parameter
from sonolube.tasks.task import in_si, task


@answer
class Circular(Answer):
    """Circular frequency of a frequency."""

    circular: float

    def blocks(self) -> Sequence[Block]:
        return [f"{self.circular:.6g} rad/s"]

    def object(self) -> dict[str, object]:
        return {"circular_frequency": {"value": self.circular, "unit": "rad/s"}}


@task
def hello(frequency: Annotated[Number, Parameter("Of the drive.", unit="Hz")]) -> Circular:
    """Circular frequency of a frequency.

    Example: sonolube hello 1kHz
    """
    return Circular(circular=2 * math.pi * in_si("frequency", frequency))
'''


def extend(file: Path, text: str, *, table: Path, after: str, line: str) -> None:
    """Add a file and one line of a table to the copied package."""
    file.parent.mkdir(exist_ok=True)
    file.write_text(text)
    content = table.read_text()
    assert after in content
    table.write_text(content.replace(after, f"{after}{line}\n", 1))


def run(folder: Path, *arguments: str) -> str:
    """Return what Python of the copied package printed."""
    environment = {**os.environ, "PYTHONPATH": str(folder), "OPENBLAS_NUM_THREADS": "1", "COLUMNS": "200"}
    found = subprocess.run(
        [sys.executable, *arguments], env=environment, cwd=folder, capture_output=True, text=True, check=False
    )
    assert found.returncode == 0, found.stderr
    return found.stdout


def answer(folder: Path, *arguments: object) -> Any:
    """Return the JSON answer of a command of the copied package."""
    command = [*map(str, arguments), "--json"]
    return json.loads(run(folder, "-c", f"from sonolube.cli import main; main({command!r})"))


@pytest.fixture
def with_friction_model(copied_package: Path) -> Path:
    models = copied_package / "models" / "friction" / "models"
    extend(
        models / "constant_ratio.py",
        FRICTION_MODEL,
        table=models / "__init__.py",
        after='        "kinematic": "sonolube.models.friction.models.kinematic:Kinematic",\n',
        line='        "constant_ratio": "sonolube.models.friction.models.constant_ratio:ConstantRatio",',
    )
    return copied_package.parent


@pytest.mark.slow
def test_a_friction_model_is_one_file_and_one_line(with_friction_model: Path) -> None:
    folder = with_friction_model
    rig = folder / "rig.toml"
    rig.write_text(
        RIG.read_text().replace("[friction]\n", '[friction]\nmodel = "constant_ratio"\ndamping_reference = "500 g/s"\n')
    )

    found = answer(folder, "friction", rig)
    assert found["friction_ratio"]["value"] == approx(0.5, rel=1e-12)
    assert found["friction_model"] == "constant_ratio"
    assert found["citation"] == "Toy and Model 2026, eq. (7)"
    assert answer(folder, "friction", RIG, "--model", "constant_ratio")["friction_ratio"]["value"] == approx(0.5)
    assert answer(folder, "simulate", rig)["friction_ratio"]["value"] == approx(0.5, rel=1e-12)

    shown = run(folder, "-c", "from sonolube.cli import main; main(['friction', '--help'])")
    assert "constant_ratio" in shown
    assert "damping_reference in kg/s" in re.sub(r"[\s│]+", " ", shown)
    assert "Toy and Model 2026, eq. (7)" in shown

    schema = json.dumps(answer(folder, "schema"))
    assert "constant_ratio" in schema
    assert "damping_reference" in schema
    assert "Toy and Model 2026, eq. (7)" in schema

    run(
        folder,
        "-c",
        "from sonolube.cli import main; "
        f"main(['sweep', {str(rig)!r}, '--over', 'drive.voltage_peak_to_peak=4V:28V:5', '--out', 'swept'])",
    )
    script = (
        "import numpy as np, xarray as xr\n"
        "from pathlib import Path\n"
        "from sonolube.models.friction import FRICTION_MODELS\n"
        "from sonolube.rig import friction_point, operating_points, read_rig\n"
        "with xr.open_dataset(next(Path('swept').rglob('*.nc'))) as swept: ratio = swept.friction_ratio.values\n"
        "print(float(np.ptp(ratio)), float(ratio.mean()))\n"
        "rig = read_rig(Path('rig.toml'))\n"
        "print(rig.friction_model.damping_reference, float(friction_point(rig).friction_ratio))\n"
        "many = operating_points(rig, voltage_peak_to_peak=np.array([4.0, 12.0, 28.0]))\n"
        "print(float(np.ptp(many.friction_ratio)), float(np.mean(many.friction_ratio)))\n"
        "model = FRICTION_MODELS['constant_ratio'](damping_reference=0.25)\n"
        "print(model.ratio(None, None, sliding_speed=[0.1, 0.2]).tolist(), model.parameters()[0].unit)\n"
    )
    swept, own, batch, direct = run(folder, "-c", script).splitlines()
    assert [float(value) for value in swept.split()] == approx([0.0, 0.5])
    assert [float(value) for value in own.split()] == approx([0.5, 0.5])
    assert [float(value) for value in batch.split()] == approx([0.0, 0.5])
    assert direct == "[0.25, 0.25] kg/s"


def test_a_parameter_of_another_friction_model_is_refused(with_friction_model: Path) -> None:
    rig = with_friction_model / "rig.toml"
    rig.write_text(RIG.read_text().replace("[friction]\n", '[friction]\ndamping_reference = "500 g/s"\n'))
    with pytest.raises(AssertionError, match=r"friction\.damping_reference.*constant_ratio"):
        answer(with_friction_model, "friction", rig)


@pytest.mark.slow
def test_an_asperity_law_is_one_file_and_one_line(copied_package: Path) -> None:
    folder = copied_package.parent
    contact = copied_package / "models" / "contact"
    extend(
        contact / "asperity_laws" / "doubled.py",
        ASPERITY_LAW,
        table=contact / "asperity.py",
        after='        "elastic": "sonolube.models.contact.asperity:ElasticAsperity",\n',
        line='        "doubled": "sonolube.models.contact.asperity_laws.doubled:DoubledAsperity",',
    )
    law = "contact.asperity_law"

    elastic = answer(folder, "contact", RIG, "--set", f"{law}=elastic")
    doubled = answer(folder, "contact", RIG, "--set", f"{law}=doubled")
    half = answer(folder, "contact", RIG, "--set", f"{law}=elastic", "--set", "contact.normal_load=1.5N")
    assert doubled["separation"]["value"] == approx(half["separation"]["value"], rel=1e-9)
    assert doubled["normal_stiffness"]["value"] == approx(elastic["normal_stiffness"]["value"], rel=1e-9)

    simulated = answer(folder, "simulate", RIG, "--set", f"{law}=doubled")
    assert simulated["vibration_amplitude"]["value"] > 0
    assert '"doubled"' in json.dumps(answer(folder, "schema"))


def test_a_task_is_one_file_and_one_line_for_terminal_and_python(copied_package: Path) -> None:
    folder = copied_package.parent
    extend(
        copied_package / "tasks" / "lookup" / "hello.py",
        TASK,
        table=copied_package / "tasks" / "table.py",
        after="TASKS: Final = (\n",
        line='    Task(LOOKUP, "hello", "lookup.hello:hello"),',
    )
    assert answer(folder, "hello", "1kHz")["circular_frequency"]["value"] == approx(6283.185307)
    assert "6283.19 rad/s" in run(folder, "-c", "from sonolube.cli import main; main(['hello', '1 kHz'])")
    assert "Circular frequency of a frequency." in run(folder, "-c", "from sonolube.cli import main; main(['--help'])")
    in_python = "from sonolube.tasks.table import TASKS; print(TASKS[0].function(1000.0))"
    assert "6283.19 rad/s" in run(folder, "-c", in_python)
