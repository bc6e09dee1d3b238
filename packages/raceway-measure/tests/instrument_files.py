"""Files as instruments write them, of one record of force and displacement whose K is known.

Sources of the formats
----------------------
tektronix : MDO3014: lines of the file that the task "box of blink" of the 35C3 CTF (2018) published; write-ups quote them.
keysight : InfiniiVision 3000T X-Series User's Guide, "CSV and ASCII XY file structure" (p. 389), which prints no example; readers quote lines.
rigol : DS1054Z, as the reader github.com/vidavidorra/rigol-csv-analyser quotes it.
picoscope : PicoScope 6 User's Guide (psw.en), "Text formats"; semicolons and decimal commas as users of other languages show them.
labview, tdms : NI, Specification for the LabVIEW Measurement File (.lvm), ni.com/tutorial/4139; NI's waveform properties, by nptdms.
digilent : WaveForms, "#Digilent WaveForms Oscilloscope Acquisition", as public readers quote it, ngscopeclient's importer among them.
sox : soxformat(7) of SoX, type .dat: lines that begin with ";", then the time and a number for each channel, blanks between.
siglent : SDS1104X-E as github.com/MartinCowen/SigFyCSV quotes it; two channels as readers of the like-made ATTEN ADS1202CL+ have them.
tensile : github.com/Mat-O-Lab/CSVToCSVW, "Supported CSV formats": "Einspannlänge;832.756" above "Zeit [s];Maschine [mm];Kraft [kN]".
lecroy, rohde-schwarz, graphtec : HDO9404, RTB2000 and GL840 files as readers in many public repositories quote them.
hioki : MEMORY HiCORDER 8807-01 instruction manual, 12.5 "Text File Internal Format" (p. 262).
yokogawa : DLM3000 Features Guide IM DLM3054-01EN, appendix 3 "ASCII Data File Format": the lines of the header; no times in the data.
matlab : writetimetable, mathworks.com/matlabcentral/answers/801181: "Time,Var1,Var2" and "1 sec,-0.2,0.03".
tds : TDS oscilloscopes: "Record Length,2.5e+03,,-0.5,0.02", settings beside the samples of one channel.
"""

from pathlib import Path

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


