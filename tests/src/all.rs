//! Tests across crates: one binary, a module for each concern.
//!
//! Documents that are made from tables are compared with what the tables say; with `SHAPELOOM_BLESS=1` in the
//! environment they are written anew instead.

mod bench;
mod between_formats;
mod boolean_command;
mod cell_faces;
mod check;
mod codes;
mod collection;
mod collection_gltf;
mod collection_heights;
mod collection_obj;
mod collection_off_stl;
mod collection_ply;
mod collection_volumes;
mod command_line;
mod compare;
mod documents;
#[path = "../fuzz/entry.rs"]
mod entry;
mod face_list_operators;
mod floors;
mod greedy_insertion;
mod half_edges;
mod harness;
mod height_files;
mod isosurface_cubes;
mod isosurface_nets;
mod laws;
mod malformed;
mod malformed_gltf;
mod malformed_heights;
mod malformed_obj;
mod malformed_off;
mod malformed_ply;
mod malformed_stl;
mod malformed_volumes;
mod memory;
mod mutations;
mod oracles;
mod orientation;
mod peer_gltf;
mod plane;
mod properties;
mod query_laws;
mod regressions;
mod regularised_sets;
mod round_trips;
mod same_bits;
mod sampled_surface;
mod self_intersection;
mod shapes;
mod structures;
mod structures_command;
mod support;
mod topology;
mod triangle_pairs;
mod verification;
mod volume_files;
mod voxelisation;
mod winding;
