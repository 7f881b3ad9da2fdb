//! Moving attributes through an operation.

use shapeloom_core::Loss;

use crate::{Attributes, Domain, MeshAttributes};

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
/// Values are mixed by each column's [`Blend`](crate::Blend) rule. What cannot be carried is named in the losses.
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
        Origins::Copies(copies) => source.mapped(copies.len(), |column| column.gathered(copies)),
        Origins::Mixed { starts, sources, weights } => {
            source.mapped(starts.len().saturating_sub(1), |column| column.mixed(starts, sources, weights))
        }
        Origins::Unknown { len, why } => {
            let named =
                source.iter().map(|column| Loss::new(format!("{domain} attribute \"{}\"", column.name()), *why));
            losses.extend(named);
            Attributes::new(*len)
        }
    }
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
}
