//! Learners: what is learned, by which rule, and the weights that the rule gives to the training cases.
//!
//! A regression and a deformation model both answer with a mean of the training cases, weighted by what the new one has in
//! common with them: features there, bone here. What they answer is the displacement itself, or what mechanics missed, which is
//! added to the mechanical prediction of the new case.

use rayon::prelude::*;

use super::bands::farthest;
use super::cohort::{Cohort, LearningCase};
use super::deformation_model::{
    DeformationModel, Fit, ModeCount, ModeRule, RIDGE, best_mode_count,
};
use super::features::{Distance, FeatureSpace, Features, Standard};
use super::pairs::{Pairs, blended, dot};
use super::regression::{LeaveOneOut, Width, weights};

/// The rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Learner {
    /// General regression neural network.
    Regression,
    /// Statistical deformation model with the modes that predict training cases best from each other.
    DeformationModel,
    /// The same with the modes that hold 95 % of the variance.
    DeformationModelByVariance,
}

/// What is learned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    Displacement,
    /// Of the displacement to its mechanical prediction.
    Residual,
}

/// What is learned and by which rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Method {
    pub learner: Learner,
    pub target: Target,
}

impl Method {
    /// Every method, in the order of tables.
    pub const ALL: [Method; 6] = [
        Method { learner: Learner::Regression, target: Target::Displacement },
        Method { learner: Learner::DeformationModel, target: Target::Displacement },
        Method { learner: Learner::DeformationModelByVariance, target: Target::Displacement },
        Method { learner: Learner::Regression, target: Target::Residual },
        Method { learner: Learner::DeformationModel, target: Target::Residual },
        Method { learner: Learner::DeformationModelByVariance, target: Target::Residual },
    ];

    /// As tables call it, beside the method of mechanical predictions.
    pub fn name(self, mechanical: &str) -> String {
        let learner = match self.learner {
            Learner::Regression => "GRNN",
            Learner::DeformationModel => "SDM",
            Learner::DeformationModelByVariance => "SDM of 95 %",
        };
        match self.target {
            Target::Displacement => learner.to_owned(),
            Target::Residual => format!("{mechanical} + {learner}"),
        }
    }
}

impl Target {
    /// Of a case from which is learned.
    pub fn of(self, case: &LearningCase) -> Vec<f64> {
        match self {
            Target::Displacement => case.actual.clone(),
            Target::Residual => {
                case.actual.iter().zip(&case.predicted).map(|(own, told)| own - told).collect()
            }
        }
    }

    /// The displacement that an answer means for a case.
    pub fn displacement(self, answer: Vec<f64>, predicted: &[f64]) -> Vec<f64> {
        match self {
            Target::Displacement => answer,
            Target::Residual => {
                answer.iter().zip(predicted).map(|(own, told)| own + told).collect()
            }
        }
    }
}

/// The cases of a cohort compared with each other, once for all that is fitted to some of them.
pub struct ComparedCases<'a> {
    pub cohort: &'a Cohort,
    pub target: Target,
    pub answers: Vec<Vec<f64>>,
    space: FeatureSpace,
    bone: Pairs,
    /// Of answers, from their mean.
    products: Pairs,
}

/// A rule fitted to training cases.
#[derive(Clone, Debug, PartialEq)]
pub struct Fitted {
    pub standard: Standard,
    pub rule: Rule,
    /// The distance from the nearest training case beyond which a case is not of their kind.
    pub farthest: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Rule {
    Regression(Width),
    DeformationModel(DeformationModel),
}

impl Rule {
    /// Of a deformation model.
    pub fn modes(&self) -> Option<ModeCount> {
        match self {
            Rule::Regression(_) => None,
            Rule::DeformationModel(model) => Some(model.modes),
        }
    }
}

impl Fitted {
    /// Of training cases at these distances, whose bone has these scalar products with that of the new case.
    pub fn weights(&self, distances: &[f64], bone: &[f64]) -> Vec<f64> {
        match &self.rule {
            Rule::Regression(width) => weights(distances, width.width),
            Rule::DeformationModel(model) => model.weights(bone),
        }
    }
}

impl<'a> ComparedCases<'a> {
    pub fn new(cohort: &'a Cohort, target: Target, distance: Distance) -> Self {
        let features: Vec<Features> =
            cohort.cases.iter().map(|case| case.features.clone()).collect();
        let answers: Vec<Vec<f64>> = cohort.cases.iter().map(|case| target.of(case)).collect();
        let bone: Vec<&[f64]> = cohort.cases.iter().map(|case| case.bone.as_slice()).collect();
        let slices: Vec<&[f64]> = answers.iter().map(Vec::as_slice).collect();
        ComparedCases {
            cohort,
            target,
            space: FeatureSpace::new(&features, distance),
            bone: Pairs::products(&bone),
            products: Pairs::centred_products(&slices),
            answers,
        }
    }

