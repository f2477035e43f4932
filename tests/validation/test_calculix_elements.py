"""Natural frequencies of ten-node elements against CalculiX, run as a separate program."""

import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from pytest import approx

from sonolube.checks import Floats
from sonolube.models.fem import Mesh, Model, box_mesh, isotropic_medium, natural_modes

MODES = 10
MODULUS, RATIO, DENSITY = 200e9, 0.29, 7900.0


def frequencies_by_calculix(mesh: Mesh, folder: Path) -> Floats:
    """Elastic natural frequencies in Hz of a free body of one material."""
    nodes = [f"{k},{x:.12g},{y:.12g},{z:.12g}" for k, (x, y, z) in enumerate(mesh.nodes, 1)]
    elements = [",".join(map(str, [k, *(cell + 1)])) for k, cell in enumerate(mesh.elements, 1)]
    material = ["*MATERIAL, NAME=M", "*ELASTIC", f"{MODULUS},{RATIO}", "*DENSITY", f"{DENSITY}"]
    step = ["*SOLID SECTION, ELSET=ALL, MATERIAL=M", "*STEP", "*FREQUENCY", f"{MODES + 6}", "*END STEP", ""]
    lines = ["*NODE", *nodes, "*ELEMENT, TYPE=C3D10, ELSET=ALL", *elements, *material, *step]
    (folder / "body.inp").write_text("\n".join(lines))
    subprocess.run(["ccx", "body"], cwd=folder, check=True, capture_output=True)
    table = (folder / "body.dat").read_text().split("PARTICIPATION")[0]
    rows = re.findall(r"^ +\d+ +\S+ +\S+ +(\S+) +\S+ *$", table, flags=re.MULTILINE)
    return np.array([float(row) for row in rows])[6:]


@pytest.mark.external
@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed: apt-get install calculix-ccx")
def test_natural_frequencies_are_those_of_calculix_on_the_same_elements(tmp_path: Path) -> None:
    # CalculiX integrates the stiffness at four points of an element, fewer than exact integration needs.
    mesh = box_mesh(length=0.127, width=0.06096, thickness=0.0254, divisions=(12, 6, 3))
    steel = isotropic_medium(youngs_modulus=MODULUS, poisson_ratio=RATIO, density=DENSITY)
    ours = natural_modes(Model(mesh=mesh, media={"block": steel}), count=MODES).elastic_frequency
    assert frequencies_by_calculix(mesh, tmp_path) == approx(ours, rel=1e-3)
