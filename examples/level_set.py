#!/usr/bin/env python3
"""A small solver on a grid: two drops that wind around each other in a vortex and become one.

The level set phi (the signed distance to the surface [m], negative inside) obeys phi_t + u . grad phi = 0, with fifth-order
WENO derivatives (Jiang & Peng 2000) and the third-order TVD Runge-Kutta scheme (Shu & Osher 1988), and is made a distance again
by phi_t + S(phi) (|grad phi| - 1) = 0 (Peng et al. 1999). The flow u is Burgers' vortex, a solution of the Navier-Stokes
equations that does not change in time: it turns fastest at its axis, z, draws liquid in towards it and stretches it along it.
A flow as smooth as that keeps drops apart for ever; on a grid they merge once the gap is thinner than a cell, as they do in
every such solver.

It writes phi_0000.vti and so on: `phi` [m], the time [s], and with --velocity the flow as well [m/s]. They can be tracked:

    python3 examples/level_set.py --out out/level_set
    kappaflow track 'out/level_set/phi_*.vti' --out out/tracked

Needs NumPy.
"""

import argparse
import pathlib

import numpy as np

HALF_WIDTHS = (0.9, 0.9, 0.675)  # of the box about the origin, 4 : 4 : 3 [m]
RADIUS = 0.3  # of the drops [m]
CENTRES = ((-0.32, 0.0, 0.03), (0.32, 0.0, -0.03))  # [m]
STRAIN = 0.2  # along the axis [1/s]
SPIN = 4.0  # angular velocity at the axis [rad/s]
CORE = 0.45  # radius of the vortex [m]
DURATION = 2.0  # [s]


def lattice(cells):
    """Coordinates with that many cells along x [m], the first point [m], and the distance between points [m]."""
    spacing = 2 * HALF_WIDTHS[0] / cells
    axes = [np.linspace(-half, half, 2 * round(half / spacing) + 1, dtype=np.float32) for half in HALF_WIDTHS]
    return np.meshgrid(*axes, indexing="ij"), [-half for half in HALF_WIDTHS], spacing


def flow(x, y, z):
    """Burgers' vortex [m/s]: inward, around and along the z axis."""
    square = (x**2 + y**2) / CORE**2
    turn = SPIN * -np.expm1(-square) / np.maximum(square, np.float32(1e-6))
    return -0.5 * STRAIN * x - turn * y, -0.5 * STRAIN * y + turn * x, STRAIN * z


