"""Heat between walls."""

TITLE = "Heat between walls"
FIGURES = ("heat_conduction_gas", "heat_conduction_metal")
