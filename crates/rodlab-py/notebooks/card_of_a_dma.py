# %% [markdown]
# # From a DMA to a material card
#
# Moduli of an epoxy at 13 temperatures become one master curve, laws, and a card for a finite-element program. The table is that of
# `crates/rodlab/examples/epoxy`.

# %%
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import pandas as pd
import rodlab
from rodlab import sheet

example = Path("../../rodlab/examples/epoxy").resolve()
epoxy = rodlab.rheology.sweep(
    [
        {
            "files": ["sweep.csv"],
            "frequency": "f",
            "modulus": sheet.Parts(storage="E'", loss="E''"),
            "temperature": sheet.Column("T"),
            "errors": sheet.MagnitudeAndPhase(magnitude="1 %", phase="0.01"),
        }
    ],
    reference_temperature="60 degC",
    density="1180 kg/m3",
    laws=["zener", "fractional zener", "havriliak-negami", "generalised maxwell"],
    folder=example,
)

# %% The verdict
print(epoxy.verdict)
for name in ("WLF, C1", "WLF, C2"):
    print(epoxy.quantity(name))
for name, parameter in epoxy.parameters("fractional zener").items():
    print(f"{name}: {parameter.value} ± {parameter.standard_error} {parameter.unit}; {parameter.verdict}")

# %% The figure
epoxy.plot()

# %% The shifts
epoxy.table("shifts").to_pandas()

# %% The card
card = epoxy.card("abaqus", name="EPOXY", poisson_ratio="0.38 ± 0.02")
print(card)

# %% The numbers are those of the command, to the last digit
out = Path(tempfile.mkdtemp())
subprocess.run(["rodlab", "fit", example / "fit.ron", "--out", out, "--quiet"], check=True)
assert card.encode() == (out / "EPOXY.inp").read_bytes()
count = 0
for name, table in epoxy.tables.items():
    by_command = pd.read_csv(out / f"{name}.csv", dtype=str, keep_default_na=False)
    for column, values in table.columns().items():
        cells = by_command[column]
        kind = values.dtype.kind
        expected = [float(cell or "nan") if kind == "f" else cell == "true" if kind == "b" else cell for cell in cells]
        known = np.where(np.isinf(values), np.nan, values) if kind == "f" else values  # an infinite end is a blank in the file
        np.testing.assert_array_equal(known, expected)
        count += len(values)
print(f"{count} numbers and words are equal")
