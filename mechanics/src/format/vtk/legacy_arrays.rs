//! Attributes and fields of VTK legacy files.

use super::cells::as_vectors;
use super::legacy::{LegacyReader, Owner};
use crate::format::arrays::{Kind, NamedArray, Values};
use crate::format::error::FormatError;
use crate::format::scalar::Scalar;
use crate::mesh::ValuesOf;

/// An array that is announced and not yet read.
struct DeclaredArray {
    name: String,
    scalar: Scalar,
    components: u64,
    tuples: u64,
}

impl LegacyReader<'_, '_> {
    pub fn read_attribute(&mut self, keyword: &str) -> Result<(), FormatError> {
        match keyword {
            "FIELD" => return self.read_field(),
            "METADATA" => {
                self.skip_metadata();
                return Ok(());
            }
            "LOOKUP_TABLE" => return self.skip_lookup_table(),
            _ => {}
        }
        let is_known = matches!(
            keyword,
            "SCALARS"
                | "VECTORS"
                | "NORMALS"
                | "TENSORS"
                | "TENSORS6"
                | "TEXTURE_COORDINATES"
                | "GLOBAL_IDS"
                | "PEDIGREE_IDS"
                | "EDGE_FLAGS"
                | "COLOR_SCALARS"
        );
        if !is_known || self.owner == Owner::Dataset {
            let shown: String = keyword.chars().take(40).collect();
            let detail = format!("{shown:?} is not expected here");
            return Err(self.cursor.bad_line(detail));
        }
        let name = decoded_name(self.cursor.expect_word("a name")?);
        let (scalar, components) = match keyword {
            "SCALARS" => self.scalars_header()?,
            "COLOR_SCALARS" => {
                let components = self.cursor.unsigned("a number of components")?;
                (Scalar::U8, components)
            }
            "TEXTURE_COORDINATES" => {
                let components = self.cursor.unsigned("a number of components")?;
                (self.scalar_type()?, components)
            }
            "VECTORS" | "NORMALS" => (self.scalar_type()?, 3),
            "TENSORS" => (self.scalar_type()?, 9),
            "TENSORS6" => (self.scalar_type()?, 6),
            _ => (self.scalar_type()?, 1),
        };
        self.read_values(DeclaredArray { name, scalar, components, tuples: self.tuples })
    }

    /// `type [components]`, then a line with the lookup table.
    fn scalars_header(&mut self) -> Result<(Scalar, u64), FormatError> {
        let scalar = self.scalar_type()?;
        let rest = self.cursor.text_line().unwrap_or_default();
        let components = match rest.trim() {
            "" => 1,
            word => word
                .parse()
                .map_err(|_| self.cursor.not_a_number("a number of components", word))?,
        };
        self.expect_keyword("LOOKUP_TABLE")?;
        self.cursor.expect_word("the name of a lookup table")?;
        Ok((scalar, components))
    }

    fn skip_lookup_table(&mut self) -> Result<(), FormatError> {
        self.cursor.expect_word("the name of a lookup table")?;
        let colours = self.cursor.unsigned("a number of colours")?;
        self.skip(Scalar::U8, colours.saturating_mul(4))
    }

    /// Information keys end with an empty line.
    fn skip_metadata(&mut self) {
        self.cursor.line();
        while let Some(line) = self.cursor.line() {
            if line.trim_ascii().is_empty() {
                return;
            }
        }
    }

    fn read_field(&mut self) -> Result<(), FormatError> {
        self.cursor.expect_word("the name of a field")?;
        let mut left = self.cursor.unsigned("a number of arrays")?;
        while left > 0 {
            let word = self.cursor.expect_word("the name of an array")?;
            if word == "METADATA" {
                self.skip_metadata();
                continue;
            }
            left -= 1;
            if word == "NULL_ARRAY" {
                continue;
            }
            let name = decoded_name(word);
            let components = self.cursor.unsigned("a number of components")?;
            let tuples = self.cursor.unsigned("a number of tuples")?;
            if self.next_is_string() {
                self.read_strings(&name, components.saturating_mul(tuples))?;
                continue;
            }
            let scalar = self.scalar_type()?;
            self.read_values(DeclaredArray { name, scalar, components, tuples })?;
        }
        Ok(())
    }

