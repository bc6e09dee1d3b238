"""Conformance suites for plug-ins, one for each kind; public, for third parties' own tests.

suite          what all suites share: duties, rows, expected failures, how they become pytest methods
contact_law, excitation, integrator, identifier, bodies, mesher, format, report, executor, study   one suite a file
steady         duties of integrators that solve for the steady motion
systems        small mechanical systems with known answers;  signals: records with a known stiffness
scenes         scenes, models and results of a bearing;  bearings: scenes and bearings that kinds of bodies are tried on
asked          what else a scene may ask of bodies, and how a bearing shows it
drivers        one driver of a scheme by itself
compiled       the few compiled loops that the suites need;  allocation: what they allocate
child          duties in child processes with limits of time and memory
units          units of options
scaffold       the package of a new plug-in

Subclass a suite in a test file, and pytest collects its checks::

    from raceway.testing import ContactLawSuite

    class TestMyLaw(ContactLawSuite):
        plugin = MyLaw()

or run all checks at once with ``check(entry)``, as ``raceway check-plugin [KIND:]NAME`` does.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from raceway.framework.registry import Entry, Registry
    from raceway.testing.suite import Conformity, Suite

#: kind -> (module, class) of its suite
SUITES: dict[str, tuple[str, str]] = {
    "contact_law": ("raceway.testing.contact_law", "ContactLawSuite"),
    "excitation": ("raceway.testing.excitation", "ExcitationSuite"),
    "integrator": ("raceway.testing.integrator", "IntegratorSuite"),
    "identifier": ("raceway.testing.identifier", "IdentifierSuite"),
    "mesher": ("raceway.testing.mesher", "MesherSuite"),
    "format": ("raceway.testing.format", "FormatSuite"),
    "bodies": ("raceway.testing.bodies", "BodiesSuite"),
    "report": ("raceway.testing.report", "ReportSuite"),
    "executor": ("raceway.testing.executor", "ExecutorSuite"),
    "study": ("raceway.testing.study", "StudySuite"),
}
_PUBLIC = {
    **{name: module for module, name in SUITES.values()},
    "Conformity": "raceway.testing.suite",
    "Row": "raceway.testing.suite",
    "Suite": "raceway.testing.suite",
    "duty": "raceway.testing.suite",
    "require": "raceway.testing.suite",
    # What tests of single steps need beside the public functions.
    **dict.fromkeys(("b7206c", "model_of", "settled"), "raceway.testing.scenes"),
    "Model": "raceway.bodies.model",
    "Registry": "raceway.framework.registry",
    "default_registry": "raceway.framework.registry",
    "run": "raceway.pipeline.run",
    "settle": "raceway.pipeline.settle",
    "simulate": "raceway.pipeline.simulate",
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
    """Run every check of the kind's suite on a registered plug-in.

    Parameters
    ----------
    entry : raceway.framework.registry.Entry, from ``Registry.find`` or ``Registry.find_any``
    """
    return suite_of(entry.kind).conformity(entry.plugin, entry.kind, entry.name)


def check_named(text: str, registry: Registry | None = None) -> Conformity:
    """``check`` for ``[KIND:]NAME``.

    Raises
    ------
    PluginError
        A name that is unknown, or that means more than one plug-in; the message lists the choices.
    """
    from raceway.framework.registry import default_registry

    return check((registry or default_registry()).find_any(text))
