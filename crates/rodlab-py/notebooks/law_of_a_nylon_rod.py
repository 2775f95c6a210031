# %% [markdown]
# # Law of a nylon rod
#
# A striker hits a rod at 3 m/s and at 20 m/s; the velocities of two sections determine the parameters of a Maxwell-Norton law
# (Ödeen 1993, paper D). The records come from a virtual test with a known law.

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
rodlab.simulate(
    sheet.ImpactedRod(
        length="402 mm",
        diameter="16 mm",
        density="1140 kg/m3",
        modulus="3.2 GPa",
        law=sheet.Norton(exponent="2.1", rate_at_10_mpa="10 1/s"),
        section_distance="394 mm",
        striker={"length": "30 mm", "diameter": "15.8 mm", "density": "2700 kg/m3", "modulus": "69 GPa"},
        velocities=["3 m/s", "20 m/s"],
        sensors=sheet.Velocity(),
    ),
    instrument={"sampling_rate": "51.2 kHz", "length": "3 ms", "before": "1 ms", "noise": "0.8 %"},
    output="shots.csv",
    seed=1993,
    out=folder,
)
tests = [
    {
        "name": velocity,
        "records": {
            "files": [file],
            "channels": [{"name": "near end", "from": "near end"}, {"name": "free end", "from": "free end"}],
        },
        "excitation": "near end",
        "response": "free end",
        "impact_velocity": velocity,
        "generator": "rodwave::lumped",
    }
    for velocity, file in (("3 m/s", "shots-1.csv"), ("20 m/s", "shots-2.csv"))
]
# the filter of the recorder is part of the model; the comparison with other laws and the profiles would take some seconds more
law = rodlab.identify(
    tests,
    length="394 mm ± 0.2 mm",
    density="1140 kg/m3 ± 0.1 %",
    recorder=sheet.LinearPhase(cutoff="16 kHz"),
    laws=["Norton"],
    compare=False,
    profiles=False,
    folder=folder,
)

# %% The verdict, and the parameters next to the true ones
print(law.verdict)
true = {"Young's modulus E": 3.2e9, "exponent kappa": 2.1, "inelastic strain rate at 10 MPa F(10 MPa)": 10.0}
for name, value in true.items():
    found = law.quantity(f"Maxwell-Norton: {name}")
    print(f"{name}: {found.value:.4g} ± {found.standard_error:.2g} {found.unit}, true {value:.4g}; {found.verdict}")
    assert found.value is not None and found.standard_error is not None
    assert abs(found.value - value) < 3 * found.standard_error

# %% The figure
figure, axes = plt.subplots(2, 1, sharex=True, layout="constrained")
for ax, name in zip(axes, ("response-1", "response-2"), strict=True):
    table = law.table(name)
    ax.plot(table.numbers("time_s"), table.numbers("measured_response_m_per_s"), label="measured")
    ax.plot(table.numbers("time_s"), table.numbers("simulated_response_maxwell_norton_m_per_s"), label="Maxwell-Norton")
    ax.set_ylabel(f"velocity ({table.units['measured_response_m_per_s']})")
    ax.set_title(table.title)
axes[1].set_xlabel(f"time ({law.table('response-1').units['time_s']})")
axes[0].legend()

# %% The numbers are those of the command, to the last digit
(folder / "law.ron").write_text(
    """Identify(title: "Nylon", recorder: LinearPhase(cutoff: "16 kHz"), specimen: (length: "394 mm ± 0.2 mm", density: "1140 kg/m3 ± 0.1 %"), laws: [Norton],
    compare: false, profiles: false, tests: ["""
    + ",".join(
        f"""(name: "{velocity}", records: (files: ["shots-{number}.csv"], channels: [
        (name: "near end", from: "near end"), (name: "free end", from: "free end")]), excitation: "near end", response: "free end",
        impact_velocity: "{velocity}", generator: "rodwave::lumped")"""
        for number, velocity in ((1, "3 m/s"), (2, "20 m/s"))
    )
    + "])",
    encoding="utf-8",
)
subprocess.run(["rodlab", "identify", folder / "law.ron", "--quiet"], check=True)
count = 0
for name, table in law.tables.items():
    by_command = pd.read_csv(folder / "law-result" / f"{name}.csv", dtype=str, keep_default_na=False)
    for column, values in table.columns().items():
        cells = by_command[column]
        kind = values.dtype.kind
        expected = [float(cell or "nan") if kind == "f" else cell == "true" if kind == "b" else cell for cell in cells]
        np.testing.assert_array_equal(values, expected)
        count += len(values)
print(f"{count} numbers and words are equal")
