//! Damaged surfaces meshed and held against the undamaged ones: how many runs of each kind of damage end how.
//!
//! `cargo bench --bench damage -- [--runs N --seed S --body NAME --damage KIND --pictures FILE]` takes the kinds of damage in
//! turn, on a made head, on one with three bones, on a ball, and, where the shared data is, on a real head and a real face. It
//! prints a table of kinds and endings and a line for each run that was neither right nor refused, with what repeats it.
//! `--pictures` writes forty runs as one PNG: a section of each, tissue grey, what the damage cost blue, what it added orange,
//! the damaged triangles red.
//! `RAYON_NUM_THREADS` sets the threads.

#[path = "../mechanics/tests/support/chords.rs"]
mod chords;
#[path = "../mechanics/tests/support/damage.rs"]
mod damage;
#[path = "../mechanics/tests/support/damaged.rs"]
#[allow(dead_code, reason = "the tests use the rest")]
mod damaged;
#[path = "measure/montage.rs"]
mod montage;
#[path = "../mechanics/tests/support/surfaces.rs"]
#[allow(dead_code, reason = "the tests use the rest")]
mod surfaces;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use damage::Damage;
use damaged::{Ending, Outcome, Undamaged, made_head};
use mechanics::format::{Mesh, ReadLimits, read};
use mechanics::mesh::{TriangleSurface, Vector};
use surfaces::{map, sphere};

/// Bodies in their turns: real surfaces, which take longest, in one of four.
const TURNS: [usize; 8] = [0, 1, 2, 3, 0, 1, 2, 4];

struct Arguments {
    runs: u64,
    seed: u64,
    body: Option<String>,
    damage: Option<String>,
    pictures: Option<PathBuf>,
}

/// A run with its numbers.
struct Run {
    body: usize,
    damage: Damage,
    seed: u64,
    off: f64,
    elsewhere: f64,
}

fn main() {
    let arguments = arguments();
    let bodies: Vec<Undamaged> = bodies(arguments.body.as_deref());
    let kinds: Vec<Damage> =
        Damage::ALL.into_iter().filter(|kind| arguments.takes(*kind)).collect();
    let mut counts: BTreeMap<(Damage, Ending), Vec<usize>> = BTreeMap::new();
    let mut runs = Vec::new();
    let begin = Instant::now();
    let mut slowest = (0.0, String::new());
    for n in 0..arguments.runs {
        let seed = arguments.seed + n;
        let damage = kinds[n as usize % kinds.len()];
        let turn = TURNS[(n as usize / kinds.len()) % TURNS.len()];
        let body = turn.min(bodies.len() - 1);
        let started = Instant::now();
        let outcome = bodies[body].outcome(damage, seed);
        let repeat =
            format!("--body {} --damage {damage:?} --runs 1 --seed {seed}", bodies[body].name);
        let seconds = started.elapsed().as_secs_f64();
        if seconds > slowest.0 {
            slowest = (seconds, repeat.clone());
        }
        let Outcome { ending, off, elsewhere, angle, .. } = outcome;
        if matches!(ending, Ending::Told(_) | Ending::Silent(_)) || arguments.runs <= 32 {
            println!(
                "{ending:?}: volume {:+.2} %, {:.2} % elsewhere, {angle:.1} degrees, {seconds:.1} s: {repeat}",
                100.0 * off,
                100.0 * elsewhere
            );
        }
        counts.entry((damage, ending)).or_insert_with(|| vec![0; bodies.len()])[body] += 1;
        runs.push(Run { body, damage, seed, off, elsewhere });
        if n % 100 == 99 {
            eprintln!(
                "{} of {} after {:.0} s",
                n + 1,
                arguments.runs,
                begin.elapsed().as_secs_f64()
            );
        }
    }
    print_table(&bodies, &counts);
    println!(
        "\n{} runs, {:.0} s; the slowest took {:.1} s: {}",
        arguments.runs,
        begin.elapsed().as_secs_f64(),
        slowest.0,
        slowest.1
    );
    if let Some(file) = &arguments.pictures {
        montage::write(&tiles(&bodies, runs), file);
    }
}

fn print_table(bodies: &[Undamaged], counts: &BTreeMap<(Damage, Ending), Vec<usize>>) {
    let names: Vec<&str> = bodies.iter().map(|body| body.name).collect();
    println!(
        "\n| damage | ending | runs | {} |\n|{}",
        names.join(" | "),
        " --- |".repeat(3 + names.len())
    );
    for ((damage, ending), of_bodies) in counts {
        let each: Vec<String> = of_bodies.iter().map(ToString::to_string).collect();
        let all: usize = of_bodies.iter().sum();
        println!("| {damage:?} | {ending:?} | {all} | {} |", each.join(" | "));
    }
    type IsSuch = fn(&Ending) -> bool;
    let kinds: [(&str, IsSuch); 4] = [
        ("right", |ending| matches!(ending, Ending::Right)),
        ("refused", |ending| matches!(ending, Ending::Refused(_))),
        ("wrong and told", |ending| matches!(ending, Ending::Told(_))),
        ("wrong in silence", |ending| matches!(ending, Ending::Silent(_))),
    ];
    for (name, is_such) in kinds {
        let such = counts.iter().filter(|((_, ending), _)| is_such(ending));
        println!("{name}: {}", such.flat_map(|(_, of_bodies)| of_bodies).sum::<usize>());
    }
}

