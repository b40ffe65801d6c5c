"""Periodic state machines, workload traces, tasks and worst-case response times; knows nothing of the language."""
