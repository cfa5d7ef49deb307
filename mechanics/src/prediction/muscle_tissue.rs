//! The tissue of cells that muscles fill in part.
//!
//! A cell is the mixture of its muscles by their shares and, in what they leave, of the tissue that it has without them, by the rule
//! of the case (`material::mixture`). Its one axis is the leading eigenvector of sum w a a^T over the parts with fibres. Shares that
//! sum to more than 1 are taken down to 1 together, and are rounded to steps that leave no more mixtures than numbers for them.
//! Source: the equivalent property of Kim et al. 2012, section 3.2.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Matrix3;

use super::case::{Muscle, Plan};
use super::check::Check;
use super::error_code::SceneErrorCode;
use super::fibres::fibres_ignored;
use super::hounsfield::{MOST_MATERIALS, TissueOfCells};
use super::method::Method;
use super::muscle_field::{MuscleField, MuscleTissue};
use crate::material::LinearElastic;
use crate::material::mixture::MixingRule;
use crate::mesh::{Vector, Warning};
use crate::muscle::axis::MeanAxis;
use crate::muscle::equivalent::{EquivalentTissue, rule_dependent_share};
use crate::progress::StopQuery;

/// Shares of cells are whole numbers of this at the finest.
const STEPS: u16 = 512;

/// A share of the volume in which the rule decides that is reported.
const DECIDED: f64 = 0.01;

/// A muscle in a cell: its number, and its share times f (x) f.
type Part = (u16, Matrix3<f64>);

/// Composition of a cell: its material without muscles, and its muscles in steps.
type Recipe = (u16, Vec<(u16, u16)>);

impl Check<'_> {
    /// Mixes muscles with a tissue of their own into the cells, and gives these their directions.
    pub(super) fn muscle_tissue(
        &mut self,
        muscles: &[MuscleField],
        (tissue, fibres): (&mut TissueOfCells, &mut Vec<Vector>),
        (method, plan): (&Method, &Plan),
    ) -> Option<MuscleTissue> {
        let own = self.tissue_of_muscles(method, plan);
        let mut parts: Vec<Vec<Part>> = vec![Vec::new(); tissue.material_of_cell.len()];
        for (number, field) in muscles.iter().enumerate().filter(|(n, _)| own[*n].is_some()) {
            for cell in field.cells.iter().filter(|cell| cell.stress.trace() > 0.0) {
                parts[cell.cell as usize].push((number as u16, cell.stress));
            }
        }
        if parts.iter().all(Vec::is_empty) || !self.can_be_mixed(tissue, &parts) {
            return None;
        }
        let rule = self.case.muscle_mixing.rule;
        let mut mixer = Mixer::new(&own, rule, tissue);
        let steps = mixer.steps(&parts, self.stop);
        let (mut told, mut volumes) = (Counts::default(), Vec::new());
        for (cell, parts) in parts.iter().enumerate() {
            if self.stop.is_asked_at(cell) {
                break;
            }
            let recipe = (mixer.tissue.material_of_cell[cell], in_steps(parts, steps));
            let volume = self.case.volume.cell_volume(cell);
            if recipe.1.is_empty() {
                volumes.push((volume, 1.0));
                continue;
            }
            let axis = mixer.axis(cell, parts, fibres);
            let (pure, ratio) = mixer.fill(cell, recipe, steps);
            volumes.push((volume, ratio));
            told.add(pure, axis);
            if let Some(axis) = axis.filter(|_| mixer.has_fibre(cell)) {
                fibres.resize(mixer.tissue.material_of_cell.len(), Vector::zeros());
                fibres[cell] = axis.direction;
            }
        }
        let Counts { cells, mixed, crossing } = told;
        let rule_decides = rule_dependent_share(volumes);
        let told = MuscleTissue { rule, cells, mixed, crossing, rule_decides };
        self.warnings.extend(told.warnings());
        Some(told)
    }

    /// That of each muscle as it pulls in a plan, without fibres where the method knows none.
    fn tissue_of_muscles(&mut self, method: &Method, plan: &Plan) -> Vec<Option<LinearElastic>> {
        let case = self.case;
        let own = case.muscles.iter().map(|muscle| muscle.tissue);
        if method.properties().knows_fibres {
            let all = case.muscles.iter();
            return all
                .map(|muscle| Some(self.activated_tissue(muscle, muscle.tissue?, plan)))
                .collect();
        }
        let ignored = own.clone().flatten().filter(LinearElastic::has_fibre).count();
        if ignored > 0 {
            self.warnings.push(fibres_ignored(ignored, "muscles"));
        }
        own.map(|tissue| tissue.map(LinearElastic::without_fibre)).collect()
    }

    /// The tissue of a muscle, stiffer where the plan activates it.
    fn activated_tissue(
        &mut self,
        muscle: &Muscle,
        tissue: LinearElastic,
        plan: &Plan,
    ) -> LinearElastic {
        let mut activations = plan.activations.iter().enumerate();
        let own = activations.find(|(_, activation)| activation.muscle == muscle.name);
        let Some((stiffening, (index, activation))) = muscle.stiffening.as_ref().zip(own) else {
            return tissue;
        };
        let at = format!("/plan/activations/{index}/stress_kpa");
        let (stress, most) = (activation.stress, stiffening.stress);
        if !(0.0..=most).contains(&stress) {
            let detail = format!(
                "{stress} kPa is more than the {most} kPa of the fully active muscle {:?}, beyond which its stiffness is not known",
                muscle.name
            );
            self.problems.add(at, SceneErrorCode::PlanOutOfRange, detail);
            return tissue;
        }
        stiffening.at(tissue, stress).unwrap_or_else(|error| {
            self.problems.add(at, SceneErrorCode::PlanOutOfRange, error.to_string());
            tissue
        })
    }

    /// Stiffnesses mix: laws of finite strain and fibres that only pull have more.
    fn can_be_mixed(&mut self, tissue: &TissueOfCells, parts: &[Vec<Part>]) -> bool {
        let filled = tissue.material_of_cell.iter().zip(parts).filter(|(_, own)| !own.is_empty());
        let filled: BTreeSet<u16> = filled.map(|(material, _)| *material).collect();
        let is_more = |material: &&u16| {
            let material = &tissue.materials[usize::from(**material)];
            material.has_pulling_fibres() || material.stated_law().is_some()
        };
        let more = filled.iter().filter(is_more).count();
        if tissue.materials.len() + self.case.muscles.len() > MOST_MATERIALS {
            let detail = format!(
                "at most {MOST_MATERIALS} tissues are distinguished, with those of muscles"
            );
            self.problems.add("/case/muscles", SceneErrorCode::TooManyRegions, detail);
            return false;
        }
        if more == 0 {
            return true;
        }
        let detail = format!(
            "the `material` of muscles is mixed into linear tissue, and {more} tissues around them have a law of finite strain or \
             fibres that only pull"
        );
        self.problems.add("/case/muscles", SceneErrorCode::MethodNotAvailable, detail);
        false
    }
}

