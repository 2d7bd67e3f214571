"""Where each observable is defined, by rules on what a scene contains; and where no exact value is known.

These are statements of what is right, made without gaspart: a test requires that gaspart refuses the
observable exactly where a rule of `UNDEFINED` says so.
"""

GROUPS = 16
"""Moving bodies of which the scatter is an error."""
FEW = 8
"""Bodies of which the centre of mass, if it is conserved, changes the density."""
NEIGHBOURS = {2: 7, 3: 13}


def _inside(kind):
    return (
        None
        if kind.case.empty
        else "fixed bodies or walls inside: volume and uniform background are undefined"
    )


def _periodic(kind):
    return None if kind.case.periodic.all() else "the container has walls"


def _walled(kind):
    return "the container has no walls" if kind.case.periodic.all() else None


def _closed(kind):
    return "bodies come and go" if kind.opened else None


def _unsheared(kind):
    return "images of the bodies slide" if kind.sheared else None


def _elastic(kind):
    return "contacts lose energy: no equilibrium" if kind.dissipates else None


def _fluctuates(kind):
    return "contacts lose energy: no equilibrium" if kind.dissipates and not kind.sheared else None


def _species(kind):
    return "single bodies belong to no species" if kind.singles else None


def _one_size(kind):
    return "a value of two sizes, but radii differ" if kind.many_sizes else None


def _groups(kind):
    return None if kind.case.count >= GROUPS else f"fewer than {GROUPS} moving bodies"


def _thermal(kind):
    alone = kind.dimension * kind.case.count - kind.conserved < 1
    return "no motion about the centre of mass" if alone else None


def _meets(kind):
    alone = kind.points or (kind.case.count == 1 and not len(kind.case.fixed))
    return "no collisions happen" if alone else None


def _pair(kind):
    return None if kind.case.count > 1 else "a pair needs two bodies"


def _neighbours(kind):
    return None if kind.case.count >= NEIGHBOURS[kind.dimension] else "too few bodies for a neighbourhood"


def _thermal_faces(kind):
    return None if kind.thermal_faces else "no face has a temperature"


def _dragged(kind):
    thermal = bool(kind.thermal_faces)
    return None if thermal and (kind.sliding or kind.driven) else "nothing drags the faces"


def _opened(kind):
    return None if kind.opened else "the number of bodies is constant"


def _stress(kind):
    return None if kind.stress else "stress is exchanged with walls, fixed bodies or fields"


def _smooth(kind):
    return "rough bodies" if kind.rough else None


def _free_axis(kind):
    return None if kind.case.periodic.any() else "displacements are bounded by walls on all axes"


def _lasting(kind):
    lasts = kind.dimension == 2 and kind.conserved
    return "discs with conserved momentum have no diffusion coefficient" if lasts else None


def _two_species(kind):
    pair = len(kind.species) == 2 and not kind.singles
    return None if pair else "needs two species"


def _walled_axis(kind):
    return None if not kind.case.periodic.all() else "images pass a plane across a periodic axis"


def _steady_flow(kind):
    return "motion about a flow that changes with a moving face" if kind.moving_face else None


_STATIC = (_closed, _unsheared, _periodic, _inside)
UNDEFINED = {
    "Z": (*_STATIC, _elastic, _pair, _meets),
    "pressure": (_unsheared, _walled),
    "force": (_unsheared, _walled),
    "heat_flux": (_unsheared, _thermal_faces),
    "wall_shear": (_unsheared, _dragged),
    "collision_rate": (_closed, _meets),
    "pair_rates": (_closed, _unsheared, _species, _meets),
    "contact_values": (*_STATIC, _elastic, _species, _one_size, _pair, _thermal),
    "msd": (_closed, _unsheared, _groups, _steady_flow),
    "D": (_closed, _unsheared, _free_axis, _lasting, _steady_flow),
    "mutual_diffusion": (*_STATIC, _elastic, _two_species, _lasting),
    "vacf": (_closed, _unsheared, _groups, _steady_flow),
    "speeds": (_closed, _groups),
    "rdf": (*_STATIC, _pair),
    "structure_factor": _STATIC,
    "partial_structure_factors": (*_STATIC, _species),
    "chemical_potential": (*_STATIC, _smooth, _elastic, _one_size),
    "density": (),
    "velocity": (),
    "flux": (_unsheared, _walled_axis),
    "number": (_opened,),
    "temperature": (_thermal,),
    "shear_viscosity": (_closed, _stress, _fluctuates),
    "bulk_viscosity": (_closed, _unsheared, _stress, _elastic),
    "thermal_conductivity": (_closed, _unsheared, _stress, _one_size, _elastic),
    "pressure_tensor": (_closed, _stress),
    "order": (*_STATIC, _neighbours),
}
"""Observable -> conditions, each of which gives the reason why it is undefined, or None."""
DYNAMIC = (
    "msd",
    "D",
    "mutual_diffusion",
    "vacf",
    "shear_viscosity",
    "bulk_viscosity",
    "thermal_conductivity",
)
"""Observables of correlations in time."""
BALANCES = ("wall_shear", "flux")
"""Observables that balances of momentum and of bodies give, whatever collides."""
OF_PARTICLES = ("msd", "vacf", "speeds")
"""Observables whose error is the scatter of bodies, which need not exchange energy."""
OF_PLACES = ("pressure", "force", "collision_rate", "density")
"""Observables that depend on the density at walls."""
OF_ALL_PLACES = (*OF_PLACES, "pair_rates")
OF_STRUCTURE = (
    "density", "rdf", "structure_factor", "partial_structure_factors", "order", "chemical_potential",
)  # fmt: skip
"""Observables of the places of all bodies."""
LONG = ("D", "mutual_diffusion", "shear_viscosity", "bulk_viscosity", "thermal_conductivity")
"""Observables that need an integral over collisions, which points do not have."""


