# %% [markdown]
# # Complex modulus of a rod
#
# Five hits on a polypropylene rod with an accelerometer at each end. The records are those of
# `crates/rodlab/examples/polypropylene`.

# %%
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import pandas as pd
import rodlab

example = Path("../../rodlab/examples/polypropylene").resolve()
hits = rodlab.read(
    "hits-*.npy",
    sampling_rate_hz=65_536,
    channels={"struck end": "m/s2", "free end": "m/s2"},
    folder=example,
)
E = rodlab.modulus.two_point(
    hits,
    length="799 mm ± 0.3 mm",
    diameter="15.8 mm ± 0.03 mm",
    density="912 kg/m3 ± 0.3 kg/m3",
    accelerometer_mass="2.9 gram ± 0.03 gram",
    silent="1.6 ms",
    band=(100, 15e3),
    poisson_ratio=0,
    report_at=["2 kHz", "5 kHz", "10 kHz"],
)

# %% The verdict
print(E.verdict)
print(f"{E.valid.sum()} of {len(E.lines)} lines are valid")
for quantity in E.quantities[:6]:
    print(quantity)

# %% The figure
E.plot()

# %% A law for a finite-element program
law = rodlab.rheology.fit(E, ["zener", "fractional zener", "generalised maxwell"])
for name, parameter in law.parameters("fractional zener").items():
    print(f"{name}: {parameter.value} ± {parameter.standard_error} {parameter.unit}; {parameter.verdict}")

# %% The numbers are those of the command, to the last digit
out = Path(tempfile.mkdtemp())
subprocess.run(["rodlab", "modulus", example / "modulus.ron", "--out", out, "--quiet"], check=True)
by_command = pd.read_csv(out / "modulus.csv", dtype=str, keep_default_na=False)
for column, values in E.columns().items():
    cells = by_command[column]
    kind = values.dtype.kind
    expected = [float(cell or "nan") if kind == "f" else cell == "true" if kind == "b" else cell for cell in cells]
    np.testing.assert_array_equal(values, expected)
print(f"{by_command.size} numbers and words are equal")