#[derive(Default)]
struct Counts {
    cells: usize,
    mixed: usize,
    crossing: usize,
}

impl Counts {
    fn add(&mut self, is_pure: bool, axis: Option<MeanAxis>) {
        self.cells += 1;
        self.mixed += usize::from(!is_pure);
        self.crossing += usize::from(axis.is_some_and(|axis| axis.is_crossing()));
    }
}

/// Materials of cells that muscles fill, each made once.
struct Mixer<'a> {
    tissue: &'a mut TissueOfCells,
    rule: MixingRule,
    /// The material that each muscle is by itself.
    pure: Vec<Option<u16>>,
    made: BTreeMap<Recipe, (u16, f64)>,
}

impl<'a> Mixer<'a> {
    fn new(own: &[Option<LinearElastic>], rule: MixingRule, tissue: &'a mut TissueOfCells) -> Self {
        let mut pure = Vec::new();
        for material in own {
            pure.push(material.map(|_| tissue.materials.len() as u16));
            tissue.materials.extend(*material);
        }
        Mixer { tissue, rule, pure, made: BTreeMap::new() }
    }

    /// Steps of shares that leave every mixture a number; with one step, as after a stop, cells are of one part.
    fn steps(&self, parts: &[Vec<Part>], stop: &StopQuery) -> u16 {
        let mut steps = STEPS;
        loop {
            let recipes = self.tissue.material_of_cell.iter().zip(parts);
            let recipes = recipes.map(|(material, own)| (*material, in_steps(own, steps)));
            let mixed: BTreeSet<Recipe> = recipes.filter(|(_, own)| !own.is_empty()).collect();
            if self.tissue.materials.len() + mixed.len() <= MOST_MATERIALS || steps == 1 {
                return steps;
            }
            steps = if stop.is_asked() { 1 } else { steps / 2 };
        }
    }

