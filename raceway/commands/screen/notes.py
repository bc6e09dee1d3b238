"""What is known of an error in a few words; result.json has the sentences."""

from __future__ import annotations

import re

#: Beginnings of what ``raceway.pipeline.error`` and the bodies say of an estimate, and what a screen says instead.
_SHORT = tuple(
    (re.compile(long, re.DOTALL), short)
    for long, short in (
        (
            r"time step and transient with their phases.*?(?:; of the last window alone, (at .*))?$",
            r"sum of the parts below \1",
        ),
        (r"not estimated: that of the mesh is not known.*", "the error of the mesh is not known"),
        (r"not estimated: no steady motion was found.*", "the turns do not repeat"),
        (r"not estimated: a second run of all nodes.*", "a second run would cost as much"),
        (r"not estimated: the record of a second \w+ with (.*) would not fit", r"no room for a second run, \1"),
        (r"no time step; residual.*", "no time step: residual of the equilibrium"),
        (r"largest misfit of .* over \|Z\| there: (at .*)", r"K, C do not fit all speeds: worst \1"),
        (r"no motion at the scene's own whirl speed.*", "no motion at the scene's own speed"),
        (r"the method's own estimate.*", "the integrator's own estimate"),
        (r"run with (.*), order \d+", r"second run, \1"),
        (r"residual that each equilibrium is solved to.*", "residual of each equilibrium"),
        (r"series of (.*?): harmonics beyond them", r"second series, \1"),
        (r"one turn of the steady motion.*", "none: it is the steady motion"),
        (r"a series of equilibria: nothing dies out", "none: equilibria have no transient"),
        (r"largest deviation of a single turn.*", "how far single turns differ"),
        (r"free vibration: its leakage.*", "free vibration that has not died out"),
        (r"friction remembers how the motion began: (\S+ between this start and \S+);.*", r"friction: \1"),
        (r"distance from the steady motion.*", "distance from the steady motion"),
        (r"Fourier line against least squares", "two ways to fit the 1x line"),
        (r"calibrated on contacts at surface points.*", "what the calibration of the contacts leaves"),
        (r"the law is Hertz's.*", "Hertz's own assumptions are not judged"),
        (
            r"largest difference of a contact's stiffness \((\S+)\) or approach \((\S+)\).*",
            "against exact Hertz; not in the total",
        ),
        (r"largest share of a contact's approach.*", "overlap that the law allows; not in the total"),
        (r"law '(\w+)' is calibrated to Hertz on elastic bodies.*", r"nothing tells how well '\1' keeps to Hertz"),
        (r"not estimated: run the scene with a finer mesh.*", "compare with a finer mesh"),
        (r"not estimated: (.*?)(?: \(.*)?", r"\1"),
    )
)
#: Signs up to which a note is shown whole.
_LONGEST = 70


def short(note: str) -> str:
    """The note of an estimate in a few words; a stranger's up to its first pause."""
    for long, words in _SHORT:
        if found := long.fullmatch(note):
            return found.expand(words).rstrip()
    if len(note) <= _LONGEST:
        return note
    return re.split(r"[;:,(]", note, maxsplit=1)[0].rstrip()
