"""A campaign on Dask: python on_dask.py [ADDRESS OF A SCHEDULER]. Without an address, it runs in two processes on this machine."""

import subprocess
import sys
from pathlib import Path

import rodlab
from distributed import Client, LocalCluster


def main() -> None:
    if not Path("sheets/sweep.csv").exists():
        subprocess.run(["rodlab", "sweep", "cone.plan", "--out", "sheets"], check=True)
    cluster = sys.argv[1] if len(sys.argv) > 1 else LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)
    with Client(cluster) as client:
        done = rodlab.campaign("sheets", "results", client, resume=True)
    for test in done.tests:
        print(f"{test['status']:<11}  {test['test']}: {test['headline']}")


if __name__ == "__main__":  # workers import this file
    main()
