"""Rebuilds the committed images of random programs: `python -m tests.wcet.soundness.rebuild` with tests/ on the path.

`images/functions.json` holds what the functions take, so that the images outlive changes of the generator.
"""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

from wcet.soundness.campaign import compile_seed

IMAGES = Path(__file__).parent / "images"
CHOICE = (
    (2000, "arm7tdmi-arm", "-O2"),
    (2000, "arm7tdmi-thumb", "-O1"),
    (2001, "arm926ej-s-arm", "-O3"),
    (2001, "cortex-m0-thumb", "-Os"),
    (2000, "arm7tdmi-arm", "-O0"),
    (2001, "cortex-m3-thumb", "-O2"),
)

if __name__ == "__main__":
    listing = {}
    for seed, target, level in CHOICE:
        name = f"{seed}{level}-{target}"
        source = compile_seed(seed, target, level, IMAGES / f"{name}.elf")
        listing[name] = {"target": target, "functions": [asdict(function) for function in source.functions]}
    (IMAGES / "functions.json").write_text(json.dumps(listing, indent=1) + "\n")
