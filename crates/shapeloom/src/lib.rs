//! Shapes in every form that practice uses, and any of them into any other, with an honest account of what each
//! conversion cost.
//!
//! This crate gathers the others under one name; each stands on its own as well.
//!
//! # The tour
//!
//! A shape in one representation is a plain value. A converter is a value too: a struct named after its algorithm, whose
//! fields are its options. Converting gives the result and a report of what it cost.
//!
//! ```
//! use shapeloom::core::glam::DVec3;
//! use shapeloom::core::{Convert, Deviation};
//! use shapeloom::parametric::{BezierPatch, BezierSurface, TessellatePatches};
//!
//! // A saddle: the bilinear patch through four corners.
//! let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE];
//! let saddle = BezierSurface::new(vec![BezierPatch::try_new(1, 1, corners)?]);
//!
//! let converted = TessellatePatches::new(0.01).convert(&saddle)?;
//! println!("{} triangles", converted.value.triangles().len());
//! // The error is proven, not guessed.
//! assert!(matches!(converted.report.deviation, Deviation::AtMost(bound) if bound <= 0.01));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Files hold a [`Shape`](shape::Shape): parts of any representation, with names, materials, units and an up axis. The
//! planner finds the converters from what a file holds to what is wanted.
//!
//! ```
//! use shapeloom::convert::{Job, Wish, convert_shape};
//! use shapeloom::core::Exec;
//! use shapeloom::io::{ReadContext, WriteContext, detect, format_by_id, read, write};
//! use shapeloom::shape::Kind;
//!
//! let file = b"1\n1 1\n0 0 0\n1 0 0\n0 1 0\n1 1 1\n";
//! let format = detect(file, Some("saddle.bpt"))?;
//! let source = read(file, format, &ReadContext::named("saddle.bpt"))?;
//! let job = Job { wish: Wish::to([Kind::TriMesh]), tolerance: 0.01, settings: Vec::new() };
//! let conversion = convert_shape(&source.shape, &job, &Exec::default())?;
//! let mut glb = Vec::new();
//! write(&conversion.shape, format_by_id("glb")?, &WriteContext::default(), &mut glb)?;
//! assert_eq!(&glb[..4], b"glTF");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # The rooms
//!
//! | module | what is there |
//! |---|---|
//! | [`core`] | boxes, affine maps, cameras; conversions, reports, options, execution, errors; the capability traits |
//! | [`spatial`] | a bounding volume hierarchy with watertight rays and closest points, winding numbers, signed distances |
//! | [`mesh`] | triangle and polygon meshes, polylines, height fields, point clouds, attributes, primitives |
//! | [`judge`] | what decides whether a shape is sound: topology, self-intersection, distances |
//! | [`parametric`] | Bézier curves and patches, and their tessellation with a proven error |
//! | [`implicit`] | trees of fields, compiled, with proven bounds; text; blobs and molecules; rays, places of points, curves in planes |
//! | [`isosurface`] | surfaces where samples on a lattice reach a value |
//! | [`implicit`] | fields as expression trees, compiled; their surfaces as triangles |
//! | [`voxels`] | grids of samples placed in space, and what makes them of meshes, points and fields |
//! | [`shape`] | the dynamic shape of parts |
//! | [`io`] | file formats |
//! | [`render`] | pictures on the CPU |
//! | [`convert`] | the registry of converters, the planner, conversion of whole shapes |

pub use shapeloom_convert as convert;
pub use shapeloom_core as core;
pub use shapeloom_implicit as implicit;
pub use shapeloom_io as io;
pub use shapeloom_isosurface as isosurface;
pub use shapeloom_judge as judge;
pub use shapeloom_mesh as mesh;
pub use shapeloom_parametric as parametric;
pub use shapeloom_render as render;
pub use shapeloom_shape as shape;
pub use shapeloom_spatial as spatial;
pub use shapeloom_voxels as voxels;
