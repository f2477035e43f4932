"""Commands that predict contact, friction, wear, vibration and temperature of a rig or a part."""
