"""Twenty natural modes of a body by scikit-fem or by CalculiX, with the settings of their manuals, on a given mesh."""

import json
import os
import re
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from peak_memory import peak_memory  # type: ignore[import-not-found]

RIGID = 6


def write_input(path: Path, mesh: dict[str, np.ndarray], constants: np.ndarray, modes: int) -> None:
    """Write a CalculiX input of C3D10 elements; one row of modulus, Poisson's ratio and density per region."""
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{k},{x:.12g},{y:.12g},{z:.12g}" for k, (x, y, z) in enumerate(mesh["nodes"], 1)]
    for region in range(len(constants)):
        lines.append(f"*ELEMENT, TYPE=C3D10, ELSET=R{region}")
        cells = np.flatnonzero(mesh["regions"] == region)
        lines += [f"{k + 1}," + ",".join(str(node + 1) for node in mesh["elements"][k]) for k in cells]
    for region, (modulus, ratio, density) in enumerate(constants):
        lines += [f"*MATERIAL, NAME=M{region}", "*ELASTIC", f"{modulus:g},{ratio:g}", "*DENSITY", f"{density:g}"]
        lines.append(f"*SOLID SECTION, ELSET=R{region}, MATERIAL=M{region}")
    lines += ["*STEP", "*FREQUENCY, SOLVER=SPOOLES", f"{modes + RIGID}", "*END STEP", ""]
    path.write_text("\n".join(lines))


def calculix(mesh: dict[str, np.ndarray], constants: np.ndarray, modes: int) -> np.ndarray:
    """Elastic natural frequencies in Hz by CalculiX with SPOOLES."""
    with tempfile.TemporaryDirectory() as folder:
        write_input(Path(folder) / "body.inp", mesh, constants, modes)
        environment = {**os.environ, "OMP_NUM_THREADS": "1"}
        subprocess.run(["ccx", "body"], cwd=folder, check=True, capture_output=True, env=environment)
        printed = (Path(folder) / "body.dat").read_text()
    rows = re.findall(r"^ +\d+ +\S+ +\S+ +(\S+) +\S+ *$", printed.split("PARTICIPATION")[0], flags=re.MULTILINE)
    return np.array([float(row) for row in rows])[RIGID:]


def scikit_fem(mesh: dict[str, np.ndarray], constants: np.ndarray, modes: int) -> np.ndarray:
    """Elastic natural frequencies in Hz by scikit-fem: ten-node elements, shift-invert ARPACK with SuperLU."""
    from scipy.sparse.linalg import eigsh
    from scipy.spatial import KDTree
    from skfem import Basis, BilinearForm, ElementTetP2, ElementVector, MeshTet, MeshTet2
    from skfem.helpers import ddot, dot, eye, sym_grad, trace

    corners, renumbered = np.unique(mesh["elements"][:, :4], return_inverse=True)
    straight = MeshTet(mesh["nodes"][corners].T.copy(), renumbered.reshape(-1, 4).T.copy())
    curved = MeshTet2.from_mesh(straight)
    ends = mesh["elements"][:, np.array([[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]])]
    _, midpoints = KDTree(curved.doflocs.T).query(mesh["nodes"][ends].mean(axis=2).reshape(-1, 3))
    locations = curved.doflocs.copy()
    locations[:, midpoints] = mesh["nodes"][mesh["elements"][:, 4:]].reshape(-1, 3).T
    basis = Basis(MeshTet2(locations, curved.t), ElementVector(ElementTetP2()), intorder=4)
    modulus, ratio, density = (constants[mesh["regions"], k][:, np.newaxis] for k in range(3))
    mu, lam = modulus / (2 * (1 + ratio)), modulus * ratio / ((1 + ratio) * (1 - 2 * ratio))

    @BilinearForm
    def stiffness(u, v, w):  # type: ignore[no-untyped-def]
        strain = sym_grad(u)
        return ddot(2 * w.mu * strain + eye(w.lam * trace(strain), 3), sym_grad(v))

    @BilinearForm
    def mass(u, v, w):  # type: ignore[no-untyped-def]
        return w.density * dot(u, v)

    k = stiffness.assemble(basis, mu=mu, lam=lam)
    m = mass.assemble(basis, density=density)
    squares = eigsh(k.tocsc(), M=m.tocsc(), k=modes + RIGID, sigma=-1e8, which="LM", return_eigenvectors=False)
    return np.asarray(np.sqrt(np.sort(squares)[RIGID:]) / (2 * np.pi))


if __name__ == "__main__":
    name, path = sys.argv[1:]
    with np.load(path) as arrays:
        body = dict(arrays)
    materials, count = body["constants"], int(body["modes"])
    wall_start, processor_start = time.perf_counter(), time.process_time()
    frequencies = (calculix if name == "calculix" else scikit_fem)(body, materials, count)
    processor, peak = time.process_time() - processor_start, peak_memory()
    if name == "calculix":  # the one program that this process started
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        processor, peak = used.ru_utime + used.ru_stime, 1024 * used.ru_maxrss
    wall = time.perf_counter() - wall_start
    result = {"wall": wall, "processor": processor, "peak": peak, "frequencies": frequencies.tolist()}
    print(json.dumps(result))  # noqa: T201
