"""Exports of one friction signal in the forms of laboratories' programs, written after descriptions of these forms.

The force is 2 N for 4 s, then 1.2 N, with a ripple of 0.05 N; 200 samples a second for 10 s.
"""

import struct
from collections.abc import Callable
from datetime import datetime, timedelta
from io import BytesIO
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from nptdms import ChannelObject, TdmsWriter
from scipy.io import netcdf_file, savemat

RATE = 200.0
TIME = np.arange(2000) / RATE
FORCE = np.round(np.where(TIME < 4, 2.0, 1.2) + 0.05 * np.sin(2 * np.pi * 3 * TIME), 5)
LOAD = 5.0
START = datetime(2026, 3, 5, 9, 30, 0)
VOLTS = '{axis}[channels.friction_force]\ncolumn = "{column}"\ngain = "2 N/V"\n'


def lines_of(
    head: list[str], *columns: Any, separator: str = ",", tail: tuple[str, ...] = (), comma: bool = False
) -> str:
    """Text of a head and of rows of cells, which are texts or numbers."""
    cells = [[cell if isinstance(cell, str) else f"{cell:.6g}" for cell in column] for column in columns]
    if comma:
        cells = [[cell.replace(".", ",") for cell in column] for column in cells]
    rows = [separator.join(row) for row in zip(*cells, strict=True)]
    return "\r\n".join([*head, *rows, *tail, ""])


def clock(form: str, *, of_day: bool = True) -> list[str]:
    """Times as text, from the start, in a format of `datetime.strftime`; %f in milliseconds."""
    begin = START if of_day else datetime(2026, 1, 1)
    return [
        (begin + timedelta(seconds=float(t)))
        .strftime(form.replace("%f", "<f>"))
        .replace("<f>", f"{round(t * 1e3) % 1000:03d}")
        for t in TIME
    ]


def tektronix_2000() -> str:
    """Rows with the settings in the first three cells, then time and volts."""
    keys = [("Record Length", "2000"), ("Sample Interval", "5.0e-03"), ("Trigger Point", "1000"), ("", "")]
    keys += [("Source", "CH1"), ("Vertical Units", "V"), ("Vertical Scale", "5.0e-01"), ("Horizontal Units", "s")]
    rows = []
    for place, (t, force) in enumerate(zip(TIME, FORCE, strict=True)):
        key, value = keys[place] if place < len(keys) else ("", "")
        rows.append(f"{key},{value},,{t:014.9f},{force / 2:.6f},")
    return "\n".join([*rows, ""])


def rigol() -> str:
    """Sequence and volts; start and increment of the time stand in the second line."""
    rows = [f"{place},{force / 2:.6e},," for place, force in enumerate(FORCE)]
    return "\n".join(["X,CH1,Start,Increment,", "Sequence,Volt,0.000000e+00,5.000000e-03", *rows, ""])


def universal_file() -> str:
    """Time response, data set 58, of evenly sampled values."""
    lines = [f"{'-1':>6}", f"{'58':>6}", "friction", "NONE", "05-Mar-26 09:30:00", "NONE", "NONE"]
    lines.append("    1         0    0         0 NONE               1   3 NONE               0   0")
    lines.append(f"         2{FORCE.size:10d}         1  0.00000e+00  5.00000e-03  0.00000e+00")
    lines.append("        17    0    0    0                 Time                    s")
    lines.append("         9    0    0    0       Friction force                    N")
    lines += ["         0    0    0    0                 NONE                 NONE"] * 2
    filled = [*FORCE, *[0.0] * (-FORCE.size % 6)]
    lines += ["".join(f"{value:13.5e}" for value in filled[at : at + 6]) for at in range(0, len(filled), 6)]
    return "\n".join([*lines, f"{'-1':>6}", ""])


