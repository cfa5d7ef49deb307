//! A cohort to learn from: operated cases on meshes whose nodes correspond.

use std::collections::BTreeMap;

use super::features::Features;
use super::pairs::dot;

/// Fewer cases leave none to learn from once one is left out.
pub const LEAST_CASES: usize = 3;

/// An operated case. Displacements in mm, three numbers for each point of the skin or node of bone.
#[derive(Clone, Debug, PartialEq)]
pub struct LearningCase {
    pub name: String,
    /// Of surgery, such as `single_jaw`.
    pub class: String,
    pub features: Features,
    /// How bone was moved.
    pub bone: Vec<f64>,
    /// How mechanics says that the skin moves.
    pub predicted: Vec<f64>,
    /// How it was measured to have moved.
    pub actual: Vec<f64>,
}

/// Cases that have passed [`Cohort::new`].
#[derive(Clone, Debug, PartialEq)]
pub struct Cohort {
    pub cases: Vec<LearningCase>,
    /// Named parts of the skin, as points.
    pub regions: BTreeMap<String, Vec<u32>>,
    /// The method of the mechanical predictions, by which tables call them.
    pub mechanical: String,
}

/// From whom a case is predicted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pool {
    /// All other cases.
    Others,
    /// Cases of other classes of surgery: what nobody who is learned from has had.
    OtherClasses,
}

/// Cases that something is learned from are this many at least.
pub const LEAST_TRAINING: usize = LEAST_CASES - 1;

