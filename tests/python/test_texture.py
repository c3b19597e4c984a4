"""Textures against those of the program's files, and what they are by definition."""

import numpy as np
import pytest
from conftest import same_bits

import kappaflow
from kappaflow._vtp import read_vtp


def test_they_are_those_of_files(staircase):
    meshes = kappaflow.read_run(staircase).meshes("total")
    last = read_vtp(staircase / "surface-total/surface_0010.vtp")
    rest, first = last.arrays["rest_position"], meshes[0].positions
    assert same_bits(kappaflow.texture_coordinates(rest, first).astype(np.float32), last.arrays["TCoords"])
    colours = kappaflow.checker_colours(rest, float(last.fields["checker_edge"][0]), last.fields["checker_origin"][0])
    assert same_bits(colours, last.arrays["checker"])


def test_planar_coordinates_are_shares_of_the_box():
    box = [[0, 0, 0], [2, 4, 1]]
    np.testing.assert_allclose(kappaflow.texture_coordinates([[1, 1, 0.5]], box, "planar"), [[0.5, 0.25]])


def test_colours_change_from_cube_to_cube():
    colours = kappaflow.checker_colours([[0.5, 0.5, 0.5], [1.5, 0.5, 0.5], [0.9, 0.1, 0.2]], 1).astype(int)
    assert (colours[0] == colours[2]).all() and np.abs(colours[0] - colours[1]).max() > 50


def test_what_is_wrong_is_said():
    with pytest.raises(kappaflow.InvalidInput, match="projection: 'round'; allowed are planar, spherical, box"):
        kappaflow.texture_coordinates([[0, 0, 0]], [[0, 0, 0]], "round")
    with pytest.raises(kappaflow.InvalidInput, match="edge: 0; a length above 0 is needed"):
        kappaflow.checker_colours([[0, 0, 0]], 0)