def labview(separator: str, sign: str) -> str:
    """LVM with times."""
    name = {"\t": "Tab", ",": "Comma"}[separator]
    head = [
        "LabVIEW Measurement",
        "Writer_Version\t2",
        "Reader_Version\t2",
        f"Separator\t{name}",
        f"Decimal_Separator\t{sign}",
    ]
    head += [
        "Multi_Headings\tNo",
        "X_Columns\tOne",
        "Time_Pref\tAbsolute",
        "Date\t2026/03/05",
        "Time\t09:30:00",
        "***End_of_Header***",
        "",
    ]
    head += [
        "Channels\t1",
        "Samples\t2000",
        "Date\t2026/03/05",
        "Time\t09:30:00",
        "Y_Unit_Label\tNewton",
        "X_Dimension\tTime",
    ]
    head += [f"X0\t0{sign}0E+0", f"Delta_X\t0{sign}005000", "***End_of_Header***", "X_Value\tFriction force\tComment"]
    rows = [f"{t:.6f}\t{f:.6f}".replace(".", sign) for t, f in zip(TIME, FORCE, strict=True)]
    return "\r\n".join([*head, *rows, ""]).replace("\t", separator)


def tdms() -> bytes:
    out = BytesIO()
    with TdmsWriter(out) as writer:
        properties = {"wf_increment": 1 / RATE, "wf_start_offset": 0.0, "unit_string": "N"}
        writer.write_segment([ChannelObject("Data", "Friction force", FORCE, properties)])
    return out.getvalue()


def matlab_5() -> bytes:
    out = BytesIO()
    savemat(out, {"t": TIME[:, None], "friction_force": FORCE[:, None]})
    return out.getvalue()


def matlab_structure() -> bytes:
    out = BytesIO()
    savemat(out, {"run": {"time": TIME, "friction_force": FORCE}})
    return out.getvalue()


def hdf5(*, matlab: bool) -> bytes:
    out = BytesIO()
    with h5py.File(out, "w", userblock_size=512 if matlab else 0) as file:
        file["time"], file["friction_force"] = (TIME[None], FORCE[None]) if matlab else (TIME, FORCE)
        if not matlab:
            file["time"].attrs["units"], file["friction_force"].attrs["units"] = "s", "N"
    content = bytearray(out.getvalue())
    if matlab:
        content[:128] = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + struct.pack("<HH", 0x0200, 0x4D49)
    return bytes(content)


def netcdf() -> bytes:
    out = BytesIO()
    file = netcdf_file(out, "w")
    file.createDimension("time", TIME.size)
    for name, values, unit in (("time", TIME, "s"), ("friction_force", FORCE, "N")):
        variable = file.createVariable(name, "d", ("time",))
        variable[:] = values
        variable.units = unit
    file.flush()
    return out.getvalue()


SIGNAL_EXPRESS = [
    "Sample number 1",
    "channel names:",
    "Friction force",
    "start times:",
    "05.03.2026 09:30:00",
    "dt:",
    "0.005",
    "data:",
]
CATMAN = ["DAQ project measurement", "Recorded: 05/03/2026 09:30:00", "Channels: 2", "Time\tReibkraft", "s\tN"]
ORIGIN = ["Time\tFriction force", "s\tN", "measured\tsensor 1"]
TRIBOMETER = [
    "TRB3 export",
    "Sample;steel 100Cr6",
    "Normal load;5.00 N",
    "",
    "Time [s];Distance [m];Friction force [N];mu",
]
DUCOM = ["Ducom Instruments", "Test ID,PoD-12", "Load (N),5", "", "Time(s),Frictional Force(N),COF,Wear(\u00b5m)"]
RTEC = ["Rtec-Instruments MFT-5000", "Recipe,reciprocating", "Step,1", "Timestamp,Fx (N),Fz (N),COF"]
SIGLENT = [
    "Record Length,Analog:2000",
    "Sample Interval,Analog:0.005",
    "Vertical Units,CH1:V",
    "Model Number,SDS1104X-E",
    "Source,CH1",
    "Second,Volt",
]
MDO = [
    "Model,MDO3024",
    "Firmware Version,1.30",
    "",
    "Waveform Type,ANALOG",
    "Point Format,Y",
    "Horizontal Units,s",
    "Sample Interval,5E-3",
    "Record Length,2000",
    "Vertical Units,V",
    ",",
    "Label,",
    "TIME,CH1",
]
OSCILLOSCOPE = '[axis]\ncolumn = "{}"\nunit = "s"\n'

