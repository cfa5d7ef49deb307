//! Bytes changed at random in many places at once: every reader answers. A few seconds by default;
//! `FACIES_FUZZ_S=3600 cargo test --release --test jobs fuzz -- --nocapture` goes on for an hour and says how far it came.

use std::time::{Duration, Instant};

use crate::answers;
use crate::samples::one_of_each;

/// Changed inputs of each kind where no time is asked for.
const USUAL: usize = 20_000;

/// No input of a few kB may take longer.
const LONGEST: Duration = Duration::from_secs(10);

/// xorshift64* (Vigna, An experimental exploration of Marsaglia's xorshift generators, scrambled, 2016).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    fn below(&mut self, limit: usize) -> usize {
        (self.next() % limit.max(1) as u64) as usize
    }

    fn of<'a, T: ?Sized>(&mut self, choices: &[&'a T]) -> &'a T {
        choices[self.below(choices.len())]
    }
}

const WORDS: [&str; 14] = [
    "-1",
    "0",
    "1e999",
    "nan",
    "4294967296",
    "18446744073709551616",
    "null",
    "\"\"",
    "{",
    "[",
    "\n",
    "\u{0}",
    "\u{202e}",
    "1e-400",
];

/// One to eight changes: bytes, words, pieces cut out, doubled or taken from another input.
fn changed(bytes: &[u8], other: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..=random.below(8) {
        let at = random.below(bytes.len());
        let end = (at + 1 + random.below(24)).min(bytes.len());
        match random.below(6) {
            0 if at < bytes.len() => bytes[at] ^= 1 << random.below(8),
            1 if at < bytes.len() => bytes[at] = random.next() as u8,
            2 => drop(bytes.drain(at..end)),
            3 => {
                let piece = bytes[at..end].to_vec();
                bytes.splice(at..at, piece);
            }
            4 => {
                let from = random.below(other.len());
                let piece = other[from..(from + 1 + random.below(24)).min(other.len())].to_vec();
                bytes.splice(at..end, piece);
            }
            _ => drop(bytes.splice(at..end, random.of(&WORDS).bytes())),
        }
    }
    bytes
}

/// Calls `check` with changed inputs, for as many or as long as is wanted.
fn fuzz(seeds: &[(&str, Vec<u8>)], mut check: impl FnMut(&str, &[u8])) {
    let seconds = std::env::var("FACIES_FUZZ_S").ok().map(|text| text.parse().unwrap());
    let until = seconds.map(|seconds| Instant::now() + Duration::from_secs(seconds));
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let mut count = 0;
    while until.map_or(count < USUAL * seeds.len(), |until| Instant::now() < until) {
        let (name, seed) = &seeds[count % seeds.len()];
        let (_, other) = &seeds[random.below(seeds.len())];
        let input = changed(seed, other, &mut random);
        let begun = Instant::now();
        check(name, &input);
        assert!(begun.elapsed() < LONGEST, "{name}: {:?}", String::from_utf8_lossy(&input));
        count += 1;
    }
    println!("{count} inputs");
}

#[test]
fn any_file_is_answered() {
    let mut read_well = 0;
    fuzz(&one_of_each(), |_, input| read_well += usize::from(answers::file(input)));
    assert!(read_well > 0, "inputs are changed beyond recognition");
}

const CASE: &str = r#"{"schema":1,"name":"a","units":"mm","frame":"LPS","volume":"m","tags":["t"],
    "regions":{"array":"layer","names":{"1":"fat"}},"skin":{"node_set":"skin"},
    "segments":[{"name":"jaw","nodes":{"array":"tag","value":2}}],"fixed":[{"any":[{"node_set":"skull"},{"surface":"b","within_mm":2.5}]}],
    "materials":{"*":{"young_modulus_kpa":15,"poisson_ratio":0.46}},"landmarks":{"chin":[1,2.5e1,-3]}}"#;
const PLAN: &str = r#"{"segments":[{"name":"jaw","translation_mm":[1,0,0],"rotation_deg":[0,0,3],
    "pivot_mm":[0,40,-50]}],"loads":[{"gravity_m_per_s2":[0,0,-9.81]}],
    "osteotomy":{"cuts":[{"name":"a","point_mm":[1,2,3],"normal":[0,0,1]}],"segments":[{"name":"jaw","below":["a"]}]}}"#;
const PREDICT: &str = r#"{"kind":"predict","case":"c","method":"fem_linear","element":"auto",
    "materials":{"*":{"young_modulus_kpa":15,"poisson_ratio":0.46}},"outputs":["skin.vtp"],
    "budget":{"wall_s":60,"memory_mb":4000},"tags":["t"]}"#;
const STUDY: &str = r#"{"kind":"study","scenes":["slab",{"case":"c","name":"a"}],"plans":["patch 4 mm"],
    "methods":["fem_linear",{"method":"msm","label":"x"}],"elements":["plain"],"levels":[0,1],
    "sweep":{"*":{"poisson_ratio":[0.3,0.46]}},"truth":{"refine":1,"element":"quadratic"},
    "thresholds":{"p95_mm":1.0},"repeats":1}"#;
const BATCH: &str = r#"{"kind":"batch","items":[{"case":"c","plan":{"segments":[{"name":"jaw","translation_mm":[1,0,0]}]},
    "method":"msm","label":"x"}],"levels":[0]}"#;
const OPTIMISE: &str = r#"{"kind":"optimise","case":"c","targets":[{"landmark":"chin","position_mm":[1,2,3],
    "sigma_mm":0.5}],"bounds":{"jaw":{"translation_mm":[[-5,5],[0,0],[-1,1]]}},"verify":true}"#;
const COMPARE: &str =
    r#"{"kind":"compare","prediction":{"job":"j"},"actual":{"mesh":"m"},"samples_per_mm2":1}"#;
const RESPONSE: &str = r#"{"kind":"response","case":"c","segments":["jaw"]}"#;
const MESH: &str = r#"{"kind":"mesh","scan":"s","thresholds_hu":{"skin":-300,"bone":250},"frame":"RAS",
    "osteotomy":{"cuts":[{"name":"a","point_mm":[1,2,3],"normal":[0,-0.2,1]},
    {"name":"b","point_mm":[0,0,0],"normal":[0,0,1],"corners_mm":[[0,0,0],[9,0,0],[0,9,0]],"kerf_mm":1}],
    "segments":[{"name":"jaw","below":["a"],"above":["b"],"seeds_mm":[[1,2,4]]}],"free_band_mm":3},
    "size":{"finest_mm":2,"coarsening":4},"scan_ends_fixed":false,"budget":{"wall_s":60},"tags":["t"]}"#;

#[test]
fn any_document_is_answered() {
    let seeds = [
        ("case", CASE),
        ("plan", PLAN),
        ("predict", PREDICT),
        ("study", STUDY),
        ("batch", BATCH),
        ("optimise", OPTIMISE),
        ("compare", COMPARE),
        ("response", RESPONSE),
        ("mesh", MESH),
    ];
    for (name, seed) in seeds {
        assert!(answers::document(name, seed.as_bytes()), "{name} is no document");
    }
    let seeds = seeds.map(|(name, text)| (name, text.as_bytes().to_vec()));
    let mut read_well = 0;
    fuzz(&seeds, |name, input| read_well += usize::from(answers::document(name, input)));
    assert!(read_well > 0, "inputs are changed beyond recognition");
}
