# What programs of others may include, as <kappaflow/core/types.h> and so on (tools/io as <kappaflow/io>). docs/api.md names
# each of them, which tests/api.cmake checks; a public header includes public headers only, which install_headers.cmake does.
set(KAPPAFLOW_PUBLIC_HEADERS
    core/body_motion.h core/bytes.h core/cell_grid.h core/connectivity.h core/errors.h core/named.h
    core/nearest_on_triangle.h core/parallel.h core/particles.h core/shapes.h core/shared_loop.h core/solid_distance.h core/solid_wall.h core/solids.h
    core/time_table.h core/triangle_tree.h core/types.h core/whole_within.h
    core/work_group.h
    surface/field/anisotropic_field.h surface/field/distance_field.h surface/field/field.h surface/field/field_kernels.h surface/field/kernel_shapes.h surface/field/symmetric_place.h
    surface/field/grid_spline.h surface/field/jet.h surface/field/particle_field.h surface/field/particle_motion.h
    surface/field/particle_weights.h surface/field/projection.h surface/field/taylor.h surface/field/taylor_terms.h
    surface/field/time_integrator.h
    surface/mesh/isosurface.h surface/mesh/mesh_distances.h surface/mesh/mesh_measures.h surface/mesh/triangle_mesh.h surface/mesh/vertex_arrays.h
    surface/mesh/vertex_history.h
    surface/motion/material.h surface/motion/normal.h surface/motion/pointwise.h surface/motion/regional.h
    surface/motion/velocity.h surface/motion/velocity_methods.h
    surface/topology/topology_options.h
    surface/remesh/initial_mesh.h surface/remesh/remesh_options.h
    surface/measure/surface_motion.h surface/measure/surface_state.h surface/measure/texture.h
    surface/tracker/fairing_options.h surface/tracker/fresh_surface.h surface/tracker/particle_origins.h
    surface/tracker/rest_grid.h
    surface/tracker/rest_pair.h surface/tracker/surface_group.h surface/tracker/surface_methods.h surface/tracker/surface_options.h surface/tracker/surface_tracker.h
    surface/tracker/tracked_surfaces.h surface/tracker/tracker_options.h
    solver/emitter.h solver/emitter_flow.h solver/fluid_solver.h solver/heat_options.h solver/options.h solver/ranks.h
    solver/rheology.h
    solver/rigid_body.h solver/temperature_law.h
    scenes/estimate.h scenes/prepared_scene.h scenes/scene.h scenes/view.h
    tools/io/files.h tools/io/particle_frame.h tools/io/pvd.h tools/io/vtp_files.h)
