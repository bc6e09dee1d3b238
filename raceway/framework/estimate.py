"""How an error was estimated, or why it is not known: a sentence for result.json, and a few words for a screen.

A part of the program, and a kind of bodies, states an estimate as a size and a note; a note is made of a member of ``Estimate``, or
is a plain sentence, which screens show as it stands.
"""

from enum import Enum, unique


class Note(str):
    """A sentence, ``short`` as a screen says it, and the member of the estimate that the note is made of."""

    short: str
    estimate: "Estimate | None"

    def __new__(cls, sentence: str, short: str = "", estimate: "Estimate | None" = None) -> "Note":
        note = super().__new__(cls, sentence)
        note.short, note.estimate = short, estimate
        return note


def few_words(note: str) -> str:
    """The few words of a note; a plain sentence as it stands."""
    return note.short if isinstance(note, Note) else note


@unique
class Estimate(Enum):
    """Sentence and few words of each way to estimate an error, by default those before its reason; a call fills names in braces in.

    Examples
    --------
    >>> note = Estimate.SECOND_RUN(change="half as many steps", order=2)
    >>> print(note, "|", note.short)
    run with half as many steps, order 2 | second run, half as many steps
    """

    # fmt: off
    # The total.
    SUM = ("time step and transient with their phases, at least half the larger; plus identification, mesh and calibration",
           "sum of the parts below")
    SUM_OF_LAST_WINDOW = (f"{SUM[0]}; of the last window alone, at {{rpm:.6g}} r/min", f"{SUM[1]} at {{rpm:.6g}} r/min")
    MESH_UNKNOWN = ("not estimated: the error of the mesh is unknown and the largest", "the error of the mesh is unknown")
    TURNS_DIFFER = ("not estimated: no steady motion was found, and the turns that are used do not repeat",
                    "the turns do not repeat")
    PART_UNKNOWN = ("not estimated: {reasons}", "the error of the {part} is unknown")
    BEYOND_PLAN = ("the run far exceeded its plan",)
    STATIC_SCENE = ("the scene is static: nothing is identified",)

    # The time step.
    NO_TIME_STEP = ("no time step; residual of the equilibrium", "no time step: residual of the equilibrium")
    OF_INTEGRATOR = ("the method's own estimate, of the displacement over its amplitude", "the integrator's own estimate")
    SECOND_RUN = ("run with {change}, order {order}", "second run, {change}")
    SECOND_RUN_COSTS = ("not estimated: a second run of all nodes would cost as much as the first",
                        "a second run would cost as much")
    SECOND_RUN_TOO_LARGE = ("not estimated: the record of a second run with {steps} steps per turn would not fit",
                            "no room for a second run, {steps} steps per turn")
    SECOND_RUN_FAILED = ("the run with {steps} steps per turn failed: {why}",)
    SECOND_RUN_WITHOUT_Z = ("the run with {steps} steps per turn gives no dynamic stiffness",)
    RESIDUAL = ("residual of each equilibrium; more of them change less", "residual of each equilibrium")
    SECOND_SERIES = ("series of {count} instead of {steps} equilibria per turn: harmonics beyond them",
                     "second series, {count} instead of {steps} equilibria per turn")
    SECOND_SERIES_TOO_LARGE = ("not estimated: the record of a second series with {count} equilibria per turn would not fit",
                               "no room for a second run, {count} equilibria per turn")
    SECOND_SERIES_FAILED = ("the series of {count} equilibria per turn failed: {why}",)

    # The transient.
    NO_MOTION = ("no motion is recorded",)
    STEADY = ("one turn of the steady motion: nothing dies out", "none: it is the steady motion")
    EQUILIBRIA = ("a series of equilibria: nothing dies out", "none: equilibria have no transient")
    FROM_STEADY = ("distance from the steady motion, less the part of the time step", "distance from the steady motion")
    STEADY_BEYOND_PLAN = ("the search for the steady motion was {why}",
                          "the search for the steady motion was stopped far beyond the plan")
    STEADY_SPEEDS_UNKNOWN = ("a steady motion of each speed could not be solved for",)
    TURN_BY_TURN = ("largest deviation of a single turn from all turns that are used", "spread of single turns")
    SINGLE_TURN = ("a single turn contains no measure of a transient",)
    LEAKAGE = ("free vibration: its leakage, a plain against Hann's window over all turns that are used, and its shift of Z",
               "free vibration that has not died out")
    OPEN_TURN = ("free vibration that does not close the turn, in the natural modes of the equilibrium",
                 "free vibration that does not close the turn")
    OTHER_START = ("friction: the motion depends on its start: {size:.2g} between this start and '{kind}'; and {transient}",
                   "friction: {size:.2g} between this start and '{kind}'")
    OTHER_START_FAILED = ("friction: the motion depends on its start, and runs from other starts failed: {why}",
                          "friction: the motion depends on its start")
    OTHER_START_WITHOUT_Z = ("friction: the motion depends on its start, and start '{kind}' gives no dynamic stiffness",
                             "friction: the motion depends on its start")

    # The identification.
    TWO_FITS = ("Fourier line against least squares", "two ways to fit the 1x component")
    MISFIT = ("largest misfit of K - m w^2 + j w C, over |Z| there: at {rpm:.6g} r/min",
              "K, C do not fit all speeds: worst at {rpm:.6g} r/min")
    NO_MOTION_AT_SPEED = ("no motion at the scene's own whirl speed, which is none of those of the fit: {why}",
                          "no motion at the scene's own speed")
    NOT_BY_IDENTIFIER = ("identifier '{kind}' gives no estimate",)

    # The mesh of the bodies.
    NO_MESH = ("rigid bodies have no mesh",)
    FINER_MESH = ("not estimated: run the scene with a finer mesh, or with bodies.kind = 'condensed'", "compare with a finer mesh")
    COARSER_MESH = ("largest change of a diagonal stiffness from a mesh twice as coarse",)
    COARSER_MESH_FAILED = ("no equilibrium with the coarser mesh: {why}",)
    FEWER_POINTS = ("a third of the displacement's change from half as many points per semi-axis (order 2)",
                    "a third of the displacement's change from half as many points per semi-axis")
    FEWER_POINTS_NOT_RIPPLE = (f"{FEWER_POINTS[0]}; stiffness ripples less, by {{ripple:.2g}}, with the places of the points",
                               FEWER_POINTS[1])
    FEWER_POINTS_FAILED = ("no equilibrium with half as many points: {why}",)
    FEWEST_POINTS = ("no fewer points to compare with",)
    RIPPLE = ("ripple: radial stiffness at one place of the points over its mean over all places{change}", "ripple")

    # The contacts and their law.
    UNLOADED = ("no contact carries anything",)
    NO_BALL_LOADED = ("no ball carries anything",)
    CALIBRATED = ("calibrated on contacts at surface points: their own error and the change of compliance with the load, over a ball's compliance",
                  "what the calibration of the contacts leaves")
    CALIBRATED_ON_MESH = (f"{CALIBRATED[0]}, with half the spread over depths of what is taken off the mesh", CALIBRATED[1])
    NOT_CALIBRATED = ("compliances are matched at depth: no contact at surface points was found to calibrate them on",
                      "compliances are matched at depth")
    AGAINST_HERTZ = ("largest difference of a contact's stiffness ({stiffness:.1e}) or approach ({approach:.1e}) from exact Hertz at the same load; not part of the total",
                     "against exact Hertz; not in the total")
    HERTZ_ITSELF = ("the law is Hertz's: what it assumes (smooth, dry half-spaces) is not estimated",
                    "Hertz's own assumptions are not judged")
    BEYOND_HERTZ = ("not estimated: what law '{kind}' adds to Hertz at the running speed is no error",)
    LAW_UNKNOWN = (
        "law '{kind}' is calibrated to Hertz on elastic bodies, and nothing in a run measures how well: compare with "
        "contact.discretisation = 'nodal' (docs/condensed.md has both for B7206C)",
        "nothing measures how well '{kind}' keeps to Hertz",
    )
    OVERLAP = ("largest share of a contact's approach that the law lets the surfaces overlap; not part of the total",
               "overlap that the law allows; not in the total")

    # The spread over hypotheses; a screen says why it is not estimated, and nothing else.
    NOTHING_TURNS = ("nothing turns", "")
    HYPOTHESES_STATED = ("every hypothesis of [kinematics] is stated by the scene", "")
    NO_OTHER_HYPOTHESIS = ("no other hypothesis can be run here{why}", "")
    POINTS_TOO_SLOW = ("not estimated: equilibria of bodies '{kind}' at surface points take too long",) * 2
    NO_STEADY_MOTION = ("not estimated: a law with memory or a speed that changes has no steady motion to compare with",) * 2
    BOUND = ("not solved: a closed bound of the change of kyy is {bound:.1e}{why}", "")
    EACH_HYPOTHESIS = ("equilibria under each hypothesis and under all; K: {how}{why}", "")
    # fmt: on

    def __call__(self, **values: object) -> Note:
        sentence = self.value[0]
        words = self.value[1] if len(self.value) > 1 else sentence.removeprefix("not estimated: ").partition(": {why}")[0]
        return Note(sentence.format(**values), words.format(**values), self)
