"""One scene at many points, for Python and the command line alike: ``raceway.sweep``."""

from __future__ import annotations

import tempfile
import warnings
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import attrs

from raceway.errors import ConvergenceError, PluginError, SceneError
from raceway.framework.doors import door
from raceway.framework.registry import Registry, registry_with
from raceway.out.progress import telling
from raceway.scene.given import plain_tables
from raceway.storage.files import writable
from raceway.storage.tables import ReadTables, Tables
from raceway.studies.many.points import in_units, numbers_at
from raceway.studies.sweep.dataset import dataset
from raceway.studies.sweep.design import Design, grid, listed_points
from raceway.studies.sweep.engine import Sweep, prepare
from raceway.studies.sweep.engine import sweep as compute
from raceway.studies.sweep.store import Store

if TYPE_CHECKING:
    import xarray

    from raceway.framework.contracts import Executor
    from raceway.out.progress import ShowProgress

SPEED = "excitation.speed_rpm"
_FROM_ZERO = (
    "A force that turns has a speed; K(n) from 0 r/min is the tangent, swept over the speed of the ring: raceway sweep SCENE "
    "--set identifier.kind=tangent --grid kinematics.spin_speed_rpm=0:20000:21 --out STORE, then for rotor programs raceway export "
    "STORE --from tangent --ross bearing.toml"
)
#: Values of the axes by key, or a list of points.
Axes = Mapping[str, Any] | Iterable[Mapping[str, Any]] | Design


@door
def sweep(
    scene: Any,
    axes: Axes,
    *,
    executor: str | Executor = "serial",
    workers: int | None = None,
    store: str | Path | None = None,
    resume: bool = False,
    retry_failed: bool = False,
    plugins: Iterable[str | Path] = (),
    progress: ShowProgress = None,
) -> xarray.Dataset:
    """Compute a scene at every point of a grid or a list.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict of tables
    axes : key of the scene -> its values (array (n,), list, or the text "start:stop:count"), all combinations of which are computed;
        or a list of points, each key -> value
    executor : "serial", "processes", "joblib", "dask" or a plug-in's name, or an executor
    workers : processes of these, by default 2
    store : folder in which every finished point is kept; None: a temporary one, removed when the results are loaded
    resume : go on with a store that is there: compute what is not finished;  retry_failed : failed points again, too
    plugins : files of one-off plug-ins, which the workers load, too
    progress : True for a bar on a terminal, or called as ``progress(what, done, total)``

    Returns
    -------
    xarray.Dataset
        ``equivalent_stiffness`` [N/m], ``equivalent_damping`` [N s/m], ``stiffness`` (..., 5, 5), ``p0`` [Pa] and others over the
        keys of ``axes``, units in their ``attrs``; ``status`` says which points failed, their values are NaN

    Raises
    ------
    SceneError
        A mistake in the scene or in a value of an axis; nothing has been computed.
    PluginError
        An executor that is not known or cannot work.
    ConvergenceError
        Every point failed.
    RacewayError
        A store that cannot be written, or that holds another sweep.

    Notes
    -----
    Worker processes import the program that calls: outside notebooks it keeps what it does below ``if __name__ == "__main__":``.

    Examples
    --------
    >>> import raceway as rw
    >>> found = rw.sweep({"bearing": {"preset": "B7206C"}}, {"load.axial": [400.0, 1000.0]})
    >>> (1e-6 * found.stiffness.sel(dof="y", dof2="y")).round(1).values.tolist()  # kyy [N/um]
    [183.4, 238.2]
    """
    with tempfile.TemporaryDirectory(prefix="raceway-sweep-") as temporary, telling(progress, remaining=True) as told:
        folder = Path(temporary) / "sweep" if store is None else writable(Path(store))
        chosen = executor_of(executor, {"workers": workers}, registry_with(plugins))
        prepared = prepared_sweep(scene, axes, folder, resume or retry_failed, plugins)
        with compute(prepared, chosen, retry_failed, told) as found:
            if (failed := all_failed(found)) is not None:
                raise failed
            return dataset(found, registry_with(plugins))


def prepared_sweep(scene: Any, axes: Axes, store: Path, resume: bool = False, plugins: Iterable[str | Path] = ()) -> Sweep:
    """A sweep that was looked over, nothing computed; options that a change of kind leaves out are warned of.

    Raises
    ------
    SceneError, PluginError, RacewayError
        As ``sweep``.
    """
    files = tuple(Path(file) for file in plugins)
    registry = registry_with(files)
    tables = plain_tables(scene, registry=registry)
    try:
        prepared = prepare(tables, _in_units(design_of(axes), tables, registry), store, files, resume)
    except SceneError as error:
        raise with_static_remedy(error) from None
    for note in prepared.survey.notes:
        warnings.warn(note, stacklevel=2)
    return prepared


def with_static_remedy(error: SceneError) -> SceneError:
    """The same mistakes; who asks for a motion at speed 0 is told how a stiffness from 0 r/min is had."""
    mistakes = [
        attrs.evolve(one, message=f"{one.message}. {_FROM_ZERO}") if one.path == SPEED and one.value == 0 else one
        for one in error.mistakes
    ]
    return SceneError(mistakes)


def design_of(axes: Axes) -> Design:
    """The points of a mapping of axes, or of a list of points."""
    if isinstance(axes, Design):
        return axes
    return grid(axes) if isinstance(axes, Mapping) else listed_points(axes)


def _in_units(design: Design, tables: ReadTables, registry: Registry) -> Design:
    """A design with all values as numbers in the units of their keys."""
    if design.axes:
        return Design(tuple(in_units(axis, tables, registry) for axis in design.axes))
    return Design(listed=tuple(numbers_at(tables, point, registry) for point in design.listed))


def executor_of(name: str | Executor, given: ReadTables, registry: Registry) -> Executor:
    """An executor by its name, with the options that are given and that it has.

    Raises
    ------
    PluginError
        A name that is not known, or an option that it does not have.
    """
    options: Tables = {key: value for key, value in given.items() if value is not None}
    if not isinstance(name, str):
        if options:
            raise PluginError(f"{', '.join(options)}: an executor that is made already has its own")
        return name
    plugin = registry.find("executor", name).plugin
    known = {field.name for field in attrs.fields(plugin)}
    for key in options:
        if key not in known:
            raise PluginError(f"executor '{name}' has no --{key}: leave it out, or choose another --executor")
    try:
        return plugin(**options)
    except ValueError as why:
        raise PluginError(f"executor '{name}': {why}") from None


def all_failed(store: Store) -> ConvergenceError | None:
    """A sweep without any result is none: the error, with the first point's reason."""
    states = store.status()
    if states["failed"] < states["total"]:
        return None
    reason = next(row["reason"] for row in store.rows())
    return ConvergenceError(f"all {states['total']} points failed; the first: {reason}")
