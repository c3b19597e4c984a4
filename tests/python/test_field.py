"""Field against the formula of Eq. 12 in numpy, finite differences, and shapes that are known exactly."""

import numpy as np
import pytest
from conftest import ball, same_bits

import kappaflow

SIGMA = 0.3
RANDOM = np.random.default_rng(1)
POINTS = RANDOM.uniform(-0.45, 0.45, (200, 3))
ROTATION = np.array([0.3, -0.5, 0.7])


def rotating_ball(time=0.0):
    """A ball that turns and moves: its particles at a time [s], and their velocities."""
    position = ball()
    velocity = np.cross(ROTATION, position) + [0.2, 0.1, -0.3]
    return position + time * velocity, velocity


def eq12(particles, points, threshold):
    square = ((points[:, None, :] - particles[None, :, :]) ** 2).sum(-1) / SIGMA**2
    return (np.clip(1 - square, 0, None) ** 3).sum(1) - threshold


def lone_particle(threshold=0.3, **options):
    """Its level sets are spheres: f = (1 - r^2/sigma^2)^3 - T."""
    return kappaflow.Field([[0.1, 0.2, 0.3]], sigma=1, threshold=threshold, **options)


def test_values_are_those_of_eq_12():
    particles, velocities = rotating_ball()
    field = kappaflow.Field(particles, velocities, sigma=SIGMA, threshold=1.5)
    np.testing.assert_allclose(field.values(POINTS), eq12(particles, POINTS, 1.5), rtol=0, atol=1e-12)
    assert (field.sigma, field.threshold, field.length_scale, field.time) == (SIGMA, 1.5, SIGMA, 0)


@pytest.mark.parametrize(("value", "derivative"), [("f", "g"), ("g", "A"), ("A", "C")])
def test_derivatives_in_space_are_finite_differences(value, derivative):
    field = kappaflow.Field(*rotating_ball(), sigma=SIGMA)
    h = 1e-6
    points = POINTS[np.abs(field.jets(POINTS).C).max((1, 2, 3)) > 0][:80]
    ahead_and_back = [[getattr(field.jets(points + s * h * np.eye(3)[a]), value) for s in (1, -1)] for a in range(3)]
    difference = np.stack([(ahead - back) / (2 * h) for ahead, back in ahead_and_back], -1)
    expected = getattr(field.jets(points), derivative)
    close = np.isclose(difference, expected, rtol=1e-5, atol=1e-6 * np.abs(expected).max())
    # The third derivatives jump where a particle's support ends, which a few differences straddle.
    assert close.all() if derivative != "C" else close.mean() > 0.99


@pytest.mark.parametrize(("value", "rate"), [("f", "f_t"), ("g", "g_t"), ("A", "A_t")])
def test_rates_are_finite_differences_of_moved_particles(value, rate):
    options = {"sigma": SIGMA, "threshold": 1.5}
    particles, velocities = rotating_ball()
    h = 1e-6
    ahead, back = (kappaflow.Field(particles + s * h * velocities, velocities, **options).jets(POINTS) for s in (1, -1))
    expected = getattr(kappaflow.Field(particles, velocities, **options).jets(POINTS), rate)
    difference = (getattr(ahead, value) - getattr(back, value)) / (2 * h)
    np.testing.assert_allclose(difference, expected, rtol=1e-5, atol=1e-6 * np.abs(expected).max())


