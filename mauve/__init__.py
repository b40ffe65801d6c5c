"""mauvec: from a robot's architecture and its ARM binary to a verdict on every deadline."""

__version__ = "0.1.0"
