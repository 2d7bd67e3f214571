"""Values of closed form for the kinds of scenes, as parts with an error of 0 (or of direct sampling)."""

import math

import numpy as np
from exact import closed, kinetic, static
from exact.values import stored


def known(observable, kind):
    """Return the parts of an observable whose values have a closed form, {} without any."""
    rule = RULES.get(observable)
    found = rule(kind) if rule else {}
    if kind.equation != "exact" and kind.equilibrium and not found:
        found = kinetic.RULES.get(observable, lambda kind: {})(kind)
    if kind.equation == "exact" and "transport" in kind.run and not found:  # dilute: so is a dense gas
        found = kinetic.RULES.get(observable, lambda kind: {})(kind.under("enskog"))
    return found


def _number(value, error=0.0):
    return {"": [value, error]}


def reservoirs(kind):
    """Return the density, the velocity, the pressure and the temperature of points between two reservoirs."""
    one, faces = kind.case.groups[0], kind.faces.values()
    z = np.array([face["activity"] for face in faces]) / (math.pi * one.radius**2)
    t = np.array([face["temperature"] for face in faces])
    density, pressure = z.sum() / 2.0, (z @ t) / 2.0
    velocity = closed.effusion(1.0, z, one.mass, t) / density
    return density, velocity, pressure, pressure / density - velocity**2 / 2.0


def _temperature(kind):
    if kind.name == RESERVOIRS:
        return {"level": [reservoirs(kind)[3], 0.0]}
    if kind.name in PLATES:
        gas = plates(kind)
        parts = [gas.temperature_across, gas.temperature_of_slide, gas.temperature_along]
        return {"level": [sum(parts[: kind.dimension]) / kind.dimension, 0.0]}
    return {"level": [kind.temperature, 0.0]} if kind.equilibrium else {}


def _density(kind):
    return {"level": [reservoirs(kind)[0], 0.0]} if kind.name == RESERVOIRS else {}


def _velocity(kind):
    d = kind.dimension
    if kind.name == RESERVOIRS:
        return {"x": [reservoirs(kind)[1], 0.0], "y": [0.0, 0.0]}
    if kind.sheared:
        return {}
    if kind.name in PLATES:
        return {"xyz"[k]: [plates(kind).mean_velocity if k == 1 else 0.0, 0.0] for k in range(d)}
    drift = kind.run.get("drift", (0.0,) * d)
    faces = [face["velocity"] for face in kind.faces.values() if face.get("velocity")]
    if faces:
        drift = faces[0]
    return {"xyz"[k]: [drift[k], 0.0] for k in range(d)} if kind.equilibrium else {}


def _heat_flux(kind):
    if kind.name in PLATES:
        gas = plates(kind)
        heat = gas.heat_flux - gas.stress * gas.velocities  # less the work of the drag on each face
        return {"x low": [-float(heat[0]), 0.0], "x high": [float(heat[1]), 0.0]}
    if not kind.equilibrium:
        return {}
    return {name.replace("_", " "): [0.0, 0.0] for name in kind.thermal_faces}


def _wall_shear(kind):
    if kind.name in PLATES:
        stress = plates(kind).stress
        return {"x low,y": [-stress, 0.0], "x high,y": [stress, 0.0]}
    if kind.driven:  # both faces together carry the force, each half of it by symmetry
        case = kind.case
        force = case.box.gravity * sum(one.count * one.mass for one in case.groups)
        faces = [name.replace("_", " ") for name in kind.thermal_faces]
        k = "xyz".index(faces[0][0])
        area = np.delete(case.box.lengths, k).prod()
        axes = [n for n in range(kind.dimension) if n != k]
        return {f"{face},{'xyz'[n]}": [force[n] / area / 2.0, 0.0] for face in faces for n in axes}
    if not kind.equilibrium:
        return {}
    parts = {}
    for name in kind.thermal_faces:
        for n in range(kind.dimension):
            if "xyz"[n] != name[0]:
                parts[f"{name.replace('_', ' ')},{'xyz'[n]}"] = [0.0, 0.0]
    return parts


def _flux(kind):
    if kind.name == RESERVOIRS:
        density, velocity, *_ = reservoirs(kind)
        return _number(density * velocity * kind.case.box.lengths[1])
    return _number(0.0)


def _number_inside(kind):
    if kind.name == RESERVOIRS:
        return _number(kind.case.box.lengths.prod() * reservoirs(kind)[0])
    return {}


def _speeds(kind):
    known_law = kind.equilibrium and (not kind.falls or kind.freedoms is None)
    return {"exact": [1.0, 0.0]} if known_law else {}


