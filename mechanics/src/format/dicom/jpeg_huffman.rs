//! Huffman codes of JPEG, and the bits that they are read from.
//!
//! Source: ITU-T T.81, annexes C and F.2.2.

/// A length of code that no bits have.
const NO_CODE: u8 = 0;
const QUICK_BITS: u32 = 8;
const LONGEST: u32 = 16;

/// Code words to values.
pub(super) struct HuffmanTable {
    /// By the first eight bits: value and length, for words that are no longer.
    quick: [(u8, u8); 1 << QUICK_BITS],
    /// For each length: one more than the last word, and the place of its first value less its first word.
    ends: [u32; LONGEST as usize + 1],
    shifts: [i64; LONGEST as usize + 1],
    values: Vec<u8>,
}

impl HuffmanTable {
    /// From how many words there are of each length, and their values; `None` where these are no code.
    pub fn new(counts: &[u8; 16], values: &[u8]) -> Option<HuffmanTable> {
        let mut table = HuffmanTable {
            quick: [(0, NO_CODE); 1 << QUICK_BITS],
            ends: [0; LONGEST as usize + 1],
            shifts: [0; LONGEST as usize + 1],
            values: values.to_vec(),
        };
        let (mut word, mut place) = (0_u32, 0_usize);
        for length in 1..=LONGEST {
            let count = usize::from(counts[length as usize - 1]);
            table.shifts[length as usize] = place as i64 - i64::from(word);
            for value in values.get(place..place + count)? {
                if word >> length != 0 {
                    return None;
                }
                table.enter(word, length, *value);
                word += 1;
            }
            place += count;
            table.ends[length as usize] = word;
            word <<= 1;
        }
        (place == values.len()).then_some(table)
    }

    fn enter(&mut self, word: u32, length: u32, value: u8) {
        if length > QUICK_BITS {
            return;
        }
        let free = QUICK_BITS - length;
        let first = (word << free) as usize;
        self.quick[first..first + (1 << free)].fill((value, length as u8));
    }
}

/// The bits of a scan, most significant first, without the zeros that are stuffed behind 0xFF.
pub(super) struct Bits<'a> {
    bytes: &'a [u8],
    at: usize,
    held: u64,
    count: u32,
    /// Bits beyond the end that were made up.
    missing: u32,
}

impl<'a> Bits<'a> {
    pub fn new(bytes: &'a [u8]) -> Bits<'a> {
        Bits { bytes, at: 0, held: 0, count: 0, missing: 0 }
    }

    /// Holds at least 32 bits, zeros where a marker or the end is met.
    fn fill(&mut self) {
        while self.count <= 32 {
            let byte = match (self.bytes.get(self.at), self.bytes.get(self.at + 1)) {
                (Some(0xFF), Some(0)) => {
                    self.at += 2;
                    0xFF
                }
                (Some(0xFF) | None, _) => {
                    self.missing += 8;
                    0
                }
                (Some(&byte), _) => {
                    self.at += 1;
                    byte
                }
            };
            self.held = self.held << 8 | u64::from(byte);
            self.count += 8;
        }
    }

    /// Whether more was taken than there was.
    pub fn is_overdrawn(&self) -> bool {
        self.missing > self.count
    }

    fn peek(&self, bits: u32) -> u32 {
        (self.held >> (self.count - bits)) as u32 & ((1 << bits) - 1)
    }

    fn drop_bits(&mut self, bits: u32) {
        self.count -= bits;
    }

    /// The value of the next code word; `None` where there is no such word.
    pub fn decode(&mut self, table: &HuffmanTable) -> Option<u8> {
        self.fill();
        let (value, length) = table.quick[self.peek(QUICK_BITS) as usize];
        if length != NO_CODE {
            self.drop_bits(u32::from(length));
            return Some(value);
        }
        for length in QUICK_BITS + 1..=LONGEST {
            let word = self.peek(length);
            if word < table.ends[length as usize] {
                self.drop_bits(length);
                let place = i64::from(word) + table.shifts[length as usize];
                return table.values.get(usize::try_from(place).ok()?).copied();
            }
        }
        None
    }

    /// The next bits as a number; at most 16.
    pub fn take(&mut self, bits: u32) -> u32 {
        self.fill();
        let taken = self.peek(bits);
        self.drop_bits(bits);
        taken
    }

    /// Moves behind the restart marker of this number; false where it does not come next.
    pub fn restart(&mut self, number: u8) -> bool {
        let marker = [0xFF, 0xD0 + number % 8];
        let is_there = self.bytes.get(self.at..self.at + 2) == Some(&marker);
        let rest = self.count.saturating_sub(self.missing);
        *self = Bits { at: self.at + 2, ..Bits::new(self.bytes) };
        is_there && rest < 8
    }
}
