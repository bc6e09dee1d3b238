"""Files as instruments write them, of one record of force and displacement whose K is known.

Sources of the formats
----------------------
tektronix : MDO3014, firmware 1.26: lines of the file that the task "box of blink" of the 35C3 CTF (2018) published; write-ups quote them.
    "Vertical Units" holds one unit per column.
keysight : InfiniiVision 3000T X-Series User's Guide, "CSV and ASCII XY file structure" (p. 389) says what is saved; the lines
    "x-axis,1,2" and "second,Volt,Volt" as users' readers of such files quote them.  The guide prints no example.
rigol : DS1054Z: "X,CH1,CH2,Start,Increment," and "Sequence,Volt,Volt,-5.999998e-02,2.000000e-05" as quoted by the reader
    github.com/vidavidorra/rigol-csv-analyser; its user guide prints no example.
picoscope : PicoScope 6 User's Guide (psw.en), "Text formats": names, units in brackets, numbers, in UTF-8.  Semicolons and decimal
    commas as users of other languages show them.
labview : NI, Specification for the LabVIEW Measurement File (.lvm), ni.com/tutorial/4139.
tdms : written by nptdms with NI's waveform properties wf_increment and wf_start_offset.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

#: Of the record: stiffness [N/m], damping [N s/m], mass [kg]; sensitivities [N/V], [V/um]; sampling rate [Hz].
STIFFNESS, DAMPING, MASS = 2e7, 900.0, 0.8
NEWTONS_PER_VOLT, VOLTS_PER_MICROMETRE, RATE = 100.0, 8e-3, 8192.0
SENSITIVITIES = (f"force_n*{NEWTONS_PER_VOLT:g}", f"x_um/{VOLTS_PER_MICROMETRE:g}")


def record(count: int = 4096) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times [s] and voltages (n,) of force and displacement, with noise of 60 dB below them."""
    rng = np.random.default_rng(7)
    time = np.arange(count) / RATE
    force, moved = np.zeros(count), np.zeros(count)
    for hz in np.arange(22.0, 500.0, 6.0):
        omega, phase = 2.0 * np.pi * hz, rng.uniform(0.0, 2.0 * np.pi)
        wave = 20.0 * np.exp(1j * (omega * time + phase))
        force += wave.real
        moved += (wave / (STIFFNESS + 1j * omega * DAMPING - MASS * omega**2)).real
    voltages = force / NEWTONS_PER_VOLT, 1e6 * moved * VOLTS_PER_MICROMETRE
    noisy = (volts + 1e-3 * volts.std() * rng.standard_normal(count) for volts in voltages)
    return time, *noisy


def _tektronix(path: Path) -> None:
    lines = [
        "Model,MDO3014", "Firmware Version,1.26", "", "Waveform Type,ANALOG,", "Point Format,Y,", "Horizontal Units,s,", "Horizontal Scale,0.04,",
        ",,", f"Sample Interval,{1.0 / RATE:.9e},", "Record Length,4096,", "Gating,0.0% to 100.0%,", ",,", "Vertical Units,V,V",
        "Vertical Scale,1,0.02", ",,", "Label,Force,Gap", "TIME,CH1,CH2",
    ]  # fmt: skip
    lines += [f"{t:.8e},{a:.6e},{b:.6e}" for t, a, b in zip(*record(), strict=True)]
    path.write_text("\n".join(lines) + "\n")


def _keysight(path: Path) -> None:
    lines = ["x-axis,1,2", "second,Volt,Volt"]
    lines += [f"{t - 0.1:+.7E},{a:+.5E},{b:+.5E}" for t, a, b in zip(*record(), strict=True)]
    path.write_text("\r\n".join(lines) + "\r\n", newline="")


def _rigol(path: Path) -> None:
    lines = ["X,CH1,CH2,Start,Increment,", f"Sequence,Volt,Volt,-1.000000e-01,{1.0 / RATE:.6e}"]
    lines += [f"{k},{a:.5e},{b:.5e}," for k, (_, a, b) in enumerate(zip(*record(), strict=True))]
    path.write_text("\n".join(lines) + "\n")


def _picoscope(path: Path) -> None:
    rows = (f"{1e3 * t:.8f};{a:.8f};{1e3 * b:.8f}".replace(".", ",") for t, a, b in zip(*record(), strict=True))
    path.write_text("\n".join(["Time;Channel A;Channel B", "(ms);(V);(mV)", "", *rows]) + "\n", encoding="utf-8")


def _labview(path: Path) -> None:
    lines = [
        "LabVIEW Measurement\t", "Writer_Version\t2", "Reader_Version\t2", "Separator\tTab", "Decimal_Separator\t,", "Multi_Headings\tNo",
        "X_Columns\tOne", "Time_Pref\tRelative", "Operator\tbench", "Date\t2026/11/26", "Time\t08:00:00,5", "***End_of_Header***\t", "\t",
        "Channels\t2\t\t", "Samples\t4096\t4096\t", "Date\t2026/11/26\t2026/11/26\t", "Time\t08:00:00,5\t08:00:00,5\t", "Y_Unit_Label\tVolts\tVolts\t",
        "X_Dimension\tTime\tTime\t", "X0\t0,0000000000000000E+0\t0,0000000000000000E+0\t", f"Delta_X\t{1.0 / RATE:.6f}\t{1.0 / RATE:.6f}\t",
        "***End_of_Header***\t\t\t", "X_Value\tForce\tGap\tComment",
    ]  # fmt: skip
    lines += [f"{t:.6f}\t{a:.6f}\t{b:.6f}".replace(".", ",") for t, a, b in zip(*record(), strict=True)]
    path.write_text("\r\n".join(lines) + "\r\n", newline="")


def _tdms(path: Path) -> None:
    from nptdms import ChannelObject, TdmsWriter

    clock = {"wf_increment": 1.0 / RATE, "wf_start_offset": 0.0, "unit_string": "V"}
    _, force, moved = record()
    with TdmsWriter(path) as writer:
        writer.write_segment(
            [ChannelObject("Bench", name, volts, clock) for name, volts in (("ai0", force), ("ai1", moved))]
        )


#: Instrument -> file's name, writer, and its names of the two channels.
FILES = {
    "tektronix": ("tek0001.csv", _tektronix, ("CH1", "CH2")),
    "keysight": ("scope_1.csv", _keysight, ("1", "2")),
    "rigol": ("NewFile1.csv", _rigol, ("CH1", "CH2")),
    "picoscope": ("20261126-0001.csv", _picoscope, ("Channel A", "Channel B")),
    "labview": ("test.lvm", _labview, ("Force", "Gap")),
    "tdms": ("bench.tdms", _tdms, ("ai0", "ai1")),
}


def write(instrument: str, folder: Path) -> tuple[Path, dict[str, str]]:
    """The file of an instrument, and the meaning of its channels."""
    name, writer, channels = FILES[instrument]
    writer(folder / name)
    return folder / name, dict(zip(channels, SENSITIVITIES, strict=True))
