"""Simulation of one schedule: exact, event by event, and never a bound. What it shows happens in one run out of many;
only the analysis (`mauve.timing.response`) says what can happen at worst."""
