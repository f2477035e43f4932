"""Modes written as universal files by pyuff and as results of CalculiX, for tests that read them back."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pyuff

from sonolube.checks import Floats


def write_universal_file(
    path: Path,
    *,
    frequency: Sequence[float],
    position: Floats,
    shape: Floats,
    mass: Sequence[float] | None = None,
    damping: Sequence[float] | None = None,
    nodes: int = 2411,
    factors: tuple[float, float] | None = None,
    number: Sequence[int] | None = None,
) -> None:
    """Data sets 164 (with factors of length and force), 2411 or 15, and 55; all numbers in the units of the file."""
    numbers = list(range(1, len(position) + 1)) if number is None else list(number)
    ones, (x, y, z) = [1] * len(numbers), np.asarray(position, float).T
    sets = []
    if factors is not None:
        length, force = factors
        sets.append(pyuff.prepare_164(units_code=9, length=length, force=force, temp=1.0, temp_offset=0.0))
    prepare = pyuff.prepare_2411 if nodes == 2411 else pyuff.prepare_15
    sets.append(prepare(node_nums=numbers, def_cs=ones, disp_cs=ones, color=ones, x=x, y=y, z=z))
    for k, (hertz, each) in enumerate(zip(frequency, shape, strict=True)):
        sets.append(
            pyuff.prepare_55(
                model_type=1,
                analysis_type=2,
                data_ch=2,
                spec_data_type=8,
                data_type=5 if np.iscomplexobj(each) else 2,
                n_data_per_node=3,
                load_case=1,
                mode_n=k + 1,
                freq=float(hertz),
                modal_m=0.0 if mass is None else float(mass[k]),
                modal_damp_vis=0.0 if damping is None else float(damping[k]),
                modal_damp_his=0.0,
                node_nums=numbers,
                r1=each[:, 0],
                r2=each[:, 1],
                r3=each[:, 2],
            )
        )
    pyuff.UFF(str(path)).write_sets(sets, "overwrite")


def frd_text(*, frequency: Sequence[float], position: Floats, shape: Floats, mass: Sequence[float]) -> str:
    """Result of CalculiX in long ASCII form, as its version 2.20 writes frequency steps."""
    count = len(position)
    lines = ["    1C", "    1UPGM               CalculiX", f"    2C{'':18}{count:12d}{'':37}1"]
    lines += [*_nodal(position), " -3"]
    for k, (hertz, each) in enumerate(zip(frequency, shape, strict=True), 1):
        lines += [f"    1PGM                {mass[k - 1]:.6E}", f"    1PMODE{'':26}{k}"]
        lines.append(f"  100CL  {100 + k:3d}{hertz:12.5E}{count:12d}{'':20} 2{k:5d}MODAL      1")
        lines += [" -4  DISP        4    1", *(f" -5  D{axis}          1    2    {axis}    0" for axis in (1, 2, 3))]
        lines += [" -5  ALL         1    2    0    0    1ALL", *_nodal(each), " -3"]
    return "\n".join([*lines, " 9999", ""])


def _nodal(values: Floats) -> list[str]:
    return [f" -1{number:10d}" + "".join(f"{v:12.5E}" for v in row) for number, row in enumerate(values, 1)]
