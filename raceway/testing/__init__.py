"""Conformance suites for plug-ins, one for each kind; public, for third parties' own tests.

suite          what all suites share: duties, rows, expected failures, how they become pytest methods, children with limits;
               scenes, models and results of a bearing
contact_law, integrator, bodies   one suite a file;  signals: excitations, identifiers
kinds          suites of few duties: formats, meshers, quantities, executors, studies
systems        small mechanical systems with known answers, compiled loops

Subclass a suite in a test file, and pytest collects its checks::

    from raceway.testing import ContactLawSuite

    class TestMyLaw(ContactLawSuite):
        plugin = MyLaw()

or run all checks at once with ``check(entry)``, as ``raceway dev check-plugin [KIND:]NAME`` does.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from raceway.framework.loading.registry import Entry, Registry
    from raceway.testing.suite import Conformity, Suite

#: kind -> (module, class) of its suite
SUITES: dict[str, tuple[str, str]] = {
    kind: (f"raceway.testing.{module}", f"{kind.title().replace('_', '')}Suite")
    for module, kinds in {
        "contact_law": "contact_law", "signals": "excitation identifier", "integrator": "integrator", "bodies": "bodies",
        "kinds": "mesher format quantity executor study",
    }.items()
    for kind in kinds.split()
}  # fmt: skip
_PUBLIC = {
    **{name: module for module, name in SUITES.values()},
    **dict.fromkeys(("Conformity", "DutyResult", "Suite", "duty", "require"), "raceway.testing.suite"),
    # What tests of single steps need beside the public functions.
    **dict.fromkeys(("b7206c", "model_of", "settled"), "raceway.testing.suite"),
    **dict.fromkeys(("Registry", "default_registry"), "raceway.framework.loading.registry"),
    **dict.fromkeys(("drive", "example_pairs", "exponents"), "raceway.testing.contact_law"),
    **dict.fromkeys(("ball_growth", "groove_depth", "load_at_edge", "ring_inertia"), "raceway.scene.growth"),
    "samples": "raceway.testing.signals",
    **dict.fromkeys(("Model", "calibration_error"), "raceway.bodies.model"),
    **dict.fromkeys(("PATIENCE", "Allowance", "run"), "raceway.pipeline.run"),
    **dict.fromkeys(("peak_at_nodes", "peak_at_points"), "raceway.plugins.bodies.elastic_stress"),
    "pressure_field": "raceway.plugins.bodies.patch_bearing",
    "solve_equilibrium": "raceway.pipeline.equilibrium",
    "simulate": "raceway.pipeline.simulate",
    "series_warnings": "raceway.pipeline.identified",
    "band_of_samples": "raceway.points.band",
}
__all__ = sorted([*_PUBLIC, "SUITES", "check", "check_named", "suite_of"])


def __getattr__(name: str) -> object:
    if name in _PUBLIC:
        return getattr(import_module(_PUBLIC[name]), name)
    raise AttributeError(f"module 'raceway.testing' has no attribute '{name}'")


def suite_of(kind: str) -> type[Suite]:
    """The suite class of a kind of plug-in."""
    module, name = SUITES[kind]
    return getattr(import_module(module), name)


def check(entry: Entry) -> Conformity:
    """Run every check of the kind's suite on a registered plug-in, from ``Registry.find`` or ``Registry.find_any``."""
    return suite_of(entry.kind).conformity(entry.plugin, entry.kind, entry.name)


def check_named(text: str, registry: Registry | None = None) -> Conformity:
    """``check`` for ``[KIND:]NAME``.

    Raises
    ------
    PluginError
        A name that is unknown, or that means more than one plug-in; the message lists the choices.
    """
    from raceway.framework.loading.registry import default_registry

    return check((registry or default_registry()).find_any(text))
