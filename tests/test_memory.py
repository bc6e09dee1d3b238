"""Memory that is available: the machine's, or what control groups of version 1 and 2 leave, on files as Linux writes them."""

from pathlib import Path

import pytest

from raceway.storage import files as memory

_MIB = 2**20


@pytest.mark.parametrize(("line", "files", "left"), [
    ("0::/", {}, 3000.0),
    ("0::/job", {"job/memory.max": "max", "job/memory.current": "7"}, 3000.0),
    ("0::/job/task", {"job/memory.max": 1000, "job/memory.current": 800, "job/memory.stat": "inactive_file"}, 500.0),
    (
        "4:cpu,memory:/job",
        {f"memory/job/memory.{name}": mib for name, mib in (("limit_in_bytes", 1000), ("usage_in_bytes", 800))}
        | {"memory/job/memory.stat": "total_inactive_file"},
        500.0,
    ),
    ("4:cpu:/job", {"memory/job/memory.limit_in_bytes": 1}, 3000.0),
])  # fmt: skip
def test_pages_of_the_file_cache_are_available_and_a_limit_of_a_group_holds(line, files, left, tmp_path: Path, monkeypatch):
    """Of 4000 MiB 200 are free and 3000 available; of a group's 1000 MiB 800 are in use, 300 of them files that are given back."""
    monkeypatch.setattr(memory, "_PROC", tmp_path)
    monkeypatch.setattr(memory, "_GROUPS", tmp_path / "groups")
    (tmp_path / "self").mkdir()
    (tmp_path / "self/cgroup").write_text(f"1:pids:/\n{line}\n")
    kib = {"MemTotal": 4000, "MemFree": 200, "MemAvailable": 3000}
    (tmp_path / "meminfo").write_text("".join(f"{name}:  {1024 * mib} kB\n" for name, mib in kib.items()))
    for name, content in files.items():
        path = tmp_path / "groups" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        text = f"anon 1\n{content} {300 * _MIB}\n" if name.endswith("stat") else content
        path.write_text(str(text * _MIB if isinstance(text, int) else text))
    assert memory.available_bytes() == left * _MIB
    assert memory.allowed_bytes() == (4000.0 if left == 3000.0 else 1000.0) * _MIB


def test_no_more_is_available_than_allowed():
    assert 0.0 < memory.available_bytes() <= memory.allowed_bytes() < 2.0**50
