"""The linear response of the tribometer: what the dissertation says of it, and limits that any structure obeys."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from pytest import approx

from sonolube.errors import InvalidInput, UnknownName
from sonolube.models.dynamics import modes
from sonolube.rig import dataset, frequency_grid, frequency_response, read_rig, structure_in_contact, write_netcdf

RIGS = Path(__file__).parents[2] / "examples" / "rigs"
TRIBOMETER = read_rig(RIGS / "tribometer.toml")


def test_the_tip_moves_as_far_per_volt_as_table_4_1_prints() -> None:
    # 2.31 um at 25.9 V peak to peak
    response = frequency_response(TRIBOMETER, frequency=22e3)
    assert response.amplitude_per_volt[0] == approx(2.31e-6 / 25.9, rel=0.01)


def test_far_below_resonance_the_stack_shares_its_stroke_by_the_masses() -> None:
    # at 5 kHz inertia rules: of the free stroke the tip takes the share of the masses behind it, and 1/(1 - (f/f_r)^2)
    response = frequency_response(TRIBOMETER, frequency=5e3)
    tip, behind = 0.1093, 2.41 + 0.07
    expected = 8.68e-9 / 2 * behind / (tip + behind) / (1 - (5 / 22) ** 2)
    assert response.amplitude_per_volt[0] == approx(expected, rel=0.01)


def test_the_impedance_is_that_of_the_free_stack_far_below_and_of_the_held_one_far_above() -> None:
    low, high = (frequency_response(TRIBOMETER, frequency=f) for f in (1e3, 500e3))
    assert 1 / (2 * np.pi * 1e3 * low.impedance[0]) == approx(360e-9, rel=0.01)
    assert 1 / (2 * np.pi * 500e3 * high.impedance[0]) == approx(360e-9 - 8.68e-9**2 * 2e9, rel=0.01)


def test_the_resonance_lies_below_the_antiresonance_as_the_coupling_demands() -> None:
    f = np.linspace(15e3, 35e3, 20001)
    impedance = frequency_response(TRIBOMETER, frequency=f).impedance
    series, parallel = f[np.argmin(impedance)], f[np.argmax(impedance)]
    # of a free stack k^2 = 1 - (f_s/f_p)^2
    assert 1 - (series / parallel) ** 2 == approx(8.68e-9**2 * 2e9 / 360e-9, rel=0.02)


def test_the_grid_meets_every_resonance_within_its_width() -> None:
    grid = frequency_grid(TRIBOMETER, lowest=1e3, highest=1e5)
    assert np.all(np.diff(grid) > 0)
    assert np.min(np.abs(grid - 22e3)) < 25
    assert (grid[0], grid[-1]) == (approx(1e3), approx(1e5))


def test_a_rig_without_structure_says_what_is_missing() -> None:
    with pytest.raises(InvalidInput, match="the tables stack and structure are missing"):
        structure_in_contact(read_rig(RIGS / "cutter_head.toml"))


def test_a_dataset_keeps_units_and_comes_back_from_its_file(tmp_path: Path) -> None:
    response = frequency_response(TRIBOMETER, frequency=[20e3, 22e3])
    values = {"frequency": response.frequency, "impedance": response.impedance}
    path = write_netcdf(dataset(values, along="frequency", title="two points"), path=tmp_path / "two.nc")
    with xr.open_dataset(path, engine="h5netcdf") as read:
        assert read["impedance"].attrs["units"] == "ohm"
        assert read["frequency"].values == approx(response.frequency)
        assert read["impedance"].values == approx(response.impedance)


def test_a_dataset_of_unknown_quantities_is_refused() -> None:
    with pytest.raises(UnknownName, match="unknown quantity 'loudness'"):
        dataset({"frequency": np.ones(2), "loudness": np.ones(2)}, along="frequency", title="")


def test_frequencies_are_even_by_their_ratio_and_closest_at_each_resonance() -> None:
    rig = TRIBOMETER
    even = frequency_grid(rig, lowest=1e3, highest=2e3, points=5, resonance_points=1)
    assert even[1:] / even[:-1] == approx(np.full(even.size - 1, 2**0.25))
    natural = modes(structure_in_contact(rig))
    tip = int(np.argmin(np.abs(natural.natural_frequency - 22e3)))
    f, width = natural.natural_frequency[tip], max(20 * natural.damping_ratio[tip], 1e-4)
    grid = frequency_grid(rig, lowest=f / 4, highest=4 * f, points=2, resonance_points=5)
    inner = grid[(grid > f / 4) & (grid < 4 * f)]
    # at -6, -3, 0, 3 and 6 of sinh over its value at 6, twenty half widths away
    share = np.sinh(3) / np.sinh(6)
    steps = 1 + width * np.array([-1, -share, 0, share, 1])
    expected = [each for each in f * steps if f / 4 < each < 4 * f]
    assert all(np.isclose(inner, each, rtol=1e-9).any() for each in expected)
    assert np.all(np.diff(grid) > 0)