    /// A rule fitted to some cases and to nothing else.
    pub fn fit(&self, learner: Learner, training: &[usize]) -> Fitted {
        let rule = match learner {
            Learner::Regression => Rule::Regression(self.leave_one_out(training).best_width()),
            Learner::DeformationModel => {
                let [skin, bone] = [&self.products, &self.bone].map(|own| own.among(training));
                self.modes(training, ModeRule::Count(best_mode_count(&skin, &bone, RIDGE)))
            }
            Learner::DeformationModelByVariance => self.modes(training, Fit::default().modes),
        };
        self.standardised(rule, training)
    }

    /// What is not tuned fitted to some cases, with the width or the number of modes that were tuned on others.
    pub fn fit_as_tuned(&self, tuned: &Rule, learner: Learner, training: &[usize]) -> Fitted {
        let rule = match (tuned, learner) {
            (Rule::Regression(_), _) => tuned.clone(),
            (Rule::DeformationModel(model), Learner::DeformationModel) => {
                self.modes(training, ModeRule::Count(model.modes.count))
            }
            (
                Rule::DeformationModel(_),
                Learner::Regression | Learner::DeformationModelByVariance,
            ) => self.modes(training, Fit::default().modes),
        };
        self.standardised(rule, training)
    }

    /// Training cases predicted from each other by regression, of which a width is searched.
    pub fn leave_one_out(&self, training: &[usize]) -> LeaveOneOut {
        LeaveOneOut::new(self.space.distances(training), self.products.among(training))
    }

    fn modes(&self, training: &[usize], modes: ModeRule) -> Rule {
        let [skin, bone] = [&self.products, &self.bone].map(|own| own.among(training));
        Rule::DeformationModel(DeformationModel::new(&skin, &bone, Fit { ridge: RIDGE, modes }))
    }

    fn standardised(&self, rule: Rule, training: &[usize]) -> Fitted {
        let farthest = farthest(&self.space.distances(training));
        Fitted { standard: self.space.standard(training), rule, farthest }
    }

    /// The displacement of a case, from training cases among which it need not be.
    pub fn displacement(&self, fitted: &Fitted, case: usize, training: &[usize]) -> Vec<f64> {
        let weights =
            fitted.weights(&self.space.row(case, training), &self.bone.row(case, training));
        let known: Vec<&[f64]> = training.iter().map(|&own| self.answers[own].as_slice()).collect();
        self.target.displacement(blended(&weights, &known), &self.cohort.cases[case].predicted)
    }

    /// How far a case is from the nearest training case.
    pub fn nearest(&self, case: usize, training: &[usize]) -> f64 {
        self.space.row(case, training).into_iter().fold(f64::INFINITY, f64::min)
    }

    /// Each training case predicted from the others by a rule that was tuned on all of them.
    pub fn left_out(&self, whole: &Fitted, learner: Learner, training: &[usize]) -> Vec<LeftOut> {
        let of = |(place, &case): (usize, &usize)| {
            let others = without(training, place);
            let fitted = self.fit_as_tuned(&whole.rule, learner, &others);
            let told = self.displacement(&fitted, case, &others);
            let actual = &self.cohort.cases[case].actual;
            let missed = actual.iter().zip(&told).map(|(own, told)| own - told).collect();
            LeftOut { place, fitted, missed }
        };
        training.par_iter().enumerate().map(of).collect()
    }
}

/// A training case that was left out.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftOut {
    /// Among the training cases.
    pub place: usize,
    /// To the others.
    pub fitted: Fitted,
    /// What was measured less what was predicted from the others.
    pub missed: Vec<f64>,
}

/// All but one, by its place.
pub fn without<T: Copy>(all: &[T], place: usize) -> Vec<T> {
    [&all[..place], &all[place + 1..]].concat()
}

/// Scalar products of the bone of a new case with those of training cases.
pub fn bone_products(bone: &[f64], cases: &[LearningCase]) -> Vec<f64> {
    cases.iter().map(|case| dot(bone, &case.bone)).collect()
}
