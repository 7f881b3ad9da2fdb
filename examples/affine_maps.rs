//! Points, vectors and normals under an affine map; a turn about an axis through a point; gimbal lock.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Affine, AffineClass, AxisAngle, Convert, Exec, YawPitchRoll};
use shapeloom::mesh::primitives::Sphere;
use shapeloom::mesh::{Domain, NORMAL, TriMesh, TriangulatePolygons};
use shapeloom::render::{Picture, Scene, SceneMesh};
use shapeloom_examples::Output;

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;

    // Translations move points but not vectors. Normals go by the inverse transpose and stay across the surface.
    let map = Affine::from_translation(DVec3::new(5.0, 0.0, 0.0)) * Affine::from_scale(DVec3::new(3.0, 1.0, 1.0));
    let (along, across) = (DVec3::new(1.0, -1.0, 0.0), DVec3::new(1.0, 1.0, 0.0).normalize());
    println!("point (1, 0, 0) goes to {}, vector (1, 0, 0) to {}", map.point(DVec3::X), map.vector(DVec3::X));
    let angle = |normal: DVec3| map.vector(along).angle_between(normal).to_degrees();
    println!("a tangent and its normal, at 90 degrees, have afterwards");
    println!("  {:.1} degrees if the normal is mapped as a vector", angle(map.vector(across)));
    println!("  {:.1} degrees if it is mapped as a normal", angle(map.normal(across)));
    println!("the map is {:?} and multiplies volumes by {}", map.class(1e-12), map.determinant());

    // A quarter turn about the vertical axis through (1, 1, 0): that point stays, and distances do.
    let turn = AxisAngle::new(DVec3::Z, std::f64::consts::FRAC_PI_2)?;
    let turn = Affine::from_rotation(turn).about(DVec3::new(1.0, 1.0, 0.0));
    println!("turned: (1, 1, 0) to {:.3}, (2, 1, 0) to {:.3}", turn.point(DVec3::new(1.0, 1.0, 0.0)), {
        turn.point(DVec3::new(2.0, 1.0, 0.0))
    });
    assert!(matches!(turn.class(1e-12), AffineClass::Rigid));
    let back = turn.inverse()? * turn;
    println!("there and back is off by {:.1e}", (back.translation.length() + (back.linear.x_axis - DVec3::X).length()));

    // With the pitch at 90 degrees yaw and roll turn about the same axis: only their difference is left.
    for degrees in [30.0f64, 90.0] {
        let angles = YawPitchRoll { yaw: 0.5, pitch: degrees.to_radians(), roll: 0.2 };
        let (found, locked) = YawPitchRoll::from_matrix(&angles.to_matrix())?;
        let lock = if locked { "gimbal lock, yaw - roll is kept" } else { "all three come back" };
        println!("pitch {degrees}: yaw {:.3}, roll {:.3} from 0.5 and 0.2: {lock}", found.yaw, found.roll);
        // The rotation is the same all the same.
        assert!(found.to_matrix().abs_diff_eq(angles.to_matrix(), 1e-12));
    }

    // A sphere made flat: on the left its normals were mapped as vectors, on the right as normals.
    let ball = TriangulatePolygons::new().convert(&Sphere::new().mesh(&Exec::default())?.value)?.value;
    let flat = Affine::from_scale(DVec3::new(1.0, 1.0, 0.3));
    let wrong = surface(&ball, &flat, -1.15, |normal| flat.vector(normal))?;
    let right = surface(&ball, &flat, 1.15, |normal| flat.normal(normal))?;
    let scene = Scene { surfaces: vec![wrong, right] };
    println!("{}", output.draw("affine_maps", &scene, [0.0, 25.0], Picture::new())?.display());
    Ok(())
}

fn surface(mesh: &TriMesh, map: &Affine, x: f64, f: impl Fn(DVec3) -> DVec3) -> Result<SceneMesh, Box<dyn Error>> {
    let column = mesh.attribute(Domain::Wedge, NORMAL).ok_or("no normals")?;
    let normals = (0..column.len()).map(|wedge| f(column.vector(wedge))).collect();
    let positions = mesh.positions().iter().map(|&position| map.point(position) + DVec3::X * x).collect();
    Ok(SceneMesh { normals: Some(normals), ..SceneMesh::new(positions, mesh.triangles().to_vec()) })
}
