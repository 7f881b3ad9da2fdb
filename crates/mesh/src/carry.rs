//! Moving attributes through an operation.

use shapeloom_core::Loss;

use crate::column::heaviest;
use crate::{Attributes, Domain, ListColumn, MeshAttributes};

/// Where the elements after an operation come from.
#[derive(Clone, Debug, PartialEq)]
pub enum Origins {
    /// Each new element is the old one with the same index.
    Same,
    /// New element `i` is old element `copies[i]`.
    Copies(Vec<u32>),
    /// New element `i` is the mixture of `sources[starts[i]..starts[i + 1]]` with the weights beside them.
    Mixed {
        /// Where each element's sources start; one more entry than new elements.
        starts: Vec<u32>,
        /// Old elements.
        sources: Vec<u32>,
        /// Their weights, of the length of `sources`.
        weights: Vec<f64>,
    },
    /// The operation cannot say: columns are dropped, and each is named in the losses.
    Unknown {
        /// The number of new elements.
        len: usize,
        /// Why.
        why: &'static str,
    },
}

/// Where the vertices, faces and wedges after an operation come from.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshOrigins {
    /// Of the vertices.
    pub vertex: Origins,
    /// Of the faces.
    pub face: Origins,
    /// Of the wedges.
    pub wedge: Origins,
}

/// Moves all attributes of a mesh through an operation that states where its new elements come from.
///
/// Values are mixed by each column's [`Blend`](crate::Blend) rule; of several lists the heaviest source gives its own, the
/// first between equals, and an element without sources gets an empty one. Lists that would multiply, as where a face of
/// many corners and a long list becomes many triangles, are dropped and named. What cannot be carried is named in the
/// losses.
/// Cost: linear in the number of new elements and sources.
///
/// # Panics
/// When an origin names an element that does not exist: operations state their own results.
pub fn carry(source: &MeshAttributes, origins: &MeshOrigins) -> (MeshAttributes, Vec<Loss>) {
    let mut losses = Vec::new();
    let mut of = |domain: Domain, origin: &Origins| carry_domain(source.of(domain), domain, origin, &mut losses);
    let vertex = of(Domain::Vertex, &origins.vertex);
    let face = of(Domain::Face, &origins.face);
    let wedge = of(Domain::Wedge, &origins.wedge);
    (MeshAttributes { vertex, face, wedge }, losses)
}

fn carry_domain(source: &Attributes, domain: Domain, origins: &Origins, losses: &mut Vec<Loss>) -> Attributes {
    match origins {
        Origins::Same => source.clone(),
        Origins::Copies(copies) => source.mapped(
            copies.len(),
            |column| column.gathered(copies),
            |list| carry_list(list, domain, copies.iter().map(|&copy| Some(copy)), losses),
        ),
        Origins::Mixed { starts, sources, weights } => {
            let part = |bounds: &[u32]| bounds[0] as usize..bounds[1] as usize;
            let heaviest = |bounds: &[u32]| heaviest(sources[part(bounds)].iter().zip(&weights[part(bounds)]));
            source.mapped(
                starts.len().saturating_sub(1),
                |column| column.mixed(starts, sources, weights),
                |list| carry_list(list, domain, starts.windows(2).map(heaviest), losses),
            )
        }
        Origins::Unknown { len, why } => {
            let columns = source.iter().map(|column| format!("{domain} attribute \"{}\"", column.name()));
            let lists = source.lists().iter().map(|list| list_name(domain, list));
            losses.extend(columns.chain(lists).map(|what| Loss::new(what, *why)));
            Attributes::new(*len)
        }
    }
}

fn list_name(domain: Domain, list: &ListColumn) -> String {
    format!("{domain} list \"{}\"", list.name())
}

/// Lists may grow to this many values for each that there was and each new element: room for every operation that
/// refines evenly, but not for a face of many corners whose long list each of its triangles would repeat.
const GROWTH: u64 = 16;

