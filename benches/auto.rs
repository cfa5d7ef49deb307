//! The method `auto` over random plans against the truth of a finer mesh at finite strain, as the table of docs/estimates.md:
//! `cargo bench --bench auto [-- SCENE … --plans N --from N --head FILE]`; FILE is a mesh that `facies mesh` made of a CT whose
//! plan cuts `maxilla` and `mandible`, with tissue joined to the teeth.
//!
//! Plans are numbered from 0, and a plan of a number is the same each time: 1 to 25 mm in any direction, 0 to 20 degrees about
//! any axis, accepted errors from .03 to 1 mm. Each is a line: what `auto` took, what it was off by in truth, and which model
//! would have been the cheapest. The truth is `fem_nonlinear` with every edge halved; plans without one are counted apart, and those
//! with more than one: Newton's method takes other steps to 99 % of a plan, and what it finds there, made longer by as much, is
//! within a third of a millimetre of the truth at every node of the skin unless it is another equilibrium. Times are those of the processor. The summary of each scene comes last.

mod measure;

use std::sync::Arc;

use measure::{face, process};
use mechanics::boundary::NodeSelection;
use mechanics::format::{Mesh, ReadLimits, read};
use mechanics::material::LinearElastic;
use mechanics::mesh::refinement::refine;
use mechanics::mesh::{Vector, sample};
use mechanics::plan::{PlannedSegment, RigidMovement};
use mechanics::prediction::{
    Accepted, Case, CaseSegment, Method, Plan, Prediction, Rung, Scene, Settings, TimedProgress,
    predict, predict_adequately,
};
use mechanics::progress::Unobserved;
use mechanics::study::scenes::half_head;

/// Movements in mm and degrees, and accepted errors in mm.
const MOVED: [f64; 2] = [1.0, 25.0];
const TURNED: f64 = 20.0;
const ACCEPTED: [f64; 2] = [0.03, 1.0];

/// The share of a plan to which a second path goes, and how far from the truth in mm its end is another equilibrium.
const NEARLY: f64 = 0.99;
const ANOTHER: f64 = 0.33;

/// A case, its segment that moves, and its forward direction.
struct Entry {
    name: &'static str,
    case: Case,
    segment: &'static str,
    /// About which it turns.
    pivot: Vector,
}

/// A plan, and the error that is accepted.
struct Question {
    number: usize,
    plan: Plan,
    /// 99 % of it.
    nearly: Plan,
    accepted_mm: f64,
    moved_mm: f64,
    turned_deg: f64,
}

/// A model in hindsight: its true mean error over the skin, and its processor time with all that comes before it.
struct Hindsight {
    rung: Rung,
    error_mm: f64,
    cpu_s: f64,
}