def _pressure_tensor(kind):
    """Return n k_B T (Z - 1 / N) on the diagonal: of velocities about the centre of mass, as declared."""
    case = kind.case
    if kind.equation == "exact":
        z, error = (known("Z", kind) or stored()[kind.name]["values"].get("Z", {"": (math.nan, 0)}))[""]
    else:
        z, error = kinetic.compressibility(kind)[""]
    scale, names = case.count * kind.temperature / case.box.lengths.prod(), "xyz"[: kind.dimension]
    if len(set(case.box.lengths)) > 1 or not math.isfinite(z):
        return {}
    diagonal = [scale * (z - 1.0 / case.count), scale * error]
    return {a + b: diagonal if a == b else [0.0, 0.0] for a in names for b in names}


class Short:
    """A gas of equal spheres at times that are short beside the time between collisions.

    The first terms in the time are exact for any density, and follow from the contact value. Each of M =
    n V Gamma / 2 collisions per time hands a momentum m v_n and an energy over the distance sigma, with
    <v_n^2> = 4 T / m: these impulses alone give the coefficients at t = 0. The flight of the particles adds a
    part that grows with t, with the factors of Enskog.
    """

    def __init__(self, kind):
        found = stored()[kind.name]["values"]
        (one,) = kind.case.groups
        self.temperature, self.mass, self.sigma = kind.temperature, one.mass, 2.0 * one.radius
        self.density = one.count / kind.case.box.lengths.prod()
        self.rate, error = found["collision_rate"][""]
        self.relative = error / self.rate
        self.contact = 2.0 * math.pi / 3.0 * self.density * self.sigma**3 * found["contact_values"]["0-0"][0]

    def correlation(self, t):
        """<v(0) v(t)> / d, which decays at first at the rate 2 Gamma / d."""
        return self.temperature / self.mass * np.exp(-2.0 / 3.0 * self.rate * np.asarray(t))

    def slope(self, t):
        """Integral of the correlation until t."""
        decay = 2.0 / 3.0 * self.rate
        return self.temperature / self.mass * (1.0 - np.exp(-decay * np.asarray(t))) / decay

    def displacement(self, t):
        """<|r(t) - r(0)|^2>."""
        decay, t = 2.0 / 3.0 * self.rate, np.asarray(t)
        return 6.0 * self.temperature / self.mass * (t / decay - (1.0 - np.exp(-decay * t)) / decay**2)

    def coefficient(self, t, name):
        """Green and Kubo's integral until t: of the "shear", the "bulk" or the "heat"."""
        impulses = self.density * self.rate * self.sigma**2
        flight = self.density * self.temperature * t
        if name == "bulk":
            return impulses * self.mass / 9.0
        if name == "shear":
            return impulses * self.mass / 15.0 + flight * (1.0 + 0.4 * self.contact) ** 2
        return impulses / 6.0 + 2.5 * flight / self.mass * (1.0 + 0.6 * self.contact) ** 2


def _dilute(kind, number):
    """Return a coefficient of a dilute gas; the error is that of its finite number and density."""
    density = kind.case.count / kind.case.box.lengths.prod()
    diameter = 2.0 * kind.case.groups[0].radius
    value = closed.dilute_transport(density, diameter, kind.temperature)[number]
    return [value, 0.01 * value]


def _short(name):
    """Return the rule of a transport coefficient at the first lag, which counts until half a lag later."""

    def rule(kind):
        if "transport" in kind.run and name != "bulk":
            return {"": _dilute(kind, {"shear": 1, "heat": 2}[name])}
        if "short" not in kind.run:
            return {}
        lag, gas = 0.5 * kind.run["interval"], Short(kind)
        value = gas.coefficient(1.5 * lag, name)
        return {f"lag={lag!r}": [value, gas.relative * value]}

    return rule


def _diffusion(kind):
    if "transport" in kind.run:
        return {"": _dilute(kind, 0)}
    if "short" not in kind.run:
        return {}
    gas, h = Short(kind), kind.run["interval"]
    rise = gas.displacement(3.0 * h) - gas.displacement(h)
    value = float(rise) / (2.0 * h) / 6.0
    return {f"lag={2.0 * h!r}": [value, gas.relative * value]}


def _mutual(kind):
    if "transport" in kind.run:  # of equal bodies: the D of each
        return {"": _dilute(kind, 0)}
    return {"D": [0.0, 0.0]} if "halves" in kind.name else {}


def _vacf(kind):
    if not kind.equilibrium:
        return {}
    case = kind.case
    if "short" in kind.run:
        at = Short(kind).correlation([0.0, kind.run["interval"]])
        return {f"first {n}": [float(at[n]), 0.0] for n in (0, 1)}
    if kind.points and not kind.thermal_faces:
        return {"curve": [1.0, 0.0]}
    return {"lag 0": [sum(g.count / g.mass for g in case.groups) / case.count * kind.temperature, 0.0]}


