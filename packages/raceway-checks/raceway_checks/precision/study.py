"""Error against run time of a scene's settings, for Python and the command line alike: ``raceway.precision``."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated


from raceway import SceneError, at_least, door
from raceway.extend import (
    DURATION, KEY_VALUES, PATH, PATHS, Registry, SceneSource, ShowProgress, Store, Tables, Vary, parse_change, plain_tables,
    registry_with, resolve, telling, tidy, writable, written,
)  # fmt: skip
from raceway_checks.precision.settings import (
    Design, Reference, Runner, Setting, SettingRun, find_reference, make_design, needs_motion, setting_at,
)  # fmt: skip
from raceway_checks.precision.answer import Precision, words_of
from raceway_checks.precision.timing import Measured, measured_once

if TYPE_CHECKING:
    from raceway.extend import OnProgress

#: Runs of each setting, and the longest predicted run [s].
REPEATS = 3
_LIMIT_S = 30.0


def _study(
    design: Design, reference: Tables, repeats: int, limit_s: float, store: Store, registry: Registry, report: OnProgress
) -> Precision:
    """Every setting run, then the reference of each physics."""
    groups: dict[str, list[Setting]] = {}
    for setting in design.settings:
        if setting.scene is not None:
            groups.setdefault(setting.physics, []).append(setting)
    total = len(design.settings) + len(groups)
    results, references = list[SettingRun](), dict[str, Reference]()

    def tell(label: str) -> None:
        report(label, len(results) + len(references), total)

    for setting in design.settings:
        tell(words_of(setting.values))
        row: Measured = {"status": "refused", "reason": setting.reason, "quantities": {}, "own_error": None, "cost": None}
        order, is_old = None, False
        if setting.scene is not None:
            method = resolve(setting.scene).integrator.method
            order = method.order if needs_motion(setting.scene) and method.inertial else None
            row, is_old = measured_once(setting.scene, repeats, repeats, registry, store)
        results.append(
            {
                "family": setting.family, "model": setting.model, "physics": setting.physics, "setting": setting.values,
                "expected_order": order, **row, "reused": is_old,
            }
        )  # fmt: skip
    runner = Runner(registry, store, limit_s, tell)
    for physics, group in groups.items():
        references[physics] = find_reference(group, runner, reference)
    references = {design.base: Reference({}, {}, "no setting could be run")} | references
    return Precision(
        design.title, tuple(results), references, design.base, design.left_out, design.notes, store.fault, bool(reference)
    )


@door
def precision(
    scene: SceneSource,
    vary: Annotated[Vary | None, KEY_VALUES] = None,
    *,
    reference: Annotated[Vary, KEY_VALUES] = (),
    repeats: Annotated[int, at_least(1)] = REPEATS,
    limit_s: Annotated[float, DURATION] = _LIMIT_S,
    out: Annotated[str | Path | None, PATH] = None,
    kept: Annotated[str | Path | None, PATH] = None,
    plugins: Annotated[Iterable[str | Path], PATHS] = (),
    progress: ShowProgress = None,
) -> Precision:
    """Run a scene with many numerical settings; report run time and error of each against a reference with a known bound.

    Parameters
    ----------
    scene : Scene, path, TOML text or dict of tables
    vary : key of the scene -> its values, whose combinations are run; None: a design made for the scene
    reference : key -> value of the reference; None: chosen automatically
    repeats : runs per setting; the fastest is reported
    limit_s : settings that are predicted to take longer are left out [s]
    out : folder in which finished rows are stored and reused, and precision.json and .md are written; None: nothing is written
    kept : folder of the finished rows instead of ``out``
    plugins : files of one-off plug-ins that the scene uses
    progress : True for a bar on a terminal, or called as ``progress(what, done, total)``

    Returns
    -------
    Precision
        ``judged`` rows with error and time [s], the ``front`` of those that no other beats, the ``cheapest`` within an error

    Raises
    ------
    SceneError
        A mistake in the scene, a value or the reference; nothing has been run.
    RacewayError
        A folder that cannot be written.

    Examples
    --------
    >>> import raceway as rw
    >>> scene = {
    ...     "bearing": {"preset": "B7206C"},
    ...     "load": {"axial": 1000.0},
    ...     "excitation": {"kind": "bidirectional", "speed_rpm": 12000, "unbalance": 3.2e-4},
    ...     "rotor": {"mass": 2.0},
    ... }
    >>> found = rw.precision(scene, {"integrator.steps_per_turn": [45, 90]}, reference={"integrator.steps_per_turn": 720}, repeats=1)
    >>> found.judged[1]["error"] < found.judged[0]["error"]
    True
    """
    registry = registry_with(plugins)
    folder = None if out is None else writable(Path(out))
    design = make_design(plain_tables(scene, registry=registry), vary or (), limit_s, registry)
    # What the user names is checked with the first setting that can run.
    reference_changes = tidy(reference) if isinstance(reference, Mapping) else dict(parse_change(text) for text in reference)
    first = next((setting for setting in design.settings if setting.scene is not None), None)
    if reference_changes and first is not None:
        trial = setting_at(first.tables, "reference", reference_changes, registry)
        if trial.scene is None:
            raise SceneError.at("reference", None, trial.reason)
    with telling(progress) as report, written(kept or folder) as store:
        study = _study(design, reference_changes, repeats, limit_s, store, registry, report)
    if folder is not None:
        study.save(folder)
    return study