    fn next_is_string(&mut self) -> bool {
        let mut ahead = self.cursor.clone();
        let is_string = ahead.word() == Some(b"string");
        if is_string {
            self.cursor = ahead;
        }
        is_string
    }

    /// Texts, one a line, or with their length in front. Only the frame mark is kept.
    fn read_strings(&mut self, name: &str, count: u64) -> Result<(), FormatError> {
        self.cursor.line();
        if count > self.cursor.remaining() {
            return Err(self.cursor.bad_line(format!("{count} texts declared")));
        }
        for number in 0..count {
            let text = if self.is_binary {
                let length = self.string_length()?;
                String::from_utf8_lossy(self.cursor.take(length)?).into_owned()
            } else {
                let line = self.cursor.text_line();
                decoded_name(&line.ok_or_else(|| self.cursor.bad_line("a text is missing"))?)
            };
            if name == "SPACE" && number == 0 && self.owner == Owner::Dataset {
                self.parsed.note_space_mark(&format!("SPACE={}", text.trim()));
                self.parsed.note_space_mark(&text);
            }
        }
        let arrays = &mut self.parsed.arrays;
        match self.owner {
            Owner::Dataset => {}
            Owner::Points => {
                arrays.wants(ValuesOf::Points, name, Kind::Other);
            }
            Owner::Cells => {
                arrays.wants(ValuesOf::Cells, name, Kind::Other);
            }
        }
        Ok(())
    }

    /// The two highest bits of the first byte tell how many bytes the length takes.
    fn string_length(&mut self) -> Result<u64, FormatError> {
        let first = self.cursor.rest().first().copied().unwrap_or_default();
        let bytes = [8, 4, 2, 1][usize::from(first >> 6)];
        let raw = self.cursor.take(bytes)?;
        let length = raw.iter().fold(0_u64, |sum, &byte| sum << 8 | u64::from(byte));
        let mark = u64::from(first >> 6) << (8 * bytes - 2);
        Ok(length - mark)
    }

    fn read_values(&mut self, announced: DeclaredArray) -> Result<(), FormatError> {
        let DeclaredArray { name, scalar, components, tuples } = announced;
        let count = components.saturating_mul(tuples);
        let has_cells = self.keeps_cell_arrays();
        let kind = Kind::of(Some(scalar), components);
        let arrays = &mut self.parsed.arrays;
        let is_wanted = match self.owner {
            Owner::Dataset => false,
            Owner::Cells if !has_cells => {
                arrays.ignore_of_surface(ValuesOf::Cells, &name);
                false
            }
            Owner::Points => arrays.wants(ValuesOf::Points, &name, kind),
            Owner::Cells => arrays.wants(ValuesOf::Cells, &name, kind),
        };
        if !is_wanted {
            return self.skip(scalar, count);
        }
        if tuples != self.tuples {
            let detail = format!("{tuples} values for {} points or cells", self.tuples);
            return Err(self.cursor.bad_line(detail));
        }
        let values = match scalar.is_integer() {
            true => Values::Integers(self.integers(scalar, count, |value| value)?),
            false => Values::Vectors(as_vectors(&self.reals(scalar, count)?)),
        };
        let array = NamedArray { name, values };
        match self.owner {
            Owner::Points => self.parsed.arrays.points.push(array),
            _ => self.parsed.arrays.cells.push(array),
        }
        Ok(())
    }
}

/// A name in which VTK wrote spaces and the like as `%20`.
fn decoded_name(name: &str) -> String {
    let mut bytes = Vec::with_capacity(name.len());
    let mut rest = name.as_bytes();
    while let Some((&byte, after)) = rest.split_first() {
        rest = after;
        let code = after.get(..2).and_then(|hex| std::str::from_utf8(hex).ok());
        let code = code.and_then(|hex| u8::from_str_radix(hex, 16).ok());
        match code {
            Some(code) if byte == b'%' => {
                bytes.push(code);
                rest = &after[2..];
            }
            _ => bytes.push(byte),
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::decoded_name;

    #[test]
    fn a_percent_sign_with_two_digits_is_one_character() {
        assert_eq!(decoded_name("set_lower%20lip"), "set_lower lip");
        assert_eq!(decoded_name("100%"), "100%");
        assert_eq!(decoded_name("%zz"), "%zz");
    }
}