def _msd(kind):
    if "short" in kind.run:
        return {"first 1": [float(Short(kind).displacement(kind.run["interval"])), 0.0]}
    return {"curve": [1.0, 0.0]} if kind.points and kind.equilibrium and not kind.thermal_faces else {}


def _pressure(kind):
    if kind.name == RESERVOIRS:
        return {f"x {end}": [reservoirs(kind)[2], 0.0] for end in ("low", "high")}
    if kind.name in PLATES:
        gas = plates(kind)
        found = {"x low": [gas.pressure, 0.0], "x high": [gas.pressure, 0.0]}
        if not kind.case.periodic[1]:
            found |= {f"y {end}": [gas.n * gas.temperature_along, 0.0] for end in ("low", "high")}
        return found
    return {}


def _force(kind):
    case, found = kind.case, {}
    for face, (pressure, _) in _pressure(kind).items():
        sides = case.box.lengths - 2.0 * case.groups[0].radius * ~case.periodic
        found[face] = [pressure * float(np.delete(sides, "xyz".index(face[0])).prod()), 0.0]
    return found


def _collision_rate(kind):
    if kind.name == "lorentz":
        radii = kind.case.fixed_radii + kind.case.groups[0].radius
        surface, room = 2.0 * math.pi * radii.sum(), kind.case.box.lengths.prod() - math.pi * (radii**2).sum()
        return _number(closed.santalo_rate(2, 1.0, surface, room))
    if "crystal" in kind.run and kind.equation == "exact":  # the collisions whose virial is Z - 1
        (one,), (z, error) = kind.case.groups, _z(kind)[""]
        speed = math.sqrt(kind.temperature / math.pi / one.mass) * closed.speed_factor(kind.freedoms)
        scale = kind.dimension * speed / one.radius
        return _number(scale * (z - 1.0), scale * error)
    return {}


def _pair_rates(kind):
    if "crystal" not in kind.run:
        return {}
    return {"0-0": _collision_rate(kind)[""]}


def _contact_values(kind):
    if "crystal" not in kind.run:
        return {}
    case, (one,), (z, error) = kind.case, kind.case.groups, _z(kind)[""]
    around = static.sphere(kind.dimension, 2.0 * one.radius)
    scale = case.box.lengths.prod() * kind.dimension / ((case.count - 1) / 2.0 * around * 2.0 * one.radius)
    return {"0-0": [scale * (z - 1.0), scale * error]}


def _z(kind):
    if "crystal" in kind.run and kind.equation == "exact":
        return _number(
            *closed.crystal_z(kind.case.count, 2.0 * kind.case.groups[0].radius, kind.case.box.lengths)
        )
    if kind.name == "two_periodic" and kind.equation == "exact":
        return _number(closed.two_body_z(2, 2.0 * kind.case.groups[0].radius, kind.case.box.lengths.prod()))
    if kind.name == "discs_thinnest" and kind.equation == "exact":  # by the second virial coefficient
        one, sigma = kind.case.groups[0], 2.0 * kind.case.groups[0].radius
        excess = (one.count - 1) * static.sphere(2, sigma) * sigma / (4.0 * kind.case.box.lengths.prod())
        return _number(1.0 + excess, excess**2)
    return {}


RESERVOIRS = "reservoirs"
PLATES = ("plates_free", "plates_free_partial")


def plates(kind):
    """Return the free-molecular gas between the faces across x of a kind."""
    case = kind.case
    (one,) = case.groups
    sides = case.box.lengths - 2.0 * one.radius * ~case.periodic
    faces = [kind.faces["x_low"], kind.faces["x_high"]]
    return closed.FreeMolecular(
        kind.dimension, one.count / sides.prod(), one.mass,
        [face["temperature"] for face in faces],
        [(face.get("velocity") or [0.0, 0.0])[1] for face in faces],
        [face.get("accommodation", 1.0) for face in faces],
    )  # fmt: skip


RULES = {
    "temperature": _temperature,
    "velocity": _velocity,
    "density": _density,
    "heat_flux": _heat_flux,
    "wall_shear": _wall_shear,
    "flux": _flux,
    "number": _number_inside,
    "speeds": _speeds,
    "vacf": _vacf,
    "msd": _msd,
    "pressure": _pressure,
    "force": _force,
    "collision_rate": _collision_rate,
    "pair_rates": _pair_rates,
    "contact_values": _contact_values,
    "Z": _z,
    "pressure_tensor": _pressure_tensor,
    "D": _diffusion,
    "mutual_diffusion": _mutual,
    "shear_viscosity": _short("shear"),
    "bulk_viscosity": _short("bulk"),
    "thermal_conductivity": _short("heat"),
}
