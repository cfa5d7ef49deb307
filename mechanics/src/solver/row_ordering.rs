//! Row ordering (permutation): neighbours near each other, independent parts for threads, constrained rows last.
//!
//! Free rows are numbered breadth first from one end of the mesh to the other (Cuthill, McKee 1969,
//! without sorting by degree), so that the rows a row is coupled to lie close by in memory. That order is
//! cut into parts. Rows of a part that are coupled to an earlier part make the separator, which comes
//! after all parts: parts couple only within themselves and with the separator, so that threads
//! can sweep them at once, and the result is that of one sequential sweep in this order.
//! Rows held altogether come last: the matrix of the free rows is the leading block.

use std::ops::Range;

use super::element_connectivity::{ElementConnectivity, ElementsOfRow};

/// Free unknowns below which one thread is faster than two.
const PARTS_FROM: usize = 12_000;

/// Free unknowns above which there are four parts and not two.
const FOUR_PARTS_FROM: usize = 400_000;

/// The order of rows in a matrix: a permutation.
#[derive(Clone, Debug, PartialEq)]
pub struct RowOrdering {
    /// The place of each row.
    pub place: Vec<u32>,
    /// Elements in the order in which rows meet them.
    pub element_order: Vec<u32>,
    /// Places that couple only among themselves and with the separator.
    pub parts: Vec<Range<usize>>,
    /// Places below this are free; the separator reaches from the last part to here.
    pub free: usize,
}

impl RowOrdering {
    /// Orders the rows that the elements couple, each of that many unknowns, from the row `start` on.
    /// `held` tells the rows without any free unknown.
    pub fn new(
        connectivity: &ElementConnectivity,
        around: &ElementsOfRow,
        held: &[bool],
        unknowns: usize,
        start: usize,
    ) -> Self {
        let rows = held.len();
        let (order, element_order) = breadth_first(connectivity, around, rows, start);
        let free_order: Vec<u32> = order.iter().copied().filter(|&r| !held[r as usize]).collect();
        let free = free_order.len();
        let count = match free * unknowns {
            0..PARTS_FROM => 1,
            PARTS_FROM..FOUR_PARTS_FROM => 2,
            _ => 4,
        };
        let part_of = parts_of_rows(connectivity, &free_order, rows, count);
        let mut place = vec![0; rows];
        let mut next = 0;
        let mut parts = Vec::with_capacity(count);
        for part in 0..=count as u8 {
            let begin = next;
            for &row in free_order.iter().filter(|&&row| part_of[row as usize] == part) {
                place[row as usize] = next as u32;
                next += 1;
            }
            if usize::from(part) < count {
                parts.push(begin..next);
            }
        }
        for &row in order.iter().filter(|&&row| held[row as usize]) {
            place[row as usize] = next as u32;
            next += 1;
        }
        RowOrdering { place, element_order, parts, free }
    }

    /// Places that couple with several parts.
    pub fn separator(&self) -> Range<usize> {
        self.parts.last().map_or(0, |part| part.end)..self.free
    }

    /// The values of each part, and those of all places for the separator to follow.
    pub(super) fn split<'a, V>(&self, mut values: &'a mut [V]) -> Vec<&'a mut [V]> {
        let mut shares = Vec::with_capacity(self.parts.len());
        for part in &self.parts {
            let (share, rest) = values.split_at_mut(part.len());
            shares.push(share);
            values = rest;
        }
        shares
    }
}

/// Rows from `start` on, and the elements as they are met. Rows without a element come last.
fn breadth_first(
    connectivity: &ElementConnectivity,
    around: &ElementsOfRow,
    rows: usize,
    start: usize,
) -> (Vec<u32>, Vec<u32>) {
    let mut seen = vec![false; rows];
    let mut is_met = vec![false; connectivity.len()];
    let mut order: Vec<u32> = Vec::with_capacity(rows);
    let mut element_order = Vec::with_capacity(connectivity.len());
    let has_elements = |row: &usize| !around.row(*row).is_empty();
    // Of no rows at all none is the first.
    let begin = Some(start).filter(|&start| start < rows);
    for first in begin.into_iter().chain(0..rows).filter(has_elements) {
        if std::mem::replace(&mut seen[first], true) {
            continue;
        }
        let mut next = order.len();
        order.push(first as u32);
        while next < order.len() {
            for &element in around.row(order[next] as usize) {
                // Each element is opened once: the first of its rows reaches all others.
                if std::mem::replace(&mut is_met[element as usize], true) {
                    continue;
                }
                element_order.push(element);
                for &row in connectivity.row(element as usize) {
                    if !std::mem::replace(&mut seen[row as usize], true) {
                        order.push(row);
                    }
                }
            }
            next += 1;
        }
    }
    order.extend((0..rows as u32).filter(|&row| !seen[row as usize]));
    (order, element_order)
}

/// The part of each free row, `count` for the separator; held rows get `u8::MAX`.
fn parts_of_rows(
    connectivity: &ElementConnectivity,
    free_order: &[u32],
    rows: usize,
    count: usize,
) -> Vec<u8> {
    let mut part_of = vec![u8::MAX; rows];
    for (at, &row) in free_order.iter().enumerate() {
        part_of[row as usize] = (at * count / free_order.len()) as u8;
    }
    if count == 1 {
        return part_of;
    }
    let cut = part_of.clone();
    for element in 0..connectivity.len() {
        let members = connectivity.row(element);
        let first = members.iter().map(|&row| cut[row as usize]).min().unwrap_or_default();
        for &row in members {
            if cut[row as usize] != u8::MAX && cut[row as usize] > first {
                part_of[row as usize] = count as u8;
            }
        }
    }
    part_of
}