STEP = f"{1.0 / RATE:.9e}"
#: Instrument -> file's name, lines above the rows, a row of its number k, time t [s] or ms, and voltages a, b.
FORMS = {
    "tektronix": (
        "tek0001.csv",
        "Model,MDO3014\nFirmware Version,1.26\n\nWaveform Type,ANALOG,\nPoint Format,Y,\nHorizontal Units,s,\nHorizontal Scale,0.04,\n,,\n"
        f"Sample Interval,{STEP},\nRecord Length,4096,\nGating,0.0% to 100.0%,\n,,\nVertical Units,V,V\nVertical Scale,1,0.02\n,,\n"
        "Label,Force,Gap\nTIME,CH1,CH2\n", "{t:.8e},{a:.6e},{b:.6e}"),
    "keysight": ("scope_1.csv", "x-axis,1,2\r\nsecond,Volt,Volt\r\n", "{t:+.7E},{a:+.5E},{b:+.5E}\r"),
    "rigol": ("NewFile1.csv", f"X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,-1.000000e-01,{1.0 / RATE:.6e}\n", "{k},{a:.5e},{b:.5e},"),
    "picoscope": ("20261126-0001.csv", "Time;Channel A;Channel B\n(ms);(V);(V)\n\n", "{ms:.8f};{a:.8f};{b:.8f}"),
    "labview": (
        "test.lvm",
        "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t,\nMulti_Headings\tNo\nX_Columns\tOne\n"
        "Time_Pref\tRelative\nOperator\tbench\nDate\t2026/11/26\nTime\t08:00:00,5\n***End_of_Header***\t\n\t\nChannels\t2\t\t\nSamples\t4096\t4096\t\n"
        "Date\t2026/11/26\t2026/11/26\t\nTime\t08:00:00,5\t08:00:00,5\t\nY_Unit_Label\tVolts\tVolts\t\nX_Dimension\tTime\tTime\t\nX0\t0,0E+0\t0,0E+0\t\n"
        f"Delta_X\t{1.0 / RATE:.6f}\t{1.0 / RATE:.6f}\t\n***End_of_Header***\t\t\t\nX_Value\tForce\tGap\tComment\n", "{t:.6f}\t{a:.6f}\t{b:.6f}"),
    "digilent": (
        "acq0001.csv",
        "#Digilent WaveForms Oscilloscope Acquisition\n#Device Name: Discovery2\n#Date Time: 2026-11-26 08:00:00.5\n#Sample rate: 8192Hz\n#Samples: 4096\n"
        "#Channel 1: Range: 500 mV/div Offset: 0 V\n\nTime (s),Channel 1 (V),Channel 2 (V)\n", "{t:.7g},{a:.6g},{b:.6g}"),
    "sox": ("bench.dat", "; Sample Rate 8192\n; Channels 2\n", "{t:15.8g} {a:15.11g} {b:15.11g}"),
    "siglent": (
        "SDS00001.csv",
        f"Record Length,Analog:4096\nSample Interval,CH1:{STEP} CH2:{STEP}\nVertical Units,CH1:V CH2:V,,\nHorizontal Units,s,,\nHorizontal Scale,0.0100000,,\n"
        "Model Number,SDS1104X-E,,\n\nSource,CH1,CH2\nSecond,Volt,Volt\n", "{t:.11f},{a:.5f},{b:.6f}"),
    "tensile": (
        "Probe 17.csv", "aktuelle Probe;17\nEinspannlänge;832,756\nProbenbreite b0;11,4\n\nZeit [s];Kraft [V];Weg [V];Bemerkung\n",
        "{t:.9f};{a:.8f};{b:.9f};ok, weiter"),
    "lecroy": (
        "C1--run--00000.csv", "LECROYHDO9404,30152,Waveform\nSegments,1,SegmentSize,4096\nSegment,TrigTime,TimeSinceSegment1\n#1,26-Nov-2026 08:00:00,0\n"
        "Time,Ampl1,Ampl2\n", "{t:.8f},{a:.8g},{b:.8g}"),
    "rohde-schwarz": ("RTB01.CSV", "in s,C1 in V,C2 in V\n", "{t:.7E},{a:.7E},{b:.7E}"),
    "hioki": (
        "MEM0001.TXT",
        '"COMMENT",\n"8807 MEM DATA"\n"DATE", "11-26-2026"\n"TIME", "15:26:55"\n"NUM_SIGS", 3\n"INTERVAL", 1.2207E-04\n"HORZ_UNITS", "S"\n'
        '"VERT_UNITS", "S", "V", "V"\n"SIGNAL", "TIME", "ACH1", "ACH2"\n"DATA"\n', "{t:+.9E}, {a:+.6E}, {b:+.6E}"),
    "yokogawa": (
        "000.CSV",
        '"Header Size","14"\n"Model Name","DLM3000"\n"Comment",""\n"BlockNumber","1"\n"TraceName","CH1","CH2"\n"BlockSize","4096","4096"\n"VUnit","V","V"\n'
        '"SampleRate","8.192E+03","8.192E+03"\n"HResolution","1.220703125E-04","1.220703125E-04"\n"HOffset","0","0"\n"HUnit","s","s"\n'
        '"Date","2026/11/26","2026/11/26"\n"Time","08:00:00","08:00:00"\n\n', ",{a:.6E},{b:.6E}"),
    "graphtec": (
        "261126-080000.CSV",
        "Vendor,GRAPHTEC Corporation\nModel,GL840-M\nSampling interval,0.1220703125ms\nTotal data points,4096\nCH,Signal name,Input\nCH1,\" CH1\",DC\nData\n"
        "Number,Date&Time,ms,CH1,CH2,Alarm1-10\nNO.,Time,ms,V,V,A1234567890\n", "{k},2026/11/26 08:00:00,{k},{a:+.6f},{b:+.6f},LLLLLLLLLL"),
    "matlab": ("TT.csv", "Time,Var1,Var2\n", "{t:.7g} sec,{a:.6g},{b:.6g}"),
    "tds": (
        "F0001CH1.CSV", "Record Length,4.096e+03,,-0.5,0.02\nSample Interval,1.22e-4,,-0.499878,0.04\nTrigger Point,1.2e+03,,-0.499756,0.06\n", ",,,{t:.9f},{a:.6f}"),
}  # fmt: skip
#: Names of both channels, CH1 and CH2 elsewhere; other columns' meaning; words of the message about files that are refused.
CHANNELS = {
    "keysight": ("1", "2"), "picoscope": ("Channel A", "Channel B"), "labview": ("Force", "Gap"), "digilent": ("Channel 1", "Channel 2"),
    "sox": ("column 2", "column 3"), "tensile": ("Kraft [V]", "Weg [V]"), "lecroy": ("Ampl1", "Ampl2"), "rohde-schwarz": ("C1 in V", "C2 in V"),
    "hioki": ("ACH1", "ACH2"), "tdms": ("ai0", "ai1"),
}  # fmt: skip
MEANING = {"graphtec": {"ms": "ignore", "Number": f"time_s*{STEP}"}}
WORDS = {
    "matlab": ("'Var1'", "missing: time", "--map", "the text of 'Time' is left out"),
    "tds": ("'column 5'", "missing: time, force, displacement", '--map "column 4=time_s"', "2 columns"),
}


def write(instrument: str, folder: Path) -> tuple[Path, dict[str, str]]:
    """The file of an instrument, and the meaning of its columns."""
    columns = dict(zip(CHANNELS.get(instrument, ("CH1", "CH2")), SENSITIVITIES, strict=True)) | MEANING.get(instrument, {})
    if instrument == "tdms":
        from nptdms import ChannelObject, TdmsWriter

        clock = {"wf_increment": 1.0 / RATE, "wf_start_offset": 0.0, "unit_string": "V"}
        with TdmsWriter(folder / "bench.tdms") as writer:
            writer.write_segment([ChannelObject("Bench", *both, clock) for both in zip(columns, record()[1:], strict=True)])
        return folder / "bench.tdms", columns
    name, head, row = FORMS[instrument]
    samples = zip(range(1, COUNT + 1), *record(), strict=True)
    rows = "\n".join(row.format(k=k, t=t, ms=1e3 * t, a=a, b=b) for k, t, a, b in samples)
    if instrument in ("picoscope", "labview", "tensile"):
        rows = rows.replace(".", ",")
    (folder / name).write_text(f"{head}{rows}\n", encoding="utf-8", newline="")
    return folder / name, {} if instrument in WORDS else columns
