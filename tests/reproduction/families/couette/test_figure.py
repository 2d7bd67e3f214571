from reproduction.families.couette.data import measured
from reproduction.families.drawn import Points, draw, estimates, shows

from gaspart.reproduction.families.couette.figure import couette


def test_profiles_and_coefficients_are_drawn():
    ds = measured()
    velocity, temperature, stress, viscosity, slip, normal = draw(couette, ds).axes

    def points(x, name, *which, shift=0.0):
        one = ds.isel(point=list(which))
        return Points(one[x] + shift, *estimates(one, name))

    shows(velocity, *(points("place", "flow", n) for n in (2, 3, 4)))
    squares = {n: (ds["speed"][n] * ds["flow"][n]) ** 2 for n in (1, 0)}
    warm = {n: estimates(ds.isel(point=n), "temperature") for n in squares}
    shows(temperature, *(Points(squares[n], *warm[n]) for n in squares))
    shows(stress, points("knudsen", "stress", 0, 2), points("knudsen", "stress", 3))
    eta = "packing_fraction"
    uniform = points(eta, "viscosity", 5, 6, shift=-0.005)
    still = points(eta, "viscosity", 7, shift=0.005)
    shows(viscosity, points(eta, "viscosity", 0), points(eta, "viscosity", 3, 4), uniform, still)
    shows(slip, points(eta, "slip", 0), points(eta, "slip", 3, 4))
    dilute = ds.isel(point=[0, 1])
    square = dilute["reduced_rate"] ** 2
    shows(normal, *(Points(square, *estimates(dilute, f"normal_{axis}")) for axis in "xyz"))
