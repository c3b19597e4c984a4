#!/usr/bin/env python3
"""How long the surface of a run's frames takes: tracked by kappaflow, and made anew by splashsurf.

    kappaflow run scenes/staircase-large.toml --duration 0.4 --track material --out out/large
    python3 tools/splashsurf/compare.py out/large --threads 1

Both read the particles of all frames from files and write a mesh for each; splashsurf's cubes are chosen so that its first mesh has
about as many vertices as kappaflow's. Needs `pip install pysplashsurf`, NumPy, kappaflow on the PATH (or --program) and its
Python package (`pip install .`). Meshes of splashsurf have no correspondence from frame to frame, nor rest positions.
"""
import argparse
import pathlib
import subprocess
import sys
import tempfile
import time

import kappaflow
import numpy

SMOOTHING = 2.0  # splashsurf's smoothing length in particle radii, as its documentation proposes
ENOUGH = 0.03  # difference of the numbers of vertices at which the search for the size of the cubes ends


def seconds(command):
    start = time.perf_counter()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - start


def vertices_of(file):
    """Of a legacy VTK file."""
    with open(file, "rb") as text:
        for line in text:
            if line.startswith(b"POINTS"):
                return int(line.split()[1])
    sys.exit(f"{file}: no points")


def reconstruct(pattern, folder, radius, cube, threads, frames):
    return ["pysplashsurf", "reconstruct", str(pattern), f"--particle-radius={radius}", f"--smoothing-length={SMOOTHING}",
            f"--cube-size={cube}", f"--num-threads={threads}", f"--end-index={frames}", f"--output-dir={folder}", "--quiet",
            "-o", "mesh_{}.vtk"]


def matching_cube(pattern, folder, radius, threads, wanted):
    """The size of the cubes [radii]: the number of vertices goes with its inverse square."""
    cube = 1.0
    for _ in range(6):
        subprocess.run(reconstruct(pattern, folder, radius, cube, threads, 1), check=True)
        vertices = vertices_of(folder / "mesh_1.vtk")
        if abs(vertices / wanted - 1) < ENOUGH:
            break
        cube *= (vertices / wanted) ** 0.5
    return cube


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", type=pathlib.Path, help="folder of a kappaflow run")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--program", default="kappaflow")
    options = parser.parse_args()
    run = kappaflow.read_run(options.run)
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        for k, frame in enumerate(run.particles):
            frame.positions.astype("<f4").tofile(folder / f"particles_{k + 1}.xyz")
        frames, particles = len(run), len(run.particles[0].positions)
        tracked = seconds([options.program, "track", options.run / "particles.pvd", "--out", folder / "tracked", "--metrics", "0",
                           "--threads", str(options.threads), "--quiet"])
        result = kappaflow.read_run(folder / "tracked")
        sizes = [len(mesh.positions) for mesh in result.meshes()]
        radius = result.record["sigma"] / 4  # of a particle: half its spacing, as sigma is two of these
        pattern = folder / "particles_{}.xyz"
        cube = matching_cube(pattern, folder, radius, options.threads, sizes[0])
        fresh = seconds(reconstruct(pattern, folder, radius, cube, options.threads, frames))
        print(f"{frames} frames of {particles} particles, {options.threads} threads, seconds a frame")
        print(f"  kappaflow track  {tracked / frames:7.3f}   {sizes[0]} to {sizes[-1]} vertices")
        print(f"  splashsurf       {fresh / frames:7.3f}   {vertices_of(folder / 'mesh_1.vtk')} to "
              f"{vertices_of(folder / f'mesh_{frames}.vtk')} vertices")
        print(f"  ratio            {tracked / fresh:7.2f}")


if __name__ == "__main__":
    main()