/// Of each kind of damage the runs that moved most, forty together.
fn tiles(bodies: &[Undamaged], mut runs: Vec<Run>) -> Vec<montage::Tile> {
    runs.retain(|run| run.off > -1.0);
    runs.sort_by(|a, b| a.damage.cmp(&b.damage).then(b.elsewhere.total_cmp(&a.elsewhere)));
    let mut rank: BTreeMap<Damage, usize> = BTreeMap::new();
    let mut ranked: Vec<(usize, Run)> = runs
        .into_iter()
        .map(|run| {
            let place = rank.entry(run.damage).or_default();
            *place += 1;
            (*place, run)
        })
        .collect();
    ranked.sort_by_key(|(place, run)| (*place, run.damage));
    ranked.truncate(montage::TILES);
    let tile = |(_, run): (usize, Run)| montage::Tile::new(&bodies[run.body], run.damage, run.seed);
    ranked.into_iter().map(tile).collect()
}

fn arguments() -> Arguments {
    let mut found = Arguments { runs: 320, seed: 0, body: None, damage: None, pictures: None };
    let mut given = std::env::args().skip(1);
    while let Some(argument) = given.next() {
        let mut value = || given.next().expect("the argument needs a value");
        match argument.as_str() {
            "--bench" => {} // cargo says so to every bench
            "--runs" => found.runs = value().parse().expect("a number"),
            "--seed" => found.seed = value().parse().expect("a number"),
            "--body" => found.body = Some(value()),
            "--damage" => found.damage = Some(value()),
            "--pictures" => found.pictures = Some(value().into()),
            other => panic!("no argument {other:?}"),
        }
    }
    found
}

impl Arguments {
    fn takes(&self, kind: Damage) -> bool {
        self.damage.as_ref().is_none_or(|wanted| *wanted == format!("{kind:?}"))
    }
}

/// All bodies that can be had, or the one of that name.
fn bodies(wanted: Option<&str>) -> Vec<Undamaged> {
    let shared = std::env::var_os("FACIES_SHARED").map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared"),
        PathBuf::from,
    );
    let takes = |name: &str| wanted.is_none_or(|wanted| wanted == name);
    let mut found = Vec::new();
    if takes("head") {
        found.push(Undamaged::new("head", made_head(), 8.0));
    }
    if takes("jaws") {
        found.push(Undamaged::new("jaws", jaws(), 8.0));
    }
    if takes("ball") {
        found.push(Undamaged::new("ball", vec![sphere(40.0, Vector::zeros(), 4)], 6.0));
    }
    if takes("scan") {
        found.extend(scan(&shared).map(|surfaces| Undamaged::new("scan", surfaces, 6.0)));
    }
    if takes("face") {
        found.extend(face(&shared).map(|surfaces| Undamaged::new("face", surfaces, 4.0)));
    }
    found
}

/// A head with three bones in it.
fn jaws() -> Vec<TriangleSurface> {
    let mut all = made_head();
    all.truncate(1);
    let bone = |size: [f64; 3], at: [f64; 3]| {
        let (size, at) = (Vector::from(size), Vector::from(at));
        map(&sphere(1.0, Vector::zeros(), 4), |x| x.component_mul(&size) + at)
    };
    all.push(bone([50.0, 65.0, 40.0], [0.0, 5.0, 45.0]));
    all.push(bone([35.0, 40.0, 15.0], [0.0, -25.0, -18.0]));
    all.push(bone([40.0, 45.0, 14.0], [0.0, -20.0, -55.0]));
    all
}

fn read_mesh(file: &Path) -> Option<Mesh> {
    let Ok(bytes) = std::fs::read(file) else {
        println!("skipped: {} is not here", file.display());
        return None;
    };
    Some(read(&bytes, &ReadLimits::default()).expect("a mesh").mesh)
}

/// The two surfaces of a real head.
fn scan(shared: &Path) -> Option<Vec<TriangleSurface>> {
    let surface = |part: &str| {
        let file = shared.join(format!("data/head_ct/headsq_quarter_{part}.stl"));
        match read_mesh(&file)? {
            Mesh::Surface(surface) => Some(surface),
            Mesh::Volume(_) | Mesh::Image(_) => None,
        }
    };
    Some(vec![surface("skin")?, surface("bone")?])
}

/// The closed surface of the soft tissue of a real face: thin layers with lips and nostrils.
fn face(shared: &Path) -> Option<Vec<TriangleSurface>> {
    match read_mesh(&shared.join("data/face/subject_face.vtu"))? {
        Mesh::Volume(volume) => Some(vec![volume.surface_of(&volume.boundary_faces())]),
        Mesh::Surface(_) | Mesh::Image(_) => None,
    }
}