    /// The mean of the fibres of a cell, by what has some.
    fn axis(&self, cell: usize, parts: &[Part], fibres: &[Vector]) -> Option<MeanAxis> {
        let has_fibre = |number: u16| self.tissue.materials[usize::from(number)].has_fibre();
        let shares: f64 = parts.iter().map(|(_, stress)| stress.trace()).sum();
        let with = parts
            .iter()
            .filter(|(number, _)| self.pure[usize::from(*number)].is_some_and(has_fibre));
        let mut sum: Matrix3<f64> = with.map(|(_, stress)| stress).sum();
        if has_fibre(self.tissue.material_of_cell[cell]) && shares < 1.0 {
            let own = fibres.get(cell).copied().unwrap_or_default();
            sum += own * own.transpose() * (1.0 - shares);
        }
        MeanAxis::of(&sum)
    }

    fn has_fibre(&self, cell: usize) -> bool {
        let number = self.tissue.material_of_cell[cell];
        self.tissue.materials[usize::from(number)].has_fibre()
    }

    /// Gives a cell its mixture; whether it is of one part, and how much the rule matters.
    fn fill(&mut self, cell: usize, recipe: Recipe, steps: u16) -> (bool, f64) {
        let (below, own) = &recipe;
        let rest = steps - own.iter().map(|(_, share)| share).sum::<u16>();
        let pure = |number: u16| self.pure[usize::from(number)].unwrap_or(*below);
        let most = own.iter().rev().max_by_key(|(_, share)| *share);
        if let Some((number, _)) = most.filter(|(_, share)| *share > rest) {
            self.tissue.pressure_of_cell[cell] = pure(*number);
        }
        if let ([(number, _)], 0) = (&own[..], rest) {
            self.tissue.material_of_cell[cell] = pure(*number);
            return (true, 1.0);
        }
        let parts = own.iter().map(|(number, share)| (pure(*number), *share));
        let parts = parts.chain([(*below, rest)]).filter(|(_, share)| *share > 0);
        let parts: Vec<(f64, LinearElastic)> = parts
            .map(|(number, share)| {
                (f64::from(share) / f64::from(steps), self.tissue.materials[usize::from(number)])
            })
            .collect();
        let (rule, materials) = (self.rule, &mut self.tissue.materials);
        let (number, ratio) = *self.made.entry(recipe).or_insert_with(|| {
            let EquivalentTissue { tissue, rule_ratio } = EquivalentTissue::new(&parts, rule);
            materials.push(tissue);
            ((materials.len() - 1) as u16, rule_ratio)
        });
        self.tissue.material_of_cell[cell] = number;
        (false, ratio)
    }
}

/// The muscles of a cell in steps that sum to `steps` at most: the differences of rounded sums, so that none is off by more than one.
fn in_steps(parts: &[Part], steps: u16) -> Vec<(u16, u16)> {
    let total: f64 = parts.iter().map(|(_, stress)| stress.trace()).sum();
    let scale = f64::from(steps) / total.max(1.0);
    let (mut sum, mut before) = (0.0, 0);
    let counted = parts.iter().map(|(number, stress)| {
        sum += stress.trace() * scale;
        let reached = (sum.round() as u16).min(steps);
        let own = reached - before;
        before = reached;
        (*number, own)
    });
    counted.filter(|(_, own)| *own > 0).collect()
}

impl MuscleTissue {
    fn warnings(&self) -> Vec<Warning> {
        let MuscleTissue { cells, crossing, rule_decides, .. } = *self;
        let crossed = format!(
            "in {crossing} of {cells} cells with muscles in them fibres cross, and one axis stands for them"
        );
        let decided = format!(
            "in {:.1} % of the tissue the stiffest mixture of its muscles is more than three times as stiff as the softest: what is \
             predicted there depends on `muscle_mixing`",
            100.0 * rule_decides
        );
        let crossed = Warning::new("muscles-cross", crossed).with("cells", crossing as f64);
        let decided = Warning::new("mixing-decides", decided).with("volume_share", rule_decides);
        let told = [
            (crossing > 0).then(|| crossed.with("of", cells as f64)),
            (rule_decides > DECIDED).then_some(decided),
        ];
        told.into_iter().flatten().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_in_steps_keep_their_sum_and_are_taken_down_together() {
        let part = |number, share: f64| (number, Matrix3::from_diagonal(&[share, 0.0, 0.0].into()));
        assert_eq!(in_steps(&[part(0, 0.3), part(2, 0.3)], 512), [(0, 154), (2, 153)]);
        assert_eq!(in_steps(&[part(0, 0.9), part(1, 0.6)], 10), [(0, 6), (1, 4)]);
        assert_eq!(in_steps(&[part(0, 0.4), part(1, 0.4)], 1), [(1, 1)]);
        assert_eq!(in_steps(&[part(0, 0.0004)], 512), []);
    }
}
