"""Heat between walls: heat_conduction_gas, heat_conduction_metal."""
