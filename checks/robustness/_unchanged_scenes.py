"""Scenes of ``unchanged``: the examples, and changes of them so that every kind of every table stands in one at least.

Large elastic meshes are left out: their equilibria are found by conjugate gradients, whose last three digits differ from run to run.
"""

#: Base trees integrate where a scene says no kind.
_NEWMARK = "integrator.kind=newmark"
_QUICK = f"{_NEWMARK} integrator.turns=3 integrator.steps_per_turn=72"
_SMALL = f"{_NEWMARK} integrator.turns=2 integrator.steps_per_turn=24"
_STRUCTURED = "mesh.element_size=2e-3 mesh.nodes_per_semi_axis=2"
_MADE = "excitation.kind=bidirectional excitation.speed_rpm=12000 excitation.unbalance=3.2e-4"
#: Name -> example, and the keys that are changed.
SCENES = {
    **{name: f"{name} {_NEWMARK}" for name in (
        "minimal", "b7206", "duplex_db", "gyroscopic", "measured", "set_tbt", "run_up", "b7206_elastic_coarse",
    )},
    **{name: name for name in ("folds", "hardening_map", "orbiting", "steady_orbit", "test_rig")},
    "penalty": f"b7206 {_QUICK} contact.kind=penalty",
    "penalty, stiffness": f"b7206 {_QUICK} contact.kind=penalty contact.stiffness=3e14",
    "film": f"b7206 {_QUICK} contact.kind=film contact.oil='VG 46' contact.temperature_c=60 contact.roughness=2e-7",
    "friction": f"b7206 {_QUICK} contact.friction=0.1 load.radial=[200,0]",
    "damping band": f"b7206 {_QUICK} contact.damping=band",
    "generalized alpha, loss factor": f"b7206 {_QUICK} integrator.kind=generalized_alpha contact.damping=0 contact.loss_factor=0.02",
    "central difference, from rest": "b7206 integrator.kind=central_difference integrator.turns=2 integrator.start=ramp",
    "periodic, one turn": "b7206 integrator.kind=periodic integrator.symmetry=none load.radial=[300,0]",
    "unidirectional, quasi static, tilt free": f"b7206 {_QUICK} excitation.kind=unidirectional integrator.kind=quasi_static supports.tilt=free",
    "impedance fit, backward whirl": "minimal identifier.kind=impedance_fit identifier.speeds_rpm=[9000,12000] "
                                     "excitation.whirl=backward integrator.kind=periodic",
    "tangent, sprung tilt, moment": f"b7206 {_NEWMARK} identifier.kind=tangent supports.tilt=5e4 load.moment=[2,1] rotor.polar_inertia=1e-3",
    "sine fit, ceramic balls": f"b7206 {_QUICK} identifier.kind=sine_fit bearing.balls.material=Si3N4",
    "axial displacement, fits, temperatures": "b7206 integrator.kind=periodic supports.axial=displacement "
        "mounting.shaft_interference=5e-6 mounting.inner_temperature=10 kinematics.ring_growth=true kinematics.ball_growth=true",
    "outer seat bed, mesh": f"b7206_condensed {_QUICK} {_STRUCTURED} supports.outer_seat=1e13",
    "gyroscopic shared, orbiting": f"gyroscopic {_NEWMARK} kinematics.gyroscopic=shared kinematics.orbiting=true load.radial=[50,0] integrator.turns=4",
    "tolerances": "minimal integrator.kind=periodic tolerances.load.axial='±10 %'",
    "DB, sprung preload": "duplex_db bearing.preload_kind=spring load.axial=200 integrator.kind=periodic",
    "DF": "duplex_db bearing.arrangement=DF integrator.kind=periodic load.radial=[100,50]",
    "DT, static": f"set_tbt bearing.arrangement=DT bearing.preload=0 load.axial=500 {_NEWMARK}",
    "TBT, moved": f"set_tbt {_MADE} {_QUICK}",
    "condensed": f"b7206_condensed {_QUICK} {_STRUCTURED}",
    "condensed, orbiting": f"b7206_condensed {_SMALL} {_STRUCTURED} integrator.kind=quasi_static kinematics.orbiting=true load.radial=[200,0]",
    "points, unilateral": f"b7206_patches {_SMALL} {_STRUCTURED} integrator.kind=quasi_static",
    "points, hertz": f"b7206_patches {_SMALL} {_STRUCTURED} contact.kind=hertz kinematics.orbiting=false integrator.kind=quasi_static",
    "points, penalty, newmark": f"b7206_patches {_SMALL} {_STRUCTURED} contact.kind=penalty integrator.kind=newmark",
    "points, static": f"b7206_article_mesh {_STRUCTURED} bodies.kind=condensed load.radial=[300,0] {_NEWMARK}",
    "elastic, full": f"b7206_elastic_coarse bodies.formulation=full {_NEWMARK}",
    "elastic, one point, penalty": f"b7206_elastic_coarse bodies.formulation=one_point contact.kind=penalty {_NEWMARK}",
    "elastic, points": f"b7206_article_mesh {_STRUCTURED} mesh.nodes_per_semi_axis=1 {_NEWMARK}",
    "elastic, moved": f"b7206_elastic_coarse {_MADE} {_SMALL} load.radial=[0,0]",
}  # fmt: skip
