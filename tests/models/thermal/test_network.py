"""Thermal networks against a general ODE solver, energy conservation and a discretised half-space."""

import numpy as np
from pytest import approx, raises
from scipy.integrate import solve_ivp
from scipy.special import erfc

from sonolube.errors import InvalidInput
from sonolube.models.thermal import ThermalNetwork, ThermalSolid, network_rise

PIN_AND_ARM = ThermalNetwork(heat_capacity=(1.5, 40.0), links=((0, 1, 0.05),), losses=(0.005, 0.2))


def test_network_transients_agree_with_a_general_ode_solver() -> None:
    time = np.array([0.0, 3.0, 10.0, 26.0])
    heat = np.array([[0.2, 0.0], [0.05, 0.1], [0.0, 0.0]])
    found = network_rise(PIN_AND_ARM, time=time, heat_rate=heat)
    state = np.zeros(2)
    for step in range(3):

        def slope(_: float, rise: np.ndarray, q: np.ndarray = heat[step]) -> np.ndarray:
            exchanged = 0.05 * (rise[0] - rise[1])
            return np.array([(q[0] - exchanged - 0.005 * rise[0]) / 1.5, (q[1] + exchanged - 0.2 * rise[1]) / 40.0])

        state = solve_ivp(slope, time[step : step + 2], state, rtol=1e-10, atol=1e-12).y[:, -1]
        assert found[step + 1] == approx(state, rel=1e-7)


def test_a_network_without_losses_conserves_heat() -> None:
    closed = ThermalNetwork(heat_capacity=(2.0, 3.0, 5.0), links=((0, 1, 0.4), (1, 2, 0.1)), losses=(0.0, 0.0, 0.0))
    rise = network_rise(closed, time=[0.0, 7.0, 1e4], heat_rate=[[1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    assert rise[1:] @ np.array([2.0, 3.0, 5.0]) == approx([7.0, 7.0])
    assert rise[2] == approx([0.7, 0.7, 0.7])


def test_a_discretised_rod_warms_like_a_half_space_before_heat_reaches_its_end() -> None:
    steel = ThermalSolid(thermal_conductivity=16.2, density=8000.0, specific_heat_capacity=500.0)
    count, piece = 400, 1e-4  # of one square metre across
    rod = ThermalNetwork(
        heat_capacity=(8000.0 * 500.0 * piece,) * count,
        links=tuple((i, i + 1, 16.2 / piece) for i in range(count - 1)),
        losses=(0.0,) * count,
    )
    heat = np.zeros((1, count))
    heat[0, 0] = 1e4
    rise = network_rise(rod, time=[0.0, 10.0], heat_rate=heat)[1]
    depths = piece * (np.arange(count) + 0.5)
    diffusion_length = 2 * np.sqrt(steel.thermal_diffusivity * 10.0)
    z = depths[:150] / diffusion_length  # Carslaw and Jaeger, 2.9
    half_space = 1e4 * diffusion_length / 16.2 * (np.exp(-(z**2)) / np.sqrt(np.pi) - z * erfc(z))
    assert rise[:150] == approx(half_space, rel=1e-3)


def test_a_heat_rate_of_the_wrong_shape_is_refused() -> None:
    with raises(InvalidInput, match=r"heat_rate must have shape \(2, 2\), got \(1, 2\)"):
        network_rise(PIN_AND_ARM, time=[0.0, 1.0, 2.0], heat_rate=[[1.0, 0.0]])


def test_a_link_to_a_body_that_does_not_exist_is_refused() -> None:
    with raises(InvalidInput, match="links must join two of 1 bodies"):
        ThermalNetwork(heat_capacity=(1.0,), links=((0, 1, 0.1),), losses=(0.1,))
