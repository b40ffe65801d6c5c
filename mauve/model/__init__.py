"""The resolved, typed model of an architecture: names bound, units converted, defaults applied, connections checked."""
