"""Number of contacts by hand."""

from pytest import approx

from sonolube.models.wear import vibration_contact_count


def test_an_hour_at_twenty_two_kilohertz_makes_eighty_million_contacts() -> None:
    assert vibration_contact_count(frequency=22e3, duration=3600.0) == approx(79.2e6)