/// Why nothing can be learned from some cases; cases by their place.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CohortError {
    #[error("{cases} cases are too few: with one left out at least {} are needed", LEAST_CASES)]
    TooFew { cases: usize },
    #[error("{name:?} is there twice, as case {first} and case {second}")]
    NamedTwice { name: String, first: usize, second: usize },
    #[error(
        "cases {first} and {second} have the same movement of the skin to the last digit: one patient is there twice"
    )]
    SamePatient { first: usize, second: usize },
    #[error(
        "{what} of case {case} has {found} numbers and that of case 0 {expected}: the meshes do not correspond"
    )]
    Length { case: usize, what: &'static str, found: usize, expected: usize },
    #[error("{what} of case {case} holds a number that is not finite")]
    NotFinite { case: usize, what: &'static str },
    #[error("region {region:?} names point {point} of {points}")]
    NoSuchPoint { region: String, point: u32, points: usize },
}

impl LearningCase {
    /// How far the node of bone goes that goes farthest, in mm.
    pub fn largest_bone_movement(&self) -> f64 {
        let lengths = self.bone.chunks_exact(3).map(|own| dot(own, own).sqrt());
        lengths.fold(0.0, f64::max)
    }
}

impl Cohort {
    /// Checks that the cases are several, different and of one mesh.
    pub fn new(
        cases: Vec<LearningCase>,
        regions: BTreeMap<String, Vec<u32>>,
        mechanical: &str,
    ) -> Result<Self, CohortError> {
        if cases.len() < LEAST_CASES {
            return Err(CohortError::TooFew { cases: cases.len() });
        }
        for (place, case) in cases.iter().enumerate() {
            same_shape(place, case, &cases[0])?;
            not_seen_before(place, case, &cases[..place])?;
        }
        let points = cases[0].actual.len() / 3;
        for (region, own) in &regions {
            if let Some(&point) = own.iter().find(|point| **point as usize >= points) {
                return Err(CohortError::NoSuchPoint { region: region.clone(), point, points });
            }
        }
        Ok(Cohort { cases, regions, mechanical: mechanical.to_owned() })
    }

    pub fn len(&self) -> usize {
        self.cases.len()
    }

    pub fn is_empty(&self) -> bool {
        self.cases.is_empty()
    }

    /// All cases but one.
    pub fn others(&self, case: usize) -> Vec<usize> {
        (0..self.len()).filter(|&other| other != case).collect()
    }

    /// Whom a case may be predicted from.
    pub fn pool(&self, pool: Pool, case: usize) -> Vec<usize> {
        match pool {
            Pool::Others => self.others(case),
            Pool::OtherClasses => {
                let is_other = |other: &usize| self.cases[*other].class != self.cases[case].class;
                (0..self.len()).filter(is_other).collect()
            }
        }
    }

    /// Of how many each case can be predicted at least.
    pub fn smallest_pool(&self, pool: Pool) -> usize {
        (0..self.len()).map(|case| self.pool(pool, case).len()).min().unwrap_or_default()
    }
}

fn same_shape(place: usize, case: &LearningCase, first: &LearningCase) -> Result<(), CohortError> {
    let blocks = case.features.blocks.iter().zip(&first.features.blocks);
    let vectors = [
        ("the displacement", &case.actual, &first.actual),
        ("the prediction", &case.predicted, &first.actual),
        ("bone", &case.bone, &first.bone),
    ];
    let vectors =
        vectors.into_iter().chain(blocks.map(|(own, of_first)| ("a feature", own, of_first)));
    for (what, own, of_first) in vectors {
        let (found, expected) = (own.len(), of_first.len());
        if found != expected {
            return Err(CohortError::Length { case: place, what, found, expected });
        }
        if own.iter().any(|value| !value.is_finite()) {
            return Err(CohortError::NotFinite { case: place, what });
        }
    }
    let [found, expected] = [case, first].map(|own| own.features.blocks.len());
    match found == expected {
        true => Ok(()),
        false => Err(CohortError::Length { case: place, what: "the features", found, expected }),
    }
}

fn not_seen_before(
    second: usize,
    case: &LearningCase,
    before: &[LearningCase],
) -> Result<(), CohortError> {
    if let Some(first) = before.iter().position(|other| other.name == case.name) {
        return Err(CohortError::NamedTwice { name: case.name.clone(), first, second });
    }
    match before.iter().position(|other| other.actual == case.actual) {
        Some(first) => Err(CohortError::SamePatient { first, second }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case(name: &str, moved: f64) -> LearningCase {
        LearningCase {
            name: name.to_owned(),
            class: "single_jaw".to_owned(),
            features: Features { blocks: vec![vec![moved; 4]] },
            bone: vec![moved; 3],
            predicted: vec![moved; 6],
            actual: vec![1.1 * moved; 6],
        }
    }

    fn of(cases: &[LearningCase]) -> Result<Cohort, CohortError> {
        Cohort::new(cases.to_vec(), BTreeMap::new(), "fem_linear")
    }

    #[test]
    fn bone_moves_as_far_as_its_farthest_node() {
        let mut own = case("a", 1.0);
        own.bone = vec![1.0, -1.0, 0.5, 3.0, 0.0, -4.0, 0.0, 0.0, 4.9];
        assert_eq!(own.largest_bone_movement(), 5.0);
    }

    #[test]
    fn bad_cohorts_are_named() {
        let good = [case("a", 1.0), case("b", 2.0), case("c", 3.0)];
        assert!(of(&good).is_ok());
        assert_eq!(of(&good[..1]), Err(CohortError::TooFew { cases: 1 }));
        let mut bad = good.clone();
        bad[2].name = "a".to_owned();
        let twice = CohortError::NamedTwice { name: "a".to_owned(), first: 0, second: 2 };
        assert_eq!(of(&bad), Err(twice));
        let mut bad = good.clone();
        bad[2].actual = bad[1].actual.clone();
        assert_eq!(of(&bad), Err(CohortError::SamePatient { first: 1, second: 2 }));
        let mut bad = good.clone();
        bad[1].predicted.truncate(3);
        let (what, found, expected) = ("the prediction", 3, 6);
        assert_eq!(of(&bad), Err(CohortError::Length { case: 1, what, found, expected }));
        let mut bad = good.clone();
        bad[1].features.blocks[0][2] = f64::NAN;
        assert_eq!(of(&bad), Err(CohortError::NotFinite { case: 1, what: "a feature" }));
        let regions = BTreeMap::from([("lips".to_owned(), vec![0, 2])]);
        let beyond = CohortError::NoSuchPoint { region: "lips".to_owned(), point: 2, points: 2 };
        assert_eq!(Cohort::new(good.to_vec(), regions, "fem_linear"), Err(beyond));
    }
}
