"""Channels of LabVIEW's binary files of measurements (.tdms), by nptdms."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from raceway.extend import LARGEST, memory_for, size_of

if TYPE_CHECKING:
    import numpy as np


def read_tdms(path: Path) -> dict[str, np.ndarray]:
    """Header with unit -> numbers (n,), or text, times first, of the file's one group of channels.

    Notes
    -----
    The clock is that of NI's waveform properties, wf_increment [s] and wf_start_offset [s]; channels whose clocks or lengths differ
    are refused.  A file without the properties has a channel of times.

    Raises
    ------
    ValueError
        The channel's fault and remedy.
    """
    import numpy as np
    from nptdms import TdmsFile

    try:
        with memory_for(size_of(path, LARGEST)):
            file = TdmsFile.read(path)
    except OSError:
        raise
    except Exception as why:  # nptdms raises whatever its parsers stumble over
        raise ValueError(f"cannot be read: it is no .tdms file, or damaged ({why})") from None
    last = (file.file_status.channel_statuses or {}).items()
    if incomplete := ", ".join(f"{name} {n}" for name, block in last if (n := block.expected_length - block.read_length)):
        raise ValueError(
            f"is cut off, samples are missing at its end: {incomplete}. Copy it again, or export those that are there"
        )
    channels = [channel for group in file.groups() for channel in group.channels()]
    if not channels:
        raise ValueError("has no channels: save the signals, too")
    columns: dict[str, np.ndarray] = {}
    steps, starts = (
        [channel.properties.get(f"wf_{name}", 0.0) for channel in channels] for name in ("increment", "start_offset")
    )
    clocks = {channel.name: (len(channel), *clock) for channel, *clock in zip(channels, steps, starts, strict=True)}
    if len(clocks) < len(channels):
        raise ValueError("two groups have channels of one name: save one measurement in a file")
    if len(set(clocks.values())) > 1:
        listing = "; ".join(
            f"{name} {count} samples every {step:g} s from {start:g} s" for name, (count, step, start) in clocks.items()
        )
        raise ValueError(f"channels differ in length or clock: {listing}. Save the channels of one task with one rate")
    count, step, start = next(iter(clocks.values()))
    if step > 0.0:
        columns["time (s)"] = start + step * np.arange(count)
    for channel in channels:
        unit = str(channel.properties.get("unit_string", channel.properties.get("NI_UnitDescription", ""))).strip()
        columns[f"{channel.name} ({unit})" if unit else channel.name] = np.asarray(channel[:])
    return columns
