"""Value analysis, loop bounds, infeasible paths, flow facts: from control flow graphs to ProgramFlow."""