def drops(x, y, z):
    """The distance to the nearer of the drops [m]."""
    return np.min([np.sqrt((x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2) - RADIUS for a, b, c in CENTRES], axis=0)


def weno5(a, b, c, d, e):
    """The derivative from five neighbouring differences, weighted by how smooth the function is there."""
    smooth = (
        13 / 12 * (a - 2 * b + c) ** 2 + 1 / 4 * (a - 4 * b + 3 * c) ** 2,
        13 / 12 * (b - 2 * c + d) ** 2 + 1 / 4 * (b - d) ** 2,
        13 / 12 * (c - 2 * d + e) ** 2 + 1 / 4 * (3 * c - 4 * d + e) ** 2,
    )
    w0, w1, w2 = (ideal / (1e-6 + s) ** 2 for ideal, s in zip((0.1, 0.6, 0.3), smooth))
    sides = w0 * (2 * a - 7 * b + 11 * c) + w1 * (5 * c - b + 2 * d) + w2 * (2 * c + 5 * d - e)
    return sides / (6 * (w0 + w1 + w2))


def differences(phi, axis, spacing):
    """(phi[i + 1] - phi[i]) / spacing for i from -3 to n + 1: beyond the box phi goes on as a straight line."""
    inner = np.diff(phi, axis=axis) / spacing
    first, last = np.take(inner, [0], axis), np.take(inner, [-1], axis)
    return np.concatenate([first] * 3 + [inner] + [last] * 3, axis)


def along(values, axis, first, count):
    return values[(slice(None),) * axis + (slice(first, first + count),)]


def one_sided(phi, axis, spacing):
    """Derivatives from below and from above."""
    n = phi.shape[axis]
    d = [along(differences(phi, axis, spacing), axis, k, n) for k in range(6)]
    return weno5(*d[:5]), weno5(*d[:0:-1])


def upwind(phi, velocity, axis, spacing):
    """The derivative from where the flow comes."""
    n = phi.shape[axis]
    d = [along(differences(phi, axis, spacing), axis, k, n) for k in range(6)]
    down = velocity > 0
    return weno5(*(np.where(down, d[k], d[5 - k]) for k in range(5)))


def advected(phi, velocity, spacing, dt):
    """phi a step later."""

    def rate(values):
        return -sum(u * upwind(values, u, axis, spacing) for axis, u in enumerate(velocity))

    first = phi + dt * rate(phi)
    second = 0.75 * phi + 0.25 * (first + dt * rate(first))
    return (phi + 2 * (second + dt * rate(second))) / 3


def reinitialised(phi, spacing, steps):
    """phi closer to a distance, with its zero where it is."""
    for _ in range(steps):
        outward = phi > 0
        square = 0
        for axis in range(3):
            below, above = one_sided(phi, axis, spacing)
            below, above = np.where(outward, below, -below), np.where(outward, above, -above)
            square = square + np.maximum(np.maximum(below, 0), -np.minimum(above, 0)) ** 2  # Godunov's
        sign = phi / np.sqrt(phi**2 + square * spacing**2 + 1e-12)
        phi = phi - 0.3 * spacing * sign * (np.sqrt(square) - 1)
    return phi


def write_vti(path, time, origin, spacing, **arrays):
    """VTK image data with raw appended arrays: sizes and numbers, one array after the other; x runs fastest."""
    data, text = b"", ""
    for name, values in arrays.items():
        components = values.shape[3] if values.ndim == 4 else 1
        text += f'<DataArray type="Float32" Name="{name}" NumberOfComponents="{components}" format="appended" offset="{len(data)}"/>\n'
        numbers = np.ascontiguousarray(values.swapaxes(0, 2), "<f4").tobytes()
        data += np.array([len(numbers)], "<u8").tobytes() + numbers
    extent = " ".join(f"0 {points - 1}" for points in next(iter(arrays.values())).shape[:3])
    corner = " ".join(repr(x) for x in origin)
    head = f"""<?xml version="1.0"?>
<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" header_type="UInt64">
<ImageData WholeExtent="{extent}" Origin="{corner}" Spacing="{spacing!r} {spacing!r} {spacing!r}">
<FieldData><DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">{time!r}</DataArray></FieldData>
<Piece Extent="{extent}"><PointData Scalars="phi">
{text}</PointData></Piece></ImageData>
<AppendedData encoding="raw">_"""
    path.write_bytes(head.encode() + data + b"</AppendedData>\n</VTKFile>\n")


def main():
    parser = argparse.ArgumentParser(description="Two drops in a vortex, by a level set on a grid.")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/level_set"), help="folder for the images")
    parser.add_argument("--frames", type=int, default=41, help="how many images, at least 2 (41)")
    parser.add_argument("--cells", type=int, default=64, help="of the grid along x, a multiple of 8, at least 16 (64)")
    parser.add_argument("--velocity", action="store_true", help="write the flow as well")
    options = parser.parse_args()
    if options.frames < 2 or options.cells < 16 or options.cells % 8:
        parser.error("--frames must be at least 2, --cells a multiple of 8 and at least 16")
    options.out.mkdir(parents=True, exist_ok=True)

    (x, y, z), origin, spacing = lattice(options.cells)
    velocity = flow(x, y, z)
    arrays = {"velocity": np.stack(velocity, axis=3)} if options.velocity else {}
    interval = DURATION / (options.frames - 1)
    fastest = np.max(sum(np.abs(u) for u in velocity))
    steps = int(np.ceil(interval * fastest / spacing))
    phi = drops(x, y, z)
    for frame in range(options.frames):
        if frame > 0:
            for _ in range(steps):
                phi = advected(phi, velocity, spacing, interval / steps)
            phi = reinitialised(phi, spacing, 2)
        write_vti(options.out / f"phi_{frame:04d}.vti", frame * interval, origin, spacing, phi=phi, **arrays)
    print(f"{options.frames} images in {options.out}, {interval:g} s apart, {steps} steps each")


if __name__ == "__main__":
    main()
