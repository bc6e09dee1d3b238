"""What disks, power cuts and foreign programs do to a file: each is given the file, another whole one of its kind, and chance."""

import random
import shutil
from collections.abc import Callable
from pathlib import Path

PAGE = 4096
Harm = Callable[[Path, Path, random.Random], None]


def cut(path: Path, other: Path, chance: random.Random) -> None:
    content = path.read_bytes()
    path.write_bytes(content[: chance.randrange(1, len(content))])


def zeroed_tail(path: Path, other: Path, chance: random.Random) -> None:
    content = path.read_bytes()
    begin = chance.randrange(1, len(content))
    path.write_bytes(content[:begin] + bytes(len(content) - begin))


def zeroed_page(path: Path, other: Path, chance: random.Random) -> None:
    content = bytearray(path.read_bytes())
    begin = PAGE * chance.randrange(-(-len(content) // PAGE))
    content[begin : begin + PAGE] = bytes(len(content[begin : begin + PAGE]))
    path.write_bytes(bytes(content))


def flipped(path: Path, other: Path, chance: random.Random) -> None:
    """One bit."""
    content = bytearray(path.read_bytes())
    content[chance.randrange(len(content))] ^= 1 << chance.randrange(8)
    path.write_bytes(bytes(content))


def swapped_pages(path: Path, other: Path, chance: random.Random) -> None:
    content = path.read_bytes()
    pages = [content[k : k + PAGE] for k in range(0, len(content), PAGE)]
    if len(pages) > 1:
        i, j = chance.sample(range(len(pages)), 2)
        pages[i], pages[j] = pages[j], pages[i]
    path.write_bytes(b"".join(pages))


def page_of_another(path: Path, other: Path, chance: random.Random) -> None:
    """One page of the other file, which was written back to the wrong place."""
    content, foreign = bytearray(path.read_bytes()), other.read_bytes()
    begin = PAGE * chance.randrange(-(-min(len(content), len(foreign)) // PAGE))
    content[begin : begin + PAGE] = foreign[begin : begin + PAGE]
    path.write_bytes(bytes(content))


def another(path: Path, other: Path, chance: random.Random) -> None:
    """The other file whole, under this one's name."""
    shutil.copyfile(other, path)


def no_such_file(path: Path, other: Path, chance: random.Random) -> None:
    """Text of another program."""
    path.write_bytes(b"x,y\n" * chance.randint(1, 5000))
