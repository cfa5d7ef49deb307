//! Compressed rows: for each row a list of entries, all lists in one array and the places where they begin in
//! another.

use std::ops::Range;

/// For each row its entries. There are fewer than 2^32 of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Rows<T> {
    /// Where each row begins, and where the last one ends.
    starts: Vec<u32>,
    entries: Vec<T>,
}

impl<T> Default for Rows<T> {
    fn default() -> Self {
        Rows { starts: vec![0], entries: Vec::new() }
    }
}

impl<T> Rows<T> {
    /// No row yet, and room for so many.
    pub fn with_room(rows: usize, entries: usize) -> Self {
        let mut starts = Vec::with_capacity(rows + 1);
        starts.push(0);
        Rows { starts, entries: Vec::with_capacity(entries) }
    }

    /// Cuts entries into rows of these lengths.
    pub fn of_lengths(lengths: &[u32], entries: Vec<T>) -> Self {
        let starts = starts_of(lengths);
        debug_assert_eq!(starts[lengths.len()] as usize, entries.len());
        Rows { starts, entries }
    }

    /// The rows of each chunk, one chunk after the other: threads make chunks, and this makes one of them.
    pub fn joined(chunks: Vec<Rows<T>>) -> Self {
        let mut joined = Rows::with_room(
            chunks.iter().map(Rows::len).sum(),
            chunks.iter().map(|chunk| chunk.entries.len()).sum(),
        );
        for chunk in chunks {
            let begin = joined.entries.len() as u32;
            joined.starts.extend(chunk.starts[1..].iter().map(|start| begin + start));
            joined.entries.extend(chunk.entries);
        }
        joined
    }

    /// Adds a row.
    pub fn push(&mut self, entries: impl IntoIterator<Item = T>) {
        self.entries.extend(entries);
        self.starts.push(self.entries.len() as u32);
    }

    /// The number of rows.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Where the entries of a row lie among those of all rows.
    #[inline(always)]
    pub fn range(&self, row: usize) -> Range<usize> {
        self.starts[row] as usize..self.starts[row + 1] as usize
    }

    #[inline(always)]
    pub fn row(&self, row: usize) -> &[T] {
        &self.entries[self.range(row)]
    }

    pub fn row_mut(&mut self, row: usize) -> &mut [T] {
        let range = self.range(row);
        &mut self.entries[range]
    }

    /// All rows, for threads to change.
    pub fn rows_mut(&mut self) -> Vec<&mut [T]> {
        let mut rest = self.entries.as_mut_slice();
        let mut next = |ends: &[u32]| {
            let (row, others) =
                std::mem::take(&mut rest).split_at_mut((ends[1] - ends[0]) as usize);
            rest = others;
            row
        };
        self.starts.windows(2).map(&mut next).collect()
    }

    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[T]> {
        (0..self.len()).map(|row| self.row(row))
    }

    /// Those of all rows.
    pub fn entries(&self) -> &[T] {
        &self.entries
    }

    pub fn entries_mut(&mut self) -> &mut [T] {
        &mut self.entries
    }

    /// Memory.
    pub fn bytes(&self) -> usize {
        size_of::<u32>() * self.starts.len() + size_of::<T>() * self.entries.len()
    }
}

impl Rows<u32> {
    /// For each of so many numbers the rows that name it, ascending.
    pub fn inverted(&self, count: usize) -> Rows<u32> {
        let mut lengths = vec![0; count];
        self.entries.iter().for_each(|&number| lengths[number as usize] += 1);
        let mut sorting = Sorting::new(&lengths, 0);
        for (row, numbers) in self.iter().enumerate() {
            numbers.iter().for_each(|&number| sorting.put(number as usize, row as u32));
        }
        sorting.finish()
    }
}

/// A counting sort of entries by row: those of one row keep the order in which they come.
pub struct Sorting<T> {
    rows: Rows<T>,
    /// Where the next entry of each row goes.
    next: Vec<u32>,
}

impl<T: Copy> Sorting<T> {
    /// For rows of these lengths. What is never put stays `blank`.
    pub fn new(lengths: &[u32], blank: T) -> Self {
        let starts = starts_of(lengths);
        let entries = vec![blank; starts[lengths.len()] as usize];
        Sorting { next: starts.clone(), rows: Rows { starts, entries } }
    }

    #[inline(always)]
    pub fn put(&mut self, row: usize, entry: T) {
        self.rows.entries[self.next[row] as usize] = entry;
        self.next[row] += 1;
    }

    pub fn finish(self) -> Rows<T> {
        self.rows
    }
}

fn starts_of(lengths: &[u32]) -> Vec<u32> {
    let mut starts = Vec::with_capacity(lengths.len() + 1);
    let mut end = 0;
    starts.push(end);
    starts.extend(lengths.iter().map(|length| {
        end += length;
        end
    }));
    starts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows() -> Rows<u32> {
        let mut rows = Rows::default();
        rows.push([2, 0]);
        rows.push([]);
        rows.push([2, 3, 0]);
        rows
    }

    #[test]
    fn rows_come_back_as_they_were_pushed() {
        let rows = rows();
        assert_eq!(rows.iter().collect::<Vec<_>>(), [&[2, 0][..], &[], &[2, 3, 0]]);
        assert_eq!(rows, Rows::of_lengths(&[2, 0, 3], vec![2, 0, 2, 3, 0]));
    }

    #[test]
    fn an_inversion_names_for_each_number_its_rows_in_order() {
        let inverted = rows().inverted(5);
        assert_eq!(inverted.iter().collect::<Vec<_>>(), [&[0, 2][..], &[], &[0, 2], &[2], &[]]);
    }

    #[test]
    fn joined_chunks_are_the_rows_of_one_after_those_of_the_other() {
        let joined = Rows::joined(vec![rows(), Rows::default(), rows()]);
        let expected: Vec<Vec<u32>> =
            rows().iter().chain(rows().iter()).map(<[u32]>::to_vec).collect();
        assert_eq!(joined.iter().collect::<Vec<_>>(), expected);
    }
}
