# %% [markdown]
# # Frequency response from five hits
#
# Hits on the end of a nylon rod in a virtual test, with the force of the hammer and the
# acceleration of the struck face.

# %%
import subprocess
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import rodlab
from rodlab import sheet

folder = Path(tempfile.mkdtemp())
nylon = {"density": "1150 kg/m3", "law": sheet.ConstantQ(modulus="2.6 GPa", loss_factor="0.094", at="3 kHz")}
rod = sheet.Chain(elements=[sheet.Rod(material="nylon", diameter="60 mm", length="300 mm")])
rodlab.simulate(
    sheet.HammerOnBody(body=rod, blows={"hits": 5, "peak": "500 N", "duration": "200 us"}),
    instrument={"sampling_rate": "51.2 kHz", "length": "80 ms", "before": "5 ms", "noise": "0.02 %"},
    materials={"nylon": nylon},
    output="hit.csv",
    out=folder,
)
hits = rodlab.read("hit-*.csv", channels={"hammer": "N", "face": "m/s2"}, folder=folder)
H = rodlab.frf.of_hits(hits, silent="4 ms", band=("20 Hz", "6 kHz"))

# %% The verdict
print(H.verdict)
for hit in hits.hits:
    print(hit.name, "accepted" if hit.accepted else hit.reasons)

# %% The figure, with the exact response
mobility = rodlab.mobility.of_hits(hits, silent="4 ms", up_to="6 kHz")
lines = mobility.valid & (mobility.frequency_hz > 0)
frequency = mobility.frequency_hz[lines]
figure, axes = plt.subplots(layout="constrained")
axes.loglog(frequency, np.abs(mobility.mobility[lines]), label="five hits")
axes.loglog(frequency, np.abs(rodlab.rods.mobility(rod, frequency, materials={"nylon": nylon})), "--", label="exact")
axes.set_xlabel("frequency (Hz)")
axes.set_ylabel("|v/F| (m/(N s))")
axes.legend()

# %% The numbers are those of the command, to the last digit
(folder / "hits.ron").write_text(
    """Frf(title: "Five hits", records: (files: ["hit-*.csv"], channels: [
    (name: "hammer", from: 1, unit: "N"), (name: "face", from: 2, unit: "m/s2")]),
    input: "hammer", silent: "4 ms", band: (from: "20 Hz", to: "6 kHz"))"""
)
subprocess.run(["rodlab", "frf", folder / "hits.ron", "--quiet"], check=True)
count = 0
for name, table in H.tables.items():
    by_command = pd.read_csv(folder / "hits-result" / f"{name}.csv", dtype=str, keep_default_na=False)
    for column, values in table.columns().items():
        cells = by_command[column]
        kind = values.dtype.kind
        expected = [float(cell or "nan") if kind == "f" else cell == "true" if kind == "b" else cell for cell in cells]
        np.testing.assert_array_equal(values, expected)
        count += len(values)
print(f"{count} numbers and words are equal")
