"""Times of other programs for the tasks of `cargo xtask bench`: the recorded baselines of docs/performance.ron.

    pip install numpy==2.4.6 scipy==1.17.1 pandas==3.1.1 pyuff==2.5.8 lmfit==1.3.4
    OMP_NUM_THREADS=1 python xtask/baselines.py

Prints the best of several runs in milliseconds of processor time on one thread, which a busy machine affects least. Files are
read from a folder in memory (/dev/shm) if there is one. The data are those of the benchmarks of crates/labio and crates/cmod.
"""

import os
import tempfile
import time
import warnings

import lmfit
import numpy as np
import pandas
import pyuff
import scipy
from scipy import optimize, signal
from scipy.io import wavfile


def best(job, runs=15):
    """Best processor time of `runs` runs [ms], after a run that is not counted."""
    job()
    times = []
    for _ in range(runs):
        start = time.process_time()
        job()
        times.append(time.process_time() - start)
    return 1e3 * min(times)


def show(name, milliseconds):
    print(f"{name}: {milliseconds:.3g} ms")


def spectra():
    random = np.random.default_rng(1)
    x = random.standard_normal(1 << 20)
    y = signal.lfilter([1.0], [1.0, -0.9], x) + 0.1 * random.standard_normal(x.size)
    settings = dict(fs=51200.0, window="hann", nperseg=8192, noverlap=4096)

    def three_calls():
        cross = signal.csd(x, y, **settings)[1]
        signal.welch(x, **settings)
        signal.coherence(x, y, **settings)
        return cross

    show("scipy csd, welch, coherence, 2^20 samples", best(three_calls, 5))


def tables(folder):
    n = np.arange(51200)
    force, response = 0.9 * np.sin(0.1 * n), 0.9 * np.sin(0.37 * n)
    path = os.path.join(folder, "hit.csv")
    with open(path, "w") as file:
        file.write("Time,force,end A\ns,N,m/s^2\n")
        for row in zip(n / 51200.0, force, response):
            file.write(",".join(repr(float(value)) for value in row) + "\n")
    frame = pandas.read_csv(path, skiprows=[1])
    show("pandas read_csv, 51200 x 3", best(lambda: pandas.read_csv(path, skiprows=[1])))
    exact = dict(skiprows=[1], float_precision="round_trip")
    show("pandas read_csv, round_trip", best(lambda: pandas.read_csv(path, **exact)))
    show("pandas to_csv", best(lambda: frame.to_csv(path, index=False), 5))

    path = os.path.join(folder, "hit.lvm")
    with open(path, "w") as file:
        file.write("LabVIEW Measurement\n" + "header\n" * 12)
        file.write("X_Value\tforce\tend A\tComment\n")
        for row in zip(n / 51200.0, force, response):
            file.write("\t".join(f"{value:.6f}" for value in row) + "\n")
    read = lambda: pandas.read_csv(path, sep="\t", skiprows=13)
    show("pandas read_csv of the rows of an LVM file", best(read))

    path = os.path.join(folder, "hit.npz")
    np.savez(path, force=force, response=response)

    def archive():
        with np.load(path) as arrays:
            return [arrays[name] for name in arrays]

    show("numpy npz, read", best(archive))
    show("numpy npz, write", best(lambda: np.savez(path, force=force, response=response)))

    path = os.path.join(folder, "hit.wav")
    both = np.stack([force, response], axis=1)
    show("scipy wavfile, write f64", best(lambda: wavfile.write(path, 51200, both)))
    show("scipy wavfile, read f64", best(lambda: wavfile.read(path)))


def universal_file(folder):
    line = np.arange(32769)
    ratio = line / 5000.3
    values = 1e-7 / (1 - ratio**2 + 0.02j * ratio)
    path = os.path.join(folder, "frf.uff")
    data = dict(
        type=58, func_type=4, rsp_node=1, rsp_dir=1, ref_dir=1, ref_node=1, data=values, x=0.5 * line,
        id1="end A", rsp_ent_name="NONE", ref_ent_name="NONE", abscissa_spec_data_type=18,
        ordinate_spec_data_type=8, orddenom_spec_data_type=13, binary=0,
    )

    def write():
        if os.path.exists(path):
            os.remove(path)
        pyuff.UFF(path).write_sets(dict(data), mode="overwrite")

    show("pyuff write, text", best(write, 7))
    show("pyuff read, text", best(lambda: pyuff.UFF(path).read_sets(), 7))


def rheology():
    random = np.random.default_rng(200)
    omega = 2 * np.pi * np.geomspace(20.0, 50e3, 200)

    def law(q):
        e0, e1, t1, e2, t2 = np.exp(q)
        return e0 + sum(e * 1j * omega * t / (1 + 1j * omega * t) for e, t in ((e1, t1), (e2, t2)))

    true = np.log([2e9, 0.4e9, 2e-5, 0.3e9, 1e-3])
    start = np.log([1e9, 1e9, 6e-6, 0.1e9, 3e-3])
    exact = law(true)
    sigma = 0.01 * np.abs(exact)
    noise = random.standard_normal(200) + 1j * random.standard_normal(200)
    data = exact + sigma * noise

    def residual(q):
        difference = (law(q) - data) / sigma
        return np.concatenate([difference.real, difference.imag])

    fit = lambda: optimize.least_squares(residual, start, method="lm")
    assert np.allclose(fit().x, true, atol=0.1)
    show("scipy least_squares, five parameters in logarithms", best(fit))
    parameters = lmfit.Parameters()
    for index, value in enumerate(start):
        parameters.add(f"q{index}", value=value)
    by_lmfit = lambda: lmfit.minimize(lambda p: residual([p[f"q{i}"].value for i in range(5)]), parameters)
    show("lmfit minimize, the same", best(by_lmfit))


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    print(f"numpy {np.__version__}, scipy {scipy.__version__}, pandas {pandas.__version__}, lmfit {lmfit.__version__}")
    spectra()
    memory = "/dev/shm" if os.path.isdir("/dev/shm") else None
    with tempfile.TemporaryDirectory(dir=memory) as scratch:
        tables(scratch)
        universal_file(scratch)
    rheology()
