"""ARM executables: from bytes to instructions, control flow graphs and loops."""
