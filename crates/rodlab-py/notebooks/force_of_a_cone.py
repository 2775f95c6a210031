# %% [markdown]
# # Force of a cone on a long rod
#
# The wide end of a nylon cone strikes a long steel rod at 0.93 m/s ± 1 % (Ödeen 1993, paper E).

# %%
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import pandas as pd
import rodlab
from rodlab import sheet

materials = {
    "nylon": {"density": "1150 kg/m3", "law": sheet.ConstantQ(modulus="2.6 GPa", loss_factor="0.094", at="3 kHz")},
    "steel": {"density": "7780 kg/m3", "law": sheet.Elastic(modulus="206 GPa")},
}
cone = sheet.Chain(elements=[sheet.Cone(material="nylon", near="75 mm", far="30 mm", length="400 mm")])
rod = sheet.LongRod(material="steel", diameter="10 mm")
F = rodlab.force.predict(cone, rod, velocity="0.93 m/s ± 1 %", duration="4 ms", materials=materials)

# %% The verdict
print(F.verdict)
for quantity in F.quantities:
    print(quantity)

# %% The figure
F.plot()

# %% When the faces meet and part
F.table("contacts").to_pandas()

# %% The numbers are those of the command, to the last digit
out = Path(tempfile.mkdtemp())
example = Path("../../rodlab/examples/cone/force.ron")
subprocess.run(["rodlab", "force", example, "--out", out, "--quiet"], check=True)
count = 0
for name, table in F.tables.items():
    by_command = pd.read_csv(out / f"{name}.csv", dtype=str, keep_default_na=False)
    for column, values in table.columns().items():
        cells = by_command[column]
        kind = values.dtype.kind
        expected = [float(cell or "nan") if kind == "f" else cell == "true" if kind == "b" else cell for cell in cells]
        np.testing.assert_array_equal(values, expected)
        count += len(values)
print(f"{count} numbers and words are equal")