#[derive(Default)]
struct Summary {
    plans: usize,
    without_truth: usize,
    with_two: usize,
    called_met: usize,
    met: usize,
    /// Called not met, and within what was accepted.
    overcautious: usize,
    /// Time over that of the cheapest that would have done.
    ratios: Vec<f64>,
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |name: &str, usual: usize| {
        let at = arguments.iter().position(|argument| argument == name);
        at.and_then(|at| arguments.get(at + 1)?.parse().ok()).unwrap_or(usual)
    };
    let (plans, from) = (number("--plans", 75), number("--from", 0));
    let mut entries = entries();
    let head = arguments.iter().position(|argument| argument == "--head");
    match head.and_then(|at| arguments.get(at + 1)) {
        Some(file) => entries.push(head_of(file)),
        None => println!("skipped: head, because `--head` names no mesh of a CT"),
    }
    println!(
        "| scene | plan | mm, degrees | accepted mm | taken | met | told mm | true mm | cheapest | time over it | against it |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    let mut summaries = Vec::new();
    for entry in entries.iter().filter(|entry| is_asked(entry.name, &arguments)) {
        let mut summary = Summary::default();
        for number in from..from + plans {
            measure_plan(entry, &question(entry, number), &mut summary);
        }
        summaries.push((entry.name, summary));
    }
    println!();
    println!(
        "| scene | plans | no truth | two | called met | of these met | not met | of these within | time, median / p90 |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    let mut all = Summary::default();
    for (name, summary) in &mut summaries {
        summary.print(name);
        all.add(summary);
    }
    all.print("all");
}

fn is_asked(name: &str, arguments: &[String]) -> bool {
    let scenes = ["block", "half_head", "subject", "template", "head"];
    let any = arguments.iter().any(|argument| scenes.contains(&argument.as_str()));
    !any || arguments.iter().any(|argument| argument == name)
}

fn measure_plan(entry: &Entry, question: &Question, summary: &mut Summary) {
    summary.plans += 1;
    let Question { number, accepted_mm, moved_mm, turned_deg, .. } = question;
    let of =
        format!("| {} | {number} | {moved_mm:.1}, {turned_deg:.1} | {accepted_mm:.3}", entry.name);
    let Some(truth) = truth(entry, &question.plan) else {
        summary.without_truth += 1;
        return println!("{of} | no truth | | | | | | |");
    };
    if has_other_truth(entry, question, &truth) {
        summary.with_two += 1;
        return println!("{of} | two equilibria | | | | | | |");
    }
    let Ok(scene) = Scene::new(&entry.case, &question.plan, &Settings::default()) else {
        summary.without_truth += 1;
        return println!("{of} | refused | | | | | | |");
    };
    let begin = process::cpu_seconds();
    let accepted = Accepted { skin_mm: *accepted_mm, time_s: 1e6, ..Accepted::default() };
    let watched = TimedProgress { stopwatch: &process::cpu_seconds, progress: &Unobserved };
    let found = predict_adequately(&entry.case, &question.plan, &scene, &accepted, watched)
        .expect("linear elements have an answer");
    let cpu_s = process::cpu_seconds() - begin;
    let off = mean_error(&scene, &found.prediction.displacement, &truth);
    let solve_every_model = solve_every_model(entry, question, &scene, &truth);
    let adequate = solve_every_model.iter().filter(|model| model.error_mm <= *accepted_mm);
    let cheapest = adequate.min_by(|a, b| a.cpu_s.total_cmp(&b.cpu_s));
    let told = found.considered.iter().find(|other| other.rung == found.rung);
    let told = told.and_then(|own| Some(own.error.as_ref()?.skin_mm)).unwrap_or(f64::NAN);
    let ratio = cheapest.map(|model| cpu_s / model.cpu_s);
    let objections: Vec<&str> = found.objections.iter().map(|own| own.warning.code).collect();
    println!(
        "{of} | {} | {} | {told:.4} | {off:.4} | {} | {} | {} |",
        found.rung.name(),
        if found.is_met { "yes" } else { "no" },
        cheapest.map_or("none", |model| model.rung.name()),
        ratio.map_or_else(String::new, |ratio| format!("{ratio:.2}")),
        objections.join(", "),
    );
    summary.called_met += usize::from(found.is_met);
    summary.met += usize::from(found.is_met && off <= *accepted_mm);
    summary.overcautious += usize::from(!found.is_met && off <= *accepted_mm);
    if found.is_met {
        summary.ratios.extend(ratio);
    }
}

/// Whether a path to nearly the same plan ends elsewhere; so does one that ends nowhere.
fn has_other_truth(entry: &Entry, question: &Question, found: &[Vector]) -> bool {
    truth(entry, &question.nearly).is_none_or(|nearly| {
        found.iter().zip(&nearly).any(|(u, v)| (u - v / NEARLY).norm() > ANOTHER)
    })
}

/// The skin of the same case with every edge halved, at finite strain.
fn truth(entry: &Entry, plan: &Plan) -> Option<Vec<Vector>> {
    let fine = Case { volume: Arc::new(refine(&entry.case.volume)), ..entry.case.clone() };
    let found = at_finite_strain(&fine, plan, false)?;
    let scene = Scene::new(&entry.case, plan, &Settings::default()).ok()?;
    let nodes = scene.skin.nodes().iter();
    Some(nodes.map(|&node| found.displacement[node as usize]).collect())
}

fn at_finite_strain(case: &Case, plan: &Plan, estimate: bool) -> Option<Prediction> {
    let (method, memory_mb, relative_residual) = (Method::FemNonlinear, 12_000.0, 1e-6);
    let settings =
        Settings { method, estimate, memory_mb, relative_residual, ..Settings::default() };
    let scene = Scene::new(case, plan, &settings).ok()?;
    predict(&scene, &Unobserved).ok()
}

/// Every model, from its own solution.
fn solve_every_model(
    entry: &Entry,
    question: &Question,
    scene: &Scene,
    truth: &[Vector],
) -> Vec<Hindsight> {
    let begin = process::cpu_seconds();
    let linear = predict(scene, &Unobserved).expect("it has an answer");
    let linear_s = process::cpu_seconds() - begin;
    let begin = process::cpu_seconds();
    let finite = at_finite_strain(&entry.case, &question.plan, true);
    let finite_s = process::cpu_seconds() - begin;
    let added = |values: &[Vector], more: &[Vector]| -> Vec<Vector> {
        values.iter().zip(more).map(|(value, more)| value + more).collect()
    };
    let mut models = Vec::new();
    let mut judge = |rung: Rung, displacement: &[Vector], cpu_s: f64| {
        let error_mm = mean_error(scene, displacement, truth);
        models.push(Hindsight { rung, error_mm, cpu_s });
    };
    let missing = linear.numerical_error.expect("estimated").missing;
    let second = added(&linear.displacement, &linear.nonlinearity.expect("estimated").left_out);
    judge(Rung::Linear, &linear.displacement, linear_s);
    judge(Rung::Corrected, &added(&linear.displacement, &missing), linear_s);
    // The second order is there already, loosely.
    judge(Rung::SecondOrder, &second, 1.5 * linear_s);
    judge(Rung::SecondOrderCorrected, &added(&second, &missing), 1.5 * linear_s);
    if let Some(finite) = finite {
        judge(Rung::FiniteStrain, &finite.displacement, finite_s);
        if let Ok(error) = &finite.numerical_error {
            let corrected = added(&finite.displacement, &error.missing);
            judge(Rung::FiniteStrainCorrected, &corrected, finite_s);
        }
    }
    models
}

/// Over the skin that moves in truth by more than a tenth of what moves farthest.
fn mean_error(scene: &Scene, displacement: &[Vector], truth: &[Vector]) -> f64 {
    let least = 0.1 * truth.iter().map(Vector::norm).fold(0.0, f64::max);
    let pairs = scene.skin.nodes().iter().zip(truth).filter(|(_, u)| u.norm() >= least);
    let errors: Vec<f64> =
        pairs.map(|(&node, u)| (displacement[node as usize] - u).norm()).collect();
    errors.iter().sum::<f64>() / errors.len().max(1) as f64
}

impl Summary {
    fn add(&mut self, other: &Summary) {
        self.plans += other.plans;
        self.without_truth += other.without_truth;
        self.with_two += other.with_two;
        self.called_met += other.called_met;
        self.met += other.met;
        self.overcautious += other.overcautious;
        self.ratios.extend(&other.ratios);
    }

    fn print(&mut self, name: &str) {
        self.ratios.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let last = self.ratios.len().saturating_sub(1);
            self.ratios.get((last as f64 * share).round() as usize).copied().unwrap_or(f64::NAN)
        };
        let not_met = self.plans - self.without_truth - self.with_two - self.called_met;
        println!(
            "| {name} | {} | {} | {} | {} | {} | {not_met} | {} | {:.2} / {:.2} |",
            self.plans,
            self.without_truth,
            self.with_two,
            self.called_met,
            self.met,
            self.overcautious,
            at(0.5),
            at(0.9),
        );
    }
}

fn entries() -> Vec<Entry> {
    let half_head = half_head();
    let mut entries = vec![
        Entry {
            name: "block",
            case: hard_block(),
            segment: "patch",
            pivot: Vector::new(50.0, 50.0, 0.0),
        },
        Entry {
            name: "half_head",
            pivot: middle(&half_head.case, "mandible"),
            case: half_head.case,
            segment: "mandible",
        },
    ];
    for face in face::faces() {
        let Some(mesh) = face.load() else { continue };
        let case = face.case(mesh, 0.46);
        let pivot = middle(&case, face.jaw);
        entries.push(Entry { name: face.name, case, segment: "jaw", pivot });
    }
    entries
}

fn hard_block() -> Case {
    let mesh = sample::hard_block([20, 20, 4]);
    let set = |name: &str| NodeSelection::NodeSet(name.to_owned());
    let material = LinearElastic::new(15.0, 0.46, 1.0).expect("within the ranges");
    Case {
        skin: Some(set("z_max")),
        segments: vec![CaseSegment { name: "patch".to_owned(), nodes: set("patch") }],
        fixed: vec![set("rest")],
        materials: [("*".to_owned(), material)].into(),
        volume: Arc::new(mesh),
        ..Case::default()
    }
}

/// The head in a file: its lower jaw moves.
fn head_of(file: &str) -> Entry {
    let bytes = std::fs::read(file).expect("a file that can be read");
    let Mesh::Volume(mesh) = read(&bytes, &ReadLimits::default()).expect("a valid file").mesh
    else {
        panic!("a head is a volume mesh");
    };
    let set = |name: &str| NodeSelection::NodeSet(name.to_owned());
    let material = LinearElastic::new(15.0, 0.46, 1.0).expect("within the ranges");
    let case = Case {
        volume: Arc::new(mesh),
        skin: Some(set("skin")),
        segments: vec![CaseSegment { name: "mandible".to_owned(), nodes: set("mandible") }],
        fixed: vec![set("maxilla"), set("fixed")],
        materials: [("*".to_owned(), material)].into(),
        ..Case::default()
    };
    let pivot = middle(&case, "mandible");
    Entry { name: "head", case, segment: "mandible", pivot }
}

fn middle(case: &Case, set: &str) -> Vector {
    let nodes = case.volume.node_set(set).expect("the set of the bone");
    let sum: Vector = nodes.iter().map(|&node| case.volume.nodes[node as usize]).sum();
    sum / nodes.len() as f64
}

/// The plan of a number; lengths and angles that are small are as frequent as large ones.
fn question(entry: &Entry, number: usize) -> Question {
    let seed = (number as u64 + 1).wrapping_mul(0x2545_f491_4f6c_dd1d);
    let mut numbers = Random(0x9e37_79b9_7f4a_7c15 ^ seed);
    let moved_mm = MOVED[0] * (MOVED[1] / MOVED[0]).powf(numbers.next());
    let turned_deg = TURNED * numbers.next().powi(2) * moved_mm / MOVED[1];
    let (along, about) = (numbers.direction(), numbers.direction());
    let planned = |share: f64| {
        let angles = about * (share * turned_deg.to_radians());
        let movement = RigidMovement::about_pivot(angles, entry.pivot, along * (share * moved_mm));
        let segments = vec![PlannedSegment { name: entry.segment.to_owned(), movement }];
        Plan { segments, ..Plan::default() }
    };
    let accepted_mm = ACCEPTED[0] * (ACCEPTED[1] / ACCEPTED[0]).powf(numbers.next());
    let (plan, nearly) = (planned(1.0), planned(NEARLY));
    Question { number, plan, nearly, accepted_mm, moved_mm, turned_deg }
}

/// Marsaglia, Xorshift RNGs, 2003.
struct Random(u64);

impl Random {
    /// In [0, 1).
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn direction(&mut self) -> Vector {
        loop {
            let x = Vector::new(self.next(), self.next(), self.next()) * 2.0 - Vector::repeat(1.0);
            if x.norm() > 0.1 && x.norm() < 1.0 {
                return x.normalize();
            }
        }
    }
}
