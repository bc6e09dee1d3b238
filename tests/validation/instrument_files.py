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
digilent : WaveForms, oscilloscope: lines with "#", an empty line and "Time (s),Channel 1 (V),Channel 2 (V)", as readers of such files in
    public repositories quote them ("#Digilent WaveForms Oscilloscope Acquisition", ngscopeclient's importer among them).
sox : soxformat(7) of SoX, type .dat: header lines begin with ";", then the time and a number for each channel, blanks between.
siglent : SDS1104X-E: "Record Length,Analog:14000" to "Second,Volt", quoted by github.com/MartinCowen/SigFyCSV; two channels as the reader of
    the like-made ATTEN ADS1202CL+ has them.
tensile : github.com/Mat-O-Lab/CSVToCSVW, "Supported CSV formats": "Einspannlänge;832.756" above "Zeit [s];Maschine [mm];Kraft [kN]".
lecroy : HDO9404 and others: "LECROYHDO9404,30152,Waveform" to "Time,Ampl", in readers of many public repositories; several channels in
    one file as tables of them have them.
rohde-schwarz : RTB2000: "in s,C1 in V,C2 in V" as public converters of its files state.
hioki : MEMORY HiCORDER 8807-01 instruction manual, 12.5 "Text File Internal Format" (p. 262).
yokogawa : DLM3000 Features Guide IM DLM3054-01EN, appendix 3 "ASCII Data File Format": the lines of the header; no times in the data.
graphtec : GL840: "Sampling interval", "Number,Date&Time,ms,CH1,...,Alarm1-10" and "NO.,Time,ms,V,...", as public readers quote them.
matlab : writetimetable, mathworks.com/matlabcentral/answers/801181: "Time,Var1,Var2" and "1 sec,-0.2,0.03".
tds : TDS oscilloscopes: "Record Length,2.5e+03,,-0.5,0.02", settings beside the samples of one channel.
"""

from __future__ import annotations

from pathlib import Path

import attrs
import numpy as np

#: Of the record: stiffness [N/m], damping [N s/m], mass [kg]; sensitivities [N/V], [V/um]; samples and their rate [Hz].
STIFFNESS, DAMPING, MASS = 2e7, 900.0, 0.8
NEWTONS_PER_VOLT, VOLTS_PER_MICROMETRE, COUNT, RATE = 100.0, 8e-3, 4096, 8192.0
SENSITIVITIES = (f"force_n*{NEWTONS_PER_VOLT:g}", f"x_um/{VOLTS_PER_MICROMETRE:g}")


def record() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times [s] and voltages (n,) of force and displacement, with noise of 60 dB below them."""
    rng = np.random.default_rng(7)
    time = np.arange(COUNT) / RATE
    force, moved = np.zeros(COUNT), np.zeros(COUNT)
    for hz in np.arange(22.0, 500.0, 6.0):
        omega, phase = 2.0 * np.pi * hz, rng.uniform(0.0, 2.0 * np.pi)
        wave = 20.0 * np.exp(1j * (omega * time + phase))
        force += wave.real
        moved += (wave / (STIFFNESS + 1j * omega * DAMPING - MASS * omega**2)).real
    voltages = force / NEWTONS_PER_VOLT, 1e6 * moved * VOLTS_PER_MICROMETRE
    noisy = (volts + 1e-3 * volts.std() * rng.standard_normal(COUNT) for volts in voltages)
    return time, *noisy


@attrs.frozen
class Form:
    """A text file: its name, the lines above the rows, a row of its index k, time t [s] and voltages a, b, and names of both channels.

    point : decimal sign;  meaning : of other columns;  words : of the message where the file is refused
    """

    name: str
    head: str
    row: str
    channels: tuple[str, str] = ("CH1", "CH2")
    point: str = "."
    meaning: tuple[tuple[str, str], ...] = ()
    words: tuple[str, ...] = ()


STEP = f"{1.0 / RATE:.9e}"
FORMS = {
    "tektronix": Form(
        "tek0001.csv",
        "Model,MDO3014\nFirmware Version,1.26\n\nWaveform Type,ANALOG,\nPoint Format,Y,\nHorizontal Units,s,\nHorizontal Scale,0.04,\n,,\n"
        f"Sample Interval,{STEP},\nRecord Length,4096,\nGating,0.0% to 100.0%,\n,,\nVertical Units,V,V\nVertical Scale,1,0.02\n,,\n"
        "Label,Force,Gap\nTIME,CH1,CH2\n",
        "{t:.8e},{a:.6e},{b:.6e}",
    ),
    "keysight": Form("scope_1.csv", "x-axis,1,2\r\nsecond,Volt,Volt\r\n", "{t:+.7E},{a:+.5E},{b:+.5E}\r", ("1", "2")),
    "rigol": Form("NewFile1.csv", f"X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,-1.000000e-01,{1.0 / RATE:.6e}\n", "{k},{a:.5e},{b:.5e},"),
    "picoscope": Form("20261126-0001.csv", "Time;Channel A;Channel B\n(ms);(V);(V)\n\n", "{ms:.8f};{a:.8f};{b:.8f}", ("Channel A", "Channel B"), ","),
    "labview": Form(
        "test.lvm",
        "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t,\nMulti_Headings\tNo\nX_Columns\tOne\n"
        "Time_Pref\tRelative\nOperator\tbench\nDate\t2026/11/26\nTime\t08:00:00,5\n***End_of_Header***\t\n\t\nChannels\t2\t\t\nSamples\t4096\t4096\t\n"
        "Date\t2026/11/26\t2026/11/26\t\nTime\t08:00:00,5\t08:00:00,5\t\nY_Unit_Label\tVolts\tVolts\t\nX_Dimension\tTime\tTime\t\nX0\t0,0E+0\t0,0E+0\t\n"
        f"Delta_X\t{1.0 / RATE:.6f}\t{1.0 / RATE:.6f}\t\n***End_of_Header***\t\t\t\nX_Value\tForce\tGap\tComment\n",
        "{t:.6f}\t{a:.6f}\t{b:.6f}", ("Force", "Gap"), ",",
    ),
    "digilent": Form(
        "acq0001.csv",
        "#Digilent WaveForms Oscilloscope Acquisition\n#Device Name: Discovery2\n#Date Time: 2026-11-26 08:00:00.5\n#Sample rate: 8192Hz\n#Samples: 4096\n"
        "#Channel 1: Range: 500 mV/div Offset: 0 V\n\nTime (s),Channel 1 (V),Channel 2 (V)\n",
        "{t:.7g},{a:.6g},{b:.6g}", ("Channel 1", "Channel 2"),
    ),
    "sox": Form("bench.dat", "; Sample Rate 8192\n; Channels 2\n", "{t:15.8g} {a:15.11g} {b:15.11g}", ("column 2", "column 3")),
    "siglent": Form(
        "SDS00001.csv",
        f"Record Length,Analog:4096\nSample Interval,CH1:{STEP} CH2:{STEP}\nVertical Units,CH1:V CH2:V,,\nHorizontal Units,s,,\nHorizontal Scale,0.0100000,,\n"
        "Model Number,SDS1104X-E,,\n\nSource,CH1,CH2\nSecond,Volt,Volt\n",
        "{t:.11f},{a:.5f},{b:.6f}",
    ),
    "tensile": Form(
        "Probe 17.csv", "aktuelle Probe;17\nEinspannlänge;832,756\nProbenbreite b0;11,4\n\nZeit [s];Weg [mm];Kraft [kN];Bemerkung\n",
        "{t:.9f};{mm:.9f};{kn:.8f};ok, weiter", ("Kraft [kN]", "Weg [mm]"), ",", (("Kraft [kN]", "force_kn"), ("Weg [mm]", "x_mm")),
    ),
    "lecroy": Form(
        "C1--run--00000.csv", "LECROYHDO9404,30152,Waveform\nSegments,1,SegmentSize,4096\nSegment,TrigTime,TimeSinceSegment1\n#1,26-Nov-2026 08:00:00,0\n"
        "Time,Ampl1,Ampl2\n", "{t:.8f},{a:.8g},{b:.8g}", ("Ampl1", "Ampl2"),
    ),
    "rohde-schwarz": Form("RTB01.CSV", "in s,C1 in V,C2 in V\n", "{t:.7E},{a:.7E},{b:.7E}", ("C1 in V", "C2 in V")),
    "hioki": Form(
        "MEM0001.TXT",
        '"COMMENT",\n"8807 MEM DATA"\n"DATE", "11-26-2026"\n"TIME", "15:26:55"\n"NUM_SIGS", 3\n"INTERVAL", 1.2207E-04\n"HORZ_UNITS", "S"\n'
        '"VERT_UNITS", "S", "V", "V"\n"SIGNAL", "TIME", "ACH1", "ACH2"\n"DATA"\n',
        "{t:+.9E}, {a:+.6E}, {b:+.6E}", ("ACH1", "ACH2"),
    ),
    "yokogawa": Form(
        "000.CSV",
        '"Header Size","14"\n"Model Name","DLM3000"\n"Comment",""\n"BlockNumber","1"\n"TraceName","CH1","CH2"\n"BlockSize","4096","4096"\n"VUnit","V","V"\n'
        '"SampleRate","8.192E+03","8.192E+03"\n"HResolution","1.220703125E-04","1.220703125E-04"\n"HOffset","0","0"\n"HUnit","s","s"\n'
        '"Date","2026/11/26","2026/11/26"\n"Time","08:00:00","08:00:00"\n\n', ",{a:.6E},{b:.6E}",
    ),
    "graphtec": Form(
        "261126-080000.CSV",
        "Vendor,GRAPHTEC Corporation\nModel,GL840-M\nSampling interval,0.1220703125ms\nTotal data points,4096\nCH,Signal name,Input\nCH1,\" CH1\",DC\nData\n"
        "Number,Date&Time,ms,CH1,CH2,Alarm1-10\nNO.,Time,ms,V,V,A1234567890\n", "{k},2026/11/26 08:00:00,{k},{a:+.6f},{b:+.6f},LLLLLLLLLL",
        meaning=(("ms", "ignore"), ("Number", f"time_s*{STEP}")),
    ),
    "matlab": Form("TT.csv", "Time,Var1,Var2\n", "{t:.7g} sec,{a:.6g},{b:.6g}", words=("'Var1'", "missing: time", "--map", "the text of 'Time' is left out")),
    "tds": Form(
        "F0001CH1.CSV", "Record Length,4.096e+03,,-0.5,0.02\nSample Interval,1.22e-4,,-0.499878,0.04\nTrigger Point,1.2e+03,,-0.499756,0.06\n", ",,,{t:.9f},{a:.6f}",
        words=("'column 5'", "missing: time, force, displacement", '--map "column 4=time_s"', "2 columns"),
    ),
}  # fmt: skip


def write(instrument: str, folder: Path) -> tuple[Path, dict[str, str]]:
    """The file of an instrument, and the meaning of its columns."""
    time, force, moved = record()
    if instrument == "tdms":
        from nptdms import ChannelObject, TdmsWriter

        clock = {"wf_increment": 1.0 / RATE, "wf_start_offset": 0.0, "unit_string": "V"}
        channels = [ChannelObject("Bench", name, volts, clock) for name, volts in (("ai0", force), ("ai1", moved))]
        with TdmsWriter(folder / "bench.tdms") as writer:
            writer.write_segment(channels)
        return folder / "bench.tdms", dict(zip(("ai0", "ai1"), SENSITIVITIES, strict=True))
    form = FORMS[instrument]
    newtons, micrometres = NEWTONS_PER_VOLT * force, moved / VOLTS_PER_MICROMETRE
    numbers = zip(range(1, COUNT + 1), time, 1e3 * time, force, moved, 1e-3 * newtons, 1e-3 * micrometres, strict=True)
    rows = [form.row.format(**dict(zip(("k", "t", "ms", "a", "b", "kn", "mm"), row, strict=True))) for row in numbers]
    rows = [row.replace(".", form.point) for row in rows]
    (folder / form.name).write_text(form.head + "\n".join(rows) + "\n", encoding="utf-8", newline="")
    meaning = dict(zip(form.channels, SENSITIVITIES, strict=True)) | dict(form.meaning)
    return folder / form.name, {} if form.words else meaning
