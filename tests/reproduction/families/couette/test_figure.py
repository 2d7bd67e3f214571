from reproduction.families.couette.data import measured
from reproduction.families.drawn import Points, draw, shows

from gaspart.reproduction.families.couette.figure import couette
from gaspart.reproduction.families.shared.rows import estimates


def test_profiles_and_coefficients_are_drawn():
    ds = measured()
    velocity, temperature, stress, viscosity, slip, normal = draw(couette, ds).axes

    def points(label, x, name, *which, shift=0.0):
        one = ds.isel(point=list(which))
        return Points(label, one[x] + shift, *estimates(one, name))

    flows = (("free flight", 2), ("dilute", 3), ("dense", 4))
    shows(velocity, "x/L", "u/U", *(points(name, "place", "flow", n) for name, n in flows))
    squares = {n: (ds["speed"][n] * ds["flow"][n]) ** 2 for n in (1, 0)}
    warm = {n: estimates(ds.isel(point=n), "temperature") for n in squares}
    names = {1: "fast walls", 0: "slow walls"}
    shows(temperature, "u^2", "temperature", *(Points(names[n], squares[n], *warm[n]) for n in squares))
    both = (("DSMC", 0, 2), ("event-driven", 3))
    shows(stress, "Knudsen", "stress", *(points(name, "knudsen", "stress", *n) for name, *n in both))
    uniform = points("response, without walls", "packing_fraction", "viscosity", 5, 6, shift=-0.005)
    still = points("Green-Kubo", "packing_fraction", "viscosity", 7, shift=0.005)
    both = (("DSMC", 0), ("event-driven", 3, 4))
    eta = "packing_fraction"
    shows(
        viscosity, "packing fraction", "Enskog",
        *(points(name, eta, "viscosity", *n) for name, *n in both), uniform, still,
    )  # fmt: skip
    shows(slip, "packing fraction", "slip", *(points(name, eta, "slip", *n) for name, *n in both))
    dilute = ds.isel(point=[0, 1])
    square = dilute["reduced_rate"] ** 2
    axes = {"x": "gradient", "y": "flow", "z": "vorticity"}
    series = (Points(name, square, *estimates(dilute, f"normal_{key}")) for key, name in axes.items())
    shows(normal, "a^2", "normal stress", *series)
