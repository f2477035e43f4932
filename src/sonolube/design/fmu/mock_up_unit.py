"""Units of the Functional Mock-up Interface with C sources inside and a binary of this platform, as zip archives.

A unit is the same to the last byte for the same rig, but for the binary, which depends on the compiler.
"""

import platform
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from importlib.resources import files
from io import BytesIO
from math import isinf
from pathlib import Path
from shutil import which
from tempfile import TemporaryDirectory
from typing import Final
from uuid import UUID
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

import numpy as np

from sonolube.design.control import FrequencyTracker, FrictionController, controller_source
from sonolube.design.fmu.chebyshev import ChebyshevTable
from sonolube.design.fmu.plant import PlantTables
from sonolube.design.fmu.variables import (
    Description,
    Variable,
    Version,
    build_description,
    controller_variables,
    model_description,
    plant_variables,
)
from sonolube.rig import Rig

_FIRST_DATE: Final = (1980, 1, 1, 0, 0, 0)  # of zip archives, so that the time of making leaves no trace
_COMPILERS: Final = ("cc", "gcc", "clang")
_FLAGS: Final = ("-std=c99", "-O2", "-fPIC", "-shared", "-fvisibility=hidden", "-ffp-contract=off")
_LONGEST_COMPILATION: Final = 300  # s
_PLATFORMS: Final[Mapping[str, Mapping[tuple[str, str], str]]] = {
    "2": {("linux", "x86_64"): "linux64", ("darwin", "x86_64"): "darwin64", ("windows", "x86_64"): "win64"},
    "3": {},
}
_SUFFIXES: Final = {"windows": ".dll", "darwin": ".dylib"}
_LEAST_TRACKED = 0.02  # of the highest voltage, as in the simulation of the closed loop
_ROW = 4  # numbers in a line of an array


@dataclass(frozen=True, kw_only=True, slots=True)
class MockUpUnit:
    """A unit of the Functional Mock-up Interface.

    Parameters
    ----------
    description : Description
    version : {"2", "3"}
    content : bytes
        Archive, a file of the ending fmu.
    platform : str
        Of the binary inside; empty without one.
    missing : str
        Why there is no binary; empty with one.
    """

    description: Description
    version: Version
    content: bytes
    platform: str
    missing: str


def c_compiler() -> str | None:
    """Path of the C compiler: the first of cc, gcc and clang; None where there is none.

    Returns
    -------
    str or None
    """
    return next((found for name in _COMPILERS if (found := which(name))), None)


def plant_unit(
    tables: PlantTables, *, version: Version, identifier: str, tool: str, compiler: str | None = None
) -> MockUpUnit:
    """Slow envelope of a rig's plant as a unit.

    Parameters
    ----------
    tables : PlantTables
    version : {"2", "3"}
        Of the interface.
    identifier : str
        Name of the unit, a word of C.
    tool : str
        Program that makes it, with its version.
    compiler : str, optional
        Path of a C compiler; without one the unit has no binary.

    Returns
    -------
    MockUpUnit
    """
    notes = {
        "model": "slow envelope: amplitude and phase of one resonance, friction by tables of steady vibrations",
        "relative_error": repr(tables.relative_error),
    }
    described = Description(
        identifier=identifier,
        title=f"Plant: {tables.rig.title}",
        text="Slow envelope model: the vibration follows the drive as one resonance, friction follows the vibration at"
        f" once; steady friction and amplitude within {tables.relative_error:.1e} of sonolube's steady states",
        notes=notes,
        step=float(f"{1 / tables.resonance['decay_rate'](np.array(tables.rig.normal_load)) / 5:.1g}"),
        variables=plant_variables(tables),
    )
    return _unit(described, "plant.c", {"model_data.h": _plant_data(tables, described)}, version, tool, compiler)


