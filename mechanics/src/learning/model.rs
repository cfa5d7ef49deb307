//! A learned model: the cases that it learned from, and the corrected prediction of a new one.

use super::bands::band;
use super::cohort::{Cohort, LearningCase};
use super::features::{Distance, Features};
use super::learner::{ComparedCases, Fitted, LeftOut, Method, bone_products, without};
use super::pairs::blended;

/// What was learned, ready to be asked.
#[derive(Clone, Debug, PartialEq)]
pub struct LearnedModel {
    pub method: Method,
    pub fitted: Fitted,
    /// Of the training cases, in their order.
    pub cases: Vec<LearningCase>,
    answers: Vec<Vec<f64>>,
    /// Each of them predicted from the others, of which bands are made.
    left_out: Vec<LeftOut>,
}

/// What is known of a case before its operation.
#[derive(Clone, Copy)]
pub struct PreoperativeCase<'a> {
    pub features: &'a Features,
    pub bone: &'a [f64],
    /// How mechanics says that the skin moves.
    pub predicted: &'a [f64],
}

/// A displacement of the skin in mm that was learned.
#[derive(Clone, Debug, PartialEq)]
pub struct Corrected {
    pub displacement: Vec<f64>,
    /// The ends of the band from 10 to 90 % of each number; absent where training cases are too few.
    pub band: Option<Vec<[f64; 2]>>,
    /// From the nearest training case, which is this one.
    pub distance: f64,
    pub nearest: usize,
}

/// Why a model says nothing about a case.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    #[error(
        "the case is {distance:.3} from the nearest that the model learned from, {nearest:?}, and 95 % of those are within {farthest:.3} of each other"
    )]
    OutOfDistribution { distance: f64, farthest: f64, nearest: String },
    #[error("{what} has {found} numbers, and {expected} in what the model learned from")]
    OtherMesh { what: &'static str, found: usize, expected: usize },
}

impl LearnedModel {
    /// Learns from all cases of a cohort.
    pub fn new(cohort: &Cohort, method: Method, distance: Distance) -> Self {
        let compared = ComparedCases::new(cohort, method.target, distance);
        let all: Vec<usize> = (0..cohort.len()).collect();
        let fitted = compared.fit(method.learner, &all);
        LearnedModel {
            method,
            cases: cohort.cases.clone(),
            left_out: compared.left_out(&fitted, method.learner, &all),
            fitted,
            answers: compared.answers,
        }
    }

    /// The displacement of a case that is of the kind of those that were learned from.
    pub fn correct(&self, asked: PreoperativeCase) -> Result<Corrected, Refusal> {
        self.fits(asked)?;
        let standard = &self.fitted.standard;
        let apart = |case: &LearningCase| {
            standard.of(asked.features.apart(&case.features, standard.distance))
        };
        let distances: Vec<f64> = self.cases.iter().map(apart).collect();
        let nearest = (0..distances.len()).min_by(|&a, &b| distances[a].total_cmp(&distances[b]));
        let nearest = nearest.unwrap_or_default();
        let distance = distances[nearest];
        if distance > self.fitted.farthest {
            let (farthest, nearest) = (self.fitted.farthest, self.cases[nearest].name.clone());
            return Err(Refusal::OutOfDistribution { distance, farthest, nearest });
        }
        let bone = bone_products(asked.bone, &self.cases);
        let known: Vec<&[f64]> = self.answers.iter().map(Vec::as_slice).collect();
        let weights = self.fitted.weights(&distances, &bone);
        let told = blended(&weights, &known);
        let displacement = self.method.target.displacement(told, asked.predicted);
        Ok(Corrected {
            displacement,
            band: self.band(asked, [&distances, &bone]),
            distance,
            nearest,
        })
    }

    /// What each training case makes of a case at these distances and with these products of bone.
    fn band(&self, asked: PreoperativeCase, of_cases: [&Vec<f64>; 2]) -> Option<Vec<[f64; 2]>> {
        let weights = |left: &LeftOut| {
            let [distances, bone] = of_cases.map(|all| without(all, left.place));
            let mut weights = left.fitted.weights(&distances, &bone);
            weights.insert(left.place, 0.0);
            weights
        };
        let weights: Vec<Vec<f64>> = self.left_out.iter().map(weights).collect();
        band(self.left_out.len(), asked.predicted.len(), |place, range| {
            let known = self.answers.iter().map(|own| &own[range.clone()]);
            let known: Vec<&[f64]> = known.collect();
            let told = blended(&weights[place], &known);
            let told = self.method.target.displacement(told, &asked.predicted[range.clone()]);
            blended(&[1.0, 1.0], &[&told, &self.left_out[place].missed[range]])
        })
    }

    fn fits(&self, asked: PreoperativeCase) -> Result<(), Refusal> {
        let Some(first) = self.cases.first() else { return Ok(()) };
        let blocks = asked.features.blocks.iter().zip(&first.features.blocks);
        let pairs = [
            ("the skin", asked.predicted.len(), first.predicted.len()),
            ("bone", asked.bone.len(), first.bone.len()),
            ("the features", asked.features.blocks.len(), first.features.blocks.len()),
        ];
        let pairs = pairs.into_iter().chain(blocks.map(|(a, b)| ("a feature", a.len(), b.len())));
        for (what, found, expected) in pairs {
            if found != expected {
                return Err(Refusal::OtherMesh { what, found, expected });
            }
        }
        Ok(())
    }
}