fn carry_list(
    list: &ListColumn,
    domain: Domain,
    sources: impl Iterator<Item = Option<u32>> + Clone,
    losses: &mut Vec<Loss>,
) -> Option<ListColumn> {
    let total = list.total(sources.clone());
    let room = GROWTH * (list.values().len() + sources.clone().count()) as u64;
    if total > room.min(u64::from(u32::MAX)) {
        let why = format!("its {} values would become {total}", list.values().len());
        losses.push(Loss::new(list_name(domain, list), why));
        return None;
    }
    Some(list.picked(sources))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Column, Values};

    #[test]
    fn every_domain_is_carried_or_named_as_lost() {
        let mut source = MeshAttributes::new(2, 1, 3);
        source.vertex.insert(Column::try_new("heat", 1, Values::F64(vec![1.0, 3.0])).unwrap()).unwrap();
        source.face.insert(Column::labels("group", vec![5])).unwrap();
        source.wedge.insert(Column::texcoords("texcoord", &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])).unwrap();
        let origins = MeshOrigins {
            vertex: Origins::Mixed { starts: vec![0, 1, 3], sources: vec![1, 0, 1], weights: vec![1.0, 0.5, 0.5] },
            face: Origins::Copies(vec![0, 0]),
            wedge: Origins::Unknown { len: 6, why: "the faces were made anew" },
        };
        let (carried, losses) = carry(&source, &origins);
        assert_eq!(carried.vertex.get("heat").unwrap().values(), &Values::F64(vec![3.0, 2.0]));
        assert_eq!(carried.face.get("group").unwrap().values(), &Values::U32(vec![5, 5]));
        assert_eq!((carried.wedge.len(), carried.wedge.is_empty()), (6, true));
        assert_eq!(losses, [Loss::new("wedge attribute \"texcoord\"", "the faces were made anew")]);
    }

    #[test]
    fn lists_follow_the_heaviest_source() {
        let list = |name: &str, starts: &[u32], values: &[u8]| {
            ListColumn::try_new(name, starts.to_vec(), Values::U8(values.to_vec())).unwrap()
        };
        let mut source = MeshAttributes::new(3, 2, 6);
        source.vertex.insert_list(list("v", &[0, 1, 3, 6], &[1, 2, 2, 3, 3, 3])).unwrap();
        source.face.insert_list(list("f", &[0, 0, 2], &[8, 9])).unwrap();
        source.wedge.insert_list(list("w", &[0; 7], &[])).unwrap();
        let origins = MeshOrigins {
            vertex: Origins::Mixed {
                starts: vec![0, 2, 2, 5],
                sources: vec![0, 1, 2, 1, 0],
                weights: vec![0.5, 0.5, 0.2, 0.5, 0.3],
            },
            face: Origins::Copies(vec![1, 0, 1]),
            wedge: Origins::Unknown { len: 9, why: "the faces were made anew" },
        };
        let (carried, losses) = carry(&source, &origins);
        // The first of two equal weights, none, the heaviest of three.
        assert_eq!(carried.vertex.list("v"), Some(&list("v", &[0, 1, 1, 3], &[1, 2, 2])));
        assert_eq!(carried.face.list("f"), Some(&list("f", &[0, 2, 2, 4], &[8, 9, 8, 9])));
        assert_eq!(losses, [Loss::new("wedge list \"w\"", "the faces were made anew")]);
        let same = MeshOrigins { vertex: Origins::Same, face: Origins::Same, wedge: Origins::Same };
        assert_eq!(carry(&source, &same), (source, vec![]));
    }

    #[test]
    fn lists_that_would_multiply_are_named_as_lost() {
        let long = ListColumn::try_new("long", vec![0, 1000], Values::U8(vec![7; 1000])).unwrap();
        let mut source = MeshAttributes::new(0, 1, 0);
        source.face.insert_list(long).unwrap();
        let copies =
            |count| MeshOrigins { vertex: Origins::Same, face: Origins::Copies(vec![0; count]), wedge: Origins::Same };
        assert!(carry(&source, &copies(16)).1.is_empty());
        let (carried, losses) = carry(&source, &copies(100_000));
        assert!(carried.face.is_empty() && carried.face.len() == 100_000);
        assert_eq!(losses, [Loss::new("face list \"long\"", "its 1000 values would become 100000000")]);
    }
}
