//! The attributes of a mesh.

use crate::{AttributeError, Attributes, Domain};

/// The attribute columns of a mesh's vertices, faces and wedges.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshAttributes {
    /// Columns with an element for each vertex.
    pub vertex: Attributes,
    /// Columns with an element for each face.
    pub face: Attributes,
    /// Columns with an element for each corner of each face, in the order of the faces.
    pub wedge: Attributes,
}

impl MeshAttributes {
    /// No columns, for that many elements.
    pub fn new(vertices: usize, faces: usize, wedges: usize) -> Self {
        Self { vertex: Attributes::new(vertices), face: Attributes::new(faces), wedge: Attributes::new(wedges) }
    }

    /// The columns of one kind of element.
    pub fn of(&self, domain: Domain) -> &Attributes {
        match domain {
            Domain::Vertex => &self.vertex,
            Domain::Face => &self.face,
            Domain::Wedge => &self.wedge,
        }
    }

    pub(crate) fn of_mut(&mut self, domain: Domain) -> &mut Attributes {
        match domain {
            Domain::Vertex => &mut self.vertex,
            Domain::Face => &mut self.face,
            Domain::Wedge => &mut self.wedge,
        }
    }

    /// Refuses attributes of other numbers of elements than these.
    pub(crate) fn check_lengths(&self, others: &Self) -> Result<(), AttributeError> {
        for domain in [Domain::Vertex, Domain::Face, Domain::Wedge] {
            let (found, expected) = (others.of(domain).len(), self.of(domain).len());
            if found != expected {
                return Err(AttributeError::Length { name: format!("every {domain} attribute"), found, expected });
            }
        }
        Ok(())
    }

    /// The memory that the columns take, in bytes.
    pub fn memory_bytes(&self) -> usize {
        self.vertex.memory_bytes() + self.face.memory_bytes() + self.wedge.memory_bytes()
    }
}
