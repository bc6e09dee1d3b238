"""The package divided into areas, and the areas that each report measures.

An area is a part of the package whose change may change the numbers of a report.  Every file of the package has one area: that
of the longest place below which it lies.  A report measures the areas that its rows judge, not every module that its run loads.
"""

from __future__ import annotations

#: Places in the package by area: folders, or modules without their suffix.
AREAS = {
    "rigid": """
        bodies/__init__ bodies/basis bodies/contact_error bodies/equilibrium bodies/grooves bodies/model
        bodies/modules bodies/mounting bodies/rigid contact_laws core/__init__ core/contact core/contact_laws
        core/ring/dense core/mesh/ring_section core/ring/__init__ core/ring/equilibrium core/ring/kernels core/ring/ring core/ring/increment core/ring/root
        core/ring/system core/ring/viscous_stiffness data/bearings bodies/pressure pipeline/settle scene/growth scene/inner_ring""",
    "film": "bodies/running contact_laws/film contact_laws/lubricant core/contact/film core/ring/kernels/normal pipeline/damping",
    "motion": """
        core/excitations core/schemes/advance core/ring/changing_speed core/ring/energy core/ring/friction core/schemes core/ring/surrogate core/ring/orbit
        core/ring/start core/signals core/stepping/record core/stepping/states data/forces integrators pipeline/__init__
        pipeline/motion pipeline/run pipeline/simulate pipeline/starting plugins/excitations plugins/identifiers""",
    "periodic": "core/periodic integrators/periodic pipeline/error/steady_motion",
    "fit": "studies/fit",
    "follow": "studies/follow core/periodic/branch core/periodic/doubling core/periodic/special",
    "errors": "pipeline/error pipeline/plausibility",
    "condensed": """
        bodies/condensed bodies/patches core/condensed core/contact/half_space core/contact/sphere core/patches core/revolution/grooves
        core/ring/kernels/between core/ring/kernels/condensed core/ring/kernels/structural core/ring/kernels/structural_rows""",
    "revolution": "core/revolution storage/array_cache",
    "elastic": "bodies/elastic core/elastic core/ring/stepped core/stepping",
    "solids": "core/hexahedron core/linear core/ring/address core/threads",
    "subsurface": """
        bodies/elastic/subsurface core/contact/subsurface core/elastic/contacts/contact_axis core/elastic/contacts/stress_profile
        core/hexahedron/stress_fit""",
    "mesh": "bodies/mesh_fit bodies/mesh_plan bodies/meshing core/mesh data/meshes plugins/formats plugins/meshers",
    "kernels": "core/jit core/signatures framework/plugin_kernel storage/kernel_files",
    "plan": "framework/probe pipeline/allowance planning",
    "scene": """
        framework/options planning/implausible scene/__init__ scene/catalogue scene/bearing scene/changes scene/file scene/given scene/presets scene/reading scene/requires scene/structure
        scene/scene scene/sets scene/tables scene/units scene/unused""",
    "gradients": "pipeline/gradient scene/continuous studies/sensitivities",
    "band": "scene/tolerance scene/tolerance_class studies/band",
    "article": "studies/article data/article",
    "catalogue": """
        data/materials data/printed data/series pipeline/ball_pass scene/materials studies/catalogue studies/infer""",
    "compare": "studies/compare",
    "limits": "studies/limits",
    "map": "studies/map data/map",
    "measured": "studies/measured storage/number_table",
    "precision": "studies/precision studies/many/measured_run",
    "rig": "studies/rig scene/rig",
    "ross": "studies/ross studies/rotor_files",
    "shaft": "studies/shaft",
    "stability": "studies/stability",
    "sweep": """
        framework/orphans plugins/executors studies/many/engine studies/many/identity studies/many/points studies/many/row_store
        studies/many/work studies/sweep""",
    "verify": "data/cases studies/many/reference studies/verify",
    "pages": """
        data/page data/view data/view_stage plugins/reports studies/compare/picture studies/fit/picture studies/many/page studies/map/picture
        studies/precision/labels studies/precision/picture studies/sensitivities/picture studies/stability/picture studies/sweep/picture studies/view""",
    "no report": """
        __init__ __main__ cli commands data/templates errors framework/__init__ framework/contracts framework/duties framework/higher_types framework/hookspecs framework/registry
        framework/doors framework/shown framework/sources front pipeline/facts pipeline/result plugins/__init__ plugins/system_libraries ross scene/schema storage/__init__ storage/cache_folder
        storage/files storage/tables storage/user_files studies/__init__ studies/command studies/many/__init__ studies/many/axes testing
        data/article_elastic studies/article/command studies/article/elastic studies/article/screen studies/compare/command studies/compare/front studies/compare/labelled studies/compare/screen studies/map/command
        studies/law studies/limits/command studies/measured/command studies/measured/front studies/measured/identified studies/precision/command studies/precision/front
        studies/precision/labelled studies/precision/screen studies/band/command studies/band/front studies/fit/command studies/fit/fitted studies/fit/screen studies/sensitivities/command studies/sensitivities/front studies/sensitivities/screen studies/rig/command studies/rig/screen
        studies/ross/command studies/ross/front studies/ross/points studies/ross/screen studies/ross/table studies/stability/command studies/stability/screen studies/sweep/command studies/sweep/front studies/sweep/screen
        studies/sweep/store_command studies/verify/command studies/verify/screen studies/view/command studies/view/front studies/view/view studies/view/mesh_command
        studies/view/mesh_screen""",
}

