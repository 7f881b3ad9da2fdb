//! The hierarchy of nodes.

use std::collections::BTreeSet;

use serde_json::Value;
use shapeloom_core::glam::{DMat3, DMat4, DQuat, DVec3};
use shapeloom_core::{Affine, Category, Findings, Place, Severity};

use super::allowance::Allowance;
use super::ignored::Ignored;
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
/// Nodes must not be below themselves. glTF asks for a tree; a node with several parents is taken for as many instances
/// as there are ways to it, with a warning, if each way puts it somewhere else: two in the same place are one too many.
/// Depth is bounded by [`Limits::max_depth`](shapeloom_core::Limits), not by the stack of the program.
pub(super) fn placed_nodes<'j>(
    document: &At<'j>,
    memory: &mut Memory<'_>,
    allowance: &Allowance,
    ignored: &mut Ignored<'j>,
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
    // Links, colours and the path of the search for cycles, and the list of nodes.
    memory.take(count, size_of::<[usize; 8]>() + 2 * size_of::<At<'_>>() + 32)?;
    let Links { children, mut ways } = links(document, count)?;
    refuse_cycles(&children)?;
    let roots = roots(document, &ways, ignored)?;
    roots.iter().for_each(|&root| ways[root] += 1);

    let mut stack: Vec<Entry> = Vec::new();
    for root in roots.into_iter().rev() {
        memory.take(1, 2 * size_of::<Entry>())?;
        stack.push(Entry { node: root, above: Affine::IDENTITY, depth: 1 });
    }
    let Some(nodes) = document.get("nodes")? else {
        return Ok(Vec::new());
    };
    let nodes: Vec<At<'j>> = nodes.elements()?.collect();
    let mut places = BTreeSet::new();
    // Every node once, and as many instances as there may be parts.
    let most = context.limits.max_elements.min(count as u64 + allowance.most_parts());
    let mut steps = 0u64;
    let mut placed = Vec::new();
    while let Some(Entry { node, above, depth }) = stack.pop() {
        let at = &nodes[node];
        if depth > context.limits.max_depth {
            let fault =
                at.fault("E-gltf-depth", format!("nodes nested {depth} deep"), format!("at most {}", depth - 1));
            return Err(fault.category(Category::OverLimit).into());
        }
        steps += 1;
        if steps.is_multiple_of(4096) {
            context.exec.check()?;
        }
        if steps > most {
            let found = "a node that is reached in very many ways";
            let fault = at.fault("E-gltf-limit", found, format!("at most {most} in all"));
            return Err(fault.category(Category::OverLimit).into());
        }
        ignored.of("nodes", at);
        let placement = above * local(at, node, findings)?;
        if ways[node] > 1 {
            // Ways may double with every level: each takes its memory from the budget.
            memory.take(1, 4 * size_of::<[u64; 13]>())?;
            if !places.insert((node, bits(&placement))) {
                let found = "a node that the scene reaches twice in the same place";
                return Err(at.fault("E-gltf-parents", found, "a tree, where each node has one parent").into());
            }
            let message = format!("{} has {} parents; it was read as an instance below each", at.path, ways[node]);
            findings.push("W-gltf-parents", Severity::Warning, Place::element("node", node as u64), message);
        }
        if at.get("mesh")?.is_some() {
            memory.take(at.path.len() + 2 * size_of::<Placed<'_>>(), 1)?;
            placed.push(Placed { node: at.clone(), placement });
        }
        memory.take(children[node].len(), 2 * size_of::<Entry>())?;
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

/// A placement as numbers that are equal where the placements are the same.
fn bits(map: &Affine) -> [u64; 12] {
    let linear = map.linear.to_cols_array();
    let all = linear.into_iter().chain(map.translation.to_array());
    let mut bits = [0; 12];
    // Adding zero turns -0 into 0.
    bits.iter_mut().zip(all).for_each(|(bits, number)| *bits = (number + 0.0).to_bits());
    bits
}

/// The children of each node, and the number of times that it is one.
struct Links {
    children: Vec<Vec<usize>>,
    ways: Vec<u32>,
}

fn links(document: &At<'_>, count: usize) -> Result<Links, Box<Fault>> {
    let mut links = Links { children: vec![Vec::new(); count], ways: vec![0; count] };
    let nodes = document.get("nodes")?;
    for (parent, node) in
        nodes.iter().map(At::elements).collect::<Result<Vec<_>, _>>()?.into_iter().flatten().enumerate()
    {
        let Some(list) = node.get("children")? else { continue };
        for child in list.elements()? {
            document.element("nodes", &child)?;
            let number = child.count_value()? as usize;
            links.ways[number] = links.ways[number].saturating_add(1);
            links.children[parent].push(number);
        }
    }
    Ok(links)
}

/// Walks down from every node once; coming back to a node on the way is a cycle, named by its first node.
fn refuse_cycles(children: &[Vec<usize>]) -> Result<(), Box<Fault>> {
    #[derive(Clone, Copy, PartialEq)]
    enum Seen {
        No,
        OnTheWay,
        Done,
    }
    let mut seen = vec![Seen::No; children.len()];
    // The way down: nodes with how many of their children are done.
    let mut way: Vec<(usize, usize)> = Vec::new();
    for start in 0..children.len() {
        if seen[start] == Seen::No {
            seen[start] = Seen::OnTheWay;
            way.push((start, 0));
        }
        while let Some((node, next)) = way.last_mut() {
            let Some(&child) = children[*node].get(*next) else {
                seen[*node] = Seen::Done;
                way.pop();
                continue;
            };
            *next += 1;
            match seen[child] {
                Seen::No => {
                    seen[child] = Seen::OnTheWay;
                    way.push((child, 0));
                }
                Seen::OnTheWay => {
                    let around = way.iter().rev().map(|&(node, _)| node).take_while(|&node| node != child);
                    let first = around.fold(child, usize::min);
                    let found = "a node that is below itself";
                    let fault = Fault::new("E-gltf-cycle", Place::Whole, found, "a tree of nodes");
                    return Err(fault.within(format!("/nodes/{first}")));
                }
                Seen::Done => {}
            }
        }
    }
    Ok(())
}

/// The roots of the scene to show; without scenes, all nodes without a parent.
fn roots<'j>(document: &At<'j>, ways: &[u32], ignored: &mut Ignored<'j>) -> Result<Vec<usize>, Box<Fault>> {
    if document.count("scenes")? == 0 {
        return Ok((0..ways.len()).filter(|&node| ways[node] == 0).collect());
    }
    let first = Value::from(0);
    let index = document.get("scene")?.unwrap_or(At { value: &first, path: "/scene".into() });
    let scene = document.element("scenes", &index)?;
    ignored.of("scenes", &scene);
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
        let (allowance, mut findings, mut ignored) = (Allowance::new(0), Findings::default(), Ignored::default());
        let root = At::root(document);
        let placed = placed_nodes(&root, &mut memory, &allowance, &mut ignored, &mut findings, context)?;
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
        let both = json!({"nodes": [{"children": [1, 1]}, {}]});
        assert_eq!(fault(both), ("E-gltf-parents", "/nodes/1".into()));
        let far = json!({"nodes": [{"children": [1]}, {"children": [2, 4]}, {"children": [3]}, {"children": [1]}, {}]});
        assert_eq!(fault(far), ("E-gltf-cycle", "/nodes/1".into()));
        let entered = json!({"nodes": [{"children": [3]}, {"children": [2]}, {"children": [3]}, {"children": [1]}]});
        assert_eq!(fault(entered), ("E-gltf-cycle", "/nodes/1".into()));
        let outside = json!({"nodes": [{"children": [9]}]});
        assert_eq!(fault(outside), ("E-gltf-reference", "/nodes/0/children/0".into()));
    }

    #[test]
    fn a_node_below_several_others_is_an_instance_below_each() {
        let document = json!({"nodes": [
            {"children": [1, 2]}, {"children": [3]}, {"children": [3], "scale": [2.0, 2.0, 2.0]}, {"children": [4]}, {"mesh": 0}
        ]});
        let placed = walk(&document, &ReadContext::default()).unwrap();
        let scales: Vec<f64> = placed.iter().map(|(_, map)| map.linear.x_axis.x).collect();
        assert_eq!(scales, [1.0, 2.0]);
        assert!(placed.iter().all(|(path, _)| path == "/nodes/4"));
    }

    #[test]
    fn ways_that_double_with_each_level_meet_the_budget() {
        // Each node stands below the one before in two places.
        let mut nodes = Vec::new();
        for level in 0..40 {
            let next = 3 * (level + 1);
            nodes.push(json!({"children": [3 * level + 1, 3 * level + 2]}));
            nodes.push(json!({"children": [next]}));
            nodes.push(
                json!({"children": [next], "translation": [f64::from(1 << (level % 30)), f64::from(level), 0.0]}),
            );
        }
        nodes.push(json!({"mesh": 0}));
        let context =
            ReadContext { exec: shapeloom_core::Exec::default().with_memory(4 << 20), ..ReadContext::default() };
        assert!(matches!(walk(&json!({"nodes": nodes}), &context), Err(ReadError::OverBudget(_))));
        // Without a budget, what the length of the document allows.
        let error = walk(&json!({"nodes": nodes}), &ReadContext::default()).unwrap_err();
        assert_eq!(error.fault().unwrap().code, "E-gltf-limit");
        let mut context = ReadContext::default();
        context.limits.max_elements = 1000;
        assert_eq!(walk(&json!({"nodes": nodes}), &context).unwrap_err().fault().unwrap().code, "E-gltf-limit");
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
