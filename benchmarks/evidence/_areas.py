"""The package divided into areas, and the areas that each report measures.

An area is a part of the package whose change may change the numbers of a report.  Every file of the package has one area: that
of the longest place below which it lies.  A report measures the areas that its rows judge, not every module that its run loads.
"""

from __future__ import annotations

#: Places in the package by area: folders, or modules without their suffix.
AREAS = {
    "rigid": """
        contact_laws core/__init__ core/bodies core/contact core/contact_laws core/dense core/equilibrium core/geometry core/hertz core/root
        core/system bodies/__init__ bodies/basis bodies/mounting bodies/rigid model pressure ring ring_section statics data/bearings""",
    "motion": """
        integrators core/advance core/changing_speed core/energy core/excitations core/friction core/identification core/integrators
        core/lines core/orbit core/record core/start core/states plugins/excitations plugins/identifiers motion run simulate starting
        data/forces""",
    "periodic": "core/periodic integrators/periodic steady_motion",
    "errors": "contact_error error_estimate finer_series free_vibration misfit other_start plausibility series_error",
    "condensed": """
        core/condensed core/half_space core/sphere core/bodies/between core/bodies/condensed_inertial core/bodies/condensed_tangential
        core/bodies/condensed_weightless core/bodies/structural core/bodies/structural_rows bodies/calibration_error bodies/compliances bodies/condensed bodies/inertia
        bodies/patches bodies/patch_report""",
    "revolution": "core/revolution array_cache",
    "elastic": """
        core/elastic core/stepping bodies/elastic bodies/elastic_points bodies/elastic_report bodies/elastic_resultants
        bodies/locking""",
    "solids": """
        core/hexahedron core/address core/aggregates core/blocks core/linear_statics core/multigrid core/natural_modes core/rigid""",
    "mesh": """
        core/meshing core/mesh core/mesh_quality core/mesh_summary meshing mesh_fit plugins/meshers plugins/formats data/meshes""",
    "kernels": "core/jit core/kernel_files core/plugin_kernel core/signatures",
    "plan": "plan planning estimate probe allowance",
    "scene": "scene scene_file structure requires options catalogue implausible unused",
    "article": "studies/article data/article",
    "compare": "studies/compare",
    "map": "studies/map data/map",
    "measured": "studies/measured number_table",
    "precision": "studies/precision studies/measured_run",
    "rig": "studies/rig rig",
    "ross": "studies/ross",
    "shaft": "studies/shaft",
    "stability": "studies/stability",
    "sweep": "studies/sweep studies/points studies/processes studies/row_store plugins/executors orphans",
    "verify": "studies/verify studies/reference data/cases",
    "pages": "studies/page studies/view plugins/reports data/page data/view data/view_stage",
    "no report": """
        __init__ __main__ cache_folder cli commands contracts data/templates errors files hookspecs plugin_sources plugins/__init__
        plugins/system_libraries registry result scaffold schema studies/__init__ studies/axes testing trust user_files""",
}

#: Areas by report; words with a slash are files or folders outside the package.
MEASURES = {
    "article": "rigid motion periodic article examples/b7206.toml",
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
    "fuzz": "rigid motion periodic errors mesh plan scene",
    "hexahedron": "solids",
    "identified_stiffness": "rigid motion",
    "identify": "measured rig shaft",
    "leave_out": "plan",
    "map": "rigid motion periodic map",
    "matrix": "rigid motion condensed elastic plan tests/matrix",
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
    "ross": "ross shaft examples/ross_rotor.py",
    "running": "rigid motion",
    "several_motions": "rigid motion periodic",
    "signals": "sweep raceway/commands/interrupt.py raceway/commands/console.py raceway/__main__.py",
    "speed": "rigid motion kernels",
    "stability": "rigid motion condensed elastic stability",
    "statics": "solids mesh",
    "swap": "rigid motion kernels",
    "sweep": "sweep",
    "tangent": "rigid",
    "verify": "rigid motion verify",
}
