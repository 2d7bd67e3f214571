from gaspart.analysis.collisions import free_flight_times as free_flight_times
from gaspart.analysis.combination import replicas as replicas
from gaspart.analysis.counters import collision_rate as collision_rate
from gaspart.analysis.counters import compressibility_factor as compressibility_factor
from gaspart.analysis.counters import wall_force as wall_force
from gaspart.analysis.counters import wall_pressure as wall_pressure
from gaspart.analysis.diffusion import diffusion_coefficient as diffusion_coefficient
from gaspart.analysis.diffusion import mutual_diffusion as mutual_diffusion
from gaspart.analysis.fields import field as field
from gaspart.analysis.fields import velocity_profile as velocity_profile
from gaspart.analysis.fluxes import heat_flux as heat_flux
from gaspart.analysis.fluxes import particle_flux as particle_flux
from gaspart.analysis.fluxes import particle_number as particle_number
from gaspart.analysis.fluxes import wall_shear as wall_shear
from gaspart.analysis.insertion import chemical_potential as chemical_potential
from gaspart.analysis.lyapunov import lyapunov_exponent as lyapunov_exponent
from gaspart.analysis.motion import mean_squared_displacement as mean_squared_displacement
from gaspart.analysis.motion import velocity_autocorrelation as velocity_autocorrelation
from gaspart.analysis.observable import Observable as Observable
from gaspart.analysis.pairs import contact_values as contact_values
from gaspart.analysis.pairs import pair_collision_rates as pair_collision_rates
from gaspart.analysis.pairs import rdf as rdf
from gaspart.analysis.species import by_species as by_species
from gaspart.analysis.structure import density as density
from gaspart.analysis.structure import order_parameter as order_parameter
from gaspart.analysis.structure import profile as profile
from gaspart.analysis.structure import speed_distribution as speed_distribution
from gaspart.analysis.structure import temperature as temperature
from gaspart.analysis.structure_factors import partial_structure_factors as partial_structure_factors
from gaspart.analysis.structure_factors import structure_factor as structure_factor
from gaspart.analysis.transport import bulk_viscosity as bulk_viscosity
from gaspart.analysis.transport import pressure_tensor as pressure_tensor
from gaspart.analysis.transport import shear_viscosity as shear_viscosity
from gaspart.analysis.transport import thermal_conductivity as thermal_conductivity

Z = compressibility_factor
pressure = wall_pressure
force = wall_force
pair_rates = pair_collision_rates
msd = mean_squared_displacement
D = diffusion_coefficient
vacf = velocity_autocorrelation
speeds = speed_distribution
velocity = velocity_profile
flux = particle_flux
number = particle_number
order = order_parameter
viscosity = shear_viscosity
