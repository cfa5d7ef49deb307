//! `facies study --stability --random N`: how random small scenes end, counted by method and by law.

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::{Value, json};

use super::claim::Claim;
use super::failure::CommandError;
use super::stability::Clock;
use mechanics::study::stability::Bounds;
use mechanics::study::stability::random::{Ending, RandomMap, WrongScene, random};

/// What one scene may take, in s.
const SCENE_S: f64 = 30.0;

/// Scenes between two lines on the screen.
const TOLD: u64 = 500;

/// Ends so many scenes of a seed, writes `random.json` and `random.csv` into the folder and prints a line for each method and
/// law. An answer that is silently wrong, or a panic, is an error.
pub fn run(out: &Path, scenes: u64, seed: u64) -> Result<(), CommandError> {
    let claim = Claim::of(out, &["random.json", "random.csv"])?;
    let clock = Clock::start();
    let bounds = Bounds { stopwatch: &clock, seconds: SCENE_S };
    let told = |ended: u64| {
        if ended.is_multiple_of(TOLD) {
            eprintln!("{ended} scenes …");
        }
    };
    let found = random(seed, 0..scenes, &bounds, &told);
    print(&found);
    claim.put("random.json", format!("{:#}\n", document(&found)))?;
    claim.put("random.csv", table(&found))?;
    for name in ["random.json", "random.csv"] {
        println!("wrote      {}", out.join(name).display());
    }
    match found.wrong.len() {
        0 => Ok(()),
        probes => Err(CommandError::SilentlyWrong { probes }),
    }
}

/// As tables and files call it: the word, and the code of what ended with one.
fn words(ending: &Ending) -> (&'static str, &str) {
    match ending {
        Ending::Answered => ("answered", ""),
        Ending::Warned => ("warned", ""),
        Ending::Refused(code) => ("refused", code),
        Ending::Failed(code) => ("failed", code),
        Ending::Wrong(_) => ("wrong", ""),
    }
}

type Counts = BTreeMap<String, BTreeMap<Ending, u64>>;

fn print(found: &RandomMap) {
    for (title, counts) in [("method", &found.by_method), ("law", &found.by_law)] {
        println!("{title}");
        for (name, endings) in counts {
            let words = endings.iter().map(|(ending, count)| {
                let (word, code) = words(ending);
                let space = if code.is_empty() { "" } else { " " };
                format!("{count} {word}{space}{code}")
            });
            println!("  {name:<28} {}", words.collect::<Vec<_>>().join(", "));
        }
    }
    let RandomMap { longest_s, longest_at, .. } = found;
    println!("longest    {longest_s:.1} s, scene {longest_at}");
    for WrongScene { place, method, law, why } in &found.wrong {
        println!("WRONG      scene {place} of seed {}, {method}, {law}: {why}", found.seed);
    }
}

fn document(found: &RandomMap) -> Value {
    let list = |counts: &Counts| -> Vec<Value> {
        let rows = counts.iter().flat_map(|(name, endings)| {
            endings.iter().map(move |(ending, count)| {
                let (word, code) = words(ending);
                json!({ "name": name, "ending": word, "code": code, "scenes": count })
            })
        });
        rows.collect()
    };
    let wrong = found.wrong.iter().map(|WrongScene { place, method, law, why }| {
        json!({ "scene": place, "method": method, "law": law, "why": why })
    });
    json!({
        "seed": found.seed,
        "scenes": found.scenes,
        "longest_s": found.longest_s,
        "longest_scene": found.longest_at,
        "methods": list(&found.by_method),
        "laws": list(&found.by_law),
        "wrong": wrong.collect::<Vec<_>>(),
    })
}

/// One line for each ending of a method or a law.
fn table(found: &RandomMap) -> String {
    let mut lines = vec!["by,name,ending,code,scenes".to_owned()];
    for (by, counts) in [("method", &found.by_method), ("law", &found.by_law)] {
        for (name, endings) in counts {
            for (ending, count) in endings {
                let (word, code) = words(ending);
                lines.push(format!("{by},\"{name}\",{word},{code},{count}"));
            }
        }
    }
    lines.join("\n") + "\n"
}