MU = FORCE / LOAD
HALF = TIME.size // 2
_PLAIN = "time [s],friction_force [N]"

EXPORTS: dict[str, Callable[[], str | bytes]] = {
    # spreadsheets and scripts
    "plain.csv": lambda: lines_of([_PLAIN], TIME, FORCE),
    "german.csv": lambda: lines_of(["Zeit [s];Reibkraft [N]"], TIME, FORCE, separator=";", comma=True),
    "utf-16.txt": lambda: lines_of(["Time (s)\tFriction Force (N)"], TIME, FORCE, separator="\t").encode("utf-16"),
    "units-row.csv": lambda: lines_of(["Time,Friction force", "s,N"], TIME, FORCE),
    "milli.csv": lambda: lines_of(["Time [ms];Friction force [mN]"], 1e3 * TIME, 1e3 * FORCE, separator=";"),
    "thousands.csv": lambda: lines_of(
        ["Zeit [s];Reibkraft [mN]"],
        [f"{t:.3f}".replace(".", ",") for t in TIME],
        [f"{1e3 * f:,.2f}".replace(",", " ").replace(".", ",").replace(" ", ".") for f in FORCE],
        separator=";",
    ),
    "matlab-table.csv": lambda: lines_of(["Time_s,FrictionForce_N"], TIME, FORCE),
    "pandas-index.csv": lambda: lines_of(
        [",time [s],friction_force [N]"], [str(n) for n in range(TIME.size)], TIME, FORCE
    ),
    "comments.txt": lambda: lines_of(
        ["# rig 3, 5 N", "# 200 samples a second", "# time [s] friction_force [N]"], TIME, FORCE, separator=" "
    ),
    "aligned.txt": lambda: lines_of(
        ["     Time [s]    Friction [N]"], [f"{t:13.4f}" for t in TIME], [f"{f:15.5f}" for f in FORCE], separator=" "
    ),
    "no-labels.txt": lambda: lines_of([], TIME, FORCE, separator="\t"),
    "summary.csv": lambda: lines_of([_PLAIN], TIME, FORCE, tail=(f"Mean,{FORCE.mean():.5f}", f"SD,{FORCE.std():.5f}")),
    "two-heads.csv": lambda: (
        lines_of([_PLAIN], TIME[:HALF], FORCE[:HALF]) + lines_of([_PLAIN], TIME[HALF:], FORCE[HALF:])
    ),
    "merged.csv": lambda: lines_of(["Clock,Sensor 1", "Time,Friction force", "s,N"], TIME, FORCE),
    "negative.csv": lambda: lines_of([_PLAIN], TIME, -FORCE),
    "coefficient.csv": lambda: lines_of(["Time [s],\u00b5,Fn [N]"], TIME, MU, np.full(TIME.size, LOAD)),
    # clocks
    "clock.csv": lambda: lines_of(
        ["Time;Friction force [N]"],
        clock("%H:%M:%S,%f", of_day=False),
        [f"{f:.5f}".replace(".", ",") for f in FORCE],
        separator=";",
    ),
    "stamps.csv": lambda: lines_of(["Timestamp,Friction force [N]"], clock("%Y-%m-%dT%H:%M:%S.%f+01:00"), FORCE),
    "date-and-time.csv": lambda: lines_of(
        ["Date;Time;Friction force [N]"], clock("%d.%m.%Y"), clock("%H:%M:%S.%f"), FORCE, separator=";"
    ),
    "american.csv": lambda: lines_of(["Date/Time,Friction force [N]"], clock("%m/%d/%Y %I:%M:%S.%f %p"), FORCE),
    "rounded.csv": lambda: lines_of([_PLAIN], np.floor(10 * TIME) / 10, FORCE),
    "epoch.csv": lambda: lines_of(["time [s],friction_force [N]"], [f"{1.7726e9 + t:.3f}" for t in TIME], FORCE),
    # oscilloscopes and loggers
    "keysight.csv": lambda: lines_of(["x-axis,1", "second,Volt"], TIME, FORCE / 2),
    "tektronix-2000.csv": tektronix_2000,
    "tektronix-mdo.csv": lambda: lines_of(MDO, TIME, FORCE / 2),
    "rigol.csv": rigol,
    "siglent.csv": lambda: lines_of(SIGLENT, TIME, FORCE / 2),
    "picoscope.csv": lambda: lines_of(["Time,Channel A", "(ms),(mV)", ""], 1e3 * TIME, 500 * FORCE),
    "digilent.csv": lambda: lines_of(
        ["#Digilent WaveForms Oscilloscope Acquisition", "#Device Name: ADP3450", "", "Time (s),Channel 1 (V)"],
        TIME,
        FORCE / 2,
    ),
    "signal-express.txt": lambda: "\n".join([*SIGNAL_EXPRESS, *(f"{f:.5f}" for f in FORCE), ""]),
    "catman.asc": lambda: lines_of(CATMAN, TIME, FORCE, separator="\t", comma=True).encode("cp1252"),
    "origin.txt": lambda: lines_of(ORIGIN, TIME, FORCE, separator="\t"),
    # tribometers
    "trb.csv": lambda: lines_of(TRIBOMETER, TIME, 0.02 * TIME, FORCE, MU, separator=";"),
    "ducom.csv": lambda: lines_of(DUCOM, TIME, FORCE, MU, np.zeros(TIME.size)).encode("cp1252"),
    "rtec.csv": lambda: lines_of(RTEC, TIME, FORCE, np.full(TIME.size, -LOAD), MU),
    "te53.tsv": lambda: lines_of(
        ["Compend 2000\tTE53\t05/03/2026", "STEP 1", "Run Time (s)\tFriction (N)"], TIME, FORCE, separator="\t"
    ),
    "csm.txt": lambda: lines_of(
        ["CSM Instruments Tribometer", "Normal load : 5.00 [N]", "", "Time [s]\t\u00b5"], TIME, MU, separator="\t"
    ).encode("cp1252"),
    # binary and structured files
    "tab.lvm": lambda: labview("\t", "."),
    "comma.lvm": lambda: labview("\t", ","),
    "run.tdms": tdms,
    "variables.mat": matlab_5,
    "structure.mat": matlab_structure,
    "seven-three.mat": lambda: hdf5(matlab=True),
    "run.h5": lambda: hdf5(matlab=False),
    "run.nc": netcdf,
    "run.uff": universal_file,
}

MAPPINGS = {
    "no-labels.txt": VOLTS.format(axis=OSCILLOSCOPE.format("column 1"), column="column 2").replace(
        'gain = "2 N/V"', 'unit = "N"'
    ),
    "keysight.csv": VOLTS.format(axis="", column="1"),
    "tektronix-2000.csv": VOLTS.format(axis=OSCILLOSCOPE.format("column 4"), column="column 5"),
    "tektronix-mdo.csv": VOLTS.format(axis="", column="CH1"),
    "rigol.csv": VOLTS.format(axis="", column="CH1"),
    "siglent.csv": VOLTS.format(axis="", column="CH1"),
    "picoscope.csv": VOLTS.format(axis="", column="Channel A"),
    "digilent.csv": VOLTS.format(axis="", column="Channel 1 (V)"),
}
"""Mappings that state what an export cannot: gains of sensors, and meanings of columns without labels."""


def write_export(name: str, folder: Path) -> tuple[Path, Path | None]:
    """An export, and its mapping where it needs one, as files of a folder."""
    content = EXPORTS[name]()
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    if name not in MAPPINGS:
        return path, None
    (folder / "mapping.toml").write_text(MAPPINGS[name])
    return path, folder / "mapping.toml"