#: Areas by report; words with a slash are files or folders outside the package.
MEASURES = {
    "article": "rigid motion periodic article examples/b7206.toml",
    "article_mesh": "elastic solids mesh plan revolution condensed examples/b7206_article_mesh.toml",
    "article_points": "rigid periodic article follow",
    "article_motion": "elastic solids mesh rigid revolution condensed examples/b7206_article_mesh.toml",
    "band": "band gradients rigid",
    "catalogue": "catalogue rigid",
    "compare": "rigid motion periodic compare",
    "compare_bodies": "rigid condensed revolution compare",
    "condensed_bodies": "revolution",
    "condensed_calibrated": "rigid condensed revolution examples/b7206_condensed.toml",
    "condensed_cost": "rigid condensed revolution",
    "condensed_friction": "condensed revolution",
    "condensed_patches": "condensed revolution examples/b7206_patches.toml",
    "condensed_seats": "condensed revolution",
    "condensed_walls": "condensed revolution errors",
    "damage": "sweep kernels revolution",
    "dask": "sweep",
    "depth": "rigid motion",
    "details": "rigid elastic examples/b7206_elastic.toml",
    "elastic": "elastic solids examples/b7206_elastic.toml",
    "elastic_dynamics": "elastic solids",
    "elastic_resultants": "elastic solids condensed examples/b7206_elastic_coarse.toml",
    "equilibria": "rigid",
    "error_estimate": "rigid motion errors",
    "error_starts": "rigid motion errors",
    "expected_values": "rigid motion",
    "film": "film rigid motion",
    "fit": "fit measured rig shaft gradients rigid examples/test_rig.toml validation/shaker.py",
    "follow": "rigid motion periodic follow",
    "fuzz": "rigid motion periodic errors mesh plan scene",
    "gradients": "gradients rigid condensed periodic",
    "hexahedron": "solids",
    "identified_stiffness": "rigid motion",
    "identify": "measured rig shaft",
    "leave_out": "plan",
    "map": "rigid motion periodic map",
    "matrix": "rigid motion condensed elastic plan tests/matrix",
    "meaning": "rigid motion film fit compare scene plan errors gradients band",
    "mesh": "mesh",
    # A text that has changed makes the table's test fail, and the fault is written anew.
    "mutants": "benchmarks/mutants/faults.toml",
    "orders": "rigid motion",
    "pages": "pages",
    "periodic": "rigid periodic",
    "plan_time": "plan",
    "precision": "rigid motion periodic errors precision",
    "random_scenes": "rigid motion plan scene",
    "rig": "measured rig shaft examples/test_rig.toml",
    "ross": "ross shaft rigid examples/ross_rotor.py benchmarks/evidence/_ross_rotor.py",
    "running": "rigid motion",
    "sets": "rigid scene limits examples/set_tbt.toml",
    "several_motions": "rigid motion periodic",
    "signals": "sweep raceway/commands/interrupt.py raceway/commands/console.py raceway/__main__.py",
    "speed": "rigid motion kernels",
    "stability": "rigid motion condensed elastic stability",
    "statics": "solids mesh",
    "subsurface": "subsurface elastic solids",
    "swap": "rigid motion kernels",
    "sweep": "sweep",
    "tangent": "rigid",
    "verify": "rigid motion verify",
}
