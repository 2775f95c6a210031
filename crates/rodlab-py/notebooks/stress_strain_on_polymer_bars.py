# %% [markdown]
# # Stress-strain curve on polymer bars
#
# One shot on a polymer between bars of nylon, whose waves are damped and spread on their way from the gauges to the specimen. The record is that
# of `crates/rodlab/examples/shpb`.

# %%
import subprocess
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import rodlab
from rodlab import bars, sheet

example = Path("../../rodlab/examples/shpb").resolve()
shot = rodlab.read(
    "shot-1.npy",
    sampling_rate_hz="500 kHz",
    channels={
        "incident": {"unit": "strain", "sensitivity": "1 ± 0.5 %"},
        "transmitted": {"unit": "strain", "sensitivity": "1 ± 0.5 %", "time_skew": "0 us ± 0.3 us"},
    },
    folder=example,
)
branches = [
    {"modulus": "0.2 GPa", "relaxation_time": "8 us"},
    {"modulus": "0.2 GPa", "relaxation_time": "60 us"},
]
nylon = {"density": "1150 kg/m3 ± 2 kg/m3", "law": sheet.Prony(equilibrium="2.6 GPa ± 0.4 %", branches=branches)}
curve = bars.stress_strain(
    shot,
    incident=bars.bar(material="nylon", diameter="20 mm ± 0.02 mm", length="1800 mm", gauges={"incident": "900 mm ± 1 mm"}),
    transmitted=bars.bar(material="nylon", diameter="20 mm ± 0.02 mm", length="1600 mm", gauges={"transmitted": "400 mm ± 1 mm"}),
    specimen_length="6 mm ± 0.02 mm",
    specimen_diameter="14 mm ± 0.02 mm",
    materials={"nylon": nylon},
    silent="250 us",
)

# %% The verdict
print(curve.verdict)
for sentence in curve.summary[1:]:
    print(sentence)

# %% The same shot with the bars assumed elastic: 2.6 GPa and 1150 kg/m3 give 1504 m/s
elastic = bars.stress_strain(
    shot,
    incident=bars.bar(density=1150, wave_speed=1504, diameter=0.02, length=1.8, gauges={"incident": "900 mm"}),
    transmitted=bars.bar(density=1150, wave_speed=1504, diameter=0.02, length=1.6, gauges={"transmitted": "400 mm"}),
    specimen_length=0.006,
    specimen_diameter=0.014,
    silent="250 us",
)
print(elastic.verdict)

# %% The figure
ax = curve.plot()
ax.plot(elastic.strain, 1e-6 * elastic.stress, "--", linewidth=1, label="bars assumed elastic")
ax.legend()

# %% Forces on both faces, and the sources of the error
faces = curve.table("faces")
figure, axes = plt.subplots(layout="constrained")
for side in ("incident", "transmitted"):
    axes.plot(faces.numbers("time_s"), faces.numbers(f"force_{side}_face_n"), label=f"{side} face")
axes.set_xlabel("time (s)")
axes.set_ylabel("force (N)")
axes.legend()
print(curve.table("budget").to_pandas().sort_values("error_largest_stress_pa", ascending=False).head(5))

# %% The numbers are those of the command, to the last digit
out = Path(tempfile.mkdtemp())
subprocess.run(["rodlab", "shpb", example / "shpb.ron", "--out", out, "--quiet"], check=True)
count = 0
for name, table in curve.tables.items():
    by_command = pd.read_csv(out / f"{name}.csv", dtype=str, keep_default_na=False)
    for column, values in table.columns().items():
        cells = by_command[column]
        kind = values.dtype.kind
        expected = [float(cell or "nan") if kind == "f" else cell == "true" if kind == "b" else cell for cell in cells]
        np.testing.assert_array_equal(values, expected)
        count += len(values)
print(f"{count} numbers and words are equal")
