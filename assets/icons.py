#!/usr/bin/env python3
"""Makes icons.ttf, the icons of the window: icons.py MaterialSymbolsRounded-Regular.ttf

The source is the outlined font of the crate egui_material_icons 0.9.0: Material Symbols by Google,
Apache License 2.0. The whole font has 4,000 icons and 1.2 MB. Needs fontTools 4.60.
"""

import re
import subprocess
import sys
from pathlib import Path

assets = Path(__file__).parent
sources = ["src/app/widgets/icons.rs", "crates/core/src/scene/light_kind.rs"]
texts = [(assets.parent / source).read_text() for source in sources]
codes = sorted({code for text in texts for code in re.findall(r'"\\u\{([0-9a-f]{4})\}"', text)})
subprocess.run(
    [
        sys.executable, "-m", "fontTools.subset", sys.argv[1],
        f"--unicodes={','.join(codes)}", "--layout-features=", "--no-recalc-timestamp",
        "--name-IDs=*", f"--output-file={assets / 'icons.ttf'}",
    ],
    check=True,
)
print(f"{len(codes)} icons")
