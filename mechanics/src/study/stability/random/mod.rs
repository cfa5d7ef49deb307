//! Map of failures over random scenes: outcomes counted by method and by law.

mod ending;
mod scene;

use std::collections::BTreeMap;
use std::ops::Range;

pub use ending::Ending;

use super::Bounds;
use ending::ending;
use scene::scene;

/// Endings of random scenes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RandomMap {
    pub seed: u64,
    pub scenes: u64,
    /// How often each ending appeared, by method with its element, and by law of what knows any.
    pub by_method: BTreeMap<String, BTreeMap<Ending, u64>>,
    pub by_law: BTreeMap<String, BTreeMap<Ending, u64>>,
    /// Places of scenes whose ending must not appear.
    pub wrong: Vec<WrongScene>,
    /// The longest time that one scene took, in s, and its place.
    pub longest_s: f64,
    pub longest_at: u64,
}

/// A scene whose ending must not appear.
#[derive(Clone, Debug, PartialEq)]
pub struct WrongScene {
    pub place: u64,
    pub method: String,
    pub law: String,
    pub why: String,
}

/// Scenes of a seed by their places. `told` hears up to which place they have ended.
pub fn random(seed: u64, places: Range<u64>, bounds: &Bounds, told: &dyn Fn(u64)) -> RandomMap {
    let scenes = places.end - places.start;
    let mut found = RandomMap { seed, scenes, ..RandomMap::default() };
    for place in places {
        found.add(place, bounds);
        told(place + 1);
    }
    found
}

impl RandomMap {
    fn add(&mut self, place: u64, bounds: &Bounds) {
        // Every constant lies in its range: a tissue that is none is a mistake of the generator.
        let Ok(scene) = scene(self.seed, place) else {
            let why = "the tissue is none".to_owned();
            let (method, law) = (String::new(), String::new());
            return self.wrong.push(WrongScene { place, method, law, why });
        };
        let begun = bounds.stopwatch.seconds();
        let ending = ending(&scene.probe, bounds);
        let took = bounds.stopwatch.seconds() - begun;
        if took > self.longest_s {
            (self.longest_s, self.longest_at) = (took, place);
        }
        if let Ending::Wrong(why) = &ending {
            let (method, law) = (scene.method.clone(), scene.law.to_owned());
            self.wrong.push(WrongScene { place, method, law, why: why.clone() });
        }
        let counted = match &ending {
            Ending::Wrong(_) => Ending::Wrong(String::new()),
            other => other.clone(),
        };
        if scene.probe.settings.method.properties().laws == crate::prediction::Laws::Any {
            let law = self.by_law.entry(scene.law.to_owned()).or_default();
            *law.entry(counted.clone()).or_default() += 1;
        }
        *self.by_method.entry(scene.method).or_default().entry(counted).or_default() += 1;
    }

    /// How many scenes ended so.
    pub fn count(&self, is_meant: impl Fn(&Ending) -> bool) -> u64 {
        let endings = self.by_method.values().flatten();
        endings.filter(|(ending, _)| is_meant(ending)).map(|(_, count)| count).sum()
    }
}
