"""What builds bearings at columns of a scene's keys, and builds once what these leave as it is."""

from collections.abc import Mapping
from functools import cached_property

import attrs
import numpy as np

from raceway.bodies.basis import contact_pairs
from raceway.bodies.columns import OF_PRELOAD, ColumnBearing, running_columns
from raceway.framework.duties import law_params
from raceway.planning.columns import column_problem
from raceway.planning.plan import ScenePlan

#: Tables of a scene that a bearing is built from, beside its speed and loads.
_BUILT = (*OF_PRELOAD, "kinematics")


@attrs.frozen(eq=False, slots=False)
class Builder:
    """Bearings at columns of a scene's keys, ``plan`` of one point; what loads leave as it is, is built once."""

    plan: ScenePlan

    @np.errstate(all="ignore")  # of points that contradict themselves
    def at(self, columns: Mapping[str, np.ndarray]) -> ColumnBearing:
        """The bearing at the points of columns (n,)."""
        return running_columns(self.mounted(columns))

    @np.errstate(all="ignore")
    def mounted(self, columns: Mapping[str, np.ndarray]) -> ColumnBearing:
        """The same with the contact law as at standstill."""
        own, problem = self.plan.problem, column_problem(self.plan.problem, columns)
        bearing = None
        if own.traits.contacts_alone and all(getattr(problem, name) is getattr(own, name) for name in _BUILT):
            speeds = ((p.spin_speed, p.time_constant) for p in (own, problem))
            if problem.excitation is own.excitation or all(np.all(a == b) for a, b in zip(*speeds, strict=True)):
                bearing = self._unloaded and self._unloaded.under(problem)
        return problem.body_kind.columns(self.plan) if bearing is None else bearing

    @cached_property
    def _unloaded(self) -> ColumnBearing | None:
        """At one point; None where a plug-in has changed what the law makes of its contacts."""
        one = attrs.evolve(self.plan.problem, points=(1,))
        bearing: ColumnBearing = one.body_kind.columns(self.plan)
        params = law_params(one.contact.law, contact_pairs(one, bearing.basis))
        return bearing if np.array_equal(params.ravel(), bearing.points.params.ravel()) else None
