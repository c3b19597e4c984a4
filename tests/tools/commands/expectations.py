"""What the checks of files for other programs hold: each is counted, and the first that does not hold ends the check."""
import pathlib
import sys

import numpy

count = 0


def fail(what):
    sys.exit(f"{pathlib.Path(sys.argv[0]).stem}: {what}")


def expect(condition, what):
    global count
    count += 1
    if not condition:
        fail(what)


def expect_equal(found, wanted, what, tolerance=0.0):
    found, wanted = numpy.asarray(found), numpy.asarray(wanted)
    expect(found.shape == wanted.shape, f"{what}: {found.shape} instead of {wanted.shape}")
    error = numpy.abs(found.astype(float) - wanted.astype(float)).max(initial=0)
    expect(error <= tolerance, f"{what} is off by {error}")
