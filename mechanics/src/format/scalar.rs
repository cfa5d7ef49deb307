//! The number types that mesh files store, in either byte order.

use super::error::FormatError;
use super::limits::room_for;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ByteOrder {
    Little,
    Big,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

/// Walks over the values of one type and calls `$each` with every value.
macro_rules! each_value {
    ($type:ty, $bytes:expr, $order:expr, $each:expr) => {
        for value in $bytes.chunks_exact(size_of::<$type>()) {
            let mut raw = [0; size_of::<$type>()];
            raw.copy_from_slice(value);
            $each(match $order {
                ByteOrder::Little => <$type>::from_le_bytes(raw),
                ByteOrder::Big => <$type>::from_be_bytes(raw),
            });
        }
    };
}

impl Scalar {
    pub fn size(self) -> u64 {
        match self {
            Scalar::I8 | Scalar::U8 => 1,
            Scalar::I16 | Scalar::U16 => 2,
            Scalar::I32 | Scalar::U32 | Scalar::F32 => 4,
            Scalar::I64 | Scalar::U64 | Scalar::F64 => 8,
        }
    }

    pub fn is_integer(self) -> bool {
        !matches!(self, Scalar::F32 | Scalar::F64)
    }

    /// Whether the type has this value.
    pub fn holds(self, value: i64) -> bool {
        match self {
            Scalar::I8 => i8::try_from(value).is_ok(),
            Scalar::U8 => u8::try_from(value).is_ok(),
            Scalar::I16 => i16::try_from(value).is_ok(),
            Scalar::U16 => u16::try_from(value).is_ok(),
            Scalar::I32 => i32::try_from(value).is_ok(),
            Scalar::U32 => u32::try_from(value).is_ok(),
            Scalar::U64 => value >= 0,
            Scalar::I64 | Scalar::F32 | Scalar::F64 => true,
        }
    }

    /// All values as real numbers. A remainder shorter than one value is left out.
    pub fn reals(self, bytes: &[u8], order: ByteOrder) -> Result<Vec<f64>, FormatError> {
        let mut values = room_for(bytes.len() / self.size() as usize)?;
        match self {
            Scalar::F32 => each_value!(f32, bytes, order, |value| values.push(f64::from(value))),
            Scalar::F64 => each_value!(f64, bytes, order, |value| values.push(value)),
            Scalar::U64 => each_value!(u64, bytes, order, |value| values.push(value as f64)),
            _ => self.each_integer(bytes, order, |value| values.push(value as f64)),
        }
        Ok(values)
    }

    /// All values as integers; floating point values are cut towards zero.
    pub fn integers<T>(
        self,
        bytes: &[u8],
        order: ByteOrder,
        convert: impl Fn(i64) -> T,
    ) -> Result<Vec<T>, FormatError> {
        let mut values = room_for(bytes.len() / self.size() as usize)?;
        self.each_integer(bytes, order, |value| values.push(convert(value)));
        Ok(values)
    }

    /// One value as a real number; zero where there are no bytes.
    pub fn real(self, bytes: &[u8], order: ByteOrder) -> f64 {
        let mut found = 0.0;
        match self {
            Scalar::F32 => each_value!(f32, bytes, order, |value| found = f64::from(value)),
            Scalar::F64 => each_value!(f64, bytes, order, |value| found = value),
            Scalar::U64 => each_value!(u64, bytes, order, |value| found = value as f64),
            _ => found = self.integer(bytes, order) as f64,
        }
        found
    }

    /// One value as an integer; zero where there are no bytes.
    pub fn integer(self, bytes: &[u8], order: ByteOrder) -> i64 {
        let mut found = 0;
        self.each_integer(bytes, order, |value| found = value);
        found
    }

    /// Calls with every value; floating point values are cut towards zero.
    pub fn each_integer(self, bytes: &[u8], order: ByteOrder, mut each: impl FnMut(i64)) {
        match self {
            Scalar::I8 => each_value!(i8, bytes, order, |value| each(i64::from(value))),
            Scalar::U8 => each_value!(u8, bytes, order, |value| each(i64::from(value))),
            Scalar::I16 => each_value!(i16, bytes, order, |value| each(i64::from(value))),
            Scalar::U16 => each_value!(u16, bytes, order, |value| each(i64::from(value))),
            Scalar::I32 => each_value!(i32, bytes, order, |value| each(i64::from(value))),
            Scalar::U32 => each_value!(u32, bytes, order, |value| each(i64::from(value))),
            Scalar::I64 => each_value!(i64, bytes, order, &mut each),
            Scalar::U64 => each_value!(u64, bytes, order, |value| each(saturated(value))),
            Scalar::F32 => each_value!(f32, bytes, order, |value| each(value as i64)),
            Scalar::F64 => each_value!(f64, bytes, order, |value| each(value as i64)),
        }
    }
}

fn saturated(value: u64) -> i64 {
    i64::try_from(value).unwrap_or(i64::MAX)
}

/// A node number of a file as ours. What does not fit becomes `u32::MAX`, which no mesh within
/// the limits has, so that the check of all indices finds it.
pub(super) fn node_number(value: i64) -> u32 {
    u32::try_from(value).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_byte_order_decides_what_two_bytes_mean() {
        let bytes = [0x01, 0x02];
        assert_eq!(Scalar::U16.integer(&bytes, ByteOrder::Little), 0x0201);
        assert_eq!(Scalar::U16.integer(&bytes, ByteOrder::Big), 0x0102);
        assert_eq!(Scalar::I8.reals(&[0xff], ByteOrder::Big).unwrap(), [-1.0]);
    }

    #[test]
    fn a_node_number_that_does_not_fit_is_no_valid_node() {
        let bytes = [u64::MAX.to_le_bytes(), 7_u64.to_le_bytes()].concat();
        let nodes = Scalar::U64.integers(&bytes, ByteOrder::Little, node_number);
        assert_eq!(nodes.unwrap(), [u32::MAX, 7]);
        assert_eq!(node_number(-1), u32::MAX);
    }
}