def undefined(observable, kind):
    """Return why an observable is undefined in a kind of scene, None if it is defined."""
    return next((why for condition in UNDEFINED[observable] if (why := condition(kind))), None)


def unknown(observable, kind):
    """Return why no exact value of a defined observable is known, None if there must be one."""
    if observable == "wall_shear" and kind.driven and len({one.radius for one in kind.case.groups}) > 1:
        return "how much each size carries has no closed form"
    if observable == "wall_shear" and not (kind.equilibrium or kind.driven or kind.points):
        return "a sheared gas of bodies that collide has no closed form"
    if observable == "msd" and kind.points and kind.exchanges:
        return "flights from thermal faces have no simple law"
    if kind.case.drawn and observable in OF_ALL_PLACES:
        return "the places of the fixed bodies are drawn"
    if "crystal" in kind.run and kind.equation == "exact" and observable in OF_STRUCTURE:
        return "a crystal has no closed form of its structure"
    if "transport" in kind.run and observable in OF_STRUCTURE and observable != "density":
        return "more bodies than are sampled"
    if "transport" in kind.run and observable in LONG and observable != "bulk_viscosity":
        return None  # of Chapman and Enskog
    if observable in DYNAMIC and (
        "short" in kind.run or (kind.name == "halves" and observable == "mutual_diffusion")
    ):
        return None  # the first terms in the time; D_12 of halves is the D of a particle
    if (
        kind.equation == "enskog"
        and not kind.dilute
        and observable in OF_PLACES
        and not kind.case.periodic.all()
    ):
        return "the local contact values of the model at walls have no closed form"
    if kind.integrable and observable == "speeds":
        return "each point keeps its speed: the few points of a bin give no error"
    if kind.integrable and observable not in OF_PARTICLES:
        return "each point keeps its speed: means over time are those of the start"
    if observable == "vacf" and kind.equilibrium:
        return None  # at lag 0
    if observable in DYNAMIC and not kind.points:
        return "correlations in time of bodies that collide have no closed form"
    if observable in OF_PARTICLES and not kind.equilibrium:
        return "flights between plates of two temperatures have no simple law"
    if observable in LONG:
        return "bodies that never collide have no transport coefficient"
    if not kind.equilibrium and not kind.points and observable not in BALANCES:
        return "bodies that collide and are in no equilibrium have no closed form"
    if observable in ("rdf", "structure_factor", "partial_structure_factors", "order") and kind.points:
        return "points have no diameter by which distances are chosen"
    if observable == "chemical_potential" and kind.case.count > 1 and not kind.points:
        return "no body can be inserted: too dense" if kind.name in ("discs_69", "discs_88") else None
    if observable == "density" and kind.name == "discs_88":
        return "a crystal that stays where it is leaves most bins empty"
    if observable == "density" and kind.conserved and kind.case.count < FEW:
        return "the centre of mass of few bodies stays where it was at the start"
    if observable == "speeds" and kind.falls and kind.freedoms is not None:
        return "the energy of flight is not constant"
    if observable == "pressure_tensor" and len(set(kind.case.box.lengths)) > 1:
        return "a box that is no cube may press its axes differently"
    if kind.many_sizes and observable == "contact_values":
        return "radii differ"
    return None
