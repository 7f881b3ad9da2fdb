//! The hierarchy of nodes.

use serde_json::Value;
use shapeloom_core::glam::{DMat3, DMat4, DQuat, DVec3};
use shapeloom_core::{Affine, Category, Findings, Place, Severity};

use super::json::At;
use crate::memory::Memory;
use crate::{Fault, ReadContext, ReadError};

/// A node with a mesh, where it is in the scene.
pub(super) struct Placed<'j> {
    pub node: At<'j>,
    pub placement: Affine,
}

/// The nodes with meshes of the scene that the document shows, parents first, children in order.
///
/// The nodes must be a forest: no cycles, no node with two parents. Depth is bounded by
/// [`Limits::max_depth`](shapeloom_core::Limits), not by the stack of the program.
pub(super) fn placed_nodes<'j>(
    document: &At<'j>,
    memory: &mut Memory<'_>,
    findings: &mut Findings,
    context: &ReadContext,
) -> Result<Vec<Placed<'j>>, ReadError> {
    let count = document.count("nodes")?;
    if count as u64 > context.limits.max_elements {
        let expected = format!("at most {}", context.limits.max_elements);
        return Err(document
            .fault("E-gltf-limit", format!("{count} nodes"), expected)
            .category(Category::OverLimit)
            .into());
    }
    // A parent and its children's numbers, an entry of the stack, a placed node with its path.
    memory.take(count, 2 * size_of::<u32>() + 2 * size_of::<Entry>() + 2 * size_of::<Placed<'_>>() + 32)?;
    let (children, parents) = links(document, count)?;
    refuse_cycles(&parents)?;

    let mut stack: Vec<Entry> = Vec::new();
    for root in roots(document, &parents)?.into_iter().rev() {
        stack.push(Entry { node: root, above: Affine::IDENTITY, depth: 1 });
    }
    let Some(nodes) = document.get("nodes")? else {
        return Ok(Vec::new());
    };
    let nodes: Vec<At<'j>> = nodes.elements()?.collect();
    let mut visited = vec![false; count];
    let mut steps = 0u32;
    let mut placed = Vec::new();
    while let Some(Entry { node, above, depth }) = stack.pop() {
        let at = &nodes[node];
        if std::mem::replace(&mut visited[node], true) {
            return Err(at.fault("E-gltf-parents", "a node that the scene reaches twice", "a tree of nodes").into());
        }
        if depth > context.limits.max_depth {
            let fault =
                at.fault("E-gltf-depth", format!("nodes nested {depth} deep"), format!("at most {}", depth - 1));
            return Err(fault.category(Category::OverLimit).into());
        }
        steps += 1;
        if steps.is_multiple_of(4096) {
            context.exec.check()?;
        }
        let placement = above * local(at, node, findings)?;
        if at.get("mesh")?.is_some() {
            placed.push(Placed { node: at.clone(), placement });
        }
        let below = children[node].iter().rev();
        stack.extend(below.map(|&child| Entry { node: child, above: placement, depth: depth + 1 }));
    }
    Ok(placed)
}

struct Entry {
    node: usize,
    above: Affine,
    depth: u32,
}

const NO_PARENT: usize = usize::MAX;

/// The children and the parent of each node.
type Links = (Vec<Vec<usize>>, Vec<usize>);

fn links(document: &At<'_>, count: usize) -> Result<Links, Box<Fault>> {
    let mut children = vec![Vec::new(); count];
    let mut parents = vec![NO_PARENT; count];
    let nodes = document.get("nodes")?;
    for (parent, node) in
        nodes.iter().map(At::elements).collect::<Result<Vec<_>, _>>()?.into_iter().flatten().enumerate()
    {
        let Some(list) = node.get("children")? else { continue };
        for child in list.elements()? {
            let at = document.element("nodes", &child)?;
            let number = child.count_value()? as usize;
            if parents[number] != NO_PARENT {
                let found = format!("a child of both node {} and node {parent}", parents[number]);
                return Err(at.fault("E-gltf-parents", found, "a tree, where each node has one parent"));
            }
            parents[number] = parent;
            children[parent].push(number);
        }
    }
    Ok((children, parents))
}

/// With one parent each, nodes are a forest unless walking up comes round again.
fn refuse_cycles(parents: &[usize]) -> Result<(), Box<Fault>> {
    // The walk in which each node was first seen; no walk enters what an earlier one has seen.
    let mut seen_in = vec![0usize; parents.len()];
    for start in 0..parents.len() {
        let (walk, mut node) = (start + 1, start);
        while node != NO_PARENT && seen_in[node] == 0 {
            seen_in[node] = walk;
            node = parents[node];
        }
        if node != NO_PARENT && seen_in[node] == walk {
            let mut first = node;
            let mut around = parents[node];
            while around != node {
                first = first.min(around);
                around = parents[around];
            }
            let fault = Fault::new("E-gltf-cycle", Place::Whole, "a node that is below itself", "a tree of nodes");
            return Err(fault.within(format!("/nodes/{first}")));
        }
    }
    Ok(())
}

/// The roots of the scene to show; without scenes, all nodes without a parent.
fn roots(document: &At<'_>, parents: &[usize]) -> Result<Vec<usize>, Box<Fault>> {
    if document.count("scenes")? == 0 {
        return Ok((0..parents.len()).filter(|&node| parents[node] == NO_PARENT).collect());
    }
    let first = Value::from(0);
    let index = document.get("scene")?.unwrap_or(At { value: &first, path: "/scene".into() });
    let scene = document.element("scenes", &index)?;
    let Some(list) = scene.get("nodes")? else {
        return Ok(Vec::new());
    };
    let mut roots = Vec::new();
    for root in list.elements()? {
        document.element("nodes", &root)?;
        roots.push(root.count_value()? as usize);
    }
    Ok(roots)
}

