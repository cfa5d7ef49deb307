//! The elements of Gmsh files.

use std::collections::BTreeSet;

use super::{GmshReader, Version};
use crate::format::error::FormatError;
use crate::mesh::CellShape;

/// Meaning of a Gmsh element type.
struct ElementType {
    name: &'static str,
    nodes: usize,
    dimension: u8,
    use_as: Use,
}

#[derive(Clone, Copy)]
enum Use {
    Cell(CellShape),
    Polygon,
    /// Lines and points matter for their groups only.
    Thin,
    Unsupported,
}

fn element_type(number: i64) -> Option<ElementType> {
    let (name, nodes, dimension, use_as) = match number {
        1 => ("line", 2, 1, Use::Thin),
        2 => ("triangle", 3, 2, Use::Polygon),
        3 => ("quadrangle", 4, 2, Use::Polygon),
        4 => ("tetrahedron", 4, 3, Use::Cell(CellShape::Tet4)),
        5 => ("hexahedron", 8, 3, Use::Cell(CellShape::Hex8)),
        6 => ("prism", 6, 3, Use::Cell(CellShape::Wedge6)),
        7 => ("pyramid", 5, 3, Use::Unsupported),
        8 => ("3-node line", 3, 1, Use::Unsupported),
        9 => ("6-node triangle", 6, 2, Use::Unsupported),
        10 => ("9-node quadrangle", 9, 2, Use::Unsupported),
        11 => ("10-node tetrahedron", 10, 3, Use::Unsupported),
        12 => ("27-node hexahedron", 27, 3, Use::Unsupported),
        13 => ("18-node prism", 18, 3, Use::Unsupported),
        14 => ("14-node pyramid", 14, 3, Use::Unsupported),
        15 => ("point", 1, 0, Use::Thin),
        16 => ("8-node quadrangle", 8, 2, Use::Unsupported),
        17 => ("20-node hexahedron", 20, 3, Use::Unsupported),
        18 => ("15-node prism", 15, 3, Use::Unsupported),
        19 => ("13-node pyramid", 13, 3, Use::Unsupported),
        _ => return None,
    };
    Some(ElementType { name, nodes, dimension, use_as })
}

/// Elements while they are read.
#[derive(Default)]
struct Elements {
    unsupported: BTreeSet<&'static str>,
    nodes: Vec<u32>,
    polygons_without_group: u64,
}

impl GmshReader<'_, '_> {
    fn element_type(&self, number: i64) -> Result<ElementType, FormatError> {
        let found = element_type(number);
        found.ok_or_else(|| self.bad(format!("element type {number} is unknown")))
    }

    pub fn read_elements_2(&mut self) -> Result<(), FormatError> {
        let count = self.cursor.unsigned("a number of elements")?;
        self.limits.check_elements(count)?;
        self.start_binary();
        self.expect_records(count, 8, 4)?;
        let mut elements = Elements::default();
        let mut left = count;
        while left > 0 {
            // Binary files announce several elements of one kind; text tells for each.
            let (kind, in_block, tags) = if self.binary.is_some() {
                (self.int()?, self.int()?, self.int()?)
            } else {
                self.int()?;
                (self.int()?, 1, self.int()?)
            };
            let kind = self.element_type(kind)?;
            let in_block = u64::try_from(in_block).unwrap_or(0);
            if in_block == 0 || in_block > left || !(0..=1000).contains(&tags) {
                return Err(self.bad("a block of elements with wrong counts"));
            }
            left -= in_block;
            for _ in 0..in_block {
                if self.binary.is_some() {
                    self.int()?;
                }
                let mut group = 0;
                for tag in 0..tags {
                    let value = self.int()?;
                    group = if tag == 0 { value } else { group };
                }
                elements.nodes.clear();
                for _ in 0..kind.nodes {
                    let number = self.int()?;
                    elements.nodes.push(self.node_numbers.index(number));
                }
                self.place(&kind, &mut elements, &[group])?;
            }
        }
        self.finish_elements(elements)
    }

    pub fn read_elements_4(&mut self) -> Result<(), FormatError> {
        let (blocks, count) = (self.size()?, self.size()?);
        self.limits.check_elements(count)?;
        let (_lowest, _highest) = (self.size()?, self.size()?);
        self.expect_records(count, 16, 2)?;
        let mut elements = Elements::default();
        let mut left = count;
        for _ in 0..blocks {
            let (dimension, entity) = (self.int()?, self.int()?);
            let kind = self.int()?;
            let kind = self.element_type(kind)?;
            let in_block = self.size()?;
            if in_block > left {
                return Err(self.bad(format!("more elements than the {count} declared")));
            }
            left -= in_block;
            let groups = self.groups.of_entity(dimension, entity);
            for _ in 0..in_block {
                self.size()?;
                elements.nodes.clear();
                for _ in 0..kind.nodes {
                    let number = self.size()?;
                    let number = i64::try_from(number).unwrap_or(-1);
                    elements.nodes.push(self.node_numbers.index(number));
                }
                self.place(&kind, &mut elements, &groups)?;
            }
        }
        if left > 0 {
            return Err(self.bad(format!("{left} of {count} elements are missing")));
        }
        self.finish_elements(elements)
    }

    /// Puts one element into the mesh and into its groups.
    fn place(
        &mut self,
        kind: &ElementType,
        elements: &mut Elements,
        groups: &[i64],
    ) -> Result<(), FormatError> {
        let nodes = &elements.nodes;
        let mut groups = groups.iter().copied().filter(|&group| group != 0);
        match kind.use_as {
            Use::Unsupported => {
                elements.unsupported.insert(kind.name);
                return Ok(());
            }
            Use::Cell(shape) => {
                let first = groups.next();
                let cell = self.cell_number(shape, nodes, first.unwrap_or(0))?;
                for group in first.into_iter().chain(groups) {
                    self.groups.add(kind.dimension, group, &[cell]);
                }
                return Ok(());
            }
            Use::Polygon => self.parsed.push_polygon(nodes, self.limits)?,
            Use::Thin => {}
        }
        let mut is_grouped = false;
        for group in groups {
            self.groups.add(kind.dimension, group, nodes);
            is_grouped = true;
        }
        elements.polygons_without_group += u64::from(!is_grouped);
        Ok(())
    }

    /// The number of a cell, which is added unless it is the one before: version 2 repeats an
    /// element for each of its groups.
    fn cell_number(
        &mut self,
        shape: CellShape,
        nodes: &[u32],
        group: i64,
    ) -> Result<u32, FormatError> {
        let cells = &mut self.parsed.cells;
        let before = cells.len().checked_sub(1);
        if let Some(before) = before
            && self.version == Version::Two
            && cells.shape(before) == shape
            && cells.nodes(before) == nodes
        {
            return Ok(before as u32);
        }
        self.limits.check_cells(cells.len() as u64 + 1)?;
        cells.push(shape, nodes);
        self.groups.cell_labels.push(group);
        Ok(cells.len() as u32 - 1)
    }

    fn finish_elements(&mut self, elements: Elements) -> Result<(), FormatError> {
        if !elements.unsupported.is_empty() {
            let types = elements.unsupported.into_iter();
            return Err(FormatError::UnsupportedCells {
                types: types.map(str::to_string).collect(),
            });
        }
        if !self.parsed.cells.is_empty() {
            let what = "surface, line and point elements without a physical group";
            self.parsed.note_skipped(elements.polygons_without_group, what);
        }
        Ok(())
    }
}