def test_curvatures_of_a_sphere():
    points = np.array([0.1, 0.2, 0.3]) + RANDOM.normal(size=(50, 3)) * 0.2
    radius = np.linalg.norm(points - [0.1, 0.2, 0.3], axis=1)
    curvatures = lone_particle().curvatures(points)
    np.testing.assert_allclose(curvatures.H, 1 / radius, rtol=1e-9)
    np.testing.assert_allclose(curvatures.K, 1 / radius**2, rtol=1e-9)
    outward = (points - [0.1, 0.2, 0.3]) / radius[:, None]
    np.testing.assert_allclose(curvatures.grad_H, -outward / radius[:, None] ** 2, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(curvatures.H_t, 0, atol=1e-12)


def test_a_plane_is_flat_and_moves_as_its_particles_do():
    axis = 0.1 * np.arange(-12, 13)
    x, y, z = (c.ravel() for c in np.meshgrid(axis, axis, 0.1 * np.arange(-12, 1), indexing="ij"))
    particles = np.stack([x, y, z], -1)
    half_inside = 32 * np.pi / 315 * (0.4 / 0.1) ** 3  # half of what Eq. 12 is inside a body, summed as an integral
    field = kappaflow.Field(particles, np.tile([0.4, 0, 0.7], (len(particles), 1)), sigma=0.4, threshold=half_inside)
    points = field.project(np.c_[RANDOM.uniform(-0.3, 0.3, (40, 2)), np.full(40, 0.05)])
    assert points.converged.all()
    assert np.abs(points.positions[:, 2] - 0.05).max() < 0.01 * 0.4  # half a spacing above the last layer
    curvatures = field.curvatures(points.positions)
    assert np.abs(curvatures.H).max() * 0.4 < 0.05  # the lattice shows a little
    normal = field.velocities(points.positions, "normal").velocity
    np.testing.assert_allclose(normal, np.tile([0, 0, 0.7], (40, 1)), atol=0.03)
    np.testing.assert_allclose(field.material_velocities(points.positions), np.tile([0.4, 0, 0.7], (40, 1)), atol=1e-12)


def test_curvature_is_the_divergence_of_the_normal():
    field = kappaflow.Field(*rotating_ball(), sigma=SIGMA)
    points = field.project(POINTS * 0.9).positions
    h = 1e-6

    def normals(x):
        g = field.jets(x).g
        return -g / np.linalg.norm(g, axis=1)[:, None]

    shape = np.stack([(normals(points + h * e) - normals(points - h * e)) / (2 * h) for e in np.eye(3)], -1)
    curvatures = field.curvatures(points)
    np.testing.assert_allclose(np.trace(shape, axis1=1, axis2=2) / 2, curvatures.H, rtol=1e-4, atol=1e-4)
    pairs = (np.trace(shape, axis1=1, axis2=2) ** 2 - np.trace(shape @ shape, axis1=1, axis2=2)) / 2
    np.testing.assert_allclose(pairs, curvatures.K, rtol=1e-3, atol=1e-3)


def test_where_nothing_is_there_is_nothing():
    field = lone_particle()
    far = [[9, 9, 9]]
    assert field.values(far)[0] == -0.3
    assert np.isnan(field.curvatures(far).H[0]) and np.isnan(field.material_velocities(far)).all()
    assert field.jets(far).length_scale[0] == 0 and not field.project(far).converged[0]
    assert field.values(np.empty((0, 3))).shape == (0,) and field.jets(np.empty((0, 3))).C.shape == (0, 3, 3, 3)


def test_projection_and_surface_of_a_sphere():
    threshold = 0.3
    radius = np.sqrt(1 - threshold ** (1 / 3))
    field = lone_particle(threshold)
    start = np.array([0.1, 0.2, 0.3]) + RANDOM.normal(size=(30, 3)) * 0.2
    points = field.project(start)
    distance = np.linalg.norm(points.positions - [0.1, 0.2, 0.3], axis=1)
    np.testing.assert_allclose(distance, radius, atol=2e-4)
    assert points.converged.all() and points.residuals.max() <= 1e-4

    positions, triangles = field.surface(0.05)
    a, b, c = (positions[triangles[:, k]] - [0.1, 0.2, 0.3] for k in range(3))
    np.testing.assert_allclose(np.linalg.norm(positions - [0.1, 0.2, 0.3], axis=1), radius, atol=2e-4)
    volume = np.einsum("ij,ij->", a, np.cross(b, c)) / 6
    assert volume == pytest.approx(4 / 3 * np.pi * radius**3, rel=0.01)  # and it is oriented outward


def test_normalised_weights_make_a_lone_particle_weigh_one():
    points = [[0.1, 0.2, 0.5]]
    assert lone_particle(weights="normalised").values(points) == lone_particle(weights="uniform").values(points)
    particles = ball()
    uniform, normalised = (kappaflow.Field(particles, sigma=SIGMA, threshold=0.5, weights=w).values([[0, 0, 0]])[0]
                           for w in ("uniform", "normalised"))
    assert uniform > 5 and normalised == pytest.approx(0.5, abs=0.2)  # about one, minus T


@pytest.mark.parametrize("kernels", ["round", "anisotropic"])
@pytest.mark.parametrize("method", list(kappaflow.velocity_methods()))
def test_the_normal_part_of_every_method_is_eq_4(method, kernels):
    field = kappaflow.Field(*rotating_ball(), sigma=SIGMA, kernels=kernels)
    positions, triangles = field.surface(0.1)
    velocity, confidence = field.velocities(positions, method, triangles=triangles, speed_limit=4)
    jets = field.jets(positions)
    normal = -jets.g / np.linalg.norm(jets.g, axis=1)[:, None]
    eq4 = jets.f_t / np.linalg.norm(jets.g, axis=1)
    np.testing.assert_allclose((velocity * normal).sum(1), eq4, rtol=1e-9, atol=1e-9)
    assert confidence.min() >= 0 and confidence.max() <= 1


def test_bits_do_not_depend_on_the_threads():
    results = []
    for count in (1, 2):
        kappaflow.set_threads(count)
        field = kappaflow.Field(*rotating_ball(), sigma=SIGMA)
        results.append([*field.jets(POINTS), *field.curvatures(POINTS), *field.velocities(POINTS, "curvature"), *field.surface(0.1)])
    kappaflow.set_threads(None)
    assert all(same_bits(one, two) for one, two in zip(*results, strict=True))


def test_arrays_of_other_types_and_orders_give_the_same():
    particles, velocities = rotating_ball()
    expected = kappaflow.Field(particles, velocities, sigma=SIGMA).values(POINTS)
    assert same_bits(kappaflow.Field(np.asfortranarray(particles), velocities.tolist(), sigma=SIGMA).values(POINTS), expected)
    assert same_bits(kappaflow.Field(particles, velocities, sigma=SIGMA).values(np.asfortranarray(POINTS)), expected)
    whole = kappaflow.Field(particles, sigma=SIGMA).values(np.zeros((1, 3), int))
    assert same_bits(whole, kappaflow.Field(particles, sigma=SIGMA).values(np.zeros((1, 3))))