/// The transform of a node: its matrix, or translation after rotation after scale.
fn local(node: &At<'_>, number: usize, findings: &mut Findings) -> Result<Affine, Box<Fault>> {
    let place = || Place::element("node", number as u64);
    let (map, path) = match node.get("matrix")? {
        Some(matrix) => {
            let columns = matrix.numbers::<16>()?;
            let full = DMat4::from_cols_array(&columns);
            if full.row(3).to_array() != [0.0, 0.0, 0.0, 1.0] {
                let message = format!("{}: the last row is not 0 0 0 1; it was taken as that", matrix.path);
                findings.push("W-gltf-matrix", Severity::Warning, place(), message);
            }
            (Affine { linear: DMat3::from_mat4(full), translation: full.w_axis.truncate() }, matrix.path)
        }
        None => {
            let get = |key: &str| node.get(key);
            let translation = get("translation")?.map_or(Ok([0.0; 3]), |value| value.numbers())?;
            let rotation = get("rotation")?.map_or(Ok([0.0, 0.0, 0.0, 1.0]), |value| value.numbers())?;
            let scale = get("scale")?.map_or(Ok([1.0; 3]), |value| value.numbers())?;
            let turn = DQuat::from_array(rotation);
            let length = turn.length();
            if (length - 1.0).abs() > 1e-3 {
                let message = format!("{}: the rotation's length is {length}; it was scaled to 1", node.path);
                findings.push("W-gltf-rotation", Severity::Warning, place(), message);
            }
            // Files store rotations in single precision; a turn must not scale.
            let turn = if length > 0.0 { turn / length } else { DQuat::IDENTITY };
            // Exact where nothing turns, so that plain nodes keep their bits.
            let turn = if rotation == [0.0, 0.0, 0.0, 1.0] { DMat3::IDENTITY } else { DMat3::from_quat(turn) };
            let linear = turn * DMat3::from_diagonal(DVec3::from_array(scale));
            (Affine { linear, translation: DVec3::from_array(translation) }, node.child("scale"))
        }
    };
    if map.determinant() == 0.0 {
        let message = format!("{path}: the map flattens space, so that normals there have no direction");
        findings.push("W-gltf-singular", Severity::Warning, place(), message);
    }
    Ok(map)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn walk(document: &Value, context: &ReadContext) -> Result<Vec<(String, Affine)>, ReadError> {
        let mut memory = Memory::new(&context.exec);
        let placed = placed_nodes(&At::root(document), &mut memory, &mut Findings::default(), context)?;
        Ok(placed.into_iter().map(|placed| (placed.node.path, placed.placement)).collect())
    }

    #[test]
    fn transforms_multiply_from_the_root_down() {
        let document = json!({"scenes": [{"nodes": [0]}], "nodes": [
            {"translation": [1.0, 0.0, 0.0], "scale": [2.0, 2.0, 2.0], "children": [2, 1]},
            {"mesh": 0},
            {"mesh": 0, "rotation": [0.0, 0.0, 1.0, 0.0], "translation": [3.0, 0.0, 0.0]}
        ]});
        let placed = walk(&document, &ReadContext::default()).unwrap();
        assert_eq!(placed.iter().map(|(path, _)| path.as_str()).collect::<Vec<_>>(), ["/nodes/2", "/nodes/1"]);
        // Half a turn about z, then 3 along x, then twice as large, then 1 along x.
        assert_eq!(placed[0].1.point(DVec3::X), DVec3::new(5.0, 0.0, 0.0));
        assert_eq!(placed[1].1.point(DVec3::X), DVec3::new(3.0, 0.0, 0.0));
    }

    #[test]
    fn what_is_no_forest_is_refused() {
        let fault = |document: Value| {
            let error = walk(&document, &ReadContext::default()).unwrap_err();
            let fault = error.fault().unwrap().clone();
            (fault.code, fault.within.unwrap())
        };
        let cycle = json!({"nodes": [{}, {"children": [3]}, {"children": [1]}, {"children": [2]}]});
        assert_eq!(fault(cycle), ("E-gltf-cycle", "/nodes/1".into()));
        let own = json!({"nodes": [{"children": [0]}]});
        assert_eq!(fault(own), ("E-gltf-cycle", "/nodes/0".into()));
        let shared = json!({"nodes": [{"children": [2]}, {"children": [2]}, {}]});
        assert_eq!(fault(shared), ("E-gltf-parents", "/nodes/2".into()));
        let twice = json!({"scenes": [{"nodes": [0, 1]}], "nodes": [{"children": [1]}, {}]});
        assert_eq!(fault(twice), ("E-gltf-parents", "/nodes/1".into()));
        let outside = json!({"nodes": [{"children": [9]}]});
        assert_eq!(fault(outside), ("E-gltf-reference", "/nodes/0/children/0".into()));
    }

    #[test]
    fn depth_is_bounded_by_the_limit() {
        let mut nodes: Vec<Value> = (1..100).map(|child| json!({"children": [child]})).collect();
        nodes.push(json!({"mesh": 0}));
        let document = json!({"nodes": nodes});
        let mut context = ReadContext::default();
        assert_eq!(walk(&document, &context).unwrap().len(), 1);
        context.limits.max_depth = 99;
        assert_eq!(walk(&document, &context).unwrap_err().fault().unwrap().code, "E-gltf-depth");
    }
}
