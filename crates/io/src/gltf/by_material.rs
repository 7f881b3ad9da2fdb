//! The triangles of a mesh by the material of each.

use std::collections::HashMap;

use shapeloom_mesh::{Column, Domain, MATERIAL, TriMesh, Values};

use super::split::Split;

/// The column that names a material for each face, if the mesh has one.
pub(super) fn material_column(mesh: &TriMesh) -> Option<&Column> {
    mesh.attribute(Domain::Face, MATERIAL).filter(|column| matches!(column.values(), Values::Text { .. }))
}

/// One part for each material, in the order of their first faces, with its name and its own vertices. Vertices that no
/// triangle uses go with the first; an empty name stands for none.
pub(super) fn by_material(split: Split, column: Option<&Column>) -> Vec<(Option<&str>, Split)> {
    let Some(column) = column.filter(|column| !column.is_empty()) else { return vec![(None, split)] };
    let mut rank: HashMap<&str, usize> = HashMap::new();
    let mut names = Vec::new();
    let mut triangles: Vec<Vec<[u32; 3]>> = Vec::new();
    for (face, &triangle) in split.triangles.iter().enumerate() {
        let name = column.text(face).unwrap_or_default();
        let of = *rank.entry(name).or_insert_with(|| {
            names.push(Some(name).filter(|name| !name.is_empty()));
            triangles.push(Vec::new());
            names.len() - 1
        });
        triangles[of].push(triangle);
    }
    if let [only] = names[..] {
        return vec![(only, split)];
    }
    let mut used = vec![false; split.vertices.len()];
    split.triangles.as_flattened().iter().for_each(|&vertex| used[vertex as usize] = true);
    // The vertex in the part at hand, and the part it was last numbered for.
    let mut numbered = vec![(0u32, usize::MAX); split.vertices.len()];
    let mut parts = Vec::new();
    for (part, (name, mut triangles)) in names.into_iter().zip(triangles).enumerate() {
        let mut wanted: Vec<u32> = triangles.as_flattened().to_vec();
        wanted.sort_unstable();
        wanted.dedup();
        if part == 0 {
            wanted.extend((0..used.len() as u32).filter(|&vertex| !used[vertex as usize]));
        }
        for (new, &old) in wanted.iter().enumerate() {
            numbered[old as usize] = (new as u32, part);
        }
        for vertex in triangles.as_flattened_mut() {
            debug_assert_eq!(numbered[*vertex as usize].1, part);
            *vertex = numbered[*vertex as usize].0;
        }
        let pick = |from: &[u32]| wanted.iter().map(|&old| from[old as usize]).collect();
        parts.push((name, Split { vertices: pick(&split.vertices), wedges: pick(&split.wedges), triangles }));
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::super::split::{NO_WEDGE, split};
    use super::*;
    use shapeloom_core::Exec;

    fn column(words: &[&str]) -> Column {
        let names: Vec<String> = ["", "oak", "elm"].map(str::to_owned).to_vec();
        let index = words.iter().map(|word| names.iter().position(|name| name == word).unwrap() as u32).collect();
        Column::try_new(MATERIAL, 1, Values::Text { names, index }).unwrap()
    }

    #[test]
    fn every_part_has_its_own_vertices() {
        let triangles = [[0, 1, 2], [2, 1, 3], [5, 3, 1]];
        let materials = column(&["elm", "oak", "elm"]);
        let parts = by_material(split(7, &triangles, &[], &Exec::default()).unwrap().unwrap(), Some(&materials));
        let names: Vec<Option<&str>> = parts.iter().map(|(name, _)| *name).collect();
        assert_eq!(names, [Some("elm"), Some("oak")]);
        // Vertices 4 and 6 are used by no triangle.
        assert_eq!(parts[0].1.vertices, [0, 1, 2, 3, 5, 4, 6]);
        assert_eq!(parts[0].1.wedges, [0, 1, 2, 5, 6, NO_WEDGE, NO_WEDGE]);
        assert_eq!(parts[0].1.triangles, [[0, 1, 2], [4, 3, 1]]);
        assert_eq!((&parts[1].1.vertices[..], &parts[1].1.triangles[..]), (&[1, 2, 3][..], &[[1, 0, 2]][..]));
    }

    #[test]
    fn one_material_keeps_the_mesh_whole() {
        let whole = || split(5, &[[0, 1, 2], [2, 1, 3]], &[], &Exec::default()).unwrap().unwrap();
        assert_eq!(by_material(whole(), Some(&column(&["oak"; 2]))), [(Some("oak"), whole())]);
        assert_eq!(by_material(whole(), Some(&column(&[""; 2]))), [(None, whole())]);
        assert_eq!(by_material(whole(), None), [(None, whole())]);
    }
}
