"""A world without hardware: a moving operator, a renderer, a quadrotor."""
