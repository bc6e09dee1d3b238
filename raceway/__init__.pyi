"""The public list: names and the modules that define them, imported when they are first used."""

__version__: str

from .bodies.model import build_model as build_model
from .cli.command import Command as Command, Option as Option
from .core.jit import jit as jit
from .core.signatures import FORCE as FORCE, LAW as LAW
from .errors import (
    BeyondPlanError as BeyondPlanError,
    ConvergenceError as ConvergenceError,
    MeshError as MeshError,
    Mistake as Mistake,
    PluginError as PluginError,
    RacewayError as RacewayError,
    SceneError as SceneError,
    StabilityError as StabilityError,
)
from .framework.doors import door as door
from .framework.hookspecs import hookimpl as hookimpl
from .framework.options import (
    above as above,
    at_least as at_least,
    between as between,
    finite as finite,
    inside as inside,
    length as length,
    one_of as one_of,
    option as option,
    optional as optional,
    positive as positive,
    word_or as word_or,
    worded as worded,
)
from .out.answer import Answer as Answer
from .out.quantities import Quantity as Quantity
from .pipeline.front import run as run
from .pipeline.result import Result as Result
from .planning.plan import Check as Check, ScenePlan as ScenePlan, check as check, make_plan as make_plan, plan as plan
from .points.band import Band as Band, band as band
from .points.branch import Followed as Followed
from .points.compare import Comparison as Comparison, compare as compare
from .points.follow import follow as follow
from .points.function import Function as Function, PointStatus as PointStatus, function as function
from .points.law import LawCurves as LawCurves, law as law
from .points.precision import Precision as Precision, precision as precision
from .points.sensitivities import Sensitivities as Sensitivities, sensitivities as sensitivities
from .points.sweep import sweep as sweep
from .scene.catalogue import Preset as Preset
from .scene.inputs import evolve as evolve, load_scene as load_scene
from .scene.reading import scene_from_dict as scene_from_dict
from .scene.scene import Scene as Scene
from .studies.app.server import app as app
from .studies.catalogue.catalogue import catalogue as catalogue
from .studies.catalogue.infer import infer as infer
from .studies.catalogue.inferred import Inferred as Inferred
from .studies.fit.fit import fit as fit
from .studies.fit.fitted import Fitted as Fitted
from .studies.fit.identify import Identified as Identified, identify as identify
from .studies.fmu.export import FMU as FMU, export_fmu as export_fmu
from .studies.rotor.export import (
    CoefficientFile as CoefficientFile,
    RossTable as RossTable,
    export_coefficients as export_coefficients,
    export_ross as export_ross,
)
from .studies.view.view import View as View, view as view
