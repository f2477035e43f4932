"""Models: surfaces, contact, friction, wear, heat, actuators, dynamics and finite elements, a phenomenon a room."""
