//! What shapes have that grids have not.

use shapeloom_core::Loss;
use shapeloom_mesh::{Domain, TriMesh};

/// All attributes of a mesh, as lost.
pub(crate) fn of_mesh(mesh: &TriMesh, why: &str) -> Vec<Loss> {
    let mut losses = Vec::new();
    for domain in [Domain::Vertex, Domain::Face, Domain::Wedge] {
        let attributes = mesh.attributes().of(domain);
        let names = attributes.iter().map(|column| format!("{domain} attribute \"{}\"", column.name()));
        let lists = attributes.lists().iter().map(|list| format!("{domain} list \"{}\"", list.name()));
        losses.extend(names.chain(lists).map(|what| Loss::new(what, why)));
    }
    losses
}
