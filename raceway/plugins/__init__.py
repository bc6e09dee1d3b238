"""Built-in plug-ins beside contact laws and integrators, a folder or a file a kind.

excitations  forces
identifiers  dynamic stiffness from motion, by one frequency or along a changing speed
bodies       what rings and balls are made of
quantities   lives, friction, temperatures, films, ball-pass frequencies
meshers      hexahedra of the bodies
executors    processes and clusters for many points, and how workers end
formats      pictures and labelled arrays of one run
"""

from raceway.framework.hookspecs import hookimpl


@hookimpl
def raceway_excitations() -> dict[str, str]:
    return {
        "unidirectional": "raceway.plugins.excitations.harmonic:Unidirectional",
        "bidirectional": "raceway.plugins.excitations.harmonic:Bidirectional",
        "run_up": "raceway.plugins.excitations.harmonic:RunUp",
        "measured": "raceway.plugins.excitations.measured_force:Measured",
    }


@hookimpl
def raceway_identifiers() -> dict[str, str]:
    return {
        "fft_1x": "raceway.plugins.identifiers:Fft1x",
        "sine_fit": "raceway.plugins.identifiers:SineFit",
        "tangent": "raceway.plugins.identifiers:Tangent",
        "impedance_fit": "raceway.plugins.identifiers:ImpedanceFit",
        "order_tracking": "raceway.plugins.identifiers:OrderTracking",
    }


@hookimpl
def raceway_bodies() -> dict[str, str]:
    return {
        "rigid": "raceway.plugins.bodies.rigid:Rigid",
        "condensed": "raceway.plugins.bodies.condensed:Condensed",
        "elastic": "raceway.plugins.bodies.elastic:Elastic",
        "cylindrical_rollers": "raceway.plugins.bodies.rollers:CylindricalRollers",
    }


@hookimpl
def raceway_meshers() -> dict[str, str]:
    return {"structured": "raceway.plugins.meshers:Structured"}


@hookimpl
def raceway_formats() -> dict[str, str]:
    return {"pictures": "raceway.plugins.formats:Pictures"}


@hookimpl
def raceway_quantities() -> dict[str, str]:
    return {
        "ball_pass": "raceway.plugins.quantities.kinematics:BallPass",
        "film": "raceway.plugins.quantities.film:FilmThickness",
        "film_parameter": "raceway.plugins.quantities.film:FilmParameter",
        "friction": "raceway.plugins.quantities.friction:Friction",
        "sliding": "raceway.plugins.quantities.kinematics:Sliding",
        "life": "raceway.plugins.quantities.life:Life",
        "heat": "raceway.plugins.quantities.heat:Temperatures",
    }


@hookimpl
def raceway_executors() -> dict[str, str]:
    return {
        "serial": "raceway.plugins.executors:Serial",
        "processes": "raceway.plugins.executors:Processes",
        "dask": "raceway.plugins.executors:Dask",
    }