def controller_unit(
    controller: FrictionController,
    tracker: FrequencyTracker | None,
    *,
    rig: Rig,
    version: Version,
    identifier: str,
    tool: str,
    compiler: str | None = None,
) -> MockUpUnit:
    """Friction controller, with its frequency tracker, as a unit that takes its samples at its own interval.

    Parameters
    ----------
    controller : FrictionController
    tracker : FrequencyTracker or None
        None for a fixed frequency.
    rig : Rig
    version : {"2", "3"}
        Of the interface.
    identifier : str
        Name of the unit, a word of C.
    tool : str
        Program that makes it, with its version.
    compiler : str, optional
        Path of a C compiler; without one the unit has no binary.

    Returns
    -------
    MockUpUnit
    """
    interval = controller.process.sample_interval
    described = Description(
        identifier=identifier,
        title=f"Friction controller: {rig.title}",
        text=f"Friction controller that takes a sample every {interval:g} s; its outputs hold in between",
        notes={"model": "sampled controller", "sample_interval": repr(interval)},
        step=interval,
        variables=controller_variables(controller, tracker),
    )
    data = [
        *_variable_table(described.variables),
        f"#define HAS_TRACKER {int(tracker is not None)}",
        f"#define LEAST_TRACKED_LEVEL ({_LEAST_TRACKED * controller.level_maximum!r})",
    ]
    written = {
        "model_data.h": "\n".join(data) + "\n",
        "control_law.c": controller_source(controller, tracker, title=rig.title),
    }
    return _unit(described, "controller.c", written, version, tool, compiler)


def _unit(
    described: Description, model: str, written: Mapping[str, str], version: Version, tool: str, compiler: str | None
) -> MockUpUnit:
    """Unit of a model, whose source is copied from this package, and of sources that were written for it."""
    entry = f"fmi{version}.c"
    sources = {entry: _template(entry), "component.h": _template("component.h"), "model.c": _template(model), **written}
    token = _token(described, sources, version, tool)
    sources["model_data.h"] = f'#define MODEL_TOKEN "{token}"\n' + sources["model_data.h"]
    name, binary, missing = _compiled(sources, entry, described.identifier, version, compiler)
    content = {"modelDescription.xml": model_description(described, version=version, token=token, tool=tool).encode()}
    content |= {f"sources/{each}": text.encode() for each, text in sources.items()}
    if version == "3":
        content["sources/buildDescription.xml"] = build_description(described.identifier).encode()
    if binary:
        content[f"binaries/{name}/{described.identifier}{_suffix()}"] = binary
    return MockUpUnit(
        description=described,
        version=version,
        content=_archive(content),
        platform=name if binary else "",
        missing=missing,
    )


def _token(described: Description, sources: Mapping[str, str], version: Version, tool: str) -> str:
    """GUID from the hash of all that the unit consists of."""
    about = model_description(described, version=version, token="", tool=tool)
    texts = [about, *(f"{name}\n{sources[name]}" for name in sorted(sources))]
    return f"{{{UUID(bytes=sha256(chr(0).join(texts).encode()).digest()[:16])}}}"


def _template(name: str) -> str:
    return files("sonolube.design.fmu").joinpath("sources", name).read_text(encoding="utf-8")


def _archive(content: Mapping[str, bytes]) -> bytes:
    """Zip archive of files by name, without the time of making."""
    buffer = BytesIO()
    with ZipFile(buffer, "w", ZIP_DEFLATED) as archive:
        for name, data in content.items():
            entry = ZipInfo(name, _FIRST_DATE)
            entry.compress_type, entry.external_attr = ZIP_DEFLATED, 0o644 << 16
            archive.writestr(entry, data)
    return buffer.getvalue()


def _platform(version: Version) -> str:
    """Name of this platform by a version of the interface; that of 3.0 where 2.0 has none."""
    system, machine = platform.system().lower(), platform.machine().lower()
    machine = {"amd64": "x86_64", "arm64": "aarch64"}.get(machine, machine)
    return _PLATFORMS[version].get((system, machine), f"{machine}-{system}")


def _suffix() -> str:
    """Ending of shared libraries on this platform."""
    return _SUFFIXES.get(platform.system().lower(), ".so")


