"""Kinds of bodies that break one duty each; all are rigid ones otherwise."""

from itertools import count

import attrs
import numpy as np

from checks.validation.scenes import built_in
from raceway import ConvergenceError, Mistake, make_plan
from raceway.bodies.rigid_bearing import RigidBearing
from raceway.extend import Cost, System, Traits

Rigid = built_in("bodies", "rigid")

TIMES = count(1)


class Broken(Rigid):
    """Builds ``bearing`` on a ``system``, where those are given."""

    name = "broken"
    bearing, system = RigidBearing, System

    def build(self, problem, plan):
        found = super().build(problem, plan)
        parts = {field.name: getattr(found.system, field.name) for field in attrs.fields(System)}
        return self.bearing(found.basis, self.system(**parts), found.guess)


def made(name, **parts):
    """A kind with other methods, or another bearing or system."""
    return type(name, (Broken,), {"name": name.lower(), **parts})()


def of_bearing(name, **methods):
    return made(name, bearing=type(name, (RigidBearing,), methods))


def of_system(name, **methods):
    return made(name, system=type(name, (System,), methods))


@attrs.frozen
class Undeclared(Rigid):
    """An option without a unit, a help and a rule."""

    name = "undeclared"
    scale: float = 1.0


def twice(_self, _scene, parts):
    for _ in range(2):
        parts.leave_out("elastic rings and balls", "only contacts deform")


def adrift(self, near=None, on_residual=None):
    q, ball, iterations = self.system.solve_equilibrium(self.guess)
    return q + 1e-8, ball, iterations


def larger(_self, problem, plan):
    bearing = Rigid().columns(problem, plan)
    bearing.points.params[:] *= 1.001
    return bearing


def stiff(factor, skew=0.0):
    """A tangent that is ``factor`` times the true one, and not symmetric."""

    def stiffness_at(_self, _q, now):
        found = factor * now.stiffness
        found[0, 1] += skew * now.stiffness[0, 0]
        return found

    return stiffness_at


def pulling(self, *args, **keys):
    now = System.evaluate(self, *args, **keys)
    return attrs.evolve(now, contact_force=now.contact_force - 1e4)


def another(self, *args, **keys):
    now = System.evaluate(self, *args, **keys)
    return attrs.evolve(now, force=1.01 * now.force)


def crooked(self, *args, **keys):
    return tuple(angle + 0.2 for angle in RigidBearing.contact_angles(self, *args, **keys))


def momentary(self, model, q, ball, force, t=0.0):
    """Of the first of several states alone."""
    one = (part.reshape(-1, *part.shape[-order:])[0] for part, order in ((q, 1), (ball, 2), (force, 1)))
    return RigidBearing.contact_angles(self, model, *one)


def drifting(self, problem, plan):
    bearing = Rigid.build(self, problem, plan)
    bearing.system.law_params[:] *= 1.0 + 1e-9 * next(TIMES)
    return bearing


def deaf(self, problem, plan):
    return Rigid.build(self, attrs.evolve(problem, kinematics=attrs.evolve(problem.kinematics, radial_expansion=0.0)), plan)


def dry(self, problem, plan):
    return Rigid.build(self, attrs.evolve(problem, contact=attrs.evolve(problem.contact, friction=0.0)), without(plan))


def without(plan):
    return plan if plan.gyroscopic else attrs.evolve(plan, balls="inertial" if plan.centrifugal else "weightless")


def still(self, problem, plan):
    return Rigid.build(self, attrs.evolve(problem, kinematics=attrs.evolve(problem.kinematics, orbiting=False)), plan)


def single(self, problem, plan):
    if problem.bearing.arrangement != "single":
        raise ConvergenceError("one row only")
    return Rigid.build(self, problem, plan)


def builds(self, problem):
    Rigid.build(self, problem, make_plan(attrs.evolve(problem.scene, bodies=Rigid())))
    return []


#: Kind, the check that it fails, and what that says.
BROKEN = [
    (Undeclared(), "declaration", "scale are not declared"),
    (made("Words", faults=lambda _self, _scene: ["no"]), "faults", "which is no Mistake"),
    (made("Unknown", faults=lambda *_: [Mistake("bearing.rollers", 1, "take another number of them")]), "faults", "no key"),
    (made("Short", faults=lambda *_: [Mistake("bearing.ball_count", 1, "wrong")]), "faults", "names no reason"),
    (made("Picky", faults=lambda *_: [Mistake("load.axial", 1.0, "leave the axial load out")]), "faults", "example is refused"),
    (made("Eager", faults=builds), "faults", "builds a RigidBearing"),
    (made("Number", traits=lambda *_: Traits(compiled=1)), "plan", "more than True and False"),
    (made("Negative", stable_step=lambda *_: -1.0), "plan", "neither None nor a time"),
    (made("Stutter", decide=twice), "plan", "is decided twice"),
    (made("Strange", unused=lambda *_: [("bearing.rollers", "there are none")]), "plan", "which is no key"),
    (made("Endless", cost=lambda *_: Cost(float("nan"))), "plan", "is no time"),
    (made("Nothing", build=lambda *_: None), "build", "returns NoneType"),
    (made("Larger", columns=larger), "columns", "from single points"),
    (of_bearing("Adrift", solve_equilibrium=adrift), "equilibrium", "of the loads is left"),
    (of_system("Stiff", stiffness_at=stiff(1.01)), "tangent", "K dq differs by 0.01"),
    (of_system("Skewed", stiffness_at=stiff(1.0, 1e-4)), "tangent", "K - K\\^T is"),
    (of_system("Pulling", evaluate=pulling), "contacts", "a contact pulls with -"),
    (of_bearing("Crooked", contact_angles=crooked), "contacts", "of them unbalanced"),
    (of_bearing("Momentary", contact_angles=momentary), "contacts", "the angles of three states"),
    (of_bearing("Flat", contact_ellipse=lambda *_: (np.ones(7),) * 3), "told", "begins at 0 without a load"),
    (of_bearing("Mute", mesh_error=lambda *_: 0.1), "told", "mesh_error\\(\\) returns 0.1"),
    (of_bearing("Wide", ball_columns=lambda *_: {"width_m": np.ones(3)}), "told", "not \\(Z,\\)"),
    (of_system("Divided", evaluate=another), "steps", "newmark: drivers differ by"),
    (made("Drifting", build=drifting), "repeats", "`displacement` differs"),
    (made("Deaf", build=deaf), "refused_or_computed", "an expanded inner ring: changes nothing"),
    (made("Dry", build=dry), "refused_or_computed", "friction: changes nothing"),
    (made("Still", build=still), "refused_or_computed", "orbiting balls: changes nothing"),
    (made("Single", build=single), "refused_or_computed", "a pair of rows: neither refused by faults\\(\\) nor computed"),
    (of_bearing("Obscure", report=lambda *_: {"what": object()}), "run", "TypeError"),
]  # fmt: skip
