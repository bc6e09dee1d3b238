"""Dynamic stiffness of ball bearings under axial load and rotor unbalance, with the error and cost of every number.

cli            the command line: ``raceway``
ross           bearings inside rotors of the program ROSS
points         one scene at many points: sweeps, comparisons, precision, bands, branches
answers        how an answer is shown: tables, pages, progress
extend         names for packages and plug-ins beside those below
testing        conformance suites for plug-ins; the scaffold of a new one
pipeline       one run: equilibrium, motion, identification, error, result
contact_laws, integrators   built-in plug-ins of these kinds
plugins        built-in excitations, identifiers, bodies, meshers, formats, quantities and executors
bodies         the bearing as it is built and mounted, rigid rings and balls; from scene and plan to a model
planning       what a scene needs, what is left out, what it will cost
scene          the scene file: tables, catalogue of bearings, schema
framework      kinds of plug-ins: contracts, hooks, options, registry
core           numerics: arrays in, arrays out; core.fem the finite elements
storage        files and caches on disk
errors         exceptions, one class by who must act
data           bearings and what makers print of them, materials, reference cases, meshes, templates of plug-ins

Imports run one way, from the top of this list to its bottom; contact_laws, integrators and plugins do not know each other.
Plug-ins, built in or foreign, are found by the registry alone.

Names below are imported when they are first used, so that ``import raceway`` stays light.

For plug-ins, beside options and their rules:

hookimpl       decorator of a function that hands plug-ins in, named after its hook
Answer         base class of what a study answers: screen, files and picture
Command        a command from the signature and docstring of a function that gives an Answer;  Option  what its line says otherwise
Quantity       declares a number of results
jit            makes a function a kernel of one signature
LAW            signature of a contact law: (gap [m], gap_rate [m/s], params, state_old, state_new, dt [s], force [N], d_gap, d_rate)
FORCE          signature of an excitation: (t [s], params, out (5,) [N, N m])

Examples
--------
>>> import raceway as rw
>>> result = rw.run("examples/b7206.toml")
>>> round(result.equivalent_stiffness * 1e-6, 1)  # K [N/um]
233.9

>>> from raceway import FORCE, hookimpl, jit
>>> @jit(FORCE)
... def turning(t, params, out):
...     out[1], out[2] = params[0] * math.cos(params[1] * t), params[0] * math.sin(params[1] * t)
>>> @hookimpl
... def raceway_excitations():
...     return []
"""

from pathlib import Path

from lazy_loader import attach_stub

__version__ = "0.3.0"

_own, _, _names = attach_stub(__name__, str(Path(__file__).with_name("names.pyi")))


def __getattr__(name: str) -> object:
    """A public name, of this package or of one that is installed beside it."""
    if name in _names:
        return _own(name)
    if name.startswith("_") and name != "__all__":
        raise AttributeError(f"module 'raceway' has no attribute '{name}'")
    if name == "__all__":
        from raceway.framework.loading import public_names

        return sorted([*_names, *public_names()])
    from raceway.framework.loading.registry import further_name

    return further_name(name)


def __dir__() -> list[str]:
    names: list[str] = __getattr__("__all__")  # type: ignore[assignment]
    return names