def _compiled(
    sources: Mapping[str, str], entry: str, identifier: str, version: Version, compiler: str | None
) -> tuple[str, bytes, str]:
    """Name of this platform, shared library of sources, and why there is none."""
    name = _platform(version)
    if compiler is None:
        tried = ", ".join(_COMPILERS)
        return name, b"", f"no C compiler ({tried}) was found: the unit holds sources only, which an importer compiles"
    with TemporaryDirectory(prefix="sonolube-fmu-") as folder:
        place = Path(folder)
        for each, text in sources.items():
            place.joinpath(each).write_bytes(text.encode())
        library = place / f"{identifier}{_suffix()}"
        command = [compiler, *_FLAGS, entry, "-o", library.name, "-lm"]
        try:
            subprocess.run(command, cwd=place, check=True, capture_output=True, timeout=_LONGEST_COMPILATION)
        except (OSError, subprocess.SubprocessError) as fault:
            last = (getattr(fault, "stderr", None) or str(fault).encode()).decode(errors="replace").strip()
            first = last.partition("\n")[0]
            return name, b"", f"{compiler} failed ({first}): the unit holds sources only, which an importer compiles"
        return name, library.read_bytes(), ""


def _plant_data(tables: PlantTables, described: Description) -> str:
    """File `model_data.h` of a plant: its variables, tables and constants."""
    heat, ranges = tables.heat, tables.ranges
    arrays = {
        "amplitude_per_level": tables.amplitude_per_level,
        "velocity_per_level": tables.velocity_per_level,
        "threshold": tables.threshold,
        "slow_ratio": tables.slow_ratio,
        **({"fast_ratio": tables.fast_ratio} if tables.has_threshold else {}),
        **tables.resonance,
    }
    constants = {"INTRINSIC_COEFFICIENT": tables.rig.friction_coefficient}
    if heat is not None:
        assert tables.heat_partition is not None
        assert tables.flash_rise_per_heat is not None
        constants |= {"HEAT_CAPACITY": heat.heat_capacity, "THERMAL_CONDUCTANCE": heat.thermal_conductance}
        arrays |= {"heat_partition": tables.heat_partition, "flash_rise_per_heat": tables.flash_rise_per_heat}
    flags = {"THRESHOLD": tables.has_threshold, "CURRENT": tables.has_current, "HEAT": heat is not None}
    parts = [
        *_variable_table(described.variables),
        *(f"#define HAS_{name} {int(value)}" for name, value in flags.items()),
        *(f"#define {name} ({float(value)!r})" for name, value in constants.items()),
        f"static const double level_ends[2] = {{{ranges.level[0]!r}, {ranges.level[1]!r}}};",
        *(line for name, table in arrays.items() for line in _table_lines(name, table)),
    ]
    return "\n".join(parts) + "\n"


def _table_lines(name: str, table: ChebyshevTable) -> list[str]:
    """C definitions of a table: numbers of coefficients, ends of the variables, coefficients."""
    shape, values = table.coefficients.shape, [repr(value) for value in table.coefficients.ravel().tolist()]
    ends = [f"{name}_ends_{i}" for i in range(len(shape))]
    rows = [", ".join(values[i : i + _ROW]) for i in range(0, len(values), _ROW)]
    return [
        f"static const int {name}_shape[] = {{{', '.join(map(str, shape))}}};",
        *(
            f"static const double {end}[2] = {{{float(low)!r}, {float(high)!r}}};"
            for end, (low, high) in zip(ends, table.ends, strict=True)
        ),
        f"static const double *const {name}_ends[] = {{{', '.join(ends)}}};",
        f"static const double {name}[] = {{",
        ",\n".join(rows),
        "};",
    ]


def _variable_table(variables: Sequence[Variable]) -> list[str]:
    """C definitions of the variables, in the order of their value references."""
    places = ", ".join([*(each.place for each in variables), "MODEL_VARIABLES"])
    rows = [
        f'    {{"{each.name}", "{each.unit}", {"INPUT" if each.is_input else "OUTPUT"}, {each.start!r},'
        f" {_bound(each.lowest)}, {_bound(each.highest)}}},"
        for each in variables
    ]
    return [f"enum {{ {places} }};", "static const variable variables[MODEL_VARIABLES] = {", *rows, "};"]


def _bound(value: float) -> str:
    """C expression of a bound."""
    return ("-HUGE_VAL" if value < 0 else "HUGE_VAL") if isinf(value) else repr(float(value))
