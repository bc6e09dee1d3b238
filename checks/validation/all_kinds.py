"""Scenes of ``unchanged`` and of the records: the examples, and changes of them so that every kind of every table and most keys stand in one at least.

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
    "rollers": f"cylindrical_rollers {_QUICK} bodies.crown=5e-4 bodies.laminae=12 load.moment=[2,1] supports.tilt=2e4",
    "rollers, oil": f"cylindrical_rollers {_NEWMARK} bodies.roller_length=8e-3 lubricant.oil='VG 68' lubricant.temperature_c=50",
    "every size": "b7206 integrator.kind=periodic bearing.ball_count=13 bearing.ball_diameter=9e-3 bearing.conformity_inner=0.52 "
        "bearing.conformity_outer=0.53 bearing.contact_angle_deg=18 bearing.first_ball_azimuth_deg=7 bearing.tilt_arm=pitch "
        "bearing.pitch_diameter=45e-3 bearing.rings.material=440C bearing.balls.density=7000 bearing.balls.young=2.5e11 "
        "bearing.balls.poisson=0.25 load.radial=[100,200] load.moment=[1,0.5] supports.tilt=free rotor.transverse_inertia=2e-3 rotor.polar_inertia=1e-3",
    "clearance, shoulders": "b7206 integrator.kind=quasi_static excitation.kind=unidirectional bearing.radial_clearance=2e-5 bearing.shoulder_height=1e-3 load.radial=[900,0] "
        "excitation.direction_deg=30 excitation.phase_lag_deg=80 kinematics.radial_expansion=2e-6 kinematics.spin_speed_rpm=8000",
    "one direction, harmonics": f"b7206 {_QUICK} excitation.kind=unidirectional excitation.direction_deg=30 identifier.kind=sine_fit identifier.harmonics=3 "
        "integrator.beta=0.3 integrator.gamma=0.6 integrator.tolerance=1e-11 excitation.ramp_turns=1",
    "time constant, rho": f"b7206 {_QUICK} integrator.kind=generalized_alpha integrator.rho_infinity=0.6 contact.damping=0 "
        "contact.time_constant=1e-7 rotor.damping=50",
    "penalty, calibrated": f"b7206 {_QUICK} contact.kind=penalty contact.calibrate_at=150 contact.friction=0.08 contact.stick_stiffness=5e7",
    "own oil": f"b7206 {_QUICK} contact.kind=film contact.viscosity_40=32e-6 contact.viscosity_100=5.4e-6 contact.temperature_c=45 contact.density=850 "
        "contact.pressure_viscosity=2e-8 contact.starvation=0.7 contact.inlet_heating=none quantities.film_parameter.roughness=1e-7",
    "losses, life": f"b7206 {_QUICK} lubricant.viscosity_40=32e-6 lubricant.viscosity_100=5.4e-6 lubricant.temperature_c=55 lubricant.oil_fraction=0.1 "
        "lubricant.drag_coefficient=0.4 lubricant.eyring_stress=4e6 lubricant.traction_limit=0.04 quantities.friction.seal_torque=0.01 "
        "quantities.friction.cage_torque=0.002 quantities.life.contamination=0.8 quantities.life.reliability=0.95 load.radial=[600,0]",
    "orbiting, life, gyroscopic": f"gyroscopic {_NEWMARK} lubricant.oil='VG 46' lubricant.temperature_c=50 quantities.life.viscosity_ratio=2 kinematics.orbiting=true "
        "load.radial=[500,0] integrator.turns=4",
    "mounted": "b7206 integrator.kind=periodic mounting.shaft_interference=8e-6 mounting.shaft_bore=12e-3 mounting.shaft_material.material=Si3N4 "
        "mounting.housing_interference=4e-6 mounting.housing_diameter=90e-3 mounting.housing_material.material=AlMgSi mounting.outer_temperature=-4 "
        "mounting.inner_temperature=6 mounting.ball_temperature=9 kinematics.ring_growth=true supports.axial=displacement",
    "warm pair": f"duplex_db {_NEWMARK} bearing.preload_kind=rigid lubricant.oil='VG 32' heat.oil_inlet_c=25 heat.oil_flow='300 cm3/min' "
        "heat.ambient_c=25 heat.inner_wetting=0.6 heat.shaft_ambient=2 heat.housing_ambient=6 mounting.shaft_interference=5e-6 kinematics.ring_growth=true",
    "warm, sprung": f"duplex_db {_NEWMARK} bearing.preload_kind=spring bearing.spring_travel=2e-5 lubricant.oil='VG 32' heat.oil_inlet_c=30 heat.oil_flow=4e-6 excitation.speed_rpm=5000",
    "unequal preloads": "duplex_db bearing.second_preload=400 integrator.kind=periodic rotor.mass=3 load.axial=80 load.moment=[1,2]",
    "seats": f"b7206_condensed {_QUICK} {_STRUCTURED} supports.inner_seat=2e13 supports.outer_seat=1e13 load.radial=[300,100]",
    "elastic, full": f"b7206_elastic_coarse bodies.formulation=full {_NEWMARK}",
    "elastic, one point, penalty": f"b7206_elastic_coarse bodies.formulation=one_point contact.kind=penalty {_NEWMARK}",
    "elastic, points": f"b7206_article_mesh {_STRUCTURED} mesh.nodes_per_semi_axis=1 {_NEWMARK}",
    "elastic, moved": f"b7206_elastic_coarse {_MADE} {_SMALL} load.radial=[0,0]",
}  # fmt: skip
